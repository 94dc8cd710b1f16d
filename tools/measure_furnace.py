"""Measure every white furnace of the full grid and write docs/furnace.md.

    python tools/measure_furnace.py [--evaluations 10000000] [--jobs 2] [--only 'metal-ggx*'] [--state FILE]

The grid is that of tests/furnace_cases.py. With --state an interrupted run goes on where it was, with the
same numbers. Exit status 1 when a mean lies more than 4 standard errors from 1.
"""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

import click
import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from scipy import stats

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

import furnace_cases  # noqa: E402
from furnace_cases import ALPHAS, ANGLES, ETA, FAMILIES, MATERIALS, Furnace  # noqa: E402
from material_cases import SHAPES  # noqa: E402

PART = 200_000  # evaluations at a time
LIMIT = 4.0
TITLES = {
    "metal": "A perfect mirror",
    "glass": f"Glass of index {ETA:g}, from above",
    "glass from below": f"Glass of index {ETA:g}, from below",
    "diffuse": "Diffuse facets of albedo 1",
}
INTRODUCTION = """\
# White furnaces

Written by `tools/measure_furnace.py` (`make docs-furnace`); do not edit.

A surface that absorbs nothing, lit from one direction, sends all of the light somewhere: the integral of
`eval(wi, wo)` over all wo is 1 when all orders of scattering are in it. A walk that loses nothing has weight
1 by construction and proves nothing; here wo is drawn from another density, a mixture of lobes, a cosine and
all directions alike, each `eval` is one walk of its own, and the mean of eval/density has to be 1. It is not
when a phase function, a free path, or a masking term is wrong, whatever the sampler does.

Every family ({shapes}), alpha in {{{alphas}}}, light at {{{angles}}} degrees
from the normal, {evaluations:,} evaluations each, in double precision. Glass is in the mode "importance", in
which energy is kept.

**{verdict}**
(a correct library has {expected:.2g} beyond {limit:g}). In root mean square they lie {spread:.2f} away; less
than 1, because the errors take no credit for drawing wo from the parts of the mixture in fixed shares. The
mean of all {cases} furnaces is {mean}.

The tables give mean - 1 and its standard error, in thousandths.
"""


@dataclass
class Sums:
    """Of one case: evaluations, and sums of the powers of estimate - 1."""

    n: int = 0
    first: float = 0.0
    second: float = 0.0

    def add(self, n: int, first: float, second: float) -> None:
        self.n, self.first, self.second = self.n + n, self.first + first, self.second + second

    @property
    def excess(self) -> float:
        return self.first / self.n

    @property
    def error(self) -> float:
        return math.sqrt((self.second / self.n - self.excess**2) / self.n)

    @property
    def deviation(self) -> float:
        """In standard errors."""
        return self.excess / self.error

    def __str__(self) -> str:
        return f"{1e3 * self.excess:+.2f} ± {1e3 * self.error:.2f}"


Key = tuple[Furnace, int]
Record = tuple[int, float, float]


def _measure(key: Key) -> Record:
    case, part = key
    excess = case.light(PART, part) - 1.0
    return len(excess), float(excess.sum()), float(np.square(excess).sum())


def _known(state: Path | None, wanted: list[Key]) -> dict[Key, Record]:
    """What an earlier run has found; a line that was cut short counts for nothing."""
    if state is None or not state.exists():
        return {}
    by_name = {(str(case), part): (case, part) for case, part in wanted}
    found = {}
    for line in state.read_text(encoding="utf-8").splitlines():
        try:
            name, part, *sums = json.loads(line)
        except ValueError:
            continue
        if (name, part) in by_name:
            found[by_name[name, part]] = tuple(sums)
    return found


def _table(outcomes: dict[Furnace, Sums], material: str) -> Iterator[str]:
    yield "| family | alpha | " + " | ".join(f"{degrees:g}°" for degrees in ANGLES) + " |"
    yield "|---|---|" + "---|" * len(ANGLES)
    for family in FAMILIES:
        for alpha in ALPHAS:
            cells = (str(outcomes[Furnace(material, family, alpha, degrees)]) for degrees in ANGLES)
            yield f"| {family} | {alpha:g} | " + " | ".join(cells) + " |"


def _document(outcomes: dict[Furnace, Sums]) -> str:
    far = [abs(sums.deviation) for sums in outcomes.values()]
    all_of_it = Sums()
    for sums in outcomes.values():
        all_of_it.add(sums.n, sums.first, sums.second)
    shapes = ", ".join(f"{name} {k} = {v:g}" for name, own in SHAPES.items() for k, v in own.items())
    inside = sum(z < LIMIT for z in far)
    head = INTRODUCTION.format(
        shapes=shapes,
        alphas=", ".join(f"{alpha:g}" for alpha in ALPHAS),
        angles=", ".join(f"{degrees:g}" for degrees in ANGLES),
        evaluations=min(sums.n for sums in outcomes.values()),
        verdict=f"{inside} of {len(far)} furnaces lie within {LIMIT:g} standard errors of 1; "
        f"the farthest lies {max(far):.1f} away",
        expected=2 * len(far) * stats.norm.sf(LIMIT),
        limit=LIMIT,
        spread=math.sqrt(math.fsum(z * z for z in far) / len(far)),
        cases=len(far),
        mean=f"1 {'+-'[all_of_it.excess < 0]} {abs(all_of_it.excess):.1e} ± {all_of_it.error:.1e}",
    )
    sections = (["", f"## {TITLES[material]}", "", *_table(outcomes, material)] for material in MATERIALS)
    return head + "\n".join(line for section in sections for line in section) + "\n"


@click.command()
@click.option(
    "--evaluations", type=click.IntRange(1), default=10_000_000, show_default=True, help="Of each furnace."
)
@click.option("--jobs", type=click.IntRange(1), default=os.cpu_count() or 1, help="Processes; all cores.")
@click.option("--only", metavar="PATTERN", default="*", help="Only these cases, as 'glass-*-80'.")
@click.option(
    "--state", type=click.Path(dir_okay=False, path_type=Path), help="Keep results here, and go on from them."
)
@click.option(
    "--output", type=click.Path(dir_okay=False, path_type=Path), default=ROOT / "docs" / "furnace.md"
)
def main(evaluations: int, jobs: int, only: str, state: Path | None, output: Path) -> None:
    """Measure the furnaces of the full grid. Those of a part are printed instead of written."""
    console = Console(stderr=True)
    cases = [case for case in furnace_cases.cases() if fnmatchcase(str(case), only)]
    wanted = [(case, part) for part in range(math.ceil(evaluations / PART)) for case in cases]
    found = _known(state, wanted)
    left = [key for key in wanted if key not in found]
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console) as progress, ProcessPoolExecutor(jobs) as pool:
        task = progress.add_task("furnaces", total=len(wanted), completed=len(found))
        for key, record in zip(left, pool.map(_measure, left, chunksize=4), strict=True):
            found[key] = record
            if state:
                with state.open("a", encoding="utf-8") as file:
                    file.write(json.dumps([str(key[0]), key[1], *record]) + "\n")
            progress.update(task, advance=1)
    outcomes = {case: Sums() for case in cases}
    for case, part in wanted:  # in this order: the same sums after an interruption
        outcomes[case].add(*found[case, part])
    if only == "*":
        output.write_text(_document(outcomes), encoding="utf-8")
        click.echo(str(output))
    else:
        for case, sums in outcomes.items():
            click.echo(f"{case}: {sums} thousandths, {sums.deviation:+.1f} standard errors")
    sys.exit(0 if all(abs(sums.deviation) < LIMIT for sums in outcomes.values()) else 1)


if __name__ == "__main__":
    main()
