"""Ten densities that no family has, as functions, samples and tables; each is built once."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import mpmath
import numpy as np

import microfacet as mf
from microfacet._densities.curve import Curve

FUNCTIONS: dict[str, tuple[Callable[[Any], Any], Callable[[Any], Any]]] = {
    "quartic": (lambda r: np.exp(-(r**4)), lambda r: mpmath.exp(-(r**4))),
    "root": (lambda r: np.exp(-3.0 * np.sqrt(r)), lambda r: mpmath.exp(-3 * mpmath.sqrt(r))),
    "ring": (lambda r: r**4 * np.exp(-3.0 * r * r), lambda r: r**4 * mpmath.exp(-3 * r * r)),
    "lobes": (
        lambda r: np.exp(-((r / 0.3) ** 2)) + 0.02 * np.exp(-(((r - 2.0) / 0.4) ** 2)),
        lambda r: mpmath.exp(-((r / mpmath.mpf(0.3)) ** 2))
        + mpmath.mpf(0.02) * mpmath.exp(-(((r - 2) / mpmath.mpf(0.4)) ** 2)),
    ),
    "heavy": (lambda r: (1.0 + r**3) ** -1.2, lambda r: (1 + r**3) ** -mpmath.mpf(1.2)),
    "singular": (lambda r: r**-1.25 * np.exp(-r), lambda r: r ** -mpmath.mpf(1.25) * mpmath.exp(-r)),
}  # fmt: skip


def _measured() -> mf.RadialNDF:
    """Of 1e5 slopes, of which two thirds are of one roughness and a third of another."""
    rng = np.random.default_rng(17)
    width = np.where(rng.random(100_000) < 0.67, 0.4, 1.4)
    return mf.RadialNDF.from_samples(rng.normal(size=(100_000, 2)) * width[:, np.newaxis], alpha=1.0)


def _table() -> mf.RadialNDF:
    """D by degrees, with the noise of a measurement."""
    theta = np.radians(np.arange(0.0, 86.0, 2.5))
    noise = np.exp(0.02 * np.random.default_rng(3).normal(size=len(theta)))
    return mf.RadialNDF.from_D(theta, 4.0 * np.exp(-2.0 * np.sin(theta) ** 2) * noise, beyond="zero")


def _compact() -> mf.RadialNDF:
    r = np.linspace(0.0, 1.5, 16)
    return mf.RadialNDF(Curve("P22", r, (2.25 - r**2) ** 2))


def _histogram() -> mf.RadialNDF:
    edges = np.array([0.0, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.5, 2.5, np.inf])
    return mf.RadialNDF.from_histogram(edges, [900, 2200, 4100, 4600, 6000, 7100, 5000, 1900, 250])


OTHERS = {"measured": _measured, "table": _table, "compact": _compact, "histogram": _histogram}
NAMES = (*FUNCTIONS, *OTHERS)


@cache
def own(name: str) -> mf.RadialNDF:
    """The density at alpha = 1."""
    return mf.RadialNDF(FUNCTIONS[name][0]) if name in FUNCTIONS else OTHERS[name]()


def towards(degrees: float, azimuth: float = 35.0) -> np.ndarray:
    """A unit vector."""
    theta, phi = np.radians(degrees), np.radians(azimuth)
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def mean_excess(name: str, t: Any) -> Any:
    """E[(slope - t)+] in arbitrary precision: over rings, int P22 2 (q - t acos(t/r)) r dr over the norm."""
    density = FUNCTIONS[name][1]
    inside = [0, 0.01, 0.1, 0.3, 1, 2, 3, 5, 10, 100, 1e4, 1e6, 1e9, mpmath.inf]
    norm = 2 * mpmath.pi * mpmath.quad(lambda r: density(r) * r, inside)

    def part(r: Any) -> Any:
        return 2 * density(r) * (mpmath.sqrt(r * r - t * t) - t * mpmath.acos(t / r)) * r

    return mpmath.quad(part, [t, *(x for x in inside if x > t)]) / norm
