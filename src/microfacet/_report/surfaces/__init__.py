"""The page of one fitted surface: map, slopes, ranking, scales, and the command that makes it again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from microfacet._files import replacing
from microfacet._report import Progress, figure
from microfacet._report.page import set_page
from microfacet._report.surfaces.content import collect

__all__ = ["write"]


def write(path: str | Path, fitted: Any, command: str, progress: Progress) -> Path:
    """Draw and set the page, and put it in place of `path` once it is complete.

    Parameters
    ----------
    path : path
        The HTML file.
    fitted : object
        What was `measured` (a surface or slopes), `results` of `fit`, `predictions`, and where there are any
        `roughness` and `scales`.
    command : str
        The command line, for who wants the page again.
    progress : callable
        Called with (what begins, steps done, steps in all).

    Returns
    -------
    Path
        Of the page, absolute.
    """
    with figure.style():
        content = collect(fitted, command, progress)
    page = set_page("surface.html.j2", content=content)
    target = Path(path).absolute()
    with replacing(target) as stream:
        stream.write(page.encode())
    return target
