"""Hills and dales of ISO 25178-2: the highest peaks and deepest pits that are significant.

Every pixel belongs to the hill of the peak that steepest ascent over its eight neighbours leads to. Hills
whose peak stands less than a share of Sz above the highest saddle around them join the hill beyond that
saddle, as Wolf's pruning has it. A hill that does so has the lower peak of the two, so that all such hills
may join at the same time: whatever else joins, neither its peak nor its highest saddle changes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from microfacet._surface.height_map import HeightMap
from microfacet._threads import in_threads

__all__ = ["TenPoints", "ten_points"]

_PRUNED = 0.05  # of Sz
_POINTS = 5
_BLOCK = 1 << 16  # pixels of the rows that are worked on at a time: they stay in the cache
_AROUND = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
_AHEAD = [(0, 1), (1, -1), (1, 0), (1, 1)]  # each pair of neighbours once

Map = NDArray[np.float64]
Labels = NDArray[np.int32]


class TenPoints(NamedTuple):
    """`S5p`, the mean height of the five highest peaks, `S5v`, the mean depth of the five deepest pits, both
    from the mean plane, and their sum `S10z`, in metres."""

    S5p: float
    S5v: float
    S10z: float


def ten_points(surface: HeightMap) -> TenPoints:
    """Five-point peak height, five-point pit depth and ten-point height of a prepared surface.

    Hills and dales count that Wolf's pruning leaves at 5 % of Sz and that do not touch the edge of the map,
    where they may go on. Of fewer than five the mean is that of those there are; of none it is nan.
    """
    heights, mask = surface.heights, surface.mask
    mean = float(np.mean(heights, where=mask))
    highest = float(np.max(heights, where=mask, initial=-math.inf))
    lowest = float(np.min(heights, where=mask, initial=math.inf))
    threshold = _PRUNED * (highest - lowest)
    found = in_threads(lambda sign: _significant(heights, mask, threshold, sign), (1.0, -1.0))
    five_p, five_v = _mean_of_highest(found[0] - mean), _mean_of_highest(found[1] + mean)
    return TenPoints(five_p, five_v, five_p + five_v)


def _mean_of_highest(found: Map) -> float:
    return float(np.mean(np.sort(found)[-_POINTS:])) if found.size else math.nan


@dataclass
class _Hills:
    """Peaks by number, which hills touch the edge, and the saddles between neighbours."""

    peaks: Map
    open: NDArray[np.bool_]
    one: NDArray[Any]
    two: NDArray[Any]
    saddles: Map  # of the hills `one` and `two`; a pair may stand there again with a lower one


def _significant(heights: Map, mask: NDArray[np.bool_], threshold: float, sign: float) -> Map:
    """Heights times `sign` of the peaks of that which are significant and not at the edge."""
    labels, count = _basins(heights, mask, sign)
    hills = _neighbours(labels, count, heights, sign)
    del labels
    parent = _joined(hills, threshold)
    is_open = np.zeros(count, dtype=np.bool_)
    is_open[parent[hills.open]] = True
    remains = (parent == np.arange(count)) & ~is_open
    return np.asarray(hills.peaks[remains])


def _blocks(shape: tuple[int, int]) -> list[slice]:
    step = max(1, _BLOCK // shape[1])
    return [slice(first, min(first + step, shape[0])) for first in range(0, shape[0], step)]


def _basins(heights: Map, mask: NDArray[np.bool_], sign: float) -> tuple[Labels, int]:
    """For every pixel the number of its peak from 0, -1 where it is missing, and how many there are."""
    ny, nx = heights.shape
    pointer = np.empty(heights.shape, dtype=np.int32)
    for rows in _blocks(heights.shape):
        pointer[rows] = _ascent(heights, rows, sign)
    numbers = np.arange(ny * nx, dtype=np.int32).reshape(ny, nx)
    summits = (pointer == numbers) & mask
    del numbers
    labels = np.empty(heights.shape, dtype=np.int32)
    count: Any = ndimage.label(summits, structure=np.ones((3, 3), dtype=int), output=labels)
    del summits
    flat, marks = pointer.reshape(-1), labels.reshape(-1)
    while True:
        moved = False
        for first in range(0, flat.size, _BLOCK):
            block = flat[first : first + _BLOCK]
            onwards = flat[block]
            moved = moved or not np.array_equal(onwards, block)
            block[...] = onwards
        if not moved:
            break
    for first in range(0, flat.size, _BLOCK):
        flat[first : first + _BLOCK] = marks[flat[first : first + _BLOCK]] - 1
    pointer[~mask] = -1
    return pointer, int(count)


def _ascent(heights: Map, rows: slice, sign: float) -> Labels:
    """The number of the highest neighbour of each pixel, or its own where none is higher."""
    ny, nx = heights.shape
    padded = np.full((rows.stop - rows.start + 2, nx + 2), -math.inf)
    first, last = max(rows.start - 1, 0), min(rows.stop + 1, ny)
    offset = 1 - (rows.start - first)
    inner = sign * heights[first:last]
    inner[np.isnan(inner)] = -math.inf
    padded[offset : offset + last - first, 1:-1] = inner
    best = padded[1:-1, 1:-1].copy()
    place = (np.arange(rows.start, rows.stop)[:, np.newaxis] * nx + np.arange(nx)).astype(np.int32)
    own = place.copy()
    for down, right in _AROUND:
        other = padded[1 + down : padded.shape[0] - 1 + down, 1 + right : nx + 1 + right]
        higher = other > best
        np.copyto(best, other, where=higher)
        np.copyto(place, own + np.int32(down * nx + right), where=higher)
    return np.asarray(place)


def _neighbours(labels: Labels, count: int, heights: Map, sign: float) -> _Hills:
    """The graph of hills that touch each other."""
    ny, nx = heights.shape
    peaks = np.full(count, -math.inf)
    pairs, saddles = [np.empty(0, dtype=np.int64)], [np.empty(0)]
    for rows in _blocks(heights.shape):
        below = min(rows.stop + 1, ny)
        z, name = sign * heights[rows.start : below], labels[rows.start : below]
        there = name >= 0
        np.maximum.at(peaks, name[there], z[there])
        met, levels = [], []
        for down, right in _AHEAD:
            high = min(rows.stop - rows.start, z.shape[0] - down)
            here = slice(0, high), slice(max(0, -right), nx - max(0, right))
            other = slice(down, high + down), slice(max(0, right), nx - max(0, -right))
            a, b = name[here], name[other]
            touch = np.nonzero((a != b) & there[here] & there[other])
            one, two = a[touch].astype(np.int64), b[touch]
            met.append(np.minimum(one, two) * count + np.maximum(one, two))
            levels.append(np.minimum(z[here][touch], z[other][touch]))
        pair, level = _highest(np.concatenate(met), np.concatenate(levels))
        pairs.append(pair)
        saddles.append(level)
    is_open = np.zeros(count, dtype=np.bool_)
    for line in (labels[0], labels[-1], labels[:, 0], labels[:, -1]):
        is_open[line[line >= 0]] = True
    one, two = np.divmod(np.concatenate(pairs), max(count, 1))
    return _Hills(peaks, is_open, one, two, np.concatenate(saddles))


def _highest(pairs: NDArray[np.int64], saddles: Map) -> tuple[NDArray[np.int64], Map]:
    """Each pair once, with the highest of its saddles."""
    if pairs.size == 0:
        return pairs, saddles
    order = np.argsort(pairs)
    pairs, saddles = pairs[order], saddles[order]
    starts = np.flatnonzero(np.concatenate(([True], pairs[1:] != pairs[:-1])))
    return pairs[starts], np.maximum.reduceat(saddles, starts)


def _joined(hills: _Hills, threshold: float) -> NDArray[np.intp]:
    """The hill that each one belongs to after pruning."""
    count = hills.peaks.size
    parent = np.arange(count)
    one = np.concatenate((hills.one, hills.two))
    two = np.concatenate((hills.two, hills.one))
    saddles = np.concatenate((hills.saddles, hills.saddles))
    # Among peaks of one height the first counts as the higher one, so that no two join each other.
    rank = np.empty(count, dtype=np.intp)
    rank[np.lexsort((-parent, hills.peaks))] = parent
    while one.size:
        highest = np.full(count, -math.inf)
        np.maximum.at(highest, one, saddles)
        joins = (saddles == highest[one]) & (hills.peaks[one] - saddles < threshold) & (rank[two] > rank[one])
        if not joins.any():
            break
        step = np.arange(count)
        step[one[joins]] = two[joins]
        while not np.array_equal(step, onwards := step[step]):
            step = onwards
        parent, one, two = step[parent], step[one], step[two]
        apart = one != two
        one, two, saddles = one[apart], two[apart], saddles[apart]
    return parent
