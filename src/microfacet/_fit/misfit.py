"""Whether a fitted family describes the slopes: a test that knows that slopes depend on each other.

Pearson's statistic of the counts of slopes in rings of standard space, and of the first two even harmonics of
their azimuth in broad rings. Slopes of a map depend on each other and parameters were fitted to them, so the
statistic is not chi-squared: it is compared with its law under the covariance of the counts over the map,
from which the effect of the fitted parameters is taken off (`pearson.probability`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._fit import pearson
from microfacet._fit.model import ANISOTROPIC, PROFILE, Model, State
from microfacet._fit.newton import Maximum
from microfacet._fit.slopes import Slopes

__all__ = ["Misfit", "misfit"]

# Probabilities beyond which rings begin, fine ones for the largest deviation; those of the test are some of
# them, which have to hold so many independent slopes each.
_RINGS = (0.005, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 0.995, 0.999)
_FINE = tuple(k / 40 for k in range(1, 40))
_FEWEST = 5.0
_BROAD = 4  # rings whose azimuths are looked at
_BROAD_FEWEST = 20.0
_SECTORS = 32  # of half a turn, for the largest deviation
_STEP = 1e-3  # of the parameters' variables, for derivatives of probabilities

Vector = NDArray[np.float64]


class Misfit(NamedTuple):
    """The probability of slopes further from the fit than these, and the largest difference between the
    measured and the fitted share of slopes, below any steepness or within any range of azimuths.
    """

    p_value: float
    deviation: float


def misfit(model: Model, found: Maximum, independent_share: float) -> Misfit:
    """The test of one fitted family."""
    slopes, state = model.slopes, found.state
    effective = max(independent_share * slopes.n, 1.0)
    rings = _held(_RINGS, effective, _FEWEST)
    broad = max(min(_BROAD, int(effective / _BROAD_FEWEST)), 1)
    broad_rings = tuple(k / broad for k in range(1, broad))
    probabilities = np.unique([*rings, *broad_rings, *_FINE])
    edges = _edges(model, state, probabilities)
    counted = _counts(slopes, model, state, edges)
    places = _Places(*(probabilities.searchsorted(one).tolist() for one in (rings, broad_rings)))
    shares = np.diff([0.0, *rings, 1.0])
    counts = _merged(counted.rings, places.rings) - slopes.sizes[:, np.newaxis] * shares
    turns = [math.sqrt(2) * _merged(table, places.broad) for table in counted.harmonics]
    along_line = model.symmetry == PROFILE
    if along_line:  # slopes have no azimuths
        turns = []
    residuals = np.hstack((counts, *turns))
    variances = slopes.n * np.concatenate((shares, np.full(len(turns) * broad, 1 / broad)))
    moved = slopes.n * _derivatives(model, state, edges, places)[: residuals.shape[1], found.free]
    information = -found.sums.hessian.sum(axis=0)[np.ix_(found.free, found.free)]
    deviation = _deviation(counted, probabilities, slopes.n, along_line)
    try:
        effect = moved @ np.linalg.inv(information)
    except np.linalg.LinAlgError:
        return Misfit(math.nan, deviation)
    root, mean = np.sqrt(variances), slopes.sizes[:, np.newaxis] * residuals.sum(axis=0) / slopes.n
    if slopes.on_map:
        # The parameters move by the inverse of the information times the score, and with them the means.
        # Under the right family they follow the slopes, which leaves less variance; where it leaves more, the
        # family is not the right one.
        moves = found.sums.gradient[:, found.free] @ effect.T
        ways = [pearson.of_cells(sums / root, slopes.shape) for sums in (residuals + moves, residuals - mean)]
        covariance = min(ways, key=lambda way: float(np.trace(way.matrix)))
    else:
        matrix = np.diag(variances) - effect @ moved.T
        matrix[: len(shares), : len(shares)] -= slopes.n * np.outer(shares, shares)
        covariance = pearson.Covariance(matrix / np.outer(root, root), math.inf)
    return Misfit(pearson.probability(residuals.sum(axis=0) / root, covariance), deviation)


class _Places(NamedTuple):
    """Numbers of the edges of the rings and of the broad rings among those of the fine ones."""

    rings: list[int]
    broad: list[int]


class _Counts(NamedTuple):
    """Of each group: slopes in each fine ring, sums of cos 2 phi, sin 2 phi, cos 4 phi, sin 4 phi there; of
    all: slopes in each sector of half a turn.
    """

    rings: Vector
    harmonics: tuple[Vector, ...]
    sectors: Vector


def _held(probabilities: tuple[float, ...], effective: float, fewest: float) -> tuple[float, ...]:
    """Those of them between which so many independent slopes are expected."""
    kept = [0.0]
    for one in probabilities:
        if (one - kept[-1]) * effective >= fewest and (1 - one) * effective >= fewest:
            kept.append(one)
    return tuple(kept[1:])


def _edges(model: Model, state: State, probabilities: Vector) -> Vector:
    """The radii in standard space (of a family that is not stretched, of slopes) with these probabilities."""
    alpha, shape = math.exp(state.log_alpha), model.shape(state)
    return np.array([model.law.quantile(one, alpha, *shape) for one in probabilities.tolist()])


def _counts(slopes: Slopes, model: Model, state: State, edges: Vector) -> _Counts:
    """Counts by group and ring, chunk by chunk."""
    groups, width = len(slopes.sizes), len(edges) + 1
    (a, b), (c, d) = state.inverse if model.stretched else slopes.stretch
    totals = [np.zeros(groups * width) for _ in range(5)]
    sectors = np.zeros(_SECTORS)
    squared_edges = edges**2
    for chunk in slopes.chunks:
        xx, yy, xy = slopes.xx[chunk.where], slopes.yy[chunk.where], slopes.xy[chunk.where]
        first = a * a * xx + (2 * a * b) * xy + b * b * yy
        second = c * c * xx + (2 * c * d) * xy + d * d * yy
        squared = np.maximum(first + second, 1e-300)
        cosine = (first - second) / squared
        sine = 2 * (a * c * xx + (a * d + b * c) * xy + b * d * yy) / squared
        lengths = np.diff(np.append(chunk.starts, len(xx)))
        place = np.repeat(chunk.groups * width, lengths) + np.searchsorted(squared_edges, squared)
        terms = (None, cosine, sine, 2 * cosine * cosine - 1, 2 * cosine * sine)
        for total, term in zip(totals, terms, strict=True):
            total += np.bincount(place, term, minlength=total.size)
        turn = np.arctan2(sine, cosine) * (_SECTORS / (2 * math.pi)) + _SECTORS / 2
        sectors += np.bincount(np.minimum(turn.astype(np.intp), _SECTORS - 1), minlength=_SECTORS)
    tables = [total.reshape(groups, width) for total in totals]
    return _Counts(tables[0], tuple(tables[1:]), sectors)


def _merged(table: Vector, places: list[int]) -> Vector:
    """Sums over the fine rings between edges."""
    return np.add.reduceat(table, [0, *(place + 1 for place in places)], axis=1)


def _derivatives(model: Model, state: State, edges: Vector, places: _Places) -> Vector:
    """By the tangent coordinates, of the mean of what is counted, per slope.

    Where the state moves, the slopes move in standard space and the probabilities of rings change. The
    anisotropy turns azimuths as well: cos 2 phi in a ring of probability p changes by -p + (change of p with
    log r)/2, and so does sin 2 phi; the other means do not change to first order.
    """
    alpha, count = math.exp(state.log_alpha), len(model.searches)

    def beyond(scale: float, change: list[float]) -> Vector:
        shape = model.shape(state, change)
        return model.law.beyond(edges, alpha * math.exp(scale), *shape)

    none, units = [0.0] * count, (_STEP * np.eye(count)).tolist()
    ways = [(beyond(_STEP, none), beyond(-_STEP, none))]
    ways += [(beyond(0.0, own), beyond(0.0, [-one for one in own])) for own in units]
    changes = [(more - less) / (2 * _STEP) for more, less in ways]
    rings, broad = len(places.rings) + 1, len(places.broad) + 1
    result = np.zeros((rings + 4 * broad, model.size))
    for column, change in zip((0, *range(model.first_shape, model.size)), changes, strict=True):
        result[:rings, column] = np.diff(change[places.rings], prepend=0.0, append=0.0)
    if model.symmetry == ANISOTROPIC:
        turned = np.diff(changes[0][places.broad], prepend=0.0, append=0.0) / 2 - 1 / broad
        for k in range(2):
            result[rings + k * broad : rings + (k + 1) * broad, 1 + k] = math.sqrt(2) * turned
    return result


def _deviation(counted: _Counts, probabilities: Vector, n: int, along_line: bool) -> float:
    below = np.cumsum(counted.rings.sum(axis=0))[:-1] / n - probabilities
    if along_line:
        return float(np.abs(below).max())
    turned = np.cumsum(counted.sectors / n - 1 / _SECTORS)
    return float(max(np.abs(below).max(), np.ptp(np.append(turned, 0.0))))
