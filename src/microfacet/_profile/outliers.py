"""Points that stick out of their neighbourhood along a line."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from microfacet._surface.checks import SurfaceError

__all__ = ["outliers"]

Trace = NDArray[np.float64]

_WINDOW = 11  # points
# Standard deviations per median absolute deviation of a normal distribution.
_NORMAL_MAD = 1.482602218505602


def outliers(heights: Trace, threshold: float) -> NDArray[np.bool_]:
    """Where the height is more than `threshold` robust standard deviations from the median around it.

    The deviation is that of the heights in the same window, so that a steep flank is none, but at least the
    median of all windows' (or their mean, where most are flat). F. R. Hampel, The influence curve and its
    role in robust estimation, JASA 69, 1974.
    """
    valid = np.isfinite(heights)
    filled = heights
    if not valid.all():  # a median filter knows no missing values: the nearest valid point stands in
        nearest = ndimage.distance_transform_edt(~valid, return_distances=False, return_indices=True)
        filled = heights[nearest[0]]
    around = np.lib.stride_tricks.sliding_window_view(np.pad(filled, _WINDOW // 2, mode="edge"), _WINDOW)
    middle = np.median(around, axis=1)
    spread = np.median(np.abs(around - middle[:, np.newaxis]), axis=1)
    least = float(np.median(spread[valid])) or float(np.mean(np.abs(filled - middle)[valid]))
    if not math.isfinite(least):
        raise SurfaceError("the heights spread too far to tell outliers")
    deviation = _NORMAL_MAD * np.maximum(spread, least)
    return np.asarray(valid & (np.abs(filled - middle) > threshold * deviation))
