"""Filters of height maps: outliers by their distance from a local median, Gaussian filters by wavelength."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, signal

from microfacet._surface.checks import SurfaceError
from microfacet._surface.form import polynomial

__all__ = ["gaussian", "outliers"]

Map = NDArray[np.float64]
Mask = NDArray[np.bool_]

# ISO 16610-61: the weight is exp(-pi (r/(a L))^2) with a = sqrt(ln 2/pi), which transmits half of a wave of
# the cut-off length L; as a Gaussian of standard deviation a L/sqrt(2 pi).
_SIGMA_PER_CUTOFF = math.sqrt(math.log(2) / 2) / math.pi
_TRUNCATE = 6.0  # standard deviations; 2e-9 of the weight lies beyond
# Standard deviations per median absolute deviation of a normal distribution.
_NORMAL_MAD = 1.482602218505602


def gaussian(heights: Map, mask: Mask, pixel_size: tuple[float, float], cutoff: float) -> Map:
    """The part of the map that a Gaussian filter of this cut-off wavelength transmits, nan where invalid.

    Missing pixels and the world beyond the edge have no weight: the weighted mean is over the valid pixels
    alone (normalised convolution), so nothing leaks in from where nothing was measured.
    """
    middle = float(np.mean(heights[mask]))
    weight = mask.astype(np.float64)
    smooth = np.where(mask, heights - middle, 0.0)
    for axis, size in ((1, pixel_size[0]), (0, pixel_size[1])):
        kernel = _kernel(_SIGMA_PER_CUTOFF * cutoff / size, heights.shape[axis])
        across = kernel.reshape((1, -1) if axis == 1 else (-1, 1))
        smooth = signal.oaconvolve(smooth, across, mode="same", axes=axis)
        weight = signal.oaconvolve(weight, across, mode="same", axes=axis)
    smooth = np.divide(smooth, weight, out=np.full(heights.shape, math.nan), where=mask)
    return np.asarray(smooth + middle)


def outliers(heights: Map, mask: Mask, threshold: float, size: int = 5) -> Mask:
    """Where the height is more than `threshold` robust standard deviations from the median around it.

    The deviation is scaled by the median absolute deviation of all of them; where that is zero (more than
    half of the heights equal their local median, as quantised ones may) by the mean absolute deviation.
    """
    filled = heights - polynomial(heights, mask, 2)  # or a tilt would show at the edges and beside holes
    if not mask.all():  # a median filter knows no missing values: the nearest valid pixel stands in
        nearest = ndimage.distance_transform_edt(~mask, return_distances=False, return_indices=True)
        filled = filled[tuple(nearest)]
    distance = np.abs(filled - ndimage.median_filter(filled, size=size, mode="nearest"))
    valid = distance[mask]
    spread = _NORMAL_MAD * float(np.median(valid)) or float(np.mean(valid))
    if not math.isfinite(spread):
        raise SurfaceError("the heights spread too far to tell outliers")
    return np.asarray(mask & (distance > threshold * spread))


def _kernel(sigma: float, count: int) -> Map:
    reach = min(math.ceil(_TRUNCATE * sigma), count - 1)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    return np.asarray(kernel / kernel.sum())
