"""White furnaces: what lossless materials send everywhere, through `eval`, is all of the light.

The weight of a lossless walk is 1 by construction and proves nothing. Here directions wo come from a density
that is not the walk's, and the mean of eval/density has to be 1. tests/test_walks.py takes some cases,
tools/measure_furnace.py all.
"""

from __future__ import annotations

import itertools
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

import microfacet as mf
from material_cases import FAMILIES, Array, of_family, towards

ALPHAS = (0.05, 0.3, 1.0, 3.0)
ANGLES = (0.0, 45.0, 80.0, 89.0)
ETA = 1.5
MATERIALS = ("metal", "glass", "glass from below", "diffuse")


def cosine_lobe(xi: Array, both: bool) -> Array:
    """Directions of density |cos|/pi above the surface, or half of it on both sides."""
    r, phi = np.sqrt(xi[:, 0]), 2.0 * np.pi * xi[:, 1]
    z = np.sqrt(1.0 - xi[:, 0])
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.where(both & (xi[:, 2] < 0.5), -z, z)], axis=-1)


def even(xi: Array, both: bool) -> Array:
    """Directions of the same density everywhere."""
    z, phi = xi[:, 0], 2.0 * np.pi * xi[:, 1]
    r = np.sqrt((1.0 - z) * (1.0 + z))
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.where(both & (xi[:, 2] < 0.5), -z, z)], axis=-1)


@dataclass(frozen=True)
class Furnace:
    """One lossless material, lit from one direction."""

    material: str
    family: str
    alpha: float
    degrees: float

    def __str__(self) -> str:
        return f"{self.material}-{self.family}-{self.alpha:g}-{self.degrees:g}"

    @property
    def wi(self) -> Array:
        """Where light comes from; below the surface as steep as above it."""
        below = self.material == "glass from below"
        return towards(180.0 - self.degrees if below else self.degrees, 20.0)

    @cached_property
    def ndf(self) -> Any:
        return of_family(self.family, self.alpha)

    def make(self, scattering: str) -> Any:
        """The material; with scattering of one order, what proposes directions."""
        if self.material == "diffuse":
            return mf.Diffuse(self.ndf, 1.0, scattering=scattering)
        if self.material == "metal":
            return mf.Conductor(self.ndf, scattering=scattering)
        return mf.Dielectric(self.ndf, ETA, scattering=scattering, mode="importance")

    @property
    def transmits(self) -> bool:
        return self.material.startswith("glass")

    @cached_property
    def lobes(self) -> list[Any]:
        """What proposes directions: scattering of one order, and a wider lobe for further orders."""
        if self.material == "diffuse":
            return []
        of_one_order = self.make("single")
        wide = Furnace(self.material, "ggx", 3.0 * self.alpha, self.degrees).make("single")
        return [of_one_order, wide]

    def propose(self, n: int, rng: np.random.Generator) -> tuple[Array, Array]:
        """Directions wo and their density: of lobes, a cosine, and all directions alike."""
        both = self.transmits
        shares = (0.35, 0.25, 0.15, 0.25)[-2 - len(self.lobes) :]
        parts = np.diff(np.rint(np.cumsum((0.0, *shares)) / sum(shares) * n).astype(int))
        drawn = [cosine_lobe(rng.random((parts[-2], 3)), both), even(rng.random((parts[-1], 3)), both)]
        for lobe, part in zip(self.lobes, parts, strict=False):
            first = lobe.sample(self.wi, rng.random((part, lobe.sample_dims)))[0]
            if not both:  # what metal mirrors downwards is turned up
                first[:, 2] = np.abs(first[:, 2])
            drawn.append(first)
        wo = np.concatenate(drawn)
        cosine, alike = (
            np.abs(wo[:, 2]) / (2.0 * np.pi if both else np.pi),
            1.0 / (4.0 if both else 2.0) / np.pi,
        )
        density = parts[-2] * cosine + parts[-1] * alike
        for lobe, part in zip(self.lobes, parts, strict=False):
            density += part * lobe.pdf(self.wi, wo)
            if not both:
                density += part * lobe.pdf(self.wi, wo * [1.0, 1.0, -1.0])
        return wo, density / n

    def light(self, n: int, part: int = 0) -> Array:
        """`n` estimates of all that leaves the surface, whose mean is to be 1; other ones for each `part`."""
        rng = np.random.default_rng([zlib.crc32(str(self).encode()), part])
        wo, density = self.propose(n, rng)
        return np.asarray(self.make("multiple").eval(self.wi, wo, rng=rng) / density)


def cases() -> Iterator[Furnace]:
    """Every material, family, roughness and angle."""
    return itertools.starmap(Furnace, itertools.product(MATERIALS, FAMILIES, ALPHAS, ANGLES))


def selection() -> list[Furnace]:
    """Of every family and material four, which meet every roughness and every angle."""
    pairs = set(zip(ALPHAS, (45.0, 89.0, 80.0, 0.0), strict=True))
    return [case for case in cases() if (case.alpha, case.degrees) in pairs]
