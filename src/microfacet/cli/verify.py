"""The command `microfacet verify`: every formula by a second route."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from microfacet.cli.parameters import parameter_options
from microfacet.cli.printing import console, progress_line
from microfacet.cli.program import families_option, json_option

if TYPE_CHECKING:
    from rich.console import Console

    from microfacet._checks import CheckItem, CheckResult

__all__ = ["verify"]


@click.command()
@click.option(
    "--grid",
    is_flag=True,
    help="Check over a grid of the whole domain (a minute or two); the table shows each check's worst point.",
)
@families_option
@click.option("--id", "ids", multiple=True, metavar="ID", help="This check, such as k0.sampling; repeatable.")
@parameter_options
@json_option
@click.pass_context
def verify(
    ctx: click.Context,
    grid: bool,
    families: tuple[str, ...],
    ids: tuple[str, ...],
    parameters: dict[str, float],
    as_json: bool,
) -> None:
    """Check every formula by a second route. The exit status is 1 when one fails.

    \b
    Examples:
      microfacet verify
      microfacet verify --family gtr --alpha 0.2 --gamma 1.7
      microfacet verify --id beckmann.sigma_delta --json
    """
    from microfacet import _checks

    out = None if as_json else console()
    items = _checks.catalogue()
    results: list[_checks.CheckResult] = []
    with progress_line() as progress:
        for result in _checks.run(ids or None, families or None, grid, parameters):
            results.append(result)
            progress(result.id, len(results), 0)
    if not results:
        raise click.UsageError("no check applies at these parameters")
    if out is None:
        click.echo(json.dumps(_record(results), indent=1, allow_nan=False))
    else:
        _print(out, items, results)
        _count(out, results)
        for line in _summary(results):
            click.echo(line)
    ctx.exit(0 if all(result.passed for result in results) else 1)


def _record(results: Sequence[CheckResult]) -> dict[str, Any]:
    """What --json prints: how the statements went, family by family, and each check at each point."""
    from microfacet import _checks

    families = {
        family: {kind: tally._asdict() for kind, tally in kinds.items()}
        for family, kinds in _checks.tallies(results).items()
    }
    return {"families": families, "checks": [result.as_dict() for result in results]}


def _print(out: Console, items: Sequence[CheckItem], results: Sequence[CheckResult]) -> None:
    """One row per check, at the worst of the parameters it ran at, grouped by family; then the histograms."""
    from rich import box
    from rich.table import Table

    from microfacet._checks import HISTOGRAM

    by_id: dict[str, list[CheckResult]] = {}
    for result in results:
        by_id.setdefault(result.id, []).append(result)
    sides = ("left side", "right side", "residual", "tolerance", "algebra")
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
        result.symbolic or "",
    ]


def _statistics(result: CheckResult) -> list[str]:
    from microfacet._checks import SIGNIFICANCE, p_value

    return [f"{result.lhs:.5g}", f"{result.rhs:g}", f"{p_value(result):.2g}", f"{SIGNIFICANCE:g}"]


def _count(out: Console, results: Sequence[CheckResult]) -> None:
    """Family by family: how many statements its notebook has, were checked, and hold; then our own."""
    from rich import box
    from rich.table import Table

    from microfacet import _checks

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("family")
    for heading in ("notebook's statements", "checked", "hold", "further ones", "checked", "hold"):
        table.add_column(heading, justify="right")
    for family, kinds in _checks.tallies(results).items():
        table.add_row(family, *(str(number) for tally in kinds.values() for number in tally))
    out.print(table)


def _summary(results: Sequence[CheckResult]) -> list[str]:
    """How many checks hold: the notebooks', then the further ones; why algebra was not run."""
    from microfacet import _checks
    from microfacet._optional import installed, sentence

    families = _checks.tallies(results).values()
    lines = []
    if len({result.id for result in results}) < len(results):
        lines.append(f"{len(results)} points; the table shows the worst of each check")
    if any(result.symbolic == _checks.NOT_RUN for result in results) and not installed("sympy"):
        lines.append(f"algebra was not run: {sentence('it needs', 'sympy')}")
    for kind in ("notebook", "further"):
        checked = sum(kinds[kind].checked for kinds in families)
        held = sum(kinds[kind].held for kinds in families)
        if checked:
            lines.append(f"{held} of {checked} {kind} checks hold")
    return lines


def _severity(result: CheckResult) -> float:
    ratio = result.residual / result.tolerance if result.tolerance else math.inf
    return math.inf if math.isnan(ratio) else ratio
