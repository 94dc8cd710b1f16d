"""Whether slopes and their opposites are equally frequent, as every family has them.

The families' densities are even, and a likelihood of them sees the squares of slopes alone: a blazed grating,
whose long facets rise gently and whose short ones fall steeply, may have the even part of some family. So the
odd harmonics of the azimuth are tested by themselves, whatever the family. Their mean is zero about the true
centre; what the median adds, which is estimated, is taken off.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._fit import blocks, pearson
from microfacet._fit.slopes import Slopes

__all__ = ["Balance", "balance", "balance_along"]

_RINGS = 3
_MOST = 300_000  # slopes that are looked at; more hardly sharpen the test
_STEP = 0.03  # of the centre, for derivatives: in median slopes, or three of its standard errors

Vector = NDArray[np.float64]


class Balance(NamedTuple):
    """The probability of slopes less balanced than these, and the largest difference between the share of
    slopes on one side of a line through the centre and one half.
    """

    p_value: float
    deviation: float


def balance(slopes: Slopes, raw: Vector, cells: NDArray[np.int16] | None) -> Balance:
    """The test of slopes (N, 2), each in a cell of its map, or without positions."""
    every = slice(None, None, max(1, len(raw) // _MOST))
    centred, inverse = raw[every] - slopes.mean, np.linalg.inv(slopes.stretch)
    white = centred @ inverse.T
    edges = np.quantile(np.hypot(*white.T), np.arange(1, _RINGS) / _RINGS)
    terms = _odd(white, edges)
    size, n = float(np.median(np.hypot(*centred.T))), len(centred)
    for axis in range(2):
        step = max(_STEP * size, 3 * slopes.mean_errors[axis])
        moved = [np.where(np.arange(2) == axis, sign * step, 0.0) for sign in (1, -1)]
        more, less = (_odd((centred - one) @ inverse.T, edges).mean(axis=0) for one in moved)
        near = np.count_nonzero(np.abs(centred[:, axis]) < step) / (2 * step * n)
        # The median moves by the mean of the signs over twice the density there.
        effect = (more - less) / (2 * step) / (2 * max(near, 1 / (2 * step * n)))
        terms += np.sign(centred[:, axis])[:, np.newaxis] * effect
    if cells is None:
        covariance = pearson.Covariance(terms.T @ terms, np.inf)
    else:
        own, count = cells[every], blocks.CELLS**2
        sizes = np.bincount(own, minlength=count)
        sums = np.stack([np.bincount(own, term, minlength=count) for term in terms.T], axis=-1)
        covariance = pearson.of_cells(sums - sizes[:, np.newaxis] * terms.mean(axis=0))
    return Balance(pearson.probability(terms.sum(axis=0), covariance), _sides(white))


def balance_along(slopes: Slopes, raw: Vector, cells: NDArray[np.intp], shape: tuple[int, int]) -> Balance:
    """The same of slopes (N,) along a line, by their signs in rings of their size."""
    every = slice(None, None, max(1, len(raw) // _MOST))
    centred, n = raw[every] - slopes.mean[0], len(raw[every])
    size = np.abs(centred)
    edges = np.quantile(size, np.arange(1, _RINGS) / _RINGS)
    terms = _signs(centred, edges)
    step = max(_STEP * float(np.median(size)), 3 * slopes.mean_errors[0])
    more, less = (_signs(centred - sign * step, edges).mean(axis=0) for sign in (1, -1))
    near = np.count_nonzero(size < step) / (2 * step * n)
    effect = (more - less) / (2 * step) / (2 * max(near, 1 / (2 * step * n)))
    terms += np.sign(centred)[:, np.newaxis] * effect
    count = shape[0] * shape[1]
    sizes = np.bincount(cells[every], minlength=count)
    sums = np.stack([np.bincount(cells[every], term, minlength=count) for term in terms.T], axis=-1)
    covariance = pearson.of_cells(sums - sizes[:, np.newaxis] * terms.mean(axis=0), shape)
    order = np.argsort(-size, kind="stable")
    steeper = np.abs(np.cumsum(np.sign(centred[order])))
    return Balance(pearson.probability(terms.sum(axis=0), covariance), float(steeper.max() / (2 * n)))


def _signs(centred: Vector, edges: Vector) -> Vector:
    """The sign of each slope, in the column of its ring."""
    ring = np.searchsorted(edges, np.abs(centred))
    return np.stack([np.where(ring == k, np.sign(centred), 0.0) for k in range(_RINGS)], axis=-1)


def _odd(white: Vector, edges: Vector) -> Vector:
    """cos phi, sin phi, cos 3 phi, sin 3 phi of each slope, in the columns of its ring."""
    radius = np.maximum(np.hypot(*white.T), 1e-300)
    cosine, sine = white.T / radius
    harmonics = (cosine, sine, cosine * (4 * cosine**2 - 3), sine * (3 - 4 * sine**2))
    ring = np.searchsorted(edges, radius)
    return np.stack([np.where(ring == k, one, 0.0) for k in range(_RINGS) for one in harmonics], axis=-1)


def _sides(white: Vector) -> float:
    """Of lines in sixteen directions, the largest difference from one half."""
    angles = np.arange(16) * (np.pi / 16)
    across = white @ np.stack((np.cos(angles), np.sin(angles)))
    return float(np.abs(np.sign(across).mean(axis=0)).max() / 2)
