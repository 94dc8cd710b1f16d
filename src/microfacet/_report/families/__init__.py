"""The report on the families: one HTML file with every formula, figure and check, and a measured surface."""

from __future__ import annotations

import platform
import time
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from microfacet._checks import SIGNIFICANCE
from microfacet._files import replacing
from microfacet._report import Progress, page
from microfacet._report.families import content, formulas
from microfacet._report.sources import sources

__all__ = ["Report", "build", "set_page"]


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
    start = time.perf_counter()
    target = Path(path).absolute()
    if not target.parent.is_dir():
        raise ValueError(f"output must lie in an existing folder, got {str(path)!r}")
    collected = content.collect(families, parameters, surface, progress or (lambda *_: None), quick)
    seconds = time.perf_counter() - start
    with replacing(target) as stream:
        stream.write(set_page(collected, seconds).encode())
    return Report(target, collected.passed, collected.total, seconds)


def set_page(collected: content.Content, seconds: float) -> str:
    """The page that shows what was collected."""
    return page.set_page(
        "families.html.j2",
        content=collected,
        common=formulas.load().common,
        sources=sources(),
        significance=SIGNIFICANCE,
        python=platform.python_version(),
        numpy=np.__version__,
        seconds=seconds,
    )
