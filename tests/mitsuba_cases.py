"""Surfaces, materials and directions that the tests of the Mitsuba plugins share; needs no Mitsuba."""

from __future__ import annotations

import itertools
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import microfacet as mf
from shapes import NAMES, several_shapes

SHAPES = several_shapes(
    {
        "gtr": (0.5, 1.0, 2.5),
        "student_t": (1.8, 3.0, 8.0),
        "bessel_k": (0.4, 1.0, 3.0),
        "generalised_exponential": (1.2, 1.5, 2.5),  # alike in roughness
    }
)
ALPHAS = (0.05, 0.3, 0.8)
STRETCHED = ((0.05, 0.3), (0.3, 0.8), (0.8, 0.05))
ANGLES = (0.0, 30.0, 60.0, 80.0, 88.0)
AZIMUTH = 35.0  # of directions on surfaces that are stretched
ETA, GLASS = (0.2, 3.9), 1.5
BUILT_IN = {"conductor": "roughconductor", "dielectric": "roughdielectric"}
OURS = {"conductor": "microfacet_conductor", "dielectric": "microfacet_dielectric"}
FAMILIES = {family.name: family for family in mf.families() if not family.singular}


@dataclass(frozen=True)
class Surface:
    """A distribution of normals as both sides name it."""

    family: str
    alpha: tuple[float, ...]  # one, or along u and v
    shape: float | None = None

    def __str__(self) -> str:
        values = "x".join(f"{alpha:g}" for alpha in self.alpha)
        return f"{self.family}-{values}" + ("" if self.shape is None else f"-{self.shape:g}")

    @property
    def own(self) -> dict[str, float]:
        """The shape parameter by its name."""
        return {} if self.shape is None else {NAMES[self.family]: self.shape}

    @property
    def properties(self) -> dict[str, Any]:
        """As properties of a plugin."""
        names = ("alpha",) if len(self.alpha) == 1 else ("alpha_u", "alpha_v")
        return {"distribution": self.family, **dict(zip(names, self.alpha, strict=True)), **self.own}

    @property
    def ndf(self) -> Any:
        """As a distribution of this library, in double precision."""
        names = ("alpha",) if len(self.alpha) == 1 else ("alpha_x", "alpha_y")
        return FAMILIES[self.family].cls(**dict(zip(names, self.alpha, strict=True)), **self.own)

    @property
    def singular(self) -> bool:
        """Whether the density of normals is infinite at the mean normal."""
        return bool(np.isinf(self.ndf.D([0.0, 0.0, 1.0])))


@dataclass(frozen=True)
class Case:
    """A material seen from a direction, given in degrees from the normal; beyond 90 from below."""

    material: str
    surface: Surface
    degrees: float
    built_in: bool = False

    def __str__(self) -> str:
        return f"{self.plugin}-{self.surface}-{self.degrees:g}"

    @property
    def plugin(self) -> str:
        return (BUILT_IN if self.built_in else OURS)[self.material]

    @property
    def azimuth(self) -> float:
        return 0.0 if len(self.surface.alpha) == 1 else AZIMUTH

    @property
    def properties(self) -> dict[str, Any]:
        """A dictionary for `mitsuba.load_dict`."""
        return {"type": self.plugin, **self.surface.properties, **constants(self.material)}


def constants(material: str) -> dict[str, Any]:
    """What facets are made of."""
    if material == "dielectric":
        return {"int_ior": GLASS, "ext_ior": 1.0}
    return {name: {"type": "uniform", "value": x} for name, x in zip(("eta", "k"), ETA, strict=True)}


def surfaces(stretched: bool = False) -> Iterator[Surface]:
    """All families with all their shapes, isotropic or stretched."""
    for family, about in FAMILIES.items():
        alphas = STRETCHED if stretched else tuple((alpha,) for alpha in ALPHAS)
        if stretched and not about.anisotropic:
            continue
        for shape, alpha in itertools.product(SHAPES.get(family, (None,)), alphas):
            yield Surface(family, alpha, shape)


def angles(material: str) -> tuple[float, ...]:
    """From above, and of what is transparent from below."""
    below = tuple(180.0 - degrees for degrees in reversed(ANGLES))
    return ANGLES + (below if material == "dielectric" else ())


def cases(built_in: bool = False) -> Iterator[Case]:
    """The full grid; of Mitsuba's own plugins for the two families that they know."""
    for material in OURS:
        for surface in (*surfaces(), *surfaces(stretched=True)):
            if built_in and surface.family not in ("beckmann", "ggx"):
                continue
            for degrees in angles(material):
                yield Case(material, surface, degrees, built_in)


def selection(each: int = 1) -> list[Case]:
    """Of every family and material, isotropic and stretched, some that look drawn, at angles in turn."""
    groups: dict[tuple[str, str, int], list[Case]] = {}
    for case in cases():
        groups.setdefault((case.material, case.surface.family, len(case.surface.alpha)), []).append(case)
    found = []
    for number, group in enumerate(groups.values()):
        choice = angles(group[0].material)
        for k in range(each):
            here = [case for case in group if case.degrees == choice[(number + 3 * k) % len(choice)]]
            found.append(min(here, key=lambda case: zlib.crc32(str(case).encode())))
    return found
