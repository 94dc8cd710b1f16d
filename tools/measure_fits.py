"""Fit slopes of known families many times and write docs/fitting_tests.md.

    python tools/measure_fits.py [--repetitions 200] [--jobs 2]

The cases are those of tests/fit_cases.py. Exit status 1 when a coverage, an identification or a recovery
fails.
"""

from __future__ import annotations

import os
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import click
import numpy as np
from rich.progress import track
from scipy import stats

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

import fit_cases  # noqa: E402
import microfacet as mf  # noqa: E402
from fit_cases import Case  # noqa: E402
from microfacet.testing import sidak  # noqa: E402

SIGNIFICANCE = 0.01
COVERAGE_SLOPES, RIVAL_SLOPES, MANY_SLOPES = 10_000, 20_000, 1_000_000
RIVALS = [("student_t", 2.5), ("student_t", 4.0), ("student_t", 6.0)]
RIVALS += [("bessel_k", 0.6), ("bessel_k", 1.3), ("bessel_k", 3.0)]
INTRODUCTION = """\
# Tests of the fit

Written by `tools/measure_fits.py` (`make fit-coverage`); do not edit.

Independent slopes of known families, alpha_x = {alpha_x:g}, alpha_y = {alpha_y:g}, rotation {rotation:g}
(GTR: as stated), fitted by `microfacet.fit`.

- **Coverage**: how many of {repetitions} intervals of 1.96 standard errors, each from {slopes:,} slopes, hold
  the true parameter. Correct ones hold 95 %; all {tests} tests together fail with probability
  {significance:g} (Sidak), so that each binomial p-value has to exceed {threshold:.2g}.
- **Recovery**: the largest deviation, in standard errors, of a parameter fitted to {many:,} slopes;
  at most 3.
"""


def _deviations(task: tuple[Case, int, int]) -> dict[str, float]:
    case, n, repetition = task
    return case.deviations(case.slopes(n, repetition))


def _identified(task: tuple[Case, int]) -> bool:
    case, repetition = task
    return mf.fit(case.slopes(RIVAL_SLOPES, repetition))[0].family == case.family


def _coverage(pool: Any, cases: list[Case], repetitions: int, threshold: float) -> tuple[list[str], bool]:
    rows = [
        "",
        "## Coverage and recovery",
        "",
        "| case | parameter | covered | p-value | recovery |",
        "|---|---|---|---|---|",
    ]
    good = True
    for case in track(cases, "coverage"):
        tasks = [(case, COVERAGE_SLOPES, k) for k in range(repetitions)]
        found = list(pool.map(_deviations, tasks, chunksize=10))
        large = _deviations((case, MANY_SLOPES, 0))
        for name, _ in case.parameters:
            covered = sum(abs(one[name]) < stats.norm.ppf(0.975) for one in found)
            p_value = fit_cases.coverage_p_value(covered, repetitions)
            good = good and p_value > threshold and abs(large[name]) < 3
            rows.append(f"| {case} | {name} | {covered} | {p_value:.2g} | {abs(large[name]):.2f} |")
    return rows, good


def _identification(pool: Any, repetitions: int) -> tuple[list[str], bool]:
    rows = [
        "",
        "## Identification",
        "",
        f"How often the family of {RIVAL_SLOPES:,} slopes comes first among all six; at least 99 %.",
        "",
        "| case | identified |",
        "|---|---|",
    ]
    good = True
    for family, shape in track(RIVALS, "identification"):
        name = fit_cases.FAMILIES[family].parameters[1].name
        case = Case(family, (*fit_cases.STRETCH.items(), (name, shape)))
        share = float(
            np.mean(list(pool.map(_identified, [(case, k) for k in range(repetitions)], chunksize=10)))
        )
        good = good and share >= 0.99
        rows.append(f"| {case} | {share:.1%} |")
    return rows, good


@click.command()
@click.option("--repetitions", type=click.IntRange(20), default=200, show_default=True)
@click.option("--jobs", type=click.IntRange(1), default=os.cpu_count() or 1, show_default=True)
def main(repetitions: int, jobs: int) -> None:
    """Measure and write the page."""
    cases = fit_cases.cases()
    tests = sum(len(case.parameters) for case in cases)
    threshold = sidak(SIGNIFICANCE, tests)
    with ProcessPoolExecutor(jobs) as pool:
        coverage, covered = _coverage(pool, cases, repetitions, threshold)
        identification, identified = _identification(pool, repetitions)
    head = INTRODUCTION.format(
        **fit_cases.STRETCH,
        repetitions=repetitions,
        slopes=COVERAGE_SLOPES,
        tests=tests,
        significance=SIGNIFICANCE,
        threshold=threshold,
        many=MANY_SLOPES,
    )
    (ROOT / "docs" / "fitting_tests.md").write_text(
        head + "\n".join([*coverage, *identification]) + "\n", "utf-8"
    )
    sys.exit(0 if covered and identified else 1)


if __name__ == "__main__":
    main()
