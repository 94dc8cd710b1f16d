"""Render time of the Mitsuba plugins beside Mitsuba's own, at equal samples, in one run.

Every family beside the built-in Beckmann, and GGX beside the built-in GGX, as metal and as glass: a sphere
under an environment, in llvm_ad_rgb, on all threads. Pictures are rendered in rounds, each material once in
every round, and ratios are formed within a round; Dr.Jit has compiled everything before.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import click
import numpy as np
from rich.table import Table

import microfacet as mf

from . import machine, renderer
from .kernels import PARAMETERS
from .results import write_whole
from .runner import CONSOLE
from .timing import Contender, Spread, Times, interleave

ALPHA = 0.3
CHOSEN = {"gtr": 2.5, "student_t": 2.5, "bessel_k": 1.5}  # where it is not the value of pictures
CONSTANTS: dict[str, dict[str, Any]] = {"conductor": {"material": "Au"}, "dielectric": {"int_ior": 1.5}}
BUILT_IN = ("beckmann", "ggx")
#: The largest ratio that is good enough: beside the built-in plugin of the same family, or its Beckmann.
TARGETS = {"ggx": 1.1, "beckmann": 1.1}
OTHERS = 1.5


def own_shape(name: str) -> dict[str, float]:
    """The shape parameter of a family as a property of a plugin, if it has one."""
    (family,) = (family for family in mf.families() if family.name == name)
    return {own.name: CHOSEN.get(name, own.pictured) for own in family.parameters[1:]}


@dataclass(frozen=True)
class Ratio:
    """Seconds of our picture by theirs."""

    material: str
    family: str
    scattering: str
    beside: str
    milliseconds: float
    ratio: Spread
    target: float | None

    @property
    def missed(self) -> bool:
        return self.target is not None and self.ratio.median > self.target


def scene(mi: Any, bsdf: dict[str, Any], size: int) -> Any:
    """A sphere that nearly fills the picture."""
    patches = np.random.default_rng(1).random((16, 32, 3)).astype(np.float32) ** 4
    view = mi.ScalarTransform4f().look_at([0, -4, 1], [0, 0, 0], [0, 0, 1])
    film = {"type": "hdrfilm", "width": size, "height": size, "pixel_format": "rgb"}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 6},
            "sensor": {"type": "perspective", "fov": 30, "to_world": view, "film": film},
            "emitter": {"type": "envmap", "bitmap": mi.Bitmap(patches)},
            "shape": {"type": "sphere", "bsdf": bsdf},
        }
    )


def contenders(material: str, size: int, samples: int, multiple: bool) -> list[Contender]:
    """The built-in plugins, and ours with one order of scattering (and all)."""
    import drjit as dr
    import mitsuba as mi

    def picture(made: Any) -> None:
        dr.eval(mi.render(made, spp=samples))
        dr.sync_thread()

    def one(name: str, bsdf: dict[str, Any]) -> Contender:
        whole = {"alpha": ALPHA, **bsdf, **CONSTANTS[material]}
        return Contender(name, partial(picture, scene(mi, whole, size)), size * size * samples)

    found = [
        one(f"built-in {family}", {"type": f"rough{material}", "distribution": family}) for family in BUILT_IN
    ]
    for scattering in ("single", "multiple") if multiple else ("single",):
        found += [
            one(
                f"{family} {scattering}",
                {
                    "type": f"microfacet_{material}",
                    "distribution": family,
                    "scattering": scattering,
                    **own_shape(family),
                },
            )
            for family in PARAMETERS
        ]
    return found


def compared(material: str, times: dict[str, Times], evaluations: int) -> Iterator[Ratio]:
    """Ratios of one round of materials."""
    for name, spent in times.items():
        family, _, scattering = name.partition(" ")
        if family == "built-in":
            continue
        beside = f"built-in {family if family in BUILT_IN else 'beckmann'}"
        target = TARGETS.get(family, OTHERS) if scattering == "single" else None
        milliseconds = 1e3 * evaluations * float(np.median(spent))
        spread = Spread.of(spent / times[beside])
        yield Ratio(material, family, scattering, beside, milliseconds, spread, target)


def measure(
    materials: tuple[str, ...], size: int, samples: int, seconds: float, multiple: bool
) -> list[Ratio]:
    """One material after the other."""
    import mitsuba

    mitsuba.set_variant(renderer.VARIANT)
    import microfacet.mitsuba  # noqa: F401  (registers the plugins)

    found: list[Ratio] = []
    for material in materials:
        entrants = contenders(material, size, samples, multiple)
        times = interleave(entrants, seconds)
        found += compared(material, times, entrants[0].evaluations)
    return found


@click.command()
@click.option("--size", type=click.IntRange(1), default=256, show_default=True, help="Pixels along a side.")
@click.option("--samples", type=click.IntRange(1), default=64, show_default=True, help="For each pixel.")
@click.option(
    "--seconds", type=float, default=60.0, show_default=True, help="Budget for metal, and for glass."
)
@click.option(
    "--only", type=click.Choice(list(CONSTANTS)), multiple=True, help="Repeatable; both by default."
)
@click.option("--multiple", is_flag=True, help="All orders of scattering, too.")
@click.option(
    "--json", "file", type=click.Path(dir_okay=False, path_type=Path), help="Also write the ratios here."
)
def mitsuba(
    size: int, samples: int, seconds: float, only: tuple[str, ...], multiple: bool, file: Path | None
) -> None:
    """Pictures by the Mitsuba plugins beside pictures by its own."""
    names, note = renderer.usable()
    if not names:
        raise click.ClickException(str(note))
    found = measure(only or tuple(CONSTANTS), size, samples, seconds, multiple)
    heads = ("material", "family", "orders", "ms", "beside", "time / its time", "at most")
    table = Table(*heads, title=f"{size} x {size} pixels, {samples} samples, {renderer.VARIANT}")
    for r in found:
        spread = f"{r.ratio.median:.2f} ({r.ratio.lower:.2f} to {r.ratio.upper:.2f})"
        target = "" if r.target is None else f"{r.target:g}" + (" missed" if r.missed else "")
        table.add_row(r.material, r.family, r.scattering, f"{r.milliseconds:.0f}", r.beside, spread, target)
    CONSOLE.print(table)
    if file:
        record = {
            "machine": machine.describe(),
            "size": size,
            "samples": samples,
            "ratios": list(map(asdict, found)),
        }
        write_whole(file, json.dumps(record, indent=1) + "\n")
