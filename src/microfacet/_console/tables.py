"""Tables for a terminal, and tab-separated text where the output is no terminal."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from microfacet._checks import CheckItem, CheckResult
from microfacet._console.evaluate import Evaluation
from microfacet._text import printable

__all__ = ["checks", "console", "evaluation", "families", "show", "summary"]

LONGEST_CELL = 1000
_INPUTS = {"P22": ("p", "q"), "P2": ("p",), "slope_cdf": ("p",), "survival": ("r",), "sample_slope": ("xi",)}
_INPUTS["sample_u"] = ("xi",)


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


def checks(out: Console, items: Sequence[CheckItem], results: Sequence[CheckResult]) -> None:
    """One row per check, at the worst of the parameters it ran at, grouped by family; then the histograms."""
    by_id: dict[str, list[CheckResult]] = {}
    for result in results:
        by_id.setdefault(result.id, []).append(result)
    sides = ("left side", "right side", "residual", "tolerance")
    statistics = ("chi-square", "degrees of freedom", "p-value", "least accepted")
    for histograms, headings, numbers in ((False, sides, _sides), (True, statistics, _statistics)):
        table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
        for heading in ("check", "parameters"):
            table.add_column(heading, overflow="fold")
        for heading in headings:
            table.add_column(heading, justify="right")
        table.add_column("")
        family = None
        for item in items:
            if item.id not in by_id or (item.route == HISTOGRAM.name) != histograms:
                continue
            if family not in (None, item.family):
                table.add_section()
            family = item.family
            worst = max(by_id[item.id], key=_severity)
            holds = all(result.passed for result in by_id[item.id])
            table.add_row(
                item.id,
                ", ".join(f"{name} {value:g}" for name, value in worst.parameters.items()),
                *numbers(worst),
                "[green]✓ holds[/green]" if holds else "[bold red]✗ fails[/bold red]",
            )
        if table.row_count:
            out.print(table)


def _sides(result: CheckResult) -> list[str]:
    return [
        f"{result.lhs:.10g}",
        f"{result.rhs:.10g}",
        f"{result.residual:.1e}",
        f"{result.tolerance:.1e}",
    ]


def _statistics(result: CheckResult) -> list[str]:
    return [f"{result.lhs:.5g}", f"{result.rhs:g}", f"{p_value(result):.2g}", f"{SIGNIFICANCE:g}"]


def summary(items: Sequence[CheckItem], results: Sequence[CheckResult]) -> list[str]:
    """How many checks hold: the notebooks', then the further ones; one holds if all its results do."""
    held: dict[str, bool] = {}
    for result in results:
        held[result.id] = held.get(result.id, True) and result.passed
    lines = []
    for kind, notebook in (("notebook", True), ("further", False)):
        ids = [item.id for item in items if item.notebook == notebook and item.id in held]
        if ids:
            lines.append(f"{sum(held[name] for name in ids)} of {len(ids)} {kind} checks hold")
    if len(results) > len(held):
        lines.insert(0, f"{len(results)} points; the table shows the worst of each check")
    return lines


def _severity(result: CheckResult) -> float:
    ratio = result.residual / result.tolerance if result.tolerance else math.inf
    return math.inf if math.isnan(ratio) else ratio


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
