"""Tables for a terminal, and tab-separated text where the output is no terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from typing import Any

from microfacet._console.evaluate import Evaluation
from microfacet._docs import QUANTITIES
from microfacet._optional import needed
from microfacet._text import printable

with needed("tables need"):
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

__all__ = ["console", "evaluation", "families", "show"]

LONGEST_CELL = 1000


def console() -> Console:
    """Standard output: as wide as the terminal, or wide enough for the tables where it is none."""
    return Console(width=None if sys.stdout.isatty() else 160)


def evaluation(out: Console, result: Evaluation) -> None:
    """One row per point; every digit that distinguishes the result."""
    names = [argument.name for argument in QUANTITIES[result.quantity].arguments]
    rows = [
        [*map(str, point), str(value)] for point, value in zip(result.points, result.results, strict=True)
    ]
    show(out, [*names, result.quantity], rows, left=0)


def families(out: Console, entries: Iterable[Any]) -> None:
    """Name, title, parameters with their intervals, whether it stretches, sources."""
    rows = [
        [
            family.name,
            family.title,
            ", ".join(f"{p.name} in ({p.lower:g}, {p.upper:g})" for p in family.parameters),
            "yes" if family.anisotropic else "no",
            ", ".join(family.sources),
        ]
        for family in entries
    ]
    show(out, ["family", "title", "parameters", "anisotropic", "sources"], rows, left=5)


def show(out: Console, headings: Sequence[str], rows: Sequence[Sequence[str]], left: int) -> None:
    """A table on a terminal; elsewhere tab-separated lines, which tools read. `left` columns are text."""
    if not out.is_terminal:
        for line in (headings, *rows):
            cells = (printable(cell, LONGEST_CELL) for cell in line)
            out.file.write("\t".join(cells) + "\n")  # rich would expand the tabs
        return
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for i, heading in enumerate(headings):
        table.add_column(heading, justify="left" if i < left else "right", overflow="fold")
    for row in rows:
        table.add_row(*(Text(printable(cell, LONGEST_CELL)) for cell in row))  # names of files are no markup
    out.print(table)
