"""The slopes of a map that a fit uses: all of them, or as many as are wanted, drawn at random.

Pixels are drawn before their slopes are taken, so that a large map needs memory for what is used and not for
all of its slopes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._fit import blocks
from microfacet._surface import Surface

__all__ = ["SEED", "Drawn", "draw"]

#: Of the draw: the same map gives the same slopes.
SEED = 0


class Drawn(NamedTuple):
    """Slopes (N, 2), row by row of the map, the cell of each, and what a reader should know of the draw."""

    slopes: NDArray[np.float64]
    cells: NDArray[np.int16]
    notes: tuple[str, ...]


def draw(surface: Surface, lag: int, most: int | None) -> Drawn:
    """All slopes of the surface at `lag`, or `most` of them if there are more."""
    mask = surface.mask
    if most is None or mask.size <= most or min(mask.shape) <= 2 * lag:
        slopes = surface.slopes(lag)  # which says what is wrong with a map that is too small
        return Drawn(slopes, blocks.cells_of_map(mask, lag), ())
    cells = blocks.cells_of_map(mask, lag)
    if len(cells) <= most:
        return Drawn(surface.slopes(lag), cells, ())
    count = len(cells)
    chosen = np.random.default_rng(SEED).choice(count, most, replace=False, shuffle=False)
    chosen.sort()
    note = f"fitted to {most} of {count} slopes, drawn at random with seed {SEED}"
    return Drawn(_slopes_at(surface, lag, chosen), cells[chosen], (note,))


def _slopes_at(surface: Surface, lag: int, chosen: NDArray[np.int64]) -> NDArray[np.float64]:
    """Slopes number `chosen`, ascending, of those that `Surface.slopes` would return."""
    mask, heights, (dx, dy) = surface.mask, surface.heights, surface.pixel_size
    ny, nx = mask.shape
    result = np.empty((len(chosen), 2))
    done, before = 0, 0
    # A row at a time: the numbers of all pixels of a map would take as much memory as its heights.
    for row in range(lag, ny - lag):
        middle = mask[row]
        known = middle[2 * lag :] & middle[: nx - 2 * lag]
        known &= mask[row + lag, lag : nx - lag]
        known &= mask[row - lag, lag : nx - lag]
        columns = np.flatnonzero(known) + lag
        end = int(np.searchsorted(chosen, before + len(columns)))
        at = columns[chosen[done:end] - before]
        result[done:end, 0] = (heights[row, at + lag] - heights[row, at - lag]) / (2 * lag * dx)
        result[done:end, 1] = (heights[row + lag, at] - heights[row - lag, at]) / (2 * lag * dy)
        done, before = end, before + len(columns)
    return result
