"""Slopes of a normal map over longer baselines."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from microfacet._surface.checks import SurfaceError

__all__ = ["averaged"]


def averaged(
    values: NDArray[np.float64], grid: NDArray[np.bool_], lag: int
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """p averaged along x and q along y from `lag` pixels before to `lag` pixels behind, by the trapezoidal
    rule, and where all of them are known.
    """
    ny, nx = grid.shape
    if min(grid.shape) <= 2 * lag:
        raise SurfaceError(f"a map of {nx} x {ny} pixels is too small for slopes at lag {lag}")
    weights = np.full(2 * lag + 1, 1 / (2 * lag))
    weights[[0, -1]] /= 2
    full = np.full((2, ny, nx), np.nan)
    full[:, grid] = values.T
    inner = slice(lag, -lag)
    p = ndimage.convolve1d(full[0], weights, axis=1)[inner, inner]
    q = ndimage.convolve1d(full[1], weights, axis=0)[inner, inner]
    known = np.isfinite(p) & np.isfinite(q)
    if not known.any():
        raise SurfaceError(f"no pixel has its neighbours at lag {lag}")
    return np.column_stack((p[known], q[known])), known
