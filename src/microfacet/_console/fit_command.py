"""The options of `microfacet fit`, and what it prints."""

from __future__ import annotations

import functools
import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

from microfacet._console.program import announce, progress, say, where
from microfacet._text import printable

__all__ = ["fit_files", "fit_options"]

Command = Callable[..., Any]


def fit_options(command: Command) -> Command:
    """Options of a fit beyond the reading; the command gets them as `options`."""

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
    @click.option("--report", type=click.Path(dir_okay=False), metavar="FILE", help="Write a page (HTML).")
    @click.option(
        "--dask",
        metavar="ADDRESS",
        help="Fit on the scheduler tcp://...; local (default for several files); none.",
    )
    @functools.wraps(command)
    def wrapped(
        terrain: bool,
        scales: bool,
        angles: tuple[float, ...],
        max_slopes: int | None,
        report: str | None,
        dask: str | None,
        **rest: Any,
    ) -> Any:
        if bool(rest["files"]) == terrain:
            raise click.UsageError("give at least one FILE, or --terrain")
        if terrain and (others := rest["reading"].keys() - {"lag"}):
            raise click.UsageError(f"--{min(others).replace('_', '-')} goes with a FILE, not with --terrain")
        if report and len(rest["files"]) > 1:
            raise click.UsageError("--report is about one file: give one, or run the command for each")
        options: dict[str, Any] = {"terrain": terrain, "scales": scales, "max_slopes": max_slopes}
        if angles:
            options["angles"] = angles
        return command(options=options, report=report, dask=dask, **rest)

    return wrapped


def fit_files(
    write: Callable[..., Any] | None,
    files: Sequence[str],
    reading: dict[str, Any],
    families: tuple[str, ...],
    options: dict[str, Any],
    report: str | None,
    dask: str | None,
    as_json: bool,
) -> int:
    """Fit, print, `write` the report; the exit status."""
    from microfacet._console import fits, records

    if report and not Path(report).absolute().parent.is_dir():
        raise ValueError(f"--report must lie in an existing folder, got {report!r}")
    jobs = [fits.Job(file, reading, families, **options) for file in files or ("",)]
    with progress() as tell:
        outcomes = fits.run(jobs, "none" if report else dask, tell, lambda line: click.echo(line, err=True))
        if report and write and isinstance(outcomes[0], fits.Fitted):
            write(report, outcomes[0], _command(), tell)
    if len(files) > 1:
        return _several(files, outcomes, as_json)
    fitted = outcomes[0]
    if isinstance(fitted, fits.Failure):  # on a worker
        raise ValueError(fitted.error)
    if as_json:
        page = {"report": where(report)} if report else {}
        click.echo(json.dumps({**records.fit(fitted), **page}, allow_nan=False))
    else:
        _tables(fitted)
        if report:
            announce(where(report), report)
    return 0


def _several(files: Sequence[str], outcomes: Sequence[Any], as_json: bool) -> int:
    from microfacet._console import fit_tables, fits, records, tables

    failed = [outcome for outcome in outcomes if isinstance(outcome, fits.Failure)]
    if as_json:
        rows = [
            {"file": file, "error": outcome.error}
            if isinstance(outcome, fits.Failure)
            else {"file": file, **records.fit(outcome)}
            for file, outcome in zip(files, outcomes, strict=True)
        ]
        click.echo(json.dumps({"files": rows}, allow_nan=False))
    else:
        fit_tables.files(tables.console(), files, outcomes)
    for failure in failed:
        say(failure.error)
    return 2 if failed else 0


def _tables(fitted: Any) -> None:
    from microfacet._console import fit_tables, tables

    first = fitted.results[0]
    at = "" if first.lag is None else f" at lag {first.lag}"
    worth = f", worth {first.n_effective:.0f} independent ones" if first.n_effective < first.n else ""
    click.echo(f"{printable(fitted.source)}: {first.n} slopes{at}{worth}", err=True)
    for note in (*fitted.steps, *fitted.notes):
        click.echo(f"  {printable(note, 400)}", err=True)
    out = tables.console()
    fit_tables.ranking(out, fitted.results)
    click.echo()
    fit_tables.prediction(out, fitted.predictions)
    if fitted.scales:
        click.echo()
        fit_tables.scales(out, fitted.scales)
    if fitted.roughness:
        click.echo()
        fit_tables.roughness(out, fitted.roughness)


def _command() -> str:
    """The command line that was typed, for a report that says how it came about."""
    import shlex

    return printable(shlex.join(["microfacet", *sys.argv[1:]]), 4000)
