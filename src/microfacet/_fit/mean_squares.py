"""Root mean squares over a map, with errors that know that neighbouring pixels depend on each other."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._surface import Surface

__all__ = ["Measured", "rms_height", "rms_slope"]

_TILES = 8  # along each side of the map
_FEWEST = 4  # tiles with something in them, or no error is known

Map = NDArray[np.float64]


class Measured(NamedTuple):
    """A root mean square and its standard error."""

    value: float
    error: float


def rms_height(surface: Surface) -> Measured:
    """Sq: of the heights from their mean."""
    heights = surface.heights
    mean = float(np.mean(heights[surface.mask]))
    return _root_mean(np.square(heights - mean))


def rms_slope(surface: Surface) -> Measured:
    """Of the gradient at the surface's own lag; at lag 1 this is Sdq by central differences."""
    lag, h, (dx, dy) = surface.lag, surface.heights, surface.pixel_size
    inner = slice(lag, -lag)
    total = np.square((h[inner, 2 * lag :] - h[inner, : -2 * lag]) / (2 * lag * dx))
    total += np.square((h[2 * lag :, inner] - h[: -2 * lag, inner]) / (2 * lag * dy))
    return _root_mean(total)


def _root_mean(squares: Map) -> Measured:
    """The root of a mean over what is not nan, and its error from how the means of tiles scatter.

    Tiles count with what they hold (a ratio estimate). G. S. Fishman, Grouping observations in digital
    simulation, Management Science 24, 1978 (batch means); W. G. Cochran, Sampling Techniques, 1977, 6.4.
    """
    known = np.isfinite(squares)
    filled = np.where(known, squares, 0.0)
    totals, counts = _tiles(filled).ravel(), _tiles(known.astype(np.float64)).ravel()
    count = float(counts.sum())
    mean = float(totals.sum()) / count
    held = counts > 0
    number = int(np.count_nonzero(held))
    rest = (totals - mean * counts)[held]
    if number < _FEWEST or mean <= 0:
        return Measured(math.sqrt(max(mean, 0.0)), math.nan)
    error = math.sqrt(number / (number - 1) * float(rest @ rest)) / count
    return Measured(math.sqrt(mean), error / (2 * math.sqrt(mean)))


def _tiles(values: Map) -> Map:
    """Sums over up to 8 x 8 rectangles that cover the map."""
    for axis, size in enumerate(values.shape):
        starts = np.unique(np.linspace(0, size, min(_TILES, size) + 1).astype(np.intp)[:-1])
        values = np.add.reduceat(values, starts, axis=axis)
    return values
