"""The commands: run, check, page, materials, mitsuba."""

from __future__ import annotations

import datetime
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from . import charts, gate, machine, page, scaling_page, suite
from .materials import materials
from .mitsuba import mitsuba
from .results import Results, write_whole
from .runner import CONSOLE, Settings, consume, measure, show

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "performance.md"
TRY = Settings(seconds=0.05, lengths=(suite.CACHE,), longest=10_000)
FULL = Settings(seconds=0.4, lengths=(suite.CACHE, suite.MILLION, suite.MEMORY), longest=10**8)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
def main() -> None:
    """How fast microfacet is, beside a copy, exp, NumPy, SciPy and Mitsuba 3."""


def _file(name: str, destination: str, help: str) -> Callable[[Any], Any]:
    kind = click.Path(dir_okay=False, path_type=Path)
    return click.option(name, destination, type=kind, metavar="PATH", help=help)


NAMES = "Only these names, as 'ggx.*', '*(varying)', 'mitsuba.*', 'arrays.*' or 'scaling.*'."


@main.command()
@click.option("--quick", is_flag=True, help="Short arrays and few rounds: seconds instead of minutes.")
@click.option("--only", metavar="PATTERN", default="*", help=NAMES)
@click.option("--length", "lengths", type=click.IntRange(1), multiple=True, metavar="N", help="Repeatable.")
@click.option("--seconds", type=float, metavar="X", help="Budget for each kernel, precision and length.")
@_file("--json", "file", "Also write the results here.")
@_file("--output", "output", "The page; its charts go into images/ beside it. [docs/performance.md]")
def run(
    quick: bool,
    only: str,
    lengths: tuple[int, ...],
    seconds: float | None,
    file: Path | None,
    output: Path | None,
) -> None:
    """Measure, print ratios and write the page with its charts.

    The page of a part (--quick, --only, --length) is written only where --output says.
    """
    usual = TRY if quick else FULL
    settings = replace(usual, seconds=seconds or usual.seconds, lengths=lengths or usual.lengths)
    results = Results(machine.describe(), f"{datetime.datetime.now():%Y-%m-%d %H:%M}")
    if results.machine["busy"] > 0.5:
        CONSOLE.print(
            "Another process is using the processors: what follows will be worse than it is.", style="yellow"
        )
    measure(results, only, settings)
    show(results)
    if file:
        results.write(file)
    partial = quick or bool(lengths) or only != "*"
    if output or not partial:
        _write_page(results, output or PAGE)


@main.command(name="page")
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--output", type=click.Path(dir_okay=False, path_type=Path), default=PAGE)
def rewrite(file: Path, output: Path) -> None:
    """Write the page again from the results in FILE (run --json)."""
    _write_page(Results.read(file), output)


@main.command()
@click.option("--record", is_flag=True, help="Measure, and set the thresholds from it, instead of checking.")
@click.option(
    "--seconds", type=float, default=0.1, show_default=True, help="Budget for each kernel and precision."
)
@click.option("--thresholds", type=click.Path(dir_okay=False, path_type=Path), default=gate.THRESHOLDS)
def check(record: bool, seconds: float, thresholds: Path) -> None:
    """Compare with what the kernels have reached before; exit status 1 if one has become much slower."""
    count = len(gate.GATED) * len(suite.DTYPES)
    if record:
        consume(gate.record(5 * seconds, thresholds), count)
        return
    known = gate.read(thresholds)
    isa = machine.instruction_set()
    if isa not in known:
        CONSOLE.print(f"{thresholds.name} has no thresholds for {isa}: nothing is checked.")
        return
    done = consume(gate.check(seconds, known), count, lambda entry: entry[0])
    failures = [sentence for _, found in done for sentence in found]
    for sentence in failures:
        click.echo(sentence, err=True)
    CONSOLE.print(f"{len(done)} kernels checked ({isa}), {sum(bool(found) for _, found in done)} too slow")
    sys.exit(1 if failures else 0)


main.add_command(materials)
main.add_command(mitsuba)


def _write_page(results: Results, output: Path) -> None:
    output.parent.mkdir(parents=True, exist_ok=True)
    images = output.parent / "images"
    if results.measurements:
        charts.speeds(results, images / "performance.png", page.main_length(results))
    if results.scaling.get("lengths"):
        charts.scaling(results, images / "performance_scaling.png")
    write_whole(output, page.document(results, scaling_page.SECTIONS))
    CONSOLE.print(str(output))


if __name__ == "__main__":
    main(prog_name="python -m benchmarks")
