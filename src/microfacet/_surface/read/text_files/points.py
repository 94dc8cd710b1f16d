"""Lists of points x, y, z that lie on a rectangular grid, in any order and with gaps."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import MAX_PIXELS, SurfaceError

__all__ = ["Gridded", "axis", "even_step", "grid", "lattice_columns"]

Column = NDArray[np.float64]

# Positions are printed with a few digits: they may miss their place by this part of a step.
_JITTER = 0.05
# Points that fill less of a grid than this were not measured on it.
_LEAST_FILLED = 0.2
_LEAST_POINTS = 9


@dataclass(frozen=True)
class Gridded:
    """Heights (ny, nx) with the smallest y first, nan where there is no point, and the steps of x and y."""

    heights: NDArray[np.float64]
    size: tuple[float, float]


def axis(values: Column) -> tuple[NDArray[np.int64], float] | None:
    """The index of every value on an equally spaced axis, and the spacing; None where there is none."""
    places, inverse = np.unique(values, return_inverse=True)
    if len(places) < 2 or not np.isfinite(places).all():
        return None
    gaps = np.diff(places)
    if not np.isfinite(gaps).all():
        return None
    # Values that differ by less belong to one place; the smallest of the other gaps is a step.
    apart = gaps > 1e-3 * np.max(gaps)
    step = float(np.min(gaps[apart]))
    step = float(np.median(gaps[apart & (gaps < 1.5 * step)]))
    near = np.concatenate(((0,), np.cumsum(np.rint(gaps / step)))).astype(np.int64)
    if near[-1] < 1 or near[-1] >= MAX_PIXELS:
        return None
    spacing = float((places[-1] - places[0]) / near[-1])
    if np.max(np.abs(places - places[0] - near * spacing)) > _JITTER * spacing:
        return None
    return near[inverse.reshape(-1)], spacing


def even_step(values: Column) -> float:
    """The step of numbers that rise or fall evenly, 0 where they do not or are fewer than four."""
    steps = np.diff(values)
    if len(steps) < 3 or not np.isfinite(steps).all():
        return 0.0
    step = float(np.mean(steps))
    return 0.0 if np.max(np.abs(steps - step)) > 1e-3 * abs(step) else step


def grid(x: Column, y: Column, z: Column) -> Gridded:
    """The map that the points make; `SurfaceError` where they lie on no regular grid."""
    known = np.isfinite(x) & np.isfinite(y)
    x, y, z = x[known], y[known], z[known]
    if len(z) < _LEAST_POINTS:
        raise SurfaceError(f"the file holds {len(z)} points x, y, z, at least {_LEAST_POINTS} are needed")
    columns, rows = axis(x), axis(y)
    if columns is None or rows is None:
        raise SurfaceError(
            "the points x, y, z lie on no regular grid along "
            f"{'x' if columns is None else 'y'}: resample them onto one first"
        )
    nx, ny = int(columns[0].max()) + 1, int(rows[0].max()) + 1
    if nx * ny > MAX_PIXELS or len(z) < _LEAST_FILLED * nx * ny:
        raise SurfaceError(
            f"the {len(z)} points x, y, z fill too little of the {nx} x {ny} places of their grid: resample "
            "them onto a regular one first"
        )
    flat = rows[0] * nx + columns[0]
    if len(np.unique(flat)) < len(flat):
        raise SurfaceError("several of the points x, y, z lie at the same place")
    heights = np.full(nx * ny, math.nan)
    heights[flat] = z
    return Gridded(heights.reshape(ny, nx), (columns[1], rows[1]))


def lattice_columns(values: NDArray[np.float64]) -> tuple[int, int, int] | None:
    """Which columns of a narrow table are x, y and z, if two of them span a regular grid."""
    count = values.shape[1]
    for x, y in itertools.combinations(range(min(count, 4)), 2):
        found = [axis(values[:, column]) for column in (x, y)]
        if any(one is None for one in found):
            continue
        nx, ny = (int(one[0].max()) + 1 for one in found if one is not None)
        others = [column for column in range(count) if column not in (x, y)]
        z = next((column for column in others if column > y), others[0])
        if nx >= 3 and ny >= 3 and _LEAST_FILLED * nx * ny <= len(values) <= nx * ny:
            return x, y, z
    return None
