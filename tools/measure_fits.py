"""Fit slopes of known families many times and write docs/fitting_tests.md.

    python tools/measure_fits.py [--repetitions 200] [--identifications 50] [--jobs 2]

The cases are those of tests/fit_cases.py, isotropic and anisotropic. Exit status 1 when a coverage, an
identification or a recovery fails.
"""

from __future__ import annotations

import os
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import click
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
MISSED = 0.01  # of identifications may be
INTRODUCTION = """\
# Tests of the fit

Written by `tools/measure_fits.py` (`make fit-coverage`); do not edit.

Independent slopes of known families, fitted by `microfacet.fit`: isotropic with alpha = 0.2 (GTR: as
stated), and anisotropic with alpha_x = {alpha_x:g}, alpha_y = {alpha_y:g}, rotation {rotation:g}.

- **Coverage**: how many of {repetitions} intervals of 1.96 standard errors, each from {slopes:,} slopes, hold
  the true parameter, where the family and its symmetry are known. Correct ones hold 95 %; all {tests} tests
  together fail with probability {significance:g} (Sidak), so that each binomial p-value has to exceed
  {threshold:.2g}.
- **Recovery**: the largest deviation, in standard errors, of a parameter fitted to {many:,} slopes;
  at most 3.
"""


def _deviations(task: tuple[Case, int, int]) -> dict[str, float]:
    case, n, repetition = task
    return case.deviations(case.slopes(n, repetition))


class _Identified(NamedTuple):
    first: bool  # family and symmetry
    tied: bool  # with the first one, or it itself
    symmetry: bool  # of the first one
    rivals: tuple[str, ...]  # other families that are tied


def _identified(task: tuple[Case, int]) -> _Identified:
    case, repetition = task
    true = fit_cases.simplest(case), case.symmetry
    results = mf.fit(case.slopes(RIVAL_SLOPES, repetition))
    tied = [(result.family, result.symmetry) for result in results if result.tied]
    rivals = {family for family, symmetry in tied if family != true[0] and symmetry == true[1]}
    return _Identified(tied[0] == true, true in tied, tied[0][1] == true[1], tuple(sorted(rivals)))


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


def _identification(pool: Any, cases: list[Case], repetitions: int) -> tuple[list[str], bool]:
    rows = [
        "",
        "## Identification",
        "",
        f"All families in both symmetries, fitted to {RIVAL_SLOPES:,} slopes, {repetitions} times each.",
        "",
        "- **First**: the true family with the true symmetry is first.",
        "- **Tied**: it is first or tied with the first.",
        "- **Symmetry**: that of the first one is true.",
        "- **Rivals**: other families of that symmetry that are tied, and how often. Some contain the true "
        "one,",
        "  others come so close to it that so many slopes do not tell them apart.",
        "",
        f"A case fails where *tied* or *symmetry* is missed more often than a rate of {MISSED:.0%} makes "
        "likely (by",
        f"a binomial test with significance {SIGNIFICANCE:g} for all cases together). GTR at gamma 2 is GGX, "
        "which is",
        "then what has to be found.",
        "",
        "| case | first | tied | symmetry | rivals |",
        "|---|---|---|---|---|",
    ]
    good = True
    for case in track(cases, "identification"):
        found = list(pool.map(_identified, [(case, k) for k in range(repetitions)], chunksize=2))
        first, tied, symmetry = (
            sum(getattr(one, name) for one in found) for name in ("first", "tied", "symmetry")
        )
        for hits in (tied, symmetry):
            by_chance = stats.binom.sf(repetitions - hits - 1, repetitions, MISSED)
            good = good and bool(by_chance > SIGNIFICANCE / len(cases))
        rivals = Counter(name for one in found for name in one.rivals).most_common()
        said = ", ".join(f"{name} {count}" for name, count in rivals) or "none"
        rows.append(f"| {case} | {first} | {tied} | {symmetry} | {said} |")
    return rows, good


@click.command()
@click.option("--repetitions", type=click.IntRange(20), default=200, show_default=True)
@click.option("--identifications", type=click.IntRange(1), default=50, show_default=True)
@click.option("--jobs", type=click.IntRange(1), default=os.cpu_count() or 1, show_default=True)
def main(repetitions: int, identifications: int, jobs: int) -> None:
    """Measure and write the page."""
    cases = [*fit_cases.isotropic_cases(), *fit_cases.cases()]
    tests = sum(len(case.parameters) for case in cases)
    threshold = sidak(SIGNIFICANCE, tests)
    with ProcessPoolExecutor(jobs) as pool:
        coverage, covered = _coverage(pool, cases, repetitions, threshold)
        identification, identified = _identification(pool, cases, identifications)
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
