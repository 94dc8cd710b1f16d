"""Where slopes lie on their map: cells, folds for validation, and what the sum over a map may scatter.

Neighbouring slopes of a map depend on each other. What is known of a mean over the map therefore follows from
how its parts differ, not from how many slopes there are. Its parts are half waves: the sums over cells are
projected on cosines over the map, and each squared projection estimates the variance of the total as long as
its waves are longer than the reach of the dependence. E. Lazarus, D. J. Lewis, J. H. Stock & M. W. Watson,
HAR inference: recommendations for practice, Journal of Business & Economic Statistics 36, 2018; U. K. Mueller
& M. W. Watson, Spatial correlation robust inference, Econometrica 90, 2022.

How far the dependence reaches is taken from the slopes: the squares of the longest waves are fitted by
Whittle's likelihood with a Gaussian in the wave number, which may be flat, and its value at infinitely long
waves is used. (P. Whittle, On stationary processes in the plane, Biometrika 41, 1954.) A steep Gaussian from
few waves makes an uncertain variance, and so do a few cells that hold nearly all of the sum; Student's factor
allows for both.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import fft, stats

__all__ = [
    "CELLS",
    "FOLDS",
    "GROUPS",
    "WHOLE",
    "Waves",
    "cells_of_grid",
    "cells_of_map",
    "decline",
    "fold_of_group",
    "scatter",
    "variances",
    "waves",
    "weights",
]

#: Folds of the cross-validation, cells along each side of a map, and groups of slopes without positions.
FOLDS = 5
CELLS = 16
GROUPS = 20
#: The cells of a map, row by row.
WHOLE = (CELLS, CELLS)

Vector = NDArray[np.float64]

# Squared length of the wave vectors in half waves over the map, up to which waves are looked at: 38 of them.
# Along a line as many.
_REACH, _ALONG = 40, 38
_STEEPEST = 1.0  # decline of the logarithm of the squares from one wave to the next
_NEWTON = 30  # steps, of which about ten are needed
_TWO_SIDED = 0.975


def cells_of_map(mask: NDArray[np.bool_], lag: int) -> NDArray[np.int16]:
    """For every slope of a map at `lag`, row by row as `Surface.slopes` has them, the number of its cell."""
    inner = slice(lag, -lag)
    return cells_of_grid(
        mask[inner, 2 * lag :] & mask[inner, : -2 * lag] & mask[2 * lag :, inner] & mask[: -2 * lag, inner]
    )


def cells_of_grid(known: NDArray[np.bool_]) -> NDArray[np.int16]:
    """For every pixel of a grid that is known, row by row, the number of its cell."""
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


class Waves(NamedTuple):
    """The variance of a total over the map, and from how many waves it was estimated (inf: the slopes are
    independent).
    """

    variance: float
    number: float

    @property
    def error(self) -> float:
        """A standard error of which 1.96 make an interval of 95 %: with Student's factor for few waves."""
        return math.sqrt(self.variance) * _student(self.number)


def variances(sums: Vector, grid: bool, shape: tuple[int, int] = WHOLE) -> list[Waves]:
    """For each column of `sums` (one row per group, mean zero), what its total may scatter; on a grid, of the
    cells of a rectangle of this shape.
    """
    table = sums.reshape(len(sums), -1)
    if not grid:
        return [Waves(float(value), math.inf) for value in np.diag(scatter(table))]
    levels, _, numbers = decline(waves(table, shape) ** 2, shape)
    # Fourth powers of sums over blocks: their excess over normal ones is what few large blocks add to the
    # variance of a variance.
    if min(shape) > 1:
        blocks = table.reshape(shape[0] // 2, 2, shape[1] // 2, 2, -1).sum(axis=(1, 3))
        blocks = blocks.reshape(len(table) // 4, -1)
    else:
        blocks = table.reshape(len(table) // 4, 4, -1).sum(axis=1)
    squares = np.square(blocks - blocks.mean(axis=0))
    fourth = np.sum(squares**2, axis=0) / np.maximum(np.sum(squares, axis=0) ** 2, 1e-300)
    numbers = 2 / (2 / numbers + np.maximum(fourth - 3 / len(blocks), 0.0))
    return [
        Waves(float(len(table) * level), float(number)) for level, number in zip(levels, numbers, strict=True)
    ]


def waves(sums: Vector, shape: tuple[int, int] = WHOLE) -> NDArray[np.float64]:
    """Projections of the columns of `sums` (one row per cell) on the longest cosines over the map, but the
    constant: orthonormal, so that independent cells make all of them equally large.
    """
    cells = fft.dctn(sums.reshape(*shape, -1), axes=(0, 1), norm="ortho")
    return np.asarray(cells.reshape(len(sums), -1)[1:][_kept(shape)])


def decline(squares: Vector, shape: tuple[int, int] = WHOLE) -> tuple[Vector, Vector, Vector]:
    """For each column the level of the squared waves at infinite length, by how much its logarithm falls for
    one unit of the squared wave number, and how many waves of one level would tell it as well.
    """
    x = _squared(shape)[_kept(shape)][:, np.newaxis]
    count, total, second = len(x), float(x.sum()), float((x * x).sum())
    scale = np.maximum(squares.mean(axis=0), 1e-300)
    y, log_level, fall = squares / scale, np.zeros(squares.shape[1]), np.zeros(squares.shape[1])
    for _ in range(_NEWTON):
        weight = y * np.exp(np.minimum(fall * x - log_level, 50.0))
        by_level, by_fall = count - weight.sum(axis=0), (x * weight).sum(axis=0) - total
        a, b, c = weight.sum(axis=0), (x * weight).sum(axis=0), (x * x * weight).sum(axis=0)
        determinant = np.maximum(a * c - b * b, 1e-12 * second)
        step_level = -(c * by_level + b * by_fall) / determinant
        step_fall = -(b * by_level + a * by_fall) / determinant
        shorter = np.minimum(
            1.0, 1 / np.maximum(np.maximum(np.abs(step_level), 10 * np.abs(step_fall)), 1e-9)
        )
        log_level, fall = log_level + shorter * step_level, fall + shorter * step_fall
        fall = np.minimum(fall, _STEEPEST)
    flat = ~(fall > 0) | ~np.isfinite(log_level)
    level = np.where(flat, scale, scale * np.exp(np.where(flat, 0.0, log_level)))
    return level, np.where(flat, 0.0, fall), np.where(flat, count, count - total**2 / second)


def scatter(sums: Vector) -> NDArray[np.float64]:
    """Covariance of the total of the rows of `sums` (one per group, mean zero), which are independent."""
    table = sums.reshape(len(sums), -1)
    table = table - table.mean(axis=0)
    return np.asarray(table.T @ table) * len(table) / (len(table) - 1)


@cache
def _squared(shape: tuple[int, int]) -> Vector:
    rows, columns = (np.arange(size) for size in shape)
    return np.asarray((rows[:, np.newaxis] ** 2 + columns**2).ravel()[1:], dtype=np.float64)


@cache
def _kept(shape: tuple[int, int]) -> NDArray[np.bool_]:
    return np.asarray(_squared(shape) <= (_REACH if min(shape) > 1 else _ALONG**2))


def weights(fall: float, shape: tuple[int, int] = WHOLE) -> Vector:
    """What raises the squares of waves to the level of infinitely long ones."""
    return np.asarray(np.exp(fall * _squared(shape)[_kept(shape)]))


@cache
def _student(number: float) -> float:
    normal = float(stats.norm.ppf(_TWO_SIDED))
    return float(stats.t.ppf(_TWO_SIDED, number)) / normal if math.isfinite(number) else 1.0
