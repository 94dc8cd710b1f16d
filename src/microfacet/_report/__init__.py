"""The report: one HTML file with every formula, figure and check, and a measured surface.

`build` collects the numbers from the library, lets `_figures` draw them and `_page` set them, and
writes the file in one step.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from microfacet._files import replacing
from microfacet._optional import require

__all__ = ["Progress", "Report", "build"]

require("the report needs", "report")

#: Told what begins, how many steps are done, and how many there are.
Progress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Report:
    """Where the page is, how the checks went, how long it took."""

    path: Path
    passed: int
    total: int
    seconds: float


def build(
    path: str | Path,
    families: Collection[str] | None = None,
    parameters: Mapping[str, float] | None = None,
    surface: Any = None,
    progress: Progress | None = None,
    quick: bool = False,
) -> Report:
    """Build the report and write it to `path`.

    Parameters
    ----------
    path : path
        The HTML file. It is replaced once the page is complete, never half-written.
    families : collection of str, optional
        Limits the report to these families.
    parameters : mapping, optional
        Replaces the notebooks' parameters in curves and checks: alpha, gamma, a.
    surface : Surface, optional
        A measured surface to fit and show.
    progress : callable, optional
        Called with (what begins, steps done, steps in all).
    quick : bool
        Leave the table of checks out.

    Returns
    -------
    Report

    Raises
    ------
    ValueError
        An unknown family, or a parameter outside its interval.
    """
    from microfacet._report import _content, _page

    start = time.perf_counter()
    target = Path(path).absolute()
    if not target.parent.is_dir():
        raise ValueError(f"output must lie in an existing folder, got {str(path)!r}")
    content = _content.collect(families, parameters, surface, progress or (lambda *_: None), quick)
    seconds = time.perf_counter() - start
    with replacing(target) as stream:
        stream.write(_page.render(content, seconds).encode())
    return Report(target, content.passed, content.total, seconds)
