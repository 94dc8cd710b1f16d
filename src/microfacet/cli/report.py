"""The command `microfacet report`."""

from __future__ import annotations

import json
from typing import Any

import click

import microfacet as mf
from microfacet.cli.densities import own_family
from microfacet.cli.parameters import parameter_options
from microfacet.cli.printing import announce, progress_line, where
from microfacet.cli.program import families_option, json_option
from microfacet.cli.surfaces import load_map, surface_options

__all__ = ["report"]


@click.command()
@click.option("--output", default="report.html", type=click.Path(dir_okay=False), help="The page to write.")
@families_option
@click.option(
    "--density", "densities", multiple=True, metavar="FILE", type=click.Path(dir_okay=False),
    help="The page of this density of one's own instead; repeat for several.",
)  # fmt: skip
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
    densities: tuple[str, ...],
    parameters: dict[str, float],
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
      microfacet report --density own.json --output own.html
      microfacet report --surface scan.x3p --output scan.html
    """
    from microfacet._report.families import build

    if densities:
        _of_densities(output, densities, families, parameters, surface or terrain or quick, as_json)
        return
    if surface and terrain:
        raise click.UsageError("--surface and --terrain exclude each other")
    if reading and not surface:
        raise click.UsageError(f"--{next(iter(reading)).replace('_', '-')} goes with --surface")
    if reading.keys() & {"profile", "resample"}:
        raise click.UsageError("the report shows a height map: fit takes profiles")
    if "slopes" in reading:
        raise click.UsageError("the report shows a height map: fit takes slopes")
    prepared = load_map(surface, **reading) if surface else None
    measured = mf.sample_terrain().level() if terrain else prepared
    with progress_line() as progress:
        result = build(output, families or None, parameters, measured, progress, quick)
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


def _of_densities(
    output: str,
    densities: tuple[str, ...],
    families: tuple[str, ...],
    parameters: dict[str, float],
    others: object,
    as_json: bool,
) -> None:
    from microfacet._report.densities import write

    if families or others or set(parameters) - {"alpha"}:
        raise click.UsageError(
            "--density makes a page of its own: of the other options it takes --alpha alone"
        )
    with progress_line() as progress:
        path = write(output, [own_family(file) for file in densities], parameters.get("alpha"), progress)
    announce(json.dumps({"path": str(path)}) if as_json else where(path), output)
