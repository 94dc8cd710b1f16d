"""The command `microfacet gallery`: balls of families and roughnesses in one picture."""

from __future__ import annotations

import json
import time
from typing import Any

import click

import microfacet as mf
from microfacet import _render
from microfacet._optional import require
from microfacet.cli.densities import densities_option
from microfacet.cli.parameters import family_named, shape_options, stretched
from microfacet.cli.printing import announce, progress_line, say, where
from microfacet.cli.program import families_option, json_option
from microfacet.cli.render import look_options, writable

__all__ = ["gallery"]


class _Alphas(click.ParamType[tuple[float, ...]]):
    """Numbers: 0.1,0.2,0.5."""

    name = "alphas"

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[float, ...]:
        """As a tuple."""
        if isinstance(value, tuple):
            return value
        try:
            return tuple(float(part) for part in value.split(","))
        except ValueError:
            self.fail(f"roughnesses are 0.1,0.2,0.5, got {value!r}", param, ctx)


@click.command()
@families_option
@densities_option
@click.option(
    "--alpha",
    "--alphas",
    "alphas",
    type=_Alphas(),
    default="0.05,0.1,0.2,0.4",
    show_default=True,
    metavar="X,X,...",
    help="Roughnesses, one row each.",
)
@shape_options(say_pictured=True)
@look_options
@click.option(
    "--size",
    type=click.IntRange(16, 1024),
    default=150,
    show_default=True,
    help="Of a ball's picture, pixels.",
)
@click.option("--spp", type=click.IntRange(min=1), default=256, show_default=True, help="Samples per pixel.")
@click.option(
    "-o",
    "--output",
    default="gallery.png",
    show_default=True,
    type=click.Path(dir_okay=False),
    help="FILE.png or FILE.jpg.",
)
@json_option
def gallery(
    families: tuple[Any, ...],
    alphas: tuple[float, ...],
    shape_given: dict[str, float],
    material: str,
    ior: float,
    scattering: str,
    size: int,
    spp: int,
    seed: int,
    variant: str,
    output: str,
    as_json: bool,
) -> None:
    """Render balls of all families at several roughnesses, side by side.

    \b
    Examples:
      microfacet gallery
      microfacet gallery --material glass --spp 1024 -o glass.jpg
      microfacet gallery --family student_t --family ggx --gamma 2.5 --alpha 0.1,0.3
    """
    path = writable(output, (".png", ".jpg", ".jpeg"))
    entries = [family_named(name) for name in families or [family.name for family in mf.families()]]
    shapes = {
        entry.name: {own.name: shape_given.get(own.name, own.pictured) for own in entry.parameters[1:]}
        for entry in entries
    }
    cells = [
        _render.Look(
            entry.name,
            stretched(entry, {"alpha": alpha, **shapes[entry.name]}).parameters,
            material,
            ior,
            scattering,
            getattr(entry, "ndf", None),
        )
        for alpha in alphas
        for entry in entries
    ]
    require("the labels of a gallery need", "plot")
    begin = time.monotonic()
    used = _render.start(variant, say)
    cells[0].check()
    pictures = []
    with progress_line() as progress:
        for number, look in enumerate(cells):
            progress(f"{look.family}, balls", number, len(cells))
            radiance = _render.render(look, "sphere", (size, size), spp, seed, backdrop=False)
            pictures.append(radiance)
    labels = _render.looks({entry.name: entry.title for entry in entries}, shapes, alphas)
    glass = {"ior": ior} if material == "glass" else {}
    record = {
        "families": shapes,
        "alphas": alphas,
        "material": material,
        **glass,
        "scattering": scattering,
        "size": size,
        "spp": spp,
        "seed": seed,
        "variant": used,
        "version": mf.__version__,
    }
    _render.save(path, _render.sheet(labels, pictures, _render.display), {"microfacet": json.dumps(record)})
    if as_json:
        took = round(time.monotonic() - begin, 2)
        announce(json.dumps({"path": where(path), **record, "seconds": took}), path)
    else:
        announce(where(path), path)
