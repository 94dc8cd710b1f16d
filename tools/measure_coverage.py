"""Fit maps of known families many times and write docs/fitting_coverage.md.

    python tools/measure_coverage.py [--maps 60] [--jobs 1]

The maps are those of tests/coverage_cases.py. Exit status 1 when intervals hold the truth too rarely or too
often.
"""

from __future__ import annotations

import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import click
import numpy as np
from rich.progress import track
from scipy import stats

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

import coverage_cases  # noqa: E402
from coverage_cases import KINDS, SHAPES, Kind  # noqa: E402

LEAST, MOST = 0.90, 0.98
INTRODUCTION = """\
# Coverage of the intervals on maps

Written by `tools/measure_coverage.py` (`make map-coverage`); do not edit.

How often an interval of 1.96 standard errors holds the true parameter, on {maps} synthetic maps of each
kind ({quarter} of ramps), of which 20 % of the pixels are missing at random. Families have
alpha = {alpha:g}{shapes}, and are fitted with one roughness.

| kind | maps |
|---|---|
{kinds}

Height maps have {size} x {size} pixels, a correlation length of {length:g} pixels and an amplitude length of
{amplitude:g} pixels, so that they hold some 250 independent roughnesses. On maps with a hundred of them the
rarest ones are missing, which makes shape parameters too large by half a standard error on average, and
intervals of Bessel K hold them with 87 %. The random field lies between 2^-1/2 and 2^1/2, with a correlation
length of {region:g} pixels; the ramp goes from 2^-1/2 to 2^1/2. The true parameters of inhomogeneous maps and
ramps are those of the law that is pooled over all roughnesses: what the same family fits to two million
independent slopes of it.

The share has to lie between {least:.0%} and {most:.0%} over all parameters of a family, but for the ramp: its
regions are the same on every map, so what they differ by is no error of the map's own mean, but the errors
hold the variance between regions. They are meant for a surface of which the map shows a part, and are too
large where the map is all there is. Such a map is said not to be one population.

- **z**: root mean square of (fitted - true)/standard error; 1 for errors that are right, less where Student's
  factor allows for few waves.
- **several**: how many maps are said not to be one population (or perhaps not), because halves differ.
- **p < 0.05**: how many maps have such a p-value in the goodness test under the right family; 5 % are due. A
  pooled law is not of the family itself, and is rejected where the difference can be seen.

| kind | family | parameter | covered | z | several | p < 0.05 |
|---|---|---|---|---|---|---|
"""

Found = tuple[dict[str, float], bool, float]


def _measured(task: tuple[str, int, int]) -> Found:
    family, kind, seed = task
    return coverage_cases.deviations(family, KINDS[kind], seed)


def _rows(family: str, kind: Kind, found: list[Found]) -> tuple[list[str], float]:
    """Rows of the table, and the share of intervals that hold the truth."""
    table = {name: np.array([one[0][name] for one in found]) for name in found[0][0]}
    held = {name: np.abs(z) < stats.norm.ppf(0.975) for name, z in table.items()}
    several, low = np.mean([not one[1] for one in found]), np.mean([one[2] < 0.05 for one in found])
    rows = [
        f"| {kind.name} | {family} | {name} | {held[name].mean():.0%} | {np.sqrt(np.mean(z**2)):.2f} "
        f"| {several:.0%} | {low:.0%} |"
        for name, z in table.items()
    ]
    return rows, float(np.mean(list(held.values())))


@click.command()
@click.option("--maps", type=click.IntRange(40), default=60, show_default=True)
@click.option("--jobs", type=click.IntRange(1), default=1, show_default=True)
def main(maps: int, jobs: int) -> None:
    """Measure and write the page."""
    began, rows, wrong = time.time(), [], []
    with ProcessPoolExecutor(jobs) as pool:
        for number, kind in enumerate(KINDS):
            for family in track(SHAPES, kind.name):
                coverage_cases.truth(family, kind.pooled)
                count = maps if kind.name != "ramp" else maps // 4
                seeds = coverage_cases.seeds(kind, family, count)
                found = list(pool.map(_measured, [(family, number, seed) for seed in seeds]))
                own, share = _rows(family, kind, found)
                rows += own
                if kind.name != "ramp" and not LEAST <= share <= MOST:
                    wrong.append(f"{kind.name}, {family}: {share:.1%}")
    shapes = [
        f"{name} = {value:g} for {family}" for family, own in SHAPES.items() for name, value in own.items()
    ]
    head = INTRODUCTION.format(
        maps=maps,
        quarter=maps // 4,
        alpha=coverage_cases.ALPHA,
        shapes="".join(f", {one}" for one in shapes),
        kinds="\n".join(f"| {kind.name} | {kind.meaning} |" for kind in KINDS),
        size=coverage_cases.SIZE,
        length=coverage_cases.LENGTH,
        amplitude=coverage_cases.AMPLITUDE,
        region=coverage_cases.REGION,
        least=LEAST,
        most=MOST,
    )
    (ROOT / "docs" / "fitting_coverage.md").write_text(head + "\n".join(rows) + "\n", "utf-8")
    click.echo(f"{time.time() - began:.0f} s")
    for line in wrong:
        click.echo(line)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
