"""Maps of known families whose slopes depend on each other, for tests of standard errors:
tests/test_coverage.py takes some, tools/measure_coverage.py all.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft, special

import fit_cases
import microfacet as mf

ALPHA = 0.2
SHAPES = {"beckmann": {}, "ggx": {}, "student_t": {"gamma": 3.0}, "bessel_k": {"a": 1.5}}
#: Side of the maps in pixels, correlation lengths of heights, amplitude, and regions of inhomogeneous maps.
SIZE, LENGTH, AMPLITUDE, REGION = 256, 2.0, 16.0, 20.0
MISSING = 0.2
_POOLED = 2_000_000  # independent slopes that say what the parameters of a pooled law are

Map = NDArray[np.float64]


def distribution(family: str) -> Any:
    """The family at its parameters."""
    return fit_cases.FAMILIES[family].cls(alpha=ALPHA, **SHAPES[family])


def independent(family: str, seed: int) -> mf.SlopeSample:
    """A normal map whose pixels do not depend on each other."""
    random = np.random.default_rng([seed, 1])
    grid = random.random((SIZE // 2, SIZE // 2)) >= MISSING
    values = tuple({"alpha": ALPHA, **SHAPES[family]}.items())
    slopes = fit_cases.Case(family, values).slopes(int(np.count_nonzero(grid)), seed)
    return mf.SlopeSample(slopes, "independent", grid=grid)


def correlated(family: str, seed: int, factor: Map | float = 1.0) -> mf.Surface:
    """A synthetic map, times a factor, of which pixels are missing at random."""
    lengths = {"correlation_length": LENGTH, "amplitude_length": AMPLITUDE}
    surface = mf.synthesize(distribution(family), (SIZE, SIZE), 1.0, seed=seed, **lengths)
    gone = np.random.default_rng([seed, 2]).random((SIZE, SIZE)) < MISSING
    return mf.Surface(np.where(gone, math.nan, surface.heights * factor), 1.0)


def patches(seed: int) -> Map:
    """A roughness between 1/sqrt 2 and sqrt 2, every value of its logarithm equally often: a smooth field
    with regions of its own on every map.
    """
    wave = 2 * math.pi * np.hypot(fft.fftfreq(SIZE)[:, np.newaxis], fft.rfftfreq(SIZE))
    root = np.exp(-((wave * REGION) ** 2) / 8)
    noise = np.random.default_rng([seed, 3]).standard_normal((SIZE, SIZE))
    weights = np.where(np.isin(np.arange(SIZE // 2 + 1), (0, SIZE // 2)), 1.0, 2.0)
    variance = np.sum(root**2 * weights) / SIZE**2
    field = fft.irfft2(fft.rfft2(noise) * root, s=(SIZE, SIZE)) / math.sqrt(variance)
    return np.asarray(2.0 ** (special.ndtr(field) - 0.5))


def ramp() -> Map:
    """The same roughness, rising from left to right."""
    return np.broadcast_to(2.0 ** (np.linspace(0, 1, SIZE) - 0.5), (SIZE, SIZE))


@dataclass(frozen=True)
class Kind:
    """A kind of maps: how one is made, and whether the true parameters are those of a pooled law."""

    name: str
    make: Callable[[str, int], Any]
    pooled: bool
    meaning: str


KINDS = (
    Kind("independent", independent, False, "a normal map of independent slopes"),
    Kind("correlated", correlated, False, "a height map of `synthesize`"),
    Kind(
        "inhomogeneous",
        lambda family, seed: correlated(family, seed, patches(seed)),
        True,
        "the same times a smooth random field, another one on every map",
    ),
    Kind(
        "ramp",
        lambda family, seed: correlated(family, seed, ramp()),
        True,
        "the same times a factor that rises from left to right, equal on all maps",
    ),
)


def seeds(kind: Kind, family: str, maps: int) -> list[int]:
    """Of so many maps, others for each kind and family: what chance does to one is not done to all."""
    first = zlib.crc32(f"{kind.name} {family}".encode()) % 10**6
    return list(range(first, first + maps))


@cache
def truth(family: str, pooled: bool) -> dict[str, float]:
    """The parameters that an interval has to hold: of the family, or what the same family fits to
    independent slopes of the law that is pooled over all regions.
    """
    own = {"alpha": ALPHA, **SHAPES[family]}
    if not pooled:
        return own
    slopes = fit_cases.Case(family, tuple(own.items())).slopes(_POOLED, 0)
    slopes *= 2.0 ** (np.random.default_rng(4).random((_POOLED, 1)) - 0.5)
    return dict(mf.fit(slopes, family, symmetry="isotropic")[0].params)


def deviations(family: str, kind: Kind, seed: int) -> tuple[dict[str, float], bool, float]:
    """(fitted - true)/standard error of every parameter, whether the map is said to be one population, and
    the p-value of the goodness test.
    """
    results = mf.fit(kind.make(family, seed), family, symmetry="isotropic")
    result = results[0]
    found = {
        name: (result.params[name] - value) / result.standard_errors[name]
        for name, value in truth(family, kind.pooled).items()
    }
    return found, results.halves is None or results.halves.agree, result.goodness.p_value
