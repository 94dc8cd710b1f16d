"""The command `microfacet synthesize`: a height map of a family, as a file that every other command reads."""

from __future__ import annotations

import json
from typing import Any

import click
import numpy as np

import microfacet as mf
from microfacet._files import ending, replacing
from microfacet.cli.densities import DensityCommand, density_option
from microfacet.cli.parameters import axes_options, family_named, parameter_options, stretched
from microfacet.cli.printing import announce, finite, where
from microfacet.cli.program import json_option

__all__ = ["synthesize"]


@click.command(cls=DensityCommand)
@click.argument("family")
@density_option
@parameter_options
@axes_options
@click.option(
    "--shape",
    type=click.IntRange(min=16),
    nargs=2,
    default=(1024, 1024),
    show_default=True,
    metavar="NX NY",
    help="Pixels along x and y.",
)
@click.option("--pixel-size", type=float, default=1e-6, show_default=True, metavar="X", help="In metres.")
@click.option("--correlation-length", type=float, metavar="X", help="In metres; 4 pixels otherwise.")
@click.option(
    "--amplitude-length", type=float, metavar="X", help="Over which the roughness varies, in metres."
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Same seed, same map.")
@click.option("--pinned", is_flag=True, help="Let this very map have the law, and seeds not scatter.")
@click.option("-o", "--output", type=click.Path(dir_okay=False), required=True, help="The FILE.npz to write.")
@json_option
def synthesize(
    family: str,
    parameters: dict[str, float],
    shape: tuple[int, int],
    output: str,
    as_json: bool,
    **how: Any,
) -> None:
    """Make a random height map whose slopes at lag 1 follow FAMILY.

    The file holds heights and pixel_size in metres; `fit` and `report` read it. The map is periodic. Seeds
    scatter about FAMILY as maps of this correlation do; with --pinned the map has its law as exactly as a
    map can.

    \b
    Examples:
      microfacet synthesize student_t --alpha 0.3 --gamma 2.5 -o map.npz
      microfacet synthesize ggx --alpha-x 0.3 --alpha-y 0.1 --rotation 30 --shape 2048 512 -o map.npz
    """
    ending(output, (".npz",), ".npz")
    entry = family_named(family)
    ndf = stretched(entry, parameters)
    surface = mf.synthesize(ndf, (shape[1], shape[0]), **how)
    with replacing(output) as stream:
        np.savez(
            stream,
            heights=surface.heights,
            pixel_size=np.array(surface.pixel_size),
            unit="m",
            made=surface.steps[0],
        )
    if as_json:
        record = {
            "family": entry.name,
            "parameters": ndf.parameters,
            "seed": how["seed"],
            "steps": surface.steps,
        }
        roughness = finite(mf.roughness(surface)._asdict())
        announce(json.dumps({"path": where(output), **record, "roughness": roughness}), output)
    else:
        announce(where(output), output)
