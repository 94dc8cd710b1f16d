"""The command `microfacet fit`."""

from __future__ import annotations

import json
import math
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microfacet._files import is_stdout
from microfacet._text import printable
from microfacet.cli.densities import densities_option
from microfacet.cli.printing import announce, console, progress_line, say, show, value, where
from microfacet.cli.program import families_option, json_option
from microfacet.cli.surfaces import surface_options

if TYPE_CHECKING:
    from rich.console import Console

    from microfacet.cli.fits import Failure, Fitted

__all__ = ["fit"]


@click.command()
@click.argument("files", nargs=-1, metavar="[FILE]...")
@surface_options
@families_option
@densities_option
@click.option("--isotropic", "symmetry", flag_value="isotropic", help="Fit one roughness alone.")
@click.option(
    "--anisotropic",
    "symmetry",
    flag_value="anisotropic",
    help="Fit one roughness along each of two axes alone; both kinds by default.",
)
@click.option("--terrain", is_flag=True, help="Fit the terrain that ships with matplotlib: no FILE.")
@click.option("--scales/--no-scales", default=True, help="Fit at lags 1, 2, 4, ... too (default).")
@click.option(
    "--angle",
    "angles",
    multiple=True,
    type=click.FloatRange(0, 90, max_open=True),
    metavar="DEGREES",
    help="Predict masking at this angle from the macronormal; repeat for several.",
)
@click.option("--max-slopes", type=click.IntRange(min=20), metavar="N", help="Of more slopes, draw N.")
@click.option(
    "--max-slope",
    type=click.FloatRange(min=0, min_open=True),
    metavar="X",
    help="The steepest slope that the instrument measures: warn of those beyond it.",
)
@click.option("--report", type=click.Path(dir_okay=False), metavar="FILE", help="Write a page (HTML).")
@click.option(
    "--dask",
    metavar="ADDRESS",
    help="Fit on the scheduler tcp://...; local (default for 128 MiB of files and more); none.",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False),
    metavar="FILE",
    help="Write a table, one row a file: FILE.csv or .parquet.",
)
@json_option
@click.pass_context
def fit(
    ctx: click.Context,
    files: tuple[str, ...],
    reading: dict[str, Any],
    families: tuple[Any, ...],
    symmetry: str | None,
    terrain: bool,
    scales: bool,
    angles: tuple[float, ...],
    max_slopes: int | None,
    max_slope: float | None,
    report: str | None,
    dask: str | None,
    output: str | None,
    as_json: bool,
) -> None:
    """Fit the families to the slopes of measured surfaces and rank them.

    FILE is a height map: .npz, .npy, .x3p, a grid of numbers, an image, and what instruments write where
    the extra surface is installed; or slopes. Several files give one table; where they are large and dask is
    installed, they are fitted at the same time.

    \b
    Examples:
      microfacet fit scan.x3p
      microfacet fit --terrain --report terrain.html
      microfacet fit scan.di --lag 2 --family student_t --family ggx --json
      microfacet fit scan.x3p --l-filter 8e-4 --report scan.html
      microfacet fit *.x3p --output table.parquet
      microfacet fit *.x3p --dask tcp://10.0.0.5:8786 --json
      microfacet fit slopes.parquet --slopes table
      microfacet fit scan.x3p --density own.json --family ggx
    """
    if bool(files) == terrain:
        raise click.UsageError("give at least one FILE, or --terrain")
    if terrain and (others := reading.keys() - {"lag"}):
        raise click.UsageError(f"--{min(others).replace('_', '-')} goes with a FILE, not with --terrain")
    if report and len(files) > 1:
        raise click.UsageError("--report is about one file: give one, or run the command for each")
    if report and not Path(report).absolute().parent.is_dir():
        raise ValueError(f"--report must lie in an existing folder, got {report!r}")
    from microfacet.cli import batch, fits

    taken = output is not None and is_stdout(output)
    if taken and as_json:
        raise click.UsageError("--json prints on the standard output, which --output takes: give a file")
    if output:
        batch.checked_output(output)
    options: dict[str, Any] = {"terrain": terrain, "scales": scales}
    options |= {"max_slopes": max_slopes, "max_slope": max_slope}
    options["symmetry"] = symmetry
    if angles:
        options["angles"] = angles
    jobs = [fits.Job(file, reading, families, **options) for file in files or ("",)]
    with progress_line() as progress:
        outcomes = fits.run(
            jobs, "none" if report else dask, progress, lambda line: click.echo(line, err=True)
        )
        if report and isinstance(outcomes[0], fits.Fitted):
            from microfacet._report.surfaces import write

            write(report, outcomes[0], _command(), progress)
    if output:
        names = files or ("terrain",)
        batch.save(output, [batch.row(*one) for one in zip(names, outcomes, strict=True)])
    pages = {name: where(path) for name, path in (("output", output), ("report", report)) if path is not None}
    if len(files) > 1:
        if as_json:
            rows = [
                {"file": file, **outcome.as_dict()} for file, outcome in zip(files, outcomes, strict=True)
            ]
            click.echo(json.dumps({"files": rows, **pages}, allow_nan=False))
        elif not taken:
            _print_files(files, outcomes)
            for path in pages.values():
                announce(path, path)
        failed = [outcome.error for outcome in outcomes if isinstance(outcome, fits.Failure)]
        for error in failed:
            say(error)
        ctx.exit(2 if failed else 0)
    fitted = outcomes[0]
    if isinstance(fitted, fits.Failure):  # on a worker
        raise ValueError(fitted.error)
    if as_json:
        click.echo(json.dumps({**fitted.as_dict(), **pages}, allow_nan=False))
    elif not taken:
        _print(fitted)
        for path in pages.values():
            announce(path, path)


def _print(fitted: Fitted) -> None:
    """One file: what was done to it, and a table of everything that was found."""
    first = fitted.results[0]
    at = "" if first.lag is None else f" at lag {first.lag}"
    worth = f", worth {first.n_effective:.0f} independent ones" if first.n_effective < first.n else ""
    click.echo(f"{printable(fitted.source)}: {first.n} slopes{at}{worth}", err=True)
    for note in (*fitted.steps, *fitted.notes):
        click.echo(f"  {printable(note, 400)}", err=True)
    out = console()
    _ranking(out, fitted.results)
    click.echo()
    click.echo(f"Verdict: {fitted.results.verdict.sentence}")
    for warning in fitted.results.warnings:
        click.echo(f"Warning: {printable(warning, 600)}")
    click.echo()
    _prediction(out, fitted.predictions)
    if fitted.scales:
        click.echo()
        _scales(out, fitted.scales)
    if fitted.roughness:
        click.echo()
        from microfacet.cli import areal, profiles

        if fitted.profile:
            profiles.print_parameters(out, fitted.roughness)
        else:
            areal.print_parameters(out, fitted.roughness, fitted.spectrum, fitted.autocorrelation)


def _print_files(names: Sequence[str], outcomes: Sequence[Fitted | Failure]) -> None:
    """One row per file: the first family, and how far behind the second one is."""
    from microfacet._fit.result import one_a_family
    from microfacet.cli import fits

    rows = []
    for name, outcome in zip(names, outcomes, strict=True):
        if isinstance(outcome, fits.Failure):
            rows.append([name, "-", "-", "-", "-", "-", outcome.error, "-", "-", ""])
            continue
        first, *others = one_a_family(outcome.results)
        second = others[0] if others else first
        noise = "noise" if outcome.scales and first.lag in outcome.scales.noise_lags else ""
        rows.append(
            [
                name,
                str(first.lag or "-"),
                str(first.n),
                f"{first.n_effective:.0f}",
                first.family,
                first.symmetry,
                _parameters(first),
                second.family if others else "-",
                f"{second.held_out - first.held_out:.5f}" if others else "-",
                noise,
            ]
        )
    headings = ["file", "lag", "n", "effective", "family", "symmetry", "parameters", "second", "held out", ""]
    show(console(), headings, rows, left=1)


def _command() -> str:
    """The command line that was typed, for a report that says how it came about."""
    return printable(shlex.join(["microfacet", *sys.argv[1:]]), 4000)


def _ranking(out: Console, results: Sequence[Any]) -> None:
    """Fitted families, best first; likelihoods and criteria relative to the first."""
    best = results[0]
    rows = [
        [
            str(rank),
            fit.family
            + ("" if rank > 1 or len(results) == 1 or not results[1].tied else " (tied)")
            + (" (tied)" if rank > 1 and fit.tied else ""),
            fit.symmetry,
            _parameters(fit),
            f"{fit.held_out - best.held_out:.5f}",
            f"{fit.held_out_error:.5f}",
            f"{fit.aic - best.aic:.1f}",
            f"{fit.bic - best.bic:.1f}",
            f"{fit.goodness.anderson_darling:.2f}",
        ]
        for rank, fit in enumerate(results, start=1)
    ]
    headings = ["rank", "family", "symmetry", "parameters", "held out", "+-", "dAIC", "dBIC", "A2"]
    show(out, headings, rows, left=4)


def _prediction(out: Console, predictions: Sequence[Any]) -> None:
    """G1 of every family, one row per direction."""
    names = list(predictions[0].G1)
    rows = [
        [f"{row.theta:g}", f"{row.azimuth:.0f}", *(f"{row.G1[name]:.4f}" for name in names)]
        for row in predictions
    ]
    show(out, ["theta", "azimuth", *(f"G1 {name}" for name in names)], rows, left=0)


def _scales(out: Console, found: Any) -> None:
    """The first family at every lag."""
    rows = []
    for k, (lag, length, results) in enumerate(zip(found.lags, found.lengths, found.results, strict=True)):
        exponent = f"{found.exponents[k]:.2f}" if k < len(found.exponents) else ""
        noise = "noise" if lag in found.noise_lags else ""
        rows.append([str(lag), f"{length:.4g}", results[0].family, _parameters(results[0]), exponent, noise])
    show(out, ["lag", "metres", "family", "parameters", "exponent", ""], rows, left=0)


def _parameters(fit: Any) -> str:
    pairs = fit.params.items()
    return ", ".join(
        f"{name} {value(number, fit.standard_errors.get(name, math.nan))}" for name, number in pairs
    )
