"""Test every sampler of the full grid and write docs/sampling_tests.md.

    python tools/measure_sampling.py [--samples 1000000] [--jobs 2] [--only 'ggx*'] [--state FILE]

The grid is that of tests/sampling_cases.py. With --state an interrupted run goes on where it was. Exit status
1 when a sampler fails.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

import click
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from scipy import stats

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

import sampling_cases  # noqa: E402
from microfacet.testing import sidak  # noqa: E402
from sampling_cases import Case  # noqa: E402

SIGNIFICANCE = 0.01
INTRODUCTION = """\
# Tests of the samplers

Written by `tools/measure_sampling.py` (`make docs-sampling`); do not edit.

Every family, with alpha in {alphas} and, where it stretches, alpha_x = {alpha_x:g} and
alpha_y = {alpha_y:g} seen along an axis and between both; student_t gamma in {student_t}; bessel_k a in
{bessel_k}; gtr gamma in {gtr}. All normals (`sample`), and visible ones (`sample_visible`)
from {incidences} degrees, as far as sigma is above 1e-290: by the
continuous and the mixture scheme, for GGX also bounded; with float64 and float32 arguments.

- **chi-square**: 32 x 32 cells in the angles of the normal against the integral of the density over each.
- **slope**: Kolmogorov-Smirnov test of the slope in the plane of incidence.

{samples:,} samples in each test. All {tests:,} tests together fail a correct library with probability
{significance:g} (Sidak), so that each p-value has to exceed {threshold:.2g}. The p-values of correct samplers
are spread evenly over (0, 1); the column *evenly spread* is the p-value of just that. *Mass* is the
largest deviation from 1 of the integral of the density.
"""


@dataclass(frozen=True)
class Outcome:
    """The p-values of one case."""

    case: Case
    chi2: float
    slope: float | None
    mass: float
    passed: bool

    def line(self) -> str:
        """For a file of outcomes."""
        return json.dumps([str(self.case), self.chi2, self.slope, self.mass, self.passed]) + "\n"


def _known(state: Path | None, cases: list[Case]) -> dict[Case, Outcome]:
    """What an earlier run has found."""
    if state is None or not state.exists():
        return {}
    by_name = {str(case): case for case in cases}
    records = map(json.loads, state.read_text(encoding="utf-8").splitlines())
    return {by_name[name]: Outcome(by_name[name], *rest) for name, *rest in records if name in by_name}


def _run(case: Case, samples: int, tests: int) -> Outcome:
    grid = case.chi2(samples, tests)
    slope = case.slope(samples, tests) if case.has_slope else None
    passed = grid.passed and (slope is None or slope.passed)
    return Outcome(case, grid.p_value, None if slope is None else slope.p_value, abs(grid.mass - 1.0), passed)


def _rows(outcomes: list[Outcome]) -> Iterator[str]:
    yield "| family | sampler | precision | test | tests | smallest p | where | evenly spread | mass |"
    yield "|---|---|---|---|---|---|---|---|---|"
    groups = dict.fromkeys((o.case.family, o.case.scheme, o.case.dtype) for o in outcomes)
    for family, scheme, dtype in groups:
        inside = [
            o for o in outcomes if (o.case.family, o.case.scheme, o.case.dtype) == (family, scheme, dtype)
        ]
        mass = f"{max(o.mass for o in inside):.0e}"
        for test in ("chi-square", "slope"):
            found = [(o.chi2 if test == "chi-square" else o.slope, o.case) for o in inside]
            known = [(p, case) for p, case in found if p is not None]
            if not known:
                continue
            least, where = min(known, key=lambda entry: entry[0])
            even = stats.kstest([p for p, _ in known], "uniform").pvalue
            values = ", ".join(f"{name} {value:g}" for name, value in where.parameters)
            place = values if scheme == "all" else f"{values}; {where.incidence:g}°, {where.azimuth:g}°"
            sampler = "`sample`" if scheme == "all" else scheme
            cells = [family, sampler, dtype, test, str(len(known)), f"{least:.2g}", place, f"{even:.2g}"]
            yield "| " + " | ".join([*cells, mass if test == "chi-square" else ""]) + " |"


def _document(outcomes: list[Outcome], samples: int, tests: int) -> str:
    def listed(values: tuple[float, ...]) -> str:
        return "{" + ", ".join(f"{value:g}" for value in values) + "}"

    head = INTRODUCTION.format(
        alphas=listed(sampling_cases.ALPHAS),
        incidences=listed(sampling_cases.INCIDENCES),
        **sampling_cases.STRETCH,
        **{name: listed(values) for name, values in sampling_cases.SHAPES.items()},
        samples=samples,
        tests=tests,
        significance=SIGNIFICANCE,
        threshold=sidak(SIGNIFICANCE, tests),
    )
    failed = [o for o in outcomes if not o.passed]
    every = [p for o in outcomes for p in (o.chi2, o.slope) if p is not None]
    even = stats.kstest(every, "uniform").pvalue
    verdict = (
        f"**{len(outcomes) - len(failed):,} of {len(outcomes):,} samplers pass**; smallest p-value of all "
    )
    verdict += f"{min(every):.2g}; that all p-values are spread evenly has itself the p-value {even:.2g}."
    lines = [head, verdict, "", *_rows(outcomes)]
    if failed:
        lines += [
            "",
            "## Failed",
            "",
            *(f"- {o.case}: {o.chi2:.2g}, {o.slope}, mass {o.mass:.1e}" for o in failed),
        ]
    return "\n".join(lines) + "\n"


@click.command()
@click.option(
    "--samples", type=click.IntRange(1000), default=1_000_000, show_default=True, help="Of each test."
)
@click.option("--jobs", type=click.IntRange(1), default=os.cpu_count() or 1, help="Processes; all cores.")
@click.option("--only", metavar="PATTERN", default="*", help="Only these cases, as '*student_t*float32'.")
@click.option(
    "--state",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Keep outcomes here, and go on from them.",
)
@click.option(
    "--output", type=click.Path(dir_okay=False, path_type=Path), default=ROOT / "docs" / "sampling_tests.md"
)
def main(samples: int, jobs: int, only: str, state: Path | None, output: Path) -> None:
    """Test the samplers of the full grid. The page of a part is printed instead of written."""
    console = Console(stderr=True)
    cases = [case for case in sampling_cases.cases() if fnmatchcase(str(case), only)]
    tests = sum(1 + case.has_slope for case in cases)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    found = _known(state, cases)
    left = [case for case in cases if case not in found]
    with Progress(*columns, console=console) as progress, ProcessPoolExecutor(jobs) as pool:
        task = progress.add_task("samplers", total=len(cases), completed=len(found))
        for outcome in pool.map(_run, left, [samples] * len(left), [tests] * len(left), chunksize=4):
            found[outcome.case] = outcome
            if state:
                with state.open("a", encoding="utf-8") as file:
                    file.write(outcome.line())
            progress.update(task, advance=1, description=outcome.case.family)
            if not outcome.passed:
                said = f"failed: {outcome.case}: p {outcome.chi2:.2g}, {outcome.slope}"
                console.print(said, soft_wrap=True)
    outcomes = [found[case] for case in cases]
    text = _document(outcomes, samples, tests)
    if only == "*":
        output.write_text(text, encoding="utf-8")
        click.echo(str(output))
    else:
        click.echo(text)
    sys.exit(0 if all(outcome.passed for outcome in outcomes) else 1)


if __name__ == "__main__":
    main()
