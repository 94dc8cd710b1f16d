"""What a slope table is made of, evenly spaced edges and masses, and where they come from."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._core import slopes as kernels

__all__ = ["Grid", "checked_grid", "histogram", "of_distribution"]

Array = NDArray[np.float64]

MOST = int(kernels.most_cells)
_STEEPEST = 1e6  # far beyond any surface: a larger slope is a mistake in the units
_FINEST = 1e-9  # of the largest slope: a step below it is lost in rounding
_EVEN = 1e-6  # of a step: more is another grid, not rounding
_FEWEST = 100
_NODES = 4  # of Gauss's rule along each side of a cell


class Grid(NamedTuple):
    """Edges of a regular grid, and the masses (p, q) of its cells, of which the sum is 1."""

    p: Array
    q: Array
    masses: Array


def _numbers(owner: str, name: str, given: ArrayLike, axes: int) -> Array:
    try:
        array = np.asarray(given)
        if array.ndim != axes or array.dtype.kind not in "fiub":
            raise TypeError
    except (TypeError, ValueError):
        shape = f" of shape {np.shape(given)}" if hasattr(given, "shape") else ""
        raise ValueError(
            f"{owner}: {name} must be an array of real numbers with {axes} "
            f"{'axis' if axes == 1 else 'axes'}, got {type(given).__name__}{shape}"
        ) from None
    return array.astype(np.float64)


def _edges(owner: str, name: str, given: ArrayLike) -> Array:
    edges = _numbers(owner, name, given, 1)
    if not 2 <= len(edges) <= MOST + 1:
        raise ValueError(f"{owner}: {name} must be 2 to {MOST + 1} edges of cells, got {len(edges)}")
    if not np.all(np.abs(edges) <= _STEEPEST):
        worst = edges[~(np.abs(edges) <= _STEEPEST)][0]
        raise ValueError(f"{owner}: {name} must lie in [{-_STEEPEST:g}, {_STEEPEST:g}], got {worst:g}")
    steps = np.diff(edges)
    step = (edges[-1] - edges[0]) / len(steps)
    if not np.all(steps > 0.0):
        raise ValueError(f"{owner}: {name} must increase strictly")
    if step < _FINEST * np.max(np.abs(edges)):
        raise ValueError(f"{owner}: the steps of {name} must be at least {_FINEST:g} of its largest edge")
    if np.max(np.abs(steps - step)) > _EVEN * step:
        raise ValueError(
            f"{owner}: {name} must be evenly spaced, got steps from {steps.min():g} to {steps.max():g}"
        )
    return edges


def checked_grid(owner: str, p_edges: ArrayLike, q_edges: ArrayLike, masses: ArrayLike) -> Grid:
    """The three as a `Grid`, or one sentence that says which of them is wrong."""
    p, q = _edges(owner, "p_edges", p_edges), _edges(owner, "q_edges", q_edges)
    cells = _numbers(owner, "masses", masses, 2)
    if cells.shape != (len(p) - 1, len(q) - 1):
        raise ValueError(
            f"{owner}: masses must have shape {(len(p) - 1, len(q) - 1)}, one less than edges each way, "
            f"got {cells.shape}"
        )
    bad = ~((cells >= 0.0) & (cells < np.inf))
    if bad.any():
        raise ValueError(f"{owner}: masses must be finite and not negative, got {cells[bad][0]:g}")
    most = float(cells.max())
    if not most > 0.0:
        raise ValueError(f"{owner}: masses must not all be 0")
    cells /= most  # neither over- nor underflows
    cells /= math.fsum(cells.ravel())
    for array in (p, q, cells):
        array.flags.writeable = False
    return Grid(p, q, cells)


def _counts(owner: str, bins: object) -> tuple[int, int]:
    pair = bins if isinstance(bins, tuple | list) else (bins, bins)
    if len(pair) != 2 or not all(
        isinstance(n, int | np.integer) and not isinstance(n, bool) and 1 <= n <= MOST for n in pair
    ):
        raise ValueError(
            f"{owner}: bins must be a whole number in [1, {MOST}] or two of them, got {bins!r:.60}"
        )
    return int(pair[0]), int(pair[1])


def _extent(owner: str, given: object) -> Array:
    """((p from, to), (q from, to))."""
    try:
        extent = np.asarray(given, dtype=np.float64)
        if extent.shape != (2, 2) or not np.all(np.abs(extent) <= _STEEPEST):
            raise ValueError
        if not np.all(extent[:, 1] > extent[:, 0]):
            raise ValueError
    except (TypeError, ValueError):
        raise ValueError(
            f"{owner}: extent must be ((p from, p to), (q from, q to)), increasing and at most "
            f"{_STEEPEST:g}, got {given!r:.80}"
        ) from None
    return extent


def _linspaces(extent: Array, counts: tuple[int, int]) -> tuple[Array, Array]:
    p, q = (
        np.linspace(low, high, count + 1) for (low, high), count in zip(extent.tolist(), counts, strict=True)
    )
    return p, q


def histogram(owner: str, given: Any, bins: Any, extent: Any) -> Grid:
    """A histogram of slopes (N, 2), or of those of a surface."""
    of_surface = getattr(given, "slopes", None)
    slopes = _numbers(owner, "slopes", of_surface() if callable(of_surface) else given, 2)
    if slopes.shape[1] != 2 or len(slopes) < _FEWEST:
        raise ValueError(f"{owner}: slopes must be at least {_FEWEST} pairs (p, q), got shape {slopes.shape}")
    bad = ~(np.abs(slopes) <= _STEEPEST)
    if bad.any():
        raise ValueError(
            f"{owner}: slopes must lie in [{-_STEEPEST:g}, {_STEEPEST:g}], got {slopes[bad][0]:g}"
        )
    found = np.stack((slopes.min(axis=0), slopes.max(axis=0)), -1)
    if not np.all(found[:, 1] > found[:, 0]):
        axis = "pq"[int(np.argmin(np.ptp(found, axis=1)))]
        raise ValueError(f"{owner}: all slopes {axis} are the same, so that there is no histogram of them")
    limits = found if extent is None else _extent(owner, extent)
    if bins is None:
        # Scott's rule for two dimensions.
        step = 3.5 * np.std(slopes, axis=0) * len(slopes) ** -0.25
        n_p, n_q = np.clip(np.ceil(np.ptp(limits, axis=1) / step), 8, MOST).astype(int).tolist()
        bins = n_p, n_q
    p, q = _linspaces(limits, _counts(owner, bins))
    masses, _, _ = np.histogram2d(slopes[:, 0], slopes[:, 1], (p, q))
    return checked_grid(owner, p, q, masses)


def of_distribution(owner: str, ndf: Any, mean: Any, bins: Any, extent: Any) -> Grid:
    """Masses of cells by Gauss's rule, of a distribution whose slopes are moved by `mean`."""
    counts = _counts(owner, bins)
    moved = _numbers(owner, "mean", mean, 1)
    if moved.shape != (2,) or not np.all(np.abs(moved) <= _STEEPEST):
        raise ValueError(f"{owner}: mean must be two slopes, got {mean!r:.60}")
    if extent is None:
        # What one slope in ten thousand exceeds, in every direction.
        turns = np.arange(64) / 64
        m = ndf.sample(np.stack((np.full(64, 1 - 1e-4), turns), -1))
        reach = np.minimum(np.abs(m[:, :2] / m[:, 2:]).max(axis=0), _STEEPEST / 2)
        extent = np.stack((moved - reach, moved + reach), -1)
    p, q = _linspaces(_extent(owner, extent), counts)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    at_p, at_q = (
        (edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * (nodes + 1) / 2).ravel() for edges in (p, q)
    )
    masses = np.empty(counts)
    for i in range(counts[0]):  # rows of cells at a time bound the memory
        rows = slice(_NODES * i, _NODES * (i + 1))
        density = ndf.P22(at_p[rows, np.newaxis] - moved[0], at_q - moved[1])
        masses[i] = np.einsum("i,ijk,k->j", weights, density.reshape(_NODES, counts[1], _NODES), weights)
    return checked_grid(owner, p, q, masses)
