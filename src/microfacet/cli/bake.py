"""The command `microfacet bake`."""

from __future__ import annotations

import json
import shlex
import sys
from typing import Any

import click

import microfacet as mf
from microfacet.cli import textures
from microfacet.cli.densities import DensityCommand, density_option
from microfacet.cli.grids import GRID
from microfacet.cli.parameters import shape_options
from microfacet.cli.printing import announce, progress_line, where
from microfacet.cli.program import json_option

__all__ = ["bake"]


@click.command(cls=DensityCommand)
@click.argument("kind", type=click.Choice(["albedo", "energy", "split-sum", "bsdf"]))
@click.argument("family")
@density_option
@click.option("--alpha", type=GRID, metavar="GRID", help="Roughness, of a dataset.")
@shape_options(GRID, "GRID")
@click.option(
    "--material", type=click.Choice(["conductor", "dielectric"]), default="conductor", help="Metal or glass."
)
@click.option("--eta", type=GRID, metavar="GRID", help="Index of refraction; a white metal without.")
@click.option("--k", type=float, default=0.0, metavar="X", help="Imaginary part of a metal's index.")
@click.option("--cos", "cos_theta", type=GRID, metavar="GRID", help="Cosines; 1/32 to 1 otherwise.")
@click.option("--azimuth", type=GRID, metavar="GRID", help="Radians, of bsdf; 0 to pi otherwise.")
@click.option("--scattering", type=click.Choice(["single", "multiple"]), default="multiple", help="Of bsdf.")
@click.option("--walks", type=click.IntRange(min=1), default=10_000, show_default=True, help="Per direction.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of the walks.")
@click.option(
    "-o",
    "--output",
    required=True,
    type=click.Path(),
    help="FILE.nc (NetCDF) or FILE.zarr; or a texture, FILE.exr or FILE.raw.",
)
@click.option("--threads", type=click.IntRange(min=1), metavar="N", help="All processors otherwise.")
@click.option("--dask", metavar="ADDRESS", help="Compute on the dask cluster of this scheduler.")
@click.option("--memory", type=float, default=2.0, show_default=True, metavar="GB", help="Refuse more.")
@textures.texture_options
@json_option
@click.pass_context
def bake(
    ctx: click.Context,
    /,
    kind: str,
    family: Any,
    shape_given: dict[str, Any],
    output: str,
    threads: int | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Tabulate albedos, the energy that one order misses, split-sum scale and bias, or f itself.

    Datasets (.nc, .zarr) are over the GRIDs that are given; one that was interrupted goes on when it is
    called again. Lookup textures (.exr, .raw with a JSON) of albedo, energy and split-sum are what renderers
    load: cosine x roughness, in slices of the shape. A GRID is 0.1,0.2,0.5 or START:STOP:COUNT, with even
    steps of the logarithm or the reciprocal as START:STOP:COUNT:log or :reciprocal.

    \b
    Examples:
      microfacet bake energy ggx --alpha 0.05:1:20 -o ggx.nc
      microfacet bake albedo student_t --alpha 0.1:1:10 --gamma 2,3,5 -o student.zarr
      microfacet bake bsdf k0 --alpha 0.3 --material dielectric --eta 1.5 --walks 1000 -o glass.nc
      microfacet bake energy student_t --gamma 1.6:20:16:reciprocal --half --snippet hlsl -o student_t.exr
      microfacet bake split-sum k0 --size 128x128 -o k0.raw
      microfacet bake energy --density own.json --alpha 0.05:1:20 -o own.nc
    """
    for entry in (family,) if isinstance(family, mf.Family) else mf.families():
        for name in shape_given:
            if family in (entry, entry.name) and name not in (own.name for own in entry.parameters):
                raise click.UsageError(f"{entry.name} has no parameter {name}")
    grid = next(iter(shape_given.values()), None)
    texture = textures.is_texture(output, options["format"])
    textures.require_only(ctx, texture)
    of_textures = textures.taken(options)
    if texture:
        textures.write_texture(kind, family, grid, output, threads, as_json, **of_textures)
    else:
        _write_dataset(kind, family, grid, output, threads, as_json, **options)


def _write_dataset(
    kind: str,
    family: Any,
    shape: Any,
    output: str,
    threads: int | None,
    as_json: bool,
    *,
    alpha: Any,
    cos_theta: Any,
    azimuth: Any,
    memory: float,
    **options: Any,
) -> None:
    if alpha is None:
        raise click.UsageError("Missing option '--alpha'.")
    grids = {"cos_theta": cos_theta, "azimuth": azimuth}
    with progress_line() as progress:
        table = mf.bake(
            kind.replace("-", "_"),
            family,
            shape=shape,
            alpha=alpha,
            output=output,
            threads=threads,
            memory=memory * 1e9,
            progress=progress,
            command=shlex.join(["microfacet", *sys.argv[1:]]),
            **{name: value for name, value in grids.items() if value is not None},
            **options,
        )
    if as_json:
        found = {"sizes": dict(table.sizes), "variables": list(table.data_vars)}
        announce(json.dumps({"path": where(output), **found}), output)
    else:
        announce(where(output), output)
