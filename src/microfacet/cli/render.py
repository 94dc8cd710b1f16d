"""The command `microfacet render`: a family, or a fitted surface, as a picture."""

from __future__ import annotations

import functools
import json
import math
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TextIO

import click

import microfacet as mf
from microfacet import _render
from microfacet._files import read_json
from microfacet._text import listed
from microfacet.cli.densities import DensityCommand, density_option
from microfacet.cli.parameters import axes_options, family_named, parameter_options, stretched
from microfacet.cli.printing import announce, progress_line, say, where
from microfacet.cli.program import json_option

__all__ = ["look_options", "render", "writable"]

Command = Callable[..., Any]
LARGEST = 4096
LONGEST_FIT = 2**24  # characters; a fit prints some ten thousand


class _Size(click.ParamType[tuple[int, int]]):
    """Pixels: 256, or 640x360."""

    name = "size"

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[int, int]:
        """As width and height."""
        if isinstance(value, tuple):
            return value
        sides = str(value).lower().split("x")
        if len(sides) > 2 or not all(side.isdecimal() and 1 <= int(side) <= LARGEST for side in sides):
            self.fail(f"a size is 256 or 640x360, up to {LARGEST} pixels a side, got {value!r}", param, ctx)
        return int(sides[0]), int(sides[-1])


def look_options(command: Command) -> Command:
    """Options for what is rendered and how well; the command gets `material`, `ior` and `how`."""

    @click.option(
        "--material", metavar="NAME", help="Au (default), another metal's name, none (white metal), or glass."
    )
    @click.option("--ior", type=float, metavar="X", help="Index of refraction of glass; 1.5 without.")
    @click.option(
        "--scattering",
        type=click.Choice(["single", "multiple"]),
        default="single",
        show_default=True,
        help="One order of scattering between facets, or all.",
    )
    @click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of the noise.")
    @click.option(
        "--variant",
        default=_render.PREFERRED,
        show_default=True,
        metavar="NAME",
        help=f"Of Mitsuba; {_render.FALLBACK} stands in where there is no LLVM to work with.",
    )
    @functools.wraps(command)
    def wrapped(material: str | None, ior: float | None, **rest: Any) -> Any:
        if ior is not None and material not in (None, "glass"):
            raise click.UsageError(f"--ior goes with --material glass, got --material {material}")
        if ior is not None and not (math.isfinite(ior) and ior > 0.0):
            raise click.UsageError(f"--ior must be in (0, inf), got {ior:g}")
        return command(
            material=material or ("Au" if ior is None else "glass"),
            ior=_render.GLASS if ior is None else ior,
            **rest,
        )

    return wrapped


def writable(path: str, formats: tuple[str, ...]) -> str:
    """`path`, if a picture can be written there."""
    if Path(path).suffix.lower() not in formats:
        raise click.UsageError(f"--output must end in {', '.join(formats)}, got {path!r}")
    if not Path(path).absolute().parent.is_dir():
        raise click.UsageError(f"--output must lie in an existing folder, got {path!r}")
    return path


@click.command(cls=DensityCommand)
@click.argument("family", required=False)
@density_option
@parameter_options
@axes_options
@click.option(
    "--fit", "fitted", type=click.File("r"), metavar="FILE", help="What `fit --json` printed, or -."
)
@click.option("--family", "chosen", metavar="NAME", help="Of the fit's families; the best without.")
@look_options
@click.option(
    "--scene", type=click.Choice(_render.SCENES), default="preview", show_default=True, help="What it covers."
)
@click.option("--size", type=_Size(), default="512", show_default=True, metavar="N|WxH", help="In pixels.")
@click.option("--spp", type=click.IntRange(min=1), default=128, show_default=True, help="Samples per pixel.")
@click.option(
    "-o",
    "--output",
    "outputs",
    multiple=True,
    type=click.Path(dir_okay=False),
    help="FILE.png, .jpg or .exr (radiance); render.png without. Repeat for several.",
)
@json_option
def render(
    family: Any,
    parameters: dict[str, float],
    fitted: TextIO | None,
    chosen: str | None,
    material: str,
    ior: float,
    scattering: str,
    scene: str,
    size: tuple[int, int],
    spp: int,
    seed: int,
    variant: str,
    outputs: tuple[str, ...],
    as_json: bool,
) -> None:
    """Render FAMILY, or a fitted surface, with Mitsuba 3: a turned body on a floor, or a ball.

    A PNG or JPEG shows radiance up to 0.6 as it is and compresses what is brighter; EXR holds it as it is.
    The axes x and y of --alpha-x and --alpha-y run along the parallels and the meridians of the object.

    \b
    Examples:
      microfacet render student_t --alpha 0.2 --gamma 2.5 --material Cu -o copper.png
      microfacet render k0 --alpha 0.1 --ior 1.5 --spp 1024 -o glass.png -o glass.exr
      microfacet render ggx --alpha-x 0.05 --alpha-y 0.3 --rotation 30 --scene sphere
      microfacet render --density own.json --alpha 0.2
      microfacet fit scan.x3p --json | microfacet render --fit - --material Al
    """
    paths = [writable(path, tuple(_render.FORMATS)) for path in outputs or ("render.png",)]
    if fitted is None:
        if family is None or chosen is not None:
            raise click.UsageError("give a FAMILY" if family is None else "--family goes with --fit")
    elif family is not None or parameters:
        raise click.UsageError("--fit brings the parameters: choose one of its families with --family")
    else:
        family, parameters = _of_fit(fitted, chosen)
    entry = family_named(family)
    ndf = stretched(entry, parameters)
    look = _render.Look(
        entry.name, ndf.parameters, material, ior, scattering, ndf if isinstance(ndf, mf.RadialNDF) else None
    )
    begin = time.monotonic()
    used = _render.start(variant, say)
    look.check()
    with progress_line() as progress:
        radiance = _render.render(
            look, scene, size, spp, seed, lambda done, total: progress(f"{entry.name}, samples", done, total)
        )
    record = {
        **look.record(),
        "scene": scene,
        "size": size,
        "spp": spp,
        "seed": seed,
        "variant": used,
        "version": mf.__version__,
    }
    for path in paths:
        _render.save(path, radiance, {"microfacet": json.dumps(record)})
    if as_json:
        took = round(time.monotonic() - begin, 2)
        announce(json.dumps({"paths": [where(path) for path in paths], **record, "seconds": took}), *paths)
    else:
        for path in paths:
            announce(where(path), *paths)


def _of_fit(stream: TextIO, chosen: str | None) -> tuple[str, dict[str, float]]:
    """Family and parameters from the JSON of a fit."""
    try:
        ranking: list[Mapping[str, Any]] = read_json(stream, LONGEST_FIT)["ranking"]
        found: dict[str, dict[str, float]] = {}
        for entry in ranking:  # best first, perhaps with both symmetries of a family
            values = {k: float(v) for k, v in entry["params"].items()}
            found.setdefault(str(entry["family"]), values)
        best = next(iter(found))
    except (ValueError, LookupError, TypeError, AttributeError, OverflowError, StopIteration):
        name = getattr(stream, "name", "-")
        raise click.UsageError(
            f"--fit takes what `microfacet fit FILE --json` printed: {name!r} is not"
        ) from None
    if chosen is not None and chosen not in found:
        raise click.UsageError(f"--family must be one of the fit's {listed(found)}, got {chosen!r}")
    return chosen or best, found[chosen or best]
