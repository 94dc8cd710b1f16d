"""Materials: single scattering beside Mitsuba 3's roughconductor and roughdielectric, and walks per second.

Both evaluate f |cos| for pairs of directions, with Smith's uncorrelated masking that Mitsuba has, and draw
directions with their weights from uniform numbers, in float32 on one thread; Mitsuba (llvm_ad_rgb) as a
shape's BSDF sees them.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import click
import numpy as np
from rich.table import Table

import microfacet as mf

from . import renderer
from .kernels import PARAMETERS
from .runner import CONSOLE
from .suite import Measurement
from .timing import Contender, interleave, ratios, speed

os.environ["MICROFACET_THREADS"] = "1"
ETA, K, GLASS = 0.2, 3.0, 1.5
CLASSES = {family.name: family.cls for family in mf.families()}


class Pairs:
    """Directions above the surface, and uniform numbers."""

    def __init__(self, length: int, dtype: str) -> None:
        rng = np.random.default_rng(2)
        wi, wo = rng.normal(size=(2, length, 3))
        for w in (wi, wo):
            w /= np.linalg.norm(w, axis=1, keepdims=True)
            w[:, 2] = abs(w[:, 2])
        self.wi, self.wo, self.xi = (a.astype(dtype) for a in (wi, wo, rng.random((length, 4))))
        self.length, self.dtype = length, np.dtype(dtype)


def distribution(family: str) -> Any:
    return CLASSES[family](**PARAMETERS[family])


def ours(family: str, material: str, operation: str, pairs: Pairs) -> Callable[[], object]:
    ndf = distribution(family)
    made: Any = (
        mf.Conductor(ndf, ETA, K, correlated=False)
        if material == "conductor"
        else mf.Dielectric(ndf, GLASS, correlated=False)
    )
    if operation == "eval":
        return partial(made.eval, pairs.wi, pairs.wo)
    return partial(made.sample, pairs.wi, pairs.xi)


class Peer:
    """Mitsuba's plugins on the same arrays."""

    def __init__(self, pairs: Pairs) -> None:
        import drjit
        import mitsuba

        mitsuba.set_variant(renderer.VARIANT)
        drjit.set_thread_count(1)
        self.drjit, self.mitsuba = drjit, mitsuba
        self.interaction = drjit.zeros(mitsuba.SurfaceInteraction3f, pairs.length)
        self.interaction.wi = mitsuba.Vector3f(*(mitsuba.Float(a) for a in pairs.wi.T.copy()))
        self.wo = mitsuba.Vector3f(*(mitsuba.Float(a) for a in pairs.wo.T.copy()))
        self.choice = mitsuba.Float(pairs.xi[:, 3].copy())
        self.point = mitsuba.Point2f(*(mitsuba.Float(a) for a in pairs.xi[:, :2].T.copy()))
        drjit.eval(self.interaction, self.wo, self.choice, self.point)

    def call(self, family: str, material: str, operation: str) -> Callable[[], object]:
        constants: dict[str, Any] = {"int_ior": GLASS, "ext_ior": 1.0}
        if material == "conductor":
            constants = {name: {"type": "uniform", "value": x} for name, x in (("eta", ETA), ("k", K))}
        alpha = PARAMETERS[family]["alpha"]
        bsdf = self.mitsuba.load_dict(
            {"type": f"rough{material}", "distribution": family, "alpha": alpha, **constants}
        )
        context = self.mitsuba.BSDFContext()

        def evaluate() -> object:
            if operation == "eval":
                value = bsdf.eval(context, self.interaction, self.wo)
            else:
                value = bsdf.sample(context, self.interaction, self.choice, self.point)
            self.drjit.eval(value)
            self.drjit.sync_thread()
            return value

        return evaluate


def beside_mitsuba(pairs: Pairs, seconds: float) -> Iterator[Measurement]:
    """Ratios ours/Mitsuba on one thread."""
    peer = Peer(pairs)
    for family in ("ggx", "beckmann"):
        for material in ("conductor", "dielectric"):
            for operation in ("eval", "sample"):
                times = interleave(
                    [
                        Contender("ours", ours(family, material, operation, pairs), pairs.length),
                        Contender("Mitsuba", peer.call(family, material, operation), pairs.length),
                    ],
                    seconds,
                )
                speeds = {name: speed(t) for name, t in times.items()}
                name = f"{family}.{material}.{operation}"
                yield Measurement(name, pairs.dtype.name, pairs.length, 1, speeds, ratios(times))


def walks(pairs: Pairs, seconds: float) -> Iterator[Measurement]:
    """Walks per second of a metal, sampled and evaluated."""
    for family in PARAMETERS:
        metal = mf.Conductor(distribution(family), ETA, K, scattering="multiple")
        calls: dict[str, Callable[[], object]] = {
            "walk": partial(metal.walk, pairs.wi, rng=1),
            "eval": partial(metal.eval, pairs.wi, pairs.wo, rng=1),
        }
        for operation, call in calls.items():
            times = interleave([Contender("ours", call, pairs.length)], seconds)
            speeds = {"ours": speed(times["ours"])}
            yield Measurement(f"{family}.{operation}", pairs.dtype.name, pairs.length, 1, speeds, {})


@click.command()
@click.option("--length", type=click.IntRange(1), default=1 << 16, show_default=True, metavar="N")
@click.option("--seconds", type=float, default=1.0, show_default=True, help="Budget for each comparison.")
def materials(length: int, seconds: float) -> None:
    """Materials beside Mitsuba's, and walks per second and core."""
    table = Table("material", "precision", "M/s", "Mitsuba M/s", "ratio", title="one thread")
    if renderer.usable()[0]:
        for m in beside_mitsuba(Pairs(length, "float32"), seconds):
            ratio = m.ratios["Mitsuba"]
            table.add_row(
                m.kernel,
                m.dtype,
                f"{m.speeds['ours'] / 1e6:.1f}",
                f"{m.speeds['Mitsuba'] / 1e6:.1f}",
                f"{ratio.median:.2f} ({ratio.lower:.2f} to {ratio.upper:.2f})",
            )
    else:
        CONSOLE.print(renderer.usable()[1])
    for dtype in ("float32", "float64"):
        for m in walks(Pairs(length, dtype), seconds):
            table.add_row(m.kernel + " (all orders)", m.dtype, f"{m.speeds['ours'] / 1e6:.2f}", "", "")
    CONSOLE.print(table)
