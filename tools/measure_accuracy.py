"""Measure every function against arbitrary precision and write docs/accuracy.md.

    python tools/measure_accuracy.py [--points 1000] [--seed 1] [--output docs/accuracy.md]

The ranges, strata and tolerances are those of tests/test_accuracy.py (tests/accuracy_points.py); only the
number of points and the seed differ. Exit status 1 when a point lies outside the contract.
"""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass, field
from pathlib import Path

import click
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

import microfacet as mf  # noqa: E402
import reference  # noqa: E402
from accuracy_points import CONTRACTS, QUANTITIES, Measurement, measure, points  # noqa: E402

CHUNK = 100
INTRODUCTION = """\
# Accuracy

Written by `tools/measure_accuracy.py`; do not edit. Largest error of each function against arbitrary
precision (`tests/reference.py`) at the exact floating-point arguments, and the arguments where it occurs:
those of the function, then the parameters, in the order of the ufunc, shown to 9 digits.

The errors are relative; those of `sample_u` absolute, because a cosine near 1 carries no information. The
points are a Latin sample of strata that cover the ranges of the contract: alpha 1e-4 to 10; u = 0 or
1e-12 <= abs(u) <= 1; slopes to 1e6 max(alpha, 1); uniform numbers down to 1e-300; gtr gamma 0.25 to 15;
student_t gamma - 3/2 from 1e-4 (gamma from 1.05 for densities and sampling) to 1e6; bessel_k a 0.05 to 150;
every end, and the special values gtr gamma = 1, 1 + 1e-10, 3/2, 2, alpha = 1, 1 + 1e-9, half-integer and
integer a.
"""


@dataclass
class Cell:
    """One row of the table: a function of a family in one precision."""

    family: str
    quantity: str
    dtype: str
    count: int = 0
    worst: dict[bool, Measurement] = field(default_factory=dict)  # inside False, beyond True
    failures: list[Measurement] = field(default_factory=list)

    def add(self, measurement: Measurement) -> None:
        self.count += 1
        if not measurement.ok:
            self.failures.append(measurement)
        if measurement.tolerance == 0.0 and measurement.ok:  # zeros, infinities, permitted underflow
            return
        best = self.worst.get(measurement.tail)
        if best is None or measurement.error > best.error:
            self.worst[measurement.tail] = measurement

    def row(self) -> str:
        cells = [f"`{self.quantity}`", self.dtype, str(self.count)]
        for tail in (False, True):
            found = self.worst.get(tail)
            cells += [f"{found.error:.1e}", f"`{_point(found)}`"] if found else ["", ""]
        return "| " + " | ".join(cells) + " |"


def _point(measurement: Measurement) -> str:
    return ", ".join(f"{x:.9g}" for x in measurement.arguments)


def _document(cells: list[Cell], count: int, seed: int) -> str:
    lines = [INTRODUCTION]
    for dtype, contract in CONTRACTS.items():
        lines.append(
            f"- {dtype}: at most {contract.tolerance:g} where abs(log(value)) < {contract.central:g} "
            f"(inside), and {contract.tail_tolerance:g} beyond, for values above {contract.smallest:g}; "
            "smaller ones may be 0."
        )
    failures = sum(len(cell.failures) for cell in cells)
    total = sum(cell.count for cell in cells)
    lines += [
        "",
        f"{total} values ({count} points per function, seed {seed}); {failures} outside the contract.",
    ]
    for family in reference.FAMILIES:
        lines += ["", f"## {family}", ""]
        lines += [
            "| function | precision | values | inside | at | beyond | at |",
            "|---|---|---|---|---|---|---|",
        ]
        lines += [cell.row() for cell in cells if cell.family == family]
    return "\n".join(lines) + "\n"


@click.command(help=__doc__)
@click.option(
    "--points", "count", type=click.IntRange(20), default=1000, show_default=True, help="Points per function."
)
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True)
@click.option(
    "--output", type=click.Path(dir_okay=False, path_type=Path), default=ROOT / "docs" / "accuracy.md"
)
def main(count: int, seed: int, output: Path) -> None:
    console = Console()
    cells: list[Cell] = []
    columns = (TextColumn("{task.description:24}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("", total=len(reference.FAMILIES) * len(QUANTITIES) * count)
        for family in reference.FAMILIES:
            for quantity in QUANTITIES:
                progress.update(task, description=f"{family}.{quantity}")
                single, double = (Cell(family, quantity, dtype) for dtype in ("float32", "float64"))
                cells += [double, single]
                function = getattr(getattr(mf, family), quantity)
                shared = points(family, quantity, 2 * count // 3, seed)
                alone = points(family, quantity, count - 2 * count // 3, seed, rounded=False)
                for sample, targets in ((shared, (single, double)), (alone, (double,))):
                    for start in range(0, len(sample), CHUNK):
                        chunk = sample[start : start + CHUNK]
                        for cell in targets:
                            for measurement in measure(function, family, quantity, cell.dtype, chunk):
                                cell.add(measurement)
                        progress.advance(task, len(chunk))
                for cell in (double, single):
                    for failure in sorted(cell.failures, key=lambda m: -m.error)[:3]:
                        console.print(
                            f"[red]{cell.dtype} {family}.{quantity}[/red]{failure}", highlight=False
                        )
    temporary = output.with_suffix(".tmp")
    temporary.write_text(_document(cells, count, seed), encoding="utf-8")
    os.replace(temporary, output)
    failures = sum(len(cell.failures) for cell in cells)
    console.print(f"{output}: {sum(cell.count for cell in cells)} values, {failures} outside the contract")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
