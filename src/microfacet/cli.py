"""The command `microfacet`: arguments, options and exit statuses. The work is done in lower modules.

Exit status 0; 1 when a check failed; 2 for bad input, with one sentence on stderr; 130 after Ctrl-C.
"""

from __future__ import annotations

import json
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import microfacet as mf
from microfacet._optional import needed

with needed("the command microfacet needs"):
    import click

from microfacet._console.bake import bake
from microfacet._console.evaluate_command import evaluate
from microfacet._console.fit_command import fit_files, fit_options
from microfacet._console.gallery import gallery
from microfacet._console.program import (
    Program,
    announce,
    families_option,
    folder_option,
    json_option,
    parameter_options,
    progress,
    surface_options,
    view_options,
    where,
)
from microfacet._console.render import render
from microfacet._console.synthesize import synthesize

__all__ = ["main"]

Parameters = dict[str, float]


@click.group(
    cls=Program, invoke_without_command=True, context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(mf.__version__, prog_name="microfacet")
@folder_option("--include-dir", mf.get_include, "Print the folder of the C++ headers.")
@folder_option("--cmake-dir", mf.get_cmake_dir, "Print the folder of the CMake package.")
@click.pass_context
def main(ctx: click.Context) -> None:
    """Microfacet normal distribution functions: evaluate, sample, fit, verify, report.

    \b
    Examples:
      microfacet verify
      microfacet report --terrain
      microfacet eval ggx sigma 0.5 1 --alpha 0.3
    """
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())


@main.command()
@click.option("--output", default="report.html", type=click.Path(dir_okay=False), help="The page to write.")
@families_option
@parameter_options
@click.option("--surface", metavar="FILE", help="Fit this measured surface and show it.")
@surface_options
@click.option("--terrain", is_flag=True, help="Fit and show the terrain that ships with matplotlib.")
@click.option("--quick", is_flag=True, help="Leave the table of checks out.")
@json_option
@click.pass_context
def report(
    ctx: click.Context,
    output: str,
    families: tuple[str, ...],
    parameters: Parameters,
    surface: str | None,
    reading: dict[str, Any],
    terrain: bool,
    quick: bool,
    as_json: bool,
) -> None:
    """Write the report: every formula, figure and check in one HTML file.

    The last line printed is the path of the page. The exit status is 1 when a check failed.

    \b
    Examples:
      microfacet report --terrain
      microfacet report --family k0 --family beckmann --alpha 0.3
      microfacet report --surface scan.x3p --output scan.html
    """
    from microfacet._console import surfaces
    from microfacet._report import build

    if surface and terrain:
        raise click.UsageError("--surface and --terrain exclude each other")
    if reading and not surface:
        raise click.UsageError(f"--{next(iter(reading)).replace('_', '-')} goes with --surface")
    if "slopes" in reading:
        raise click.UsageError("the report shows a height map: fit takes slopes")
    prepared = surfaces.load_map(surface, **reading) if surface else None
    measured = mf.sample_terrain().level() if terrain else prepared
    with progress() as tell:
        result = build(output, families or None, parameters, measured, tell, quick)
    if as_json:
        summary = {"passed": result.passed, "total": result.total, "seconds": round(result.seconds, 2)}
        announce(json.dumps({"path": str(result.path), **summary}), output)
    else:
        if result.total:
            announce(
                f"{result.passed} of {result.total} checks hold; built in {result.seconds:.0f} s", output
            )
        announce(str(result.path), output)
    ctx.exit(0 if result.passed == result.total else 1)


@main.command()
@click.option(
    "--grid",
    is_flag=True,
    help="Check over a grid of the whole domain (a minute or two); the table shows each check's worst point.",
)
@families_option
@click.option("--id", "ids", multiple=True, metavar="ID", help="This check, such as k0.sampling; repeatable.")
@parameter_options
@json_option
@click.pass_context
def verify(
    ctx: click.Context,
    grid: bool,
    families: tuple[str, ...],
    ids: tuple[str, ...],
    parameters: Parameters,
    as_json: bool,
) -> None:
    """Check every formula by a second route. The exit status is 1 when one fails.

    \b
    Examples:
      microfacet verify
      microfacet verify --family gtr --alpha 0.2 --gamma 1.7
      microfacet verify --id beckmann.sigma_delta --json
    """
    from microfacet import _checks
    from microfacet._console import check_tables, tables

    items = _checks.catalogue()
    results: list[_checks.CheckResult] = []
    with progress() as tell:
        for result in _checks.run(ids or None, families or None, grid, parameters):
            results.append(result)
            tell(result.id, len(results), 0)
    if not results:
        raise click.UsageError("no check applies at these parameters")
    if as_json:
        click.echo(json.dumps([result.as_dict() for result in results], indent=1, allow_nan=False))
    else:
        check_tables.checks(tables.console(), items, results)
        for line in check_tables.summary(items, results):
            click.echo(line)
    ctx.exit(0 if all(result.passed for result in results) else 1)


@main.command()
@click.argument("family")
@click.option(
    "-n", "--count", type=click.IntRange(min=1), default=10, show_default=True, help="How many normals."
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Same seed, same normals."
)
@parameter_options
@view_options
@click.option("--dtype", type=click.Choice(["float64", "float32"]), default="float64", help="Precision.")
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False), help="FILE.npy, .csv or .parquet; stdout otherwise."
)
@json_option
def sample(
    family: str,
    count: int,
    seed: int,
    parameters: Parameters,
    view: dict[str, Any] | None,
    dtype: str,
    output: str | None,
    as_json: bool,
) -> None:
    """Draw normals from D cos(theta), or those seen from a direction: rows x, y, z.

    The normal in a row depends on the seed and the number of the row alone. With --json a summary is printed,
    and --output says where the normals go.

    \b
    Examples:
      microfacet sample ggx --alpha 0.3
      microfacet sample k0 --alpha 0.3 --visible 85 -n 1000000 --seed 7 -o visible.npy
      microfacet sample ggx --alpha 0.3 --visible 60 --bounded -o normals.csv --json
    """
    from microfacet._console import draw
    from microfacet._console.parameters import distribution, family_named

    if as_json and output is None:
        raise click.UsageError("--json prints a summary: say with --output where the normals go")
    ndf = distribution(family_named(family), parameters)
    work = draw.Draw(ndf, count, seed, dtype, None if view is None else draw.View(**view))
    if output is None:
        draw.write_csv(work, sys.stdout.buffer)
        return
    with progress() as tell:
        draw.save(work, Path(output), tell)
    announce(json.dumps({"path": where(output), **work.as_dict()}) if as_json else where(output), output)


@main.command()
@click.argument("files", nargs=-1, metavar="[FILE]...")
@surface_options
@families_option
@fit_options
@json_option
@click.pass_context
def fit(ctx: click.Context, /, **arguments: Any) -> None:
    """Fit the families to the slopes of measured surfaces and rank them.

    FILE is a height map: .npz, .npy, .x3p, a grid of numbers, an image, and what instruments write where
    the extra surface is installed; or slopes. Several files give one table; where dask is installed they are
    fitted at the same time.

    \b
    Examples:
      microfacet fit scan.x3p
      microfacet fit --terrain --report terrain.html
      microfacet fit scan.di --lag 2 --family student_t --family ggx --json
      microfacet fit scan.x3p --l-filter 8e-4 --report scan.html
      microfacet fit *.x3p --dask tcp://10.0.0.5:8786 --json
      microfacet fit slopes.parquet --slopes table
    """
    write = import_module("microfacet._report.fit").write if arguments["report"] else None
    ctx.exit(fit_files(write, **arguments))


@main.command()
@json_option
def families(as_json: bool) -> None:
    """List the families, their parameters and sources."""
    from microfacet._console import records, tables

    entries = mf.families()
    if as_json:
        click.echo(json.dumps(records.families(entries), indent=1))
    else:
        tables.families(tables.console(), entries)


main.add_command(evaluate)
main.add_command(synthesize)
main.add_command(bake)
main.add_command(render)
main.add_command(gallery)


if __name__ == "__main__":
    main()
