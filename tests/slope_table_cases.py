"""Densities on grids of slopes on which tests run, and their projected area by sums over cells."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest

import microfacet as mf

__all__ = ["MADE", "Array", "each_table", "exact_sigma", "made", "sphere", "towards"]

Array = np.ndarray


def _of(extent: tuple[float, float, float, float], masses: Any) -> mf.SlopeTable:
    masses = np.asarray(masses, dtype=float)
    p, q = np.linspace(*extent[:2], masses.shape[0] + 1), np.linspace(*extent[2:], masses.shape[1] + 1)
    return mf.SlopeTable(p, q, masses)


def _anisotropic() -> mf.SlopeTable:
    p, q = np.meshgrid(np.linspace(-1, 1, 12), np.linspace(-2, 2, 9), indexing="ij")
    return _of((-1.1, 1.1, -2.2, 2.2), np.exp(-4 * p**2 + 2 * p * q - q**2))


def _two_lobed() -> mf.SlopeTable:
    p, q = np.meshgrid(np.linspace(-1, 1, 14), np.linspace(-1, 1, 8), indexing="ij")
    return _of((-1.0, 1.0, -0.5, 0.5), np.exp(-12 * (abs(p) - 0.7) ** 2 - 3 * q**2) * (1.3 + p))


def _with_holes() -> mf.SlopeTable:
    rng = np.random.default_rng(8)
    return _of((-0.9, 1.4, -0.8, 0.7), np.where(rng.random((9, 11)) < 0.7, 0.0, rng.random((9, 11))))


def _heavy() -> mf.SlopeTable:
    slopes = np.random.default_rng(9).standard_t(3, size=(100_000, 2)) * [0.3, 0.1]
    return mf.SlopeTable.from_slopes(slopes, bins=(16, 10), extent=((-2, 2), (-1, 1)))


MADE: dict[str, Callable[[], mf.SlopeTable]] = {
    "anisotropic": _anisotropic,
    "tilted": lambda: _anisotropic().moved(0.8, -0.5),
    "two lobes": _two_lobed,
    "holes": _with_holes,
    "one cell": lambda: _of((0.1, 0.5, -0.3, 0.6), [[2.0]]),
    "heavy tails": _heavy,
    "narrow": lambda: _of((0.5, 0.5001, -0.2, -0.1999), [[1.0, 3.0], [2.0, 0.0], [1.0, 5.0]]),
}


@cache
def made(name: str) -> mf.SlopeTable:
    return MADE[name]()


each_table = pytest.mark.parametrize("name", MADE)


def towards(degrees: float, azimuth: float) -> Array:
    a, f = np.radians(degrees), np.radians(azimuth)
    return np.array([np.sin(a) * np.cos(f), np.sin(a) * np.sin(f), np.cos(a)])


def sphere(n: int, seed: int = 1) -> Array:
    w = np.random.default_rng(seed).normal(size=(n, 3))
    return w / np.linalg.norm(w, axis=1, keepdims=True)


def exact_sigma(ndf: mf.SlopeTable, w: Array) -> Any:
    """Sum over cells in 60 digits: the mean of max(t + u + v, 0), u, v uniform, is a difference of cubes."""
    with mpmath.workdps(60):
        x, y, z = map(mpmath.mpf, map(float, w))

        def cells(edges: Array) -> tuple[Any, list[Any]]:
            first, last, n = mpmath.mpf(float(edges[0])), mpmath.mpf(float(edges[-1])), len(edges) - 1
            return (last - first) / n, [first + (last - first) * (2 * i + 1) / (2 * n) for i in range(n)]

        (dp, ps), (dq, qs) = cells(ndf.p_edges), cells(ndf.q_edges)
        a, b = abs(x) * dp / 2, abs(y) * dq / 2

        def mean(t: Any) -> Any:
            if abs(t) >= a + b:
                return max(t, 0)
            cube = [max(t + s * a + r * b, 0) ** 3 * s * r for s in (1, -1) for r in (1, -1)]
            if a > 0 and b > 0:
                return sum(cube) / (24 * a * b)
            return max(t + a + b, 0) ** 2 / (4 * (a + b))

        return mpmath.fsum(
            mpmath.mpf(float(ndf.masses[i, j])) * mean(z - x * p - y * q)
            for i, p in enumerate(ps)
            for j, q in enumerate(qs)
        ) / mpmath.fsum(map(float, ndf.masses.ravel()))
