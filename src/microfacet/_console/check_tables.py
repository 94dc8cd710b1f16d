"""What `verify` prints: checks beside each other, histograms apart, and how many hold."""

from __future__ import annotations

import math
from collections.abc import Sequence

from microfacet._checks import HISTOGRAM, SIGNIFICANCE, CheckItem, CheckResult, p_value
from microfacet._optional import needed

with needed("tables need"):
    from rich import box
    from rich.console import Console
    from rich.table import Table

__all__ = ["checks", "summary"]


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
