"""Missing pixels filled for what cannot do without them: a Fourier transform."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["filled"]

_SWEEPS = 12

Map = NDArray[np.float64]
Mask = NDArray[np.bool_]


def filled(heights: Map, mask: Mask) -> Map:
    """A copy in which missing pixels continue smoothly what lies around them.

    They solve Laplace's equation, nearly: coarser and coarser means give a first guess, holes of a few pixels
    then take the mean of their four neighbours until that settles.
    """
    values = np.where(mask, heights, 0.0)
    if mask.all():
        return values
    _guess(values, mask)
    rows, columns = np.nonzero(~mask)
    ny, nx = mask.shape
    around = [
        (np.maximum(rows - 1, 0), columns),
        (np.minimum(rows + 1, ny - 1), columns),
        (rows, np.maximum(columns - 1, 0)),
        (rows, np.minimum(columns + 1, nx - 1)),
    ]
    for _ in range(_SWEEPS):
        values[rows, columns] = sum(values[place] for place in around) / 4
    return values


def _guess(values: Map, mask: Mask) -> None:
    """Fill what is missing, in place, with means over the valid pixels of a coarser map, itself filled."""
    if mask.all():
        return
    ny, nx = values.shape
    shape = -(-ny // 2), -(-nx // 2)
    total, weight = np.zeros(shape), np.zeros(shape)
    for i in (0, 1):
        for j in (0, 1):
            part = values[i::2, j::2] * mask[i::2, j::2]
            total[: part.shape[0], : part.shape[1]] += part
            weight[: part.shape[0], : part.shape[1]] += mask[i::2, j::2]
    known = weight > 0
    coarse = np.divide(total, weight, out=np.zeros(shape), where=known)
    _guess(coarse, known)
    rows, columns = np.nonzero(~mask)
    values[rows, columns] = coarse[rows // 2, columns // 2]
