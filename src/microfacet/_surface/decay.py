"""How an autocorrelation falls with the shift: by direction, and averaged over all of them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

__all__ = ["decay", "picture", "radial"]

_RAYS = 720  # directions in half a turn
_STEP = 0.25  # of the smaller pixel side, along a ray
_AT_A_TIME = 64  # steps along all rays
_SPLINED = (
    1 << 23
)  # shifts up to which splines go between them, lines beyond: splines take as much memory again
_PICTURE = 96  # pixels to either side in a picture

Map = NDArray[Any]
Vector = NDArray[np.float64]


def decay(found: Map, pixel_size: tuple[float, float], limit: float) -> tuple[Vector, Vector, float]:
    """Directions, the distance along each to the first fall to the limit, and how far was looked in all.

    The distance is inf where there is no such fall.
    """
    dx, dy = pixel_size
    up, right = found.shape[0] // 2, found.shape[1] - 1
    angles = np.arange(_RAYS) * math.pi / _RAYS
    reach, step = min(up * dy, right * dx), _STEP * min(dx, dy)
    distances, last = np.full(_RAYS, math.inf), np.ones(_RAYS)
    order: Any = 3 if found.size <= _SPLINED else 1
    coefficients: Any = ndimage.spline_filter(found, order=3) if order == 3 else found
    rays = np.arange(_RAYS)
    for first in range(0, math.ceil(reach / step), _AT_A_TIME):
        r = step * np.arange(first + 1, first + _AT_A_TIME + 1)
        r = r[r <= reach]
        if not (rays.size and r.size):
            break
        x, y = np.outer(np.cos(angles[rays]), r) / dx, np.outer(np.sin(angles[rays]), r) / dy
        turned = x < 0  # the map of shifts is symmetric
        places: Any = [np.where(turned, -y, y) + up, np.abs(x)]
        values = ndimage.map_coordinates(coefficients, places, order=order, prefilter=False, mode="nearest")
        along = np.concatenate((last[rays, np.newaxis], values), axis=1)
        fell = (along[:, 1:] <= limit).any(axis=1)
        k = np.argmax(along[:, 1:] <= limit, axis=1)[fell]
        before, after = along[fell, k], along[fell, k + 1]
        distances[rays[fell]] = (first + k + (before - limit) / (before - after)) * step
        last[rays] = along[:, -1]
        rays = rays[~fell]
    return angles, distances, reach


def radial(found: Map, pixel_size: tuple[float, float], reach: float) -> tuple[Vector, Vector]:
    """The mean over all directions at distances a pixel apart."""
    dx, dy = pixel_size
    up = found.shape[0] // 2
    x, y = np.arange(found.shape[1]) * dx, (np.arange(found.shape[0]) - up) * dy
    step = math.sqrt(dx * dy)
    count = int(reach / step) + 1
    sums, number, distances = np.zeros(count), np.zeros(count), np.zeros(count)
    for row, height in zip(found, y, strict=True):
        r = np.hypot(x, height)
        place = np.rint(r / step).astype(np.intp)
        inside = place < count
        weight = np.where(x[inside] > 0, 2.0, 1.0)  # the other half of the shifts
        sums += np.bincount(place[inside], weight * row[inside], count)
        distances += np.bincount(place[inside], weight * r[inside], count)
        number += np.bincount(place[inside], weight, count)
    there = number > 0
    return distances[there] / number[there], sums[there] / number[there]


def picture(found: Map, pixel_size: tuple[float, float], extent: float) -> tuple[Vector, tuple[float, float]]:
    """The middle of the map of shifts, thinned to a size for pictures, with both halves."""
    dx, dy = pixel_size
    up = found.shape[0] // 2
    rows, columns = min(up, math.ceil(extent / dy)), min(found.shape[1] - 1, math.ceil(extent / dx))
    thin = max(1, math.ceil(max(rows, columns) / _PICTURE))
    rows, columns = rows // thin * thin, columns // thin * thin
    half = found[up - rows : up + rows + 1 : thin, : columns + 1 : thin].astype(np.float64)
    return np.concatenate((half[::-1, :0:-1], half), axis=1), (dx * thin, dy * thin)
