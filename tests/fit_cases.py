"""Slopes of known families for tests of the fit: tests/test_fit_errors.py takes some,
tools/measure_fits.py all.
"""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

import microfacet as mf
from shapes import several_shapes

FAMILIES = {family.name: family for family in mf.families() if not family.singular}
STRETCH = {"alpha_x": 0.12, "alpha_y": 0.3, "rotation": 0.4}
SHAPES = several_shapes({"student_t": (1.8, 4.0, 6.0), "bessel_k": (0.6, 1.3, 3.0)})
GTR = ((0.2, 1.0), (0.05, 2.0), (0.4, 3.5))


@dataclass(frozen=True)
class Case:
    """A family at parameters."""

    family: str
    parameters: tuple[tuple[str, float], ...]

    def __str__(self) -> str:
        return f"{self.family} ({', '.join(f'{name} {value:g}' for name, value in self.parameters)})"

    @property
    def truth(self) -> dict[str, float]:
        """The parameters by name."""
        return dict(self.parameters)

    @property
    def symmetry(self) -> str:
        """As a result of a fit names it."""
        return "isotropic" if "alpha" in self.truth else "anisotropic"

    def slopes(self, n: int, repetition: int) -> NDArray[np.float64]:
        """n independent slopes; each repetition has random numbers of its own."""
        rng = np.random.default_rng([zlib.crc32(str(self).encode()), repetition])
        truth, family = self.truth, FAMILIES[self.family]
        shape = [truth[parameter.name] for parameter in family.parameters[1:]]
        alpha = truth.get("alpha", 1.0)
        radius = family.kernels.sample_slope(rng.random(n), alpha, *shape)
        azimuth = 2 * np.pi * rng.random(n)
        p, q = radius * np.cos(azimuth), radius * np.sin(azimuth)
        if "alpha" in truth:
            return np.column_stack((p, q))
        p, q = truth["alpha_x"] * p, truth["alpha_y"] * q
        c, s = math.cos(truth["rotation"]), math.sin(truth["rotation"])
        return np.column_stack((c * p - s * q, s * p + c * q))

    def fit(self, slopes: NDArray[np.float64]) -> Any:
        """The same family fitted, with the same parameters."""
        return mf.fit(slopes, self.family, symmetry=self.symmetry)[0]

    def deviations(self, slopes: NDArray[np.float64]) -> dict[str, float]:
        """(fitted - true)/standard error of every parameter."""
        result = self.fit(slopes)
        return {
            name: (result.params[name] - value) / result.standard_errors[name]
            for name, value in self.parameters
        }


def cases() -> list[Case]:
    """Every family with all parameters that it can have; those with a shape parameter at several."""
    return [
        case
        for name, family in FAMILIES.items()
        for case in _cases(name, tuple(STRETCH.items()) if family.anisotropic else (("alpha", 0.2),))
    ]


def isotropic_cases() -> list[Case]:
    """The same with one roughness, of the families that can have two."""
    names = [name for name, family in FAMILIES.items() if family.anisotropic]
    return [case for name in names for case in _cases(name, (("alpha", 0.2),))]


def _cases(name: str, roughness: tuple[tuple[str, float], ...]) -> list[Case]:
    own = FAMILIES[name].parameters[1:]
    if name == "gtr":
        return [Case(name, (("alpha", alpha), ("gamma", gamma))) for alpha, gamma in GTR]
    if not own:
        return [Case(name, roughness)]
    return [Case(name, (*roughness, (own[0].name, value))) for value in SHAPES[name]]


def simplest(case: Case) -> str:
    """The family with the fewest parameters that is this density: gtr is ggx at gamma 2."""
    own, truth = FAMILIES[case.family], case.truth
    at = (truth.get("alpha", 1.0), *(truth[parameter.name] for parameter in own.parameters[1:]))
    radius = own.kernels.sample_slope(np.linspace(0.01, 0.99, 99), *at)
    for name, family in FAMILIES.items():
        if len(family.parameters) < len(own.parameters):
            alpha = radius[49] / family.kernels.sample_slope(0.5, 1.0)
            same = family.kernels.P22(radius, 0.0, alpha) / own.kernels.P22(radius, 0.0, *at)
            if np.allclose(same, 1.0, rtol=1e-9):
                return name
    return case.family


def coverage_p_value(covered: int, repetitions: int) -> float:
    """How often chance alone is as far from 95 %: the exact binomial test."""
    return float(stats.binomtest(covered, repetitions, 0.95).pvalue)
