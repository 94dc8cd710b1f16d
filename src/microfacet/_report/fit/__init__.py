"""The page of one fitted surface: map, slopes, ranking, scales, and the command that makes it again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from microfacet._files import replacing

__all__ = ["write"]


def write(path: str | Path, fitted: Any, command: str, progress: Callable[[str, int, int], None]) -> Path:
    """Draw and set the page, and put it in place of `path` once it is complete.

    Parameters
    ----------
    path : path
        The HTML file.
    fitted : object
        `results` of `fit`, `predictions`, and where there are any `surface` or `slopes`, `roughness`,
        `scales`; `source`, `steps`, `notes`.
    command : str
        The command line, for who wants the page again.
    progress : callable
        Called with (what begins, steps done, steps in all).

    Returns
    -------
    Path
        Of the page, absolute.
    """
    from microfacet._report import _page, _svg
    from microfacet._report.fit import _content

    with _svg.style():
        content = _content.collect(fitted, command, progress)
    page = _page.set_page("fit.html.j2", content=content)
    target = Path(path).absolute()
    with replacing(target) as stream:
        stream.write(page.encode())
    return target
