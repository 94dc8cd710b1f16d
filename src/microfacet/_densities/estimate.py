"""A smooth density from counts of slopes: a penalised spline for its logarithm, as smooth as the counts say.

Counts in rings of the plane of slopes are taken for Poisson numbers, whose mean is the integral of
exp(spline) over the ring. Second differences of the spline's coefficients are penalised, with the strength
under which the counts are most probable (Laplace's approximation). P. H. C. Eilers & B. D. Marx, Flexible
smoothing with B-splines and penalties, 1996; P. H. C. Eilers, Ill-posed problems with counts, the composite
link model and penalized likelihood, 2007.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet._densities.curve import smooth_variable

__all__ = ["FEWEST_COUNTS", "from_counts", "from_radii"]

Array = NDArray[np.float64]

FEWEST_COUNTS = 200  # below, a density cannot be told from its noise
_CELLS, _KNOTS, _BINS = 600, 60, 400
_DEGREE = 7  # of the spline: tables of what is smooth are small, and soon made
_BEYOND = 1.5  # of log r: counts of nothing there say how the density ends
_STRENGTHS = np.geomspace(1e-3, 1e7, 21)


def from_radii(radii: Array) -> Callable[[Any], Any]:
    """The density of slopes with these lengths."""
    if len(radii) < FEWEST_COUNTS:
        raise ValueError(
            f"RadialNDF: {FEWEST_COUNTS} slopes at least are needed to say anything of a density, "
            f"got {len(radii)}"
        )
    positive = radii[radii > 0.0]
    if 2 * len(positive) < len(radii) or len(np.unique(positive[:1000])) < 20:
        raise ValueError(
            "RadialNDF: most of the slopes have one length, which leaves no density to estimate "
            "(quantised heights? take a larger lag)"
        )
    scale = float(np.quantile(radii, 0.02)) or float(positive.min())
    top = smooth_variable(float(radii.max()), scale)
    edges = _radius(np.linspace(0.0, top, _BINS + 1), scale)
    edges[-1] = radii.max() * (1.0 + 1e-12)
    counts = np.histogram(radii, edges)[0].astype(np.float64)
    beyond = _radius(np.linspace(top, top + _BEYOND, _BINS // 5 + 1), scale)[1:]
    edges, counts = np.concatenate((edges, beyond)), np.concatenate((counts, np.zeros(len(beyond))))
    return _fitted(edges, counts, scale)


def from_counts(edges: Array, counts: Array) -> Callable[[Any], Any]:
    """The density of slopes whose lengths have these counts between these edges; the last may be infinite."""
    if counts.sum() < FEWEST_COUNTS:
        raise ValueError(
            f"RadialNDF: {FEWEST_COUNTS} counts at least are needed to say anything of a density, "
            f"got {counts.sum():g}"
        )
    if np.count_nonzero(counts) < 4:
        raise ValueError("RadialNDF: at least 4 bins of the histogram must not be empty")
    share = np.cumsum(np.concatenate(([0.0], counts))) / counts.sum()
    inner = np.isfinite(edges)
    scale = float(np.interp(0.02, share[inner], edges[inner]))
    scale = max(scale, float(edges[edges > 0.0][0]) / 4.0)
    edges = edges.copy()
    if math.isinf(edges[-1]):
        edges[-1] = edges[-2] * math.exp(2.0 * _BEYOND)
    else:
        edges = np.append(edges, edges[-1] * math.exp(_BEYOND))
        counts = np.append(counts, 0.0)
    return _fitted(edges, counts, scale)


def _radius(s: Array, scale: float) -> Array:
    return np.asarray(scale * np.sqrt(np.expm1(2.0 * s)))


def _fitted(edges: Array, counts: Array, scale: float) -> Callable[[Any], Any]:
    """exp of the most probable spline, which goes on along straight lines beyond its ends."""
    from scipy.interpolate import BSpline

    low, high = (float(smooth_variable(edge, scale)) for edge in (edges[0], edges[-1]))
    # Cells within bins, so that each has one bin and the edges of bins are edges of cells.
    borders = [
        np.linspace(begin, end, max(1, math.ceil((end - begin) / (high - low) * _CELLS)) + 1)[:-1]
        for begin, end in zip(
            smooth_variable(edges[:-1], scale), smooth_variable(edges[1:], scale), strict=True
        )
    ]
    bin_of = np.repeat(np.arange(len(counts)), [len(part) for part in borders])
    starts = np.flatnonzero(np.diff(bin_of, prepend=-1))
    cells = np.concatenate((*borders, [high]))
    middle = 0.5 * (cells[:-1] + cells[1:])
    area = math.pi * np.diff(np.square(_radius(cells, scale)))
    step = (high - low) / _KNOTS
    knots = low + step * np.arange(-_DEGREE, _KNOTS + _DEGREE + 1)
    basis = BSpline.design_matrix(middle, knots, _DEGREE).toarray()
    penalty = np.diff(np.eye(basis.shape[1]), 2, axis=0)
    penalty = penalty.T @ penalty

    start: Array = np.log((counts.sum() + 1.0) / area.sum()) * np.ones(basis.shape[1])
    rough = np.log((counts + 0.3) / np.add.reduceat(area, starts))
    start = np.asarray(np.linalg.lstsq(basis, rough[bin_of], rcond=None)[0]) if len(counts) > 20 else start
    best, evidence = start, -math.inf
    coefficients = start
    for strength in _STRENGTHS[::-1]:
        found = _maximum(coefficients, basis, area, starts, counts, strength * penalty)
        if found is None:
            continue
        coefficients, value, log_determinant = found
        rank = len(penalty) - 2
        value += 0.5 * (rank * math.log(strength) - log_determinant)
        if value > evidence:
            best, evidence = coefficients, value
    if evidence == -math.inf:
        raise ValueError("RadialNDF: no smooth density describes these counts")
    spline = BSpline(knots, best, _DEGREE)
    return _continued(spline, low, high, scale)


def _maximum(
    at: Array, basis: Array, area: Array, starts: NDArray[np.intp], counts: Array, penalty: Array
) -> tuple[Array, float, float] | None:
    """Coefficients, the penalised log-likelihood and the log determinant there; None where Newton fails."""

    def objective(coefficients: Array) -> tuple[float, Array, Array]:
        cells = area * np.exp(np.minimum(basis @ coefficients, 600.0))
        mean = np.maximum(np.add.reduceat(cells, starts), 1e-300)
        value = float(np.sum(counts * np.log(mean) - mean) - 0.5 * coefficients @ penalty @ coefficients)
        return value, cells, mean

    value, cells, mean = objective(at)
    for _ in range(200):
        rows = np.add.reduceat(cells[:, np.newaxis] * basis, starts, axis=0)
        slope = (counts / mean - 1.0) @ rows - penalty @ at
        scaled = rows / np.sqrt(mean)[:, np.newaxis]
        information = scaled.T @ scaled + penalty
        information[np.diag_indices_from(information)] += 1e-10 * np.trace(information) / len(information)
        step = np.linalg.solve(information, slope)
        size = 1.0
        while size > 1e-6:
            moved = objective(at + size * step)
            if moved[0] >= value - 1e-12 * abs(value):
                break
            size *= 0.5
        else:
            return None
        gain = moved[0] - value
        at, (value, cells, mean) = at + size * step, moved
        if abs(gain) < 1e-9 * (1.0 + abs(value)) and size == 1.0:
            return at, value, float(np.linalg.slogdet(information)[1])
    return None


def _continued(spline: Any, low: float, high: float, scale: float) -> Callable[[Any], Any]:
    slopes = spline.derivative()
    ends = (float(slopes(low)), float(slopes(high)))

    def density(r: Any) -> Any:
        s = smooth_variable(r, scale)
        inside = spline(np.clip(s, low, high))
        return np.exp(inside + ends[0] * np.minimum(s - low, 0.0) + ends[1] * np.maximum(s - high, 0.0))

    return density
