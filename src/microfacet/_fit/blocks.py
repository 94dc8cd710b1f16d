"""Where slopes lie on their map: cells, folds for validation, and sums over blocks of neighbouring cells.

Neighbouring slopes of a map depend on each other. What is known of a mean over the map therefore follows from
how its parts differ, not from how many slopes there are: the circular block bootstrap. D. N. Politis & J. P.
Romano, A circular block-resampling procedure for stationary data, 1992; for two dimensions S. N. Lahiri,
Resampling Methods for Dependent Data, 2003, chapter 12.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["CELLS", "FOLDS", "GROUPS", "cells_of_map", "fold_of_group", "neighbouring_tiles", "scatter"]

#: Folds of the cross-validation, cells along each side of a map, and groups of slopes without positions.
FOLDS = 5
CELLS = 16
GROUPS = 20

Vector = NDArray[np.float64]


def cells_of_map(mask: NDArray[np.bool_], lag: int) -> NDArray[np.int16]:
    """For every slope of a map at `lag`, row by row as `Surface.slopes` has them, the number of its cell."""
    inner = slice(lag, -lag)
    known = (
        mask[inner, 2 * lag :] & mask[inner, : -2 * lag] & mask[2 * lag :, inner] & mask[: -2 * lag, inner]
    )
    ny, nx = known.shape
    row = (CELLS * np.arange(ny) // ny * CELLS).astype(np.int16)
    column = (CELLS * np.arange(nx) // nx).astype(np.int16)
    return np.asarray((row[:, np.newaxis] + column)[known])


def fold_of_group(groups: int) -> NDArray[np.intp]:
    """The fold of each group. On a map, blocks of 2 x 2 cells stay together and folds are spread over it."""
    number = np.arange(groups)
    if groups == GROUPS:
        return number % FOLDS
    rows, columns = number // CELLS // 2, number % CELLS // 2
    return np.asarray((rows + 2 * columns) % FOLDS)


def scatter(sums: Vector, grid: bool) -> NDArray[np.float64]:
    """Covariance of the total of the rows of `sums` (one row per group, mean zero) by the block bootstrap.

    Blocks are 2 x 2 cells, overlap, and wrap around the map. The bootstrap is not run: the variance of a
    total over resampled blocks is known, the mean of the blocks' squares times their number. Groups without
    positions are taken one by one.
    """
    table = sums.reshape(len(sums), -1)
    if not grid:
        table = table - table.mean(axis=0)
        return np.asarray(table.T @ table) * len(table) / (len(table) - 1)
    cells = table.reshape(CELLS, CELLS, -1)
    cells = cells - cells.mean(axis=(0, 1))
    pairs = cells + np.roll(cells, 1, axis=0)
    blocks = (pairs + np.roll(pairs, 1, axis=1)).reshape(CELLS * CELLS, -1)
    return np.asarray(blocks.T @ blocks) / 4


def neighbouring_tiles(sums: Vector) -> float:
    """How strongly blocks depend on their neighbours: the largest correlation of totals of adjacent
    blocks.
    """
    blocks = sums.reshape(CELLS // 2, 2, CELLS // 2, 2, -1).sum(axis=(1, 3))
    blocks = blocks - blocks.mean(axis=(0, 1))
    total = np.sum(blocks**2, axis=(0, 1))
    known: Any = total > 0
    if not np.any(known):
        return 0.0
    east = np.sum(blocks[:, 1:] * blocks[:, :-1], axis=(0, 1)) / np.where(known, total, 1) * 8 / 7
    north = np.sum(blocks[1:] * blocks[:-1], axis=(0, 1)) / np.where(known, total, 1) * 8 / 7
    return float(np.max(np.maximum(east, north)[known]))
