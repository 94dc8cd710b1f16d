"""A density with its probabilities, by quadrature: quick to make, for fits that try many shapes.

The tables of `RadialNDF` are a hundred times as dear, and exact to fourteen digits; here it is nine.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Standard"]

Array = NDArray[np.float64]

_PANEL, _NODES = 0.025, 6  # of log r
_SPACED = 0.04  # of log slope, between quadratures
_NEGLIGIBLE = 650.0  # minus the logarithm of a share of the mass that is nothing, and
_LITTLE = 60.0  # of what may lie beyond slopes that are numbers


class Standard:
    """A joint density of slopes as a function of r at alpha = 1, normalised.

    Parameters
    ----------
    density : callable
        Of float64 arrays; it need not be normalised.
    """

    def __init__(self, density: Callable[[Any], Any]) -> None:
        self._density = density
        coarse = np.arange(-150.0, 170.0, 0.5)
        with np.errstate(all="ignore"):
            values = np.asarray(density(np.exp(coarse)), dtype=np.float64)
            if values.shape != coarse.shape or not np.any(values > 0.0) or np.any(values < 0.0):
                raise ValueError("P22 must be positive somewhere, negative nowhere, and keep the shape of r")
            mass = np.where(values > 0.0, np.log(np.where(values > 0.0, values, 1.0)) + 2.0 * coarse, -np.inf)
        peak = int(np.argmax(np.where(np.isfinite(mass), mass, -np.inf)))
        seen = np.flatnonzero(mass > mass[peak] - _NEGLIGIBLE)
        low, high = coarse[max(seen[0] - 1, 0)], coarse[min(seen[-1] + 1, len(coarse) - 1)]
        if max(mass[0], mass[-1]) > mass[peak] - _LITTLE or not math.isfinite(mass[peak]):
            raise ValueError("P22 must be integrable over the plane")
        self._edges = np.linspace(low, high, math.ceil((high - low) / _PANEL) + 1)
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        half = 0.5 * (self._edges[1] - self._edges[0])
        at = self._edges[:-1, np.newaxis] + half * (nodes + 1.0)
        with np.errstate(all="ignore"):
            inside = 2.0 * math.pi * np.nan_to_num(density(np.exp(at.ravel())), nan=0.0).reshape(at.shape)
        panels = half * ((inside * np.exp(2.0 * at)) @ weights)
        self.norm = float(panels.sum())
        if not 0.0 < self.norm < math.inf:
            raise ValueError(f"P22 must be integrable over the plane, its integral is {self.norm:g}")
        # From both ends, so that both tails keep their digits.
        self._above = np.append(np.cumsum(panels[::-1])[::-1], 0.0) / self.norm
        self._below = np.append(0.0, np.cumsum(panels)) / self.norm

    def P22(self, r: ArrayLike) -> Any:
        """The density at slope r."""
        with np.errstate(all="ignore"):
            return np.nan_to_num(self._density(np.asarray(r, dtype=np.float64)), nan=0.0) / self.norm

    def survival(self, r: ArrayLike) -> Any:
        """The probability of a slope above r."""
        return self._read(np.asarray(r, dtype=np.float64), self._above, -1.0)

    def _read(self, r: Array, sums: Array, sign: float) -> Any:
        """Hermite's cubic in log r through the logarithms of sums over panels."""
        from scipy.interpolate import CubicHermiteSpline

        kept = np.flatnonzero(sums > 1e-290)
        x = self._edges[kept]
        density = 2.0 * math.pi * np.exp(2.0 * x) * self.P22(np.exp(x))
        curve = CubicHermiteSpline(x, np.log(sums[kept]), sign * density / sums[kept])
        with np.errstate(divide="ignore"):
            at = np.log(r)
        found = np.exp(curve(np.clip(at, x[0], x[-1])))
        beyond = at > self._edges[-1] if sign < 0.0 else at < self._edges[0]
        return np.where(beyond, 0.0, found)

    def quantile(self, xi: ArrayLike) -> Any:
        """The slope below which it lies with probability xi."""
        share = np.asarray(xi, dtype=np.float64)
        kept = np.flatnonzero((self._below > 0.0) & (self._above > 0.0))
        odds = np.log(self._below[kept]) - np.log(self._above[kept])
        with np.errstate(divide="ignore"):
            target = np.log(share) - np.log1p(-share)
        x = np.interp(target, odds, self._edges[kept])
        for _ in range(4):
            above = np.clip(self.survival(np.exp(x)), 1e-300, 1.0)
            below = np.clip(self._read(np.exp(x), self._below, 1.0), 1e-300, 1.0)
            slope = 2.0 * math.pi * np.exp(2.0 * x) * self.P22(np.exp(x)) / (above * below)
            step = (target - (np.log(below) - np.log(above))) / np.where(slope > 0.0, slope, np.inf)
            x = np.clip(x + np.clip(step, -_PANEL, _PANEL), self._edges[0], self._edges[-1])
        return np.where(share > 0.0, np.exp(x), 0.0)

    def P2(self, p: ArrayLike) -> Any:
        """The density of the slope along an axis, by a spline through the logarithms of quadratures.

        It is 2 int P22(t cosh y) t cosh y dy over y > 0. Below the slope that hardly any slope is below it is
        constant, also where the density at slope 0 is infinite.
        """
        from scipy.interpolate import CubicSpline

        least = float(self._edges[np.searchsorted(self._below, 1e-16)])  # hardly a slope is smaller
        t = np.abs(np.asarray(p, dtype=np.float64))
        at = np.clip(np.log(np.maximum(t, 1e-300)), least, 140.0)
        first, last = (round(find(at) / _SPACED) for find in (np.min, np.max))
        x = _SPACED * np.arange(first - 6, last + 7)
        nodes, weights = np.polynomial.legendre.leggauss(10)
        y = (np.arange(40)[:, np.newaxis] + 0.5 * (nodes + 1.0)).ravel()
        with np.errstate(all="ignore"):
            r = np.exp(x)[:, np.newaxis] * np.cosh(y)
            values = (self.P22(r.ravel()).reshape(r.shape) * r) @ np.tile(weights, 40)
        kept = np.flatnonzero(values > 1e-290)
        if kept.size < 4:
            return np.zeros_like(t)
        curve = CubicSpline(x[kept], np.log(values[kept]))
        seen = (at >= x[kept[0]]) & (at <= x[kept[-1]])
        return np.where(seen, np.exp(curve(np.clip(at, x[kept[0]], x[kept[-1]]))), 0.0)

    def slope_cdf(self, p: ArrayLike) -> Any:
        """The probability that the slope along an axis is at most p.

        Pr(slope > t) is the mean of acos(t/r)/pi over r > t, which is int survival(t cosh y)/(pi cosh y) dy.
        """
        slopes = np.asarray(p, dtype=np.float64)
        nodes, weights = np.polynomial.legendre.leggauss(10)
        y = (np.arange(40)[:, np.newaxis] + 0.5 * (nodes + 1.0)).ravel()
        factor = np.tile(0.5 * weights, 40) / (math.pi * np.cosh(y))
        t = np.minimum(np.abs(slopes), 1e30)
        above = self.survival(t[..., np.newaxis] * np.cosh(y)) @ factor
        above = np.where(t > 0.0, above, 0.5)
        return np.where(slopes > 0.0, 1.0 - above, above)
