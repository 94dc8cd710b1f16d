"""Whether pixels are missing at random, or where the surface is steep."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from microfacet._fit.verdict import percent
from microfacet._surface import SlopeSample, Surface

__all__ = ["missing"]

_TILE, _MOST_TILES = 8, 256  # pixels along a side of a region at least, and regions along a side at most
_FEWEST = 30  # regions
_KNOWN = 0.15  # of a region's differences, so that its steepness can be told
_SIGNIFICANCE = 1e-3
_APART = 0.01  # of the missing shares where it is steep and where it is flat

Vector = NDArray[np.float64]


def missing(source: Surface | SlopeSample) -> Iterator[str]:
    """One sentence where the missing share goes with the steepness of what is left."""
    if isinstance(source, Surface):
        valid = source.mask
    elif source.grid is not None:
        valid = source.grid
    else:
        return
    share = 1 - np.count_nonzero(valid) / valid.size
    if share == 0:
        return
    gone, steepness = _regions(source, valid)
    if len(gone) < _FEWEST or np.ptp(gone) == 0 or np.ptp(steepness) == 0:
        return
    order = np.argsort(steepness, kind="stable")
    fifth = max(len(order) // 5, 1)
    flat, steep = float(np.mean(gone[order[:fifth]])), float(np.mean(gone[order[-fifth:]]))
    test = stats.spearmanr(gone, steepness)
    if test.pvalue > _SIGNIFICANCE or abs(steep - flat) < _APART * max(1.0, share / 0.1):
        return
    effect = (
        "roughness and tails come out too small"
        if steep > flat
        else "flat parts are missing, and the roughness comes out too large"
    )
    yield (
        f"{percent(share)} of the pixels are missing, and not at random: {percent(steep)} in the steepest "
        f"fifth of the map, {percent(flat)} in the flattest; {effect}"
    )


def _regions(source: Surface | SlopeSample, valid: NDArray[np.bool_]) -> tuple[Vector, Vector]:
    """Of square regions whose steepness can be told: the missing share, and the mean size of the slopes."""
    ny, nx = valid.shape
    side = max(_TILE, -(-max(ny, nx) // _MOST_TILES))
    columns = nx // side
    gone, steepness = [np.empty(0)], [np.empty(0)]

    def totals(band: NDArray[np.float64]) -> Vector:
        return np.asarray(band[:, : columns * side].reshape(side, columns, side).sum(axis=(0, 2)))

    for row in range(0, ny - side + 1, side):
        rows, total, count = slice(row, row + side), np.zeros(columns), np.zeros(columns)
        # Each difference counts by itself: of pixels with both there are the fewer, the more are missing.
        for sizes in _sizes(source, valid, rows):
            known = np.isfinite(sizes)
            total += totals(np.where(known, sizes, 0.0))
            count += totals(known.astype(np.float64))
        enough = count >= _KNOWN * side**2
        gone.append(1 - totals(valid[rows].astype(np.float64))[enough] / side**2)
        steepness.append(total[enough] / count[enough])
    return np.concatenate(gone), np.concatenate(steepness)


def _sizes(source: Surface | SlopeSample, valid: NDArray[np.bool_], rows: slice) -> tuple[Vector, ...]:
    """Sizes of the slopes in some rows, nan where they are not known; of heights by their neighbours."""
    if isinstance(source, Surface):
        h, (dx, dy) = source.heights[rows], source.pixel_size
        along, across = np.full((2, *h.shape), np.nan)
        along[:, :-1], across[:-1] = np.abs(np.diff(h, axis=1)) / dx, np.abs(np.diff(h, axis=0)) / dy
        return along, across
    before, inside = int(np.count_nonzero(valid[: rows.start])), valid[rows]
    sizes = np.full(inside.shape, np.nan)
    sizes[inside] = np.hypot(*source.values[before : before + int(np.count_nonzero(inside))].T)
    return (sizes,)
