"""Test the samplers of the Mitsuba plugins with Mitsuba's chi-square harness and write docs/mitsuba_tests.md.

    python tools/measure_mitsuba.py [--samples 1000000] [--only 'microfacet_conductor-ggx*'] [--state FILE]

The grid is that of tests/mitsuba_cases.py. With --state an interrupted run goes on where it was. Exit status
1 when a test fails.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import asdict
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import click
import mitsuba
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from scipy import stats

import microfacet.mitsuba  # noqa: F401  (registers the plugins)

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

import mitsuba_cases  # noqa: E402
from microfacet.testing import sidak  # noqa: E402
from mitsuba_cases import Case  # noqa: E402

VARIANT, SCALAR = "llvm_ad_rgb", "scalar_rgb"
SIGNIFICANCE = 0.01
INTRODUCTION = """\
# Tests of the Mitsuba plugins' samplers

Written by `tools/measure_mitsuba.py` (`make docs-mitsuba`); do not edit.

Mitsuba {version}'s own harness (`mitsuba.chi2.ChiSquareTest` with `BSDFAdapter`) compares directions that a
plugin samples with the density that it states: `microfacet_conductor` and `microfacet_dielectric` (of index
{glass:g}), all families, alpha in {alphas} and stretched, (alpha_u, alpha_v) in {stretched}, seen from an
azimuth of {azimuth:g} degrees; gtr gamma in {gtr}, student_t gamma in {student_t}, bessel_k a in {bessel_k};
{angles} degrees from the normal, glass also as many from below.

{samples:,} samples in each test, 50 x 101 cells. All {tests:,} tests together fail correct plugins with
probability {significance:g} (Sidak), so that each p-value has to exceed {threshold:.2g}.

The harness integrates the density over a cell by the trapezoidal rule. Where the density is infinite (K0 and
Bessel K with a <= 1 at the mean normal; heavy tails through glass, in a caustic), or much narrower than a
cell (alpha = 0.05 along the normal), that integral is wrong: the harness rejects exact samples of exact
densities, and Mitsuba's own `roughdielectric`.
Here the cells are integrated adaptively (`tests/mitsuba_chi2.py`); histogram, pooling and statistic are the
harness's. The column *as it comes* counts tests that pass without this, with `ires={subdivisions}`.
"""
Record = dict[str, Any]


def _key(case: Case, variant: str) -> str:
    return f"{variant}:{case}"


def _known(state: Path | None) -> dict[str, Record]:
    """What an earlier run has found."""
    if state is None or not state.exists():
        return {}
    return dict(map(json.loads, state.read_text(encoding="utf-8").splitlines()))


def _listed(values: Any) -> str:
    return (
        "{" + ", ".join(f"({x[0]:g}, {x[1]:g})" if isinstance(x, tuple) else f"{x:g}" for x in values) + "}"
    )


def _where(case: Case) -> str:
    values = ", ".join(f"{value:g}" for value in case.surface.alpha)
    return f"{values}; {case.degrees:g}°"


def _table(found: list[tuple[Case, Record]], smallest: float, plain: bool) -> Iterator[str]:
    extra = (" as it comes |", "---|") if plain else ("", "")
    yield "| plugin | family | passed | smallest p | where (alpha; angle) | evenly spread | mass |" + extra[0]
    yield "|---|---|---|---|---|---|---|" + extra[1]
    groups: dict[tuple[str, str], list[tuple[Case, Record]]] = {}
    for case, record in found:
        own = ", ".join(f"{name} {value:g}" for name, value in case.surface.own.items())
        groups.setdefault((case.plugin, f"{case.surface.family} {own}".strip()), []).append((case, record))
    for (plugin, family), inside in groups.items():
        case, least = min(inside, key=lambda entry: entry[1]["p_value"])
        passed = sum(record["passed"] for _, record in inside)
        even = stats.kstest([record["p_value"] for _, record in inside], "uniform").pvalue
        mass = max(abs(record["mass"] - record["drawn"]) for _, record in inside)
        cells = [plugin, family, f"{passed} of {len(inside)}", f"{least['p_value']:.2g}", _where(case)]
        cells += [f"{even:.2g}", f"{mass:.0e}"]
        if plain:
            cells.append(str(sum(record["plain"] > smallest for _, record in inside)))
        yield "| " + " | ".join(cells) + " |"


def _document(arrays: list[tuple[Case, Record]], scalar: list[tuple[Case, Record]], samples: int) -> str:
    import mitsuba_chi2

    tests = len(arrays) + len(scalar)
    smallest = float(sidak(SIGNIFICANCE, tests))
    head = INTRODUCTION.format(
        version=mitsuba.__version__,
        glass=mitsuba_cases.GLASS,
        alphas=_listed(mitsuba_cases.ALPHAS),
        stretched=_listed(mitsuba_cases.STRETCHED),
        azimuth=mitsuba_cases.AZIMUTH,
        angles=_listed(mitsuba_cases.ANGLES),
        **{name: _listed(values) for name, values in mitsuba_cases.SHAPES.items()},
        samples=samples,
        tests=tests,
        significance=SIGNIFICANCE,
        threshold=smallest,
        subdivisions=mitsuba_chi2.SUBDIVISIONS,
    )
    both = [*arrays, *scalar]
    failed = [(case, record) for case, record in both if not record["passed"]]
    least = min(record["p_value"] for _, record in both)
    lines = [head, f"**{tests - len(failed):,} of {tests:,} tests pass**; smallest p-value {least:.2g}."]
    lines.append(
        "*Mass* is the largest difference between the integral of the density and the share of samples"
    )
    lines += ["that have a weight.", "", f"## {VARIANT}", "", *_table(arrays, smallest, True)]
    lines += ["", f"## {SCALAR}", ""]
    lines += [
        "One call at a time, 20,000 samples, by `microfacet.testing.chi2`, as the harness needs arrays.",
        "",
    ]
    lines += _table(scalar, smallest, False)
    if failed:
        lines += ["", "## Failed", ""]
        for case, record in failed:
            values = f"p {record['p_value']:.2g}, mass {record['mass']:.4f}, drawn {record['drawn']:.4f}"
            lines.append(f"- {case}: {values}")
    return "\n".join(lines) + "\n"


@click.command()
@click.option(
    "--samples", type=click.IntRange(1000), default=1_000_000, show_default=True, help="Of each test."
)
@click.option("--only", metavar="PATTERN", default="*", help="Only these cases, as '*-student_t-0.05-*'.")
@click.option(
    "--state", type=click.Path(dir_okay=False, path_type=Path), help="Keep outcomes here; go on from them."
)
@click.option(
    "--output", type=click.Path(dir_okay=False, path_type=Path), default=ROOT / "docs" / "mitsuba_tests.md"
)
def main(samples: int, only: str, state: Path | None, output: Path) -> None:
    """Test the samplers of the full grid. The page of a part is printed instead of written."""
    wanted = {
        VARIANT: [case for case in mitsuba_cases.cases() if fnmatchcase(str(case), only)],
        SCALAR: [case for case in mitsuba_cases.selection(each=3) if fnmatchcase(str(case), only)],
    }
    tests = sum(map(len, wanted.values()))
    found = _known(state)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    console = Console(stderr=True)
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("samplers", total=tests)
        for variant, cases in wanted.items():
            mitsuba.set_variant(variant)
            import mitsuba_chi2

            options = {"samples": samples, "plain": True} if variant == VARIANT else {}
            for case in cases:
                if _key(case, variant) not in found:
                    (outcome,) = mitsuba_chi2.run_named([str(case)], tests, **options)
                    found[_key(case, variant)] = asdict(outcome)
                    if state:
                        with state.open("a", encoding="utf-8") as file:
                            file.write(json.dumps([_key(case, variant), asdict(outcome)]) + "\n")
                    if not outcome.passed:
                        console.print(f"failed: {variant}: {case}: p {outcome.p_value:.2g}", soft_wrap=True)
                progress.update(task, advance=1, description=case.surface.family)
    arrays, scalar = ([(case, found[_key(case, v)]) for case in wanted[v]] for v in (VARIANT, SCALAR))
    text = _document(arrays, scalar, samples)
    if only == "*":
        output.write_text(text, encoding="utf-8")
        click.echo(str(output))
    else:
        click.echo(text)
    sys.exit(0 if all(record["passed"] for _, record in arrays + scalar) else 1)


if __name__ == "__main__":
    main()
