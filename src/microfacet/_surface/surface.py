"""The height map, and the preparation that a slope density needs: levelling and finite differences."""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["MAX_PIXELS", "METRES_PER_UNIT", "Surface", "SurfaceError", "pixel_sizes"]

#: Largest map that is accepted (8192 x 8192 pixels, 512 MiB as float64): bounds the memory of everything
#: here.
MAX_PIXELS = 2**26

#: Length units that a file may state, in metres. Both micro signs (U+00B5, U+03BC) are in use.
METRES_PER_UNIT = {
    "km": 1e3, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "\u00b5m": 1e-6, "\u03bcm": 1e-6,
    "nm": 1e-9, "A": 1e-10, "\u00c5": 1e-10, "pm": 1e-12, "fm": 1e-15,
}  # fmt: skip


class SurfaceError(ValueError):
    """A height map that cannot be used; the message is one sentence that says why."""


@dataclass(frozen=True, eq=False)
class Surface:
    """Heights on a rectangular grid of pixels, in metres.

    Column ``j`` lies at ``x = j dx`` and row ``i`` at ``y = i dy``: +x runs along the columns, +y up the rows
    in the order in which they are stored, +z away from the material. The arrays are copies and read-only.

    Parameters
    ----------
    heights : array_like, shape (ny, nx)
        Heights in metres. A pixel that is not finite is invalid, whatever `mask` says.
    pixel_size : float or (float, float)
        ``(dx, dy)`` in metres, positive; one number means square pixels.
    mask : array_like of bool, shape (ny, nx), optional
        True where the height is valid. Heights of invalid pixels become nan.
    unit : str
        The unit in which the source stated its heights, for display; `heights` are metres.
    source : str
        Where the heights come from, for display.
    steps : tuple of str
        Every preparation step taken so far, in order, one phrase each.
    lag : int
        The lag in pixels at which `slopes` are taken unless another is asked for.

    Raises
    ------
    SurfaceError
        If the heights are not a real 2-D array of at least 3 x 3 and at most 2**26 pixels, fewer than 9
        pixels are valid, or a pixel size is not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> y, x = np.mgrid[0:5, 0:6] * 1e-6
    >>> tilted = Surface(0.5 * x - 0.25 * y, pixel_size=1e-6)
    >>> tilted.slopes(lag=2).round(12)
    array([[ 0.5 , -0.25],
           [ 0.5 , -0.25]])
    >>> bool(abs(tilted.level().heights).max() < 1e-20)
    True
    """

    heights: NDArray[np.float64]
    pixel_size: tuple[float, float]
    mask: NDArray[np.bool_] = None  # type: ignore[assignment]  # __post_init__ fills it in
    unit: str = "m"
    source: str = "array"
    steps: tuple[str, ...] = ()
    lag: int = 1

    def __post_init__(self) -> None:
        heights = _height_array(self.heights)
        valid = np.isfinite(heights)
        if np.abs(heights, where=valid, out=np.zeros_like(heights)).max() > 1e30:  # squares must stay finite
            raise SurfaceError("heights must lie in [-1e30, 1e30] metres")
        if isinstance(self.heights, np.ma.MaskedArray):
            valid &= ~np.ma.getmaskarray(self.heights)
        if self.mask is not None:
            mask = np.asarray(self.mask)
            if mask.shape != heights.shape or mask.dtype != np.bool_:
                raise SurfaceError(
                    f"mask must be a bool array of the shape of the heights, {heights.shape}, "
                    f"got {mask.dtype} of shape {mask.shape}"
                )
            valid &= mask
        if np.count_nonzero(valid) < 9:
            raise SurfaceError(
                f"the map has {np.count_nonzero(valid)} valid pixels of {valid.size}, at least 9 are needed"
            )
        heights[~valid] = math.nan
        heights.flags.writeable = valid.flags.writeable = False
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "mask", valid)
        object.__setattr__(self, "pixel_size", pixel_sizes(self.pixel_size))
        object.__setattr__(self, "steps", tuple(self.steps))
        object.__setattr__(self, "lag", _checked_lag(self.lag))

    def level(self) -> Surface:
        """Subtract the least-squares plane through the valid pixels.

        Returns
        -------
        Surface
            The levelled map; its `steps` name the step.
        """
        # Centred, scaled coordinates keep the 3 x 3 normal equations well-conditioned; sums over rows and
        # columns avoid an (N, 3) design matrix.
        ny, nx = self.heights.shape
        x = np.linspace(-1.0, 1.0, nx)[np.newaxis, :]
        y = np.linspace(-1.0, 1.0, ny)[:, np.newaxis]
        basis = (np.ones((1, 1)), x, y)
        weight = self.mask.astype(np.float64)
        middle = float(np.mean(self.heights[self.mask]))
        heights = np.where(self.mask, self.heights - middle, 0.0)
        normal = np.array([[np.sum(weight * a * b) for b in basis] for a in basis])
        right = np.array([np.sum(heights * a) for a in basis])
        offset, tilt_x, tilt_y = np.linalg.lstsq(normal, right, rcond=None)[0]
        levelled = self.heights - (middle + offset + tilt_x * x + tilt_y * y)
        return replace(
            self, heights=levelled, steps=(*self.steps, "levelled: least-squares plane subtracted")
        )

    def slopes(self, lag: int | None = None) -> NDArray[np.float64]:
        """Slopes by central differences over `lag` pixels on each side.

        .. math:: p = \\frac{h(x + l\\,dx, y) - h(x - l\\,dx, y)}{2 l\\,dx},\\quad
                  q = \\frac{h(x, y + l\\,dy) - h(x, y - l\\,dy)}{2 l\\,dy}

        The baseline is 2 `lag` pixels. Both slopes belong to the same pixel; a pixel for which one of the
        four neighbours is missing or outside the map is left out.

        Parameters
        ----------
        lag : int, optional
            Pixels on each side, at least 1; the `lag` of the surface by default.

        Returns
        -------
        ndarray, shape (N, 2)
            Slopes ``(p, q)`` along +x and +y (dimensionless), row by row.

        Raises
        ------
        SurfaceError
            If `lag` is not a positive integer or no pixel has its four neighbours.
        """
        lag = self.lag if lag is None else _checked_lag(lag)
        h, (dx, dy) = self.heights, self.pixel_size
        if min(h.shape) <= 2 * lag:
            ny, nx = h.shape
            raise SurfaceError(f"a map of {nx} x {ny} pixels is too small for slopes at lag {lag}")
        inner = slice(lag, -lag)
        with np.errstate(over="ignore"):
            p = (h[inner, 2 * lag :] - h[inner, : -2 * lag]) / (2 * lag * dx)
            q = (h[2 * lag :, inner] - h[: -2 * lag, inner]) / (2 * lag * dy)
        known = np.isfinite(p) & np.isfinite(q)
        if not known.any():
            raise SurfaceError(f"no pixel has its four neighbours at lag {lag}")
        return np.column_stack((p[known], q[known]))


def pixel_sizes(value: Any) -> tuple[float, float]:
    """``(dx, dy)`` from one number or two; `SurfaceError` unless both are positive and finite."""
    try:
        sizes = np.asarray(value)
    except (TypeError, ValueError):
        sizes = np.empty(0)
    if sizes.shape not in ((), (1,), (2,)) or sizes.dtype.kind not in "iuf":
        raise SurfaceError(f"pixel_size must be one number or (dx, dy), in metres, got {_short(value)}")
    dx, dy = (float(size) for size in np.broadcast_to(sizes, (2,)))
    # The limits keep dx, dy and every quotient by them far from overflow; no map comes near them.
    if not (1e-30 < dx < 1e30 and 1e-30 < dy < 1e30):
        raise SurfaceError(f"pixel_size must lie in (1e-30, 1e30) metres, got ({dx:g}, {dy:g})")
    return dx, dy


def _height_array(heights: ArrayLike) -> NDArray[np.float64]:
    """A float64 copy; ints become floats, everything that is not a real 2-D map is refused."""
    try:
        array = np.asarray(heights)
    except (TypeError, ValueError):  # rows of different lengths
        array = np.empty(0, dtype=object)
    if array.dtype.kind not in "iuf":
        raise SurfaceError(f"heights must be a 2-D map of real numbers, got an array of {array.dtype}")
    if array.ndim != 2 or min(array.shape) < 3:
        raise SurfaceError(f"heights must be a 2-D map of at least 3 x 3 pixels, got shape {array.shape}")
    if array.size > MAX_PIXELS:
        raise SurfaceError(f"a map of {array.shape} exceeds the limit of {MAX_PIXELS} pixels")
    with np.errstate(over="ignore"):  # a longdouble beyond float64 becomes inf, that is, invalid
        return np.array(array, dtype=np.float64, order="C")


def _checked_lag(lag: Any) -> int:
    try:
        number = 0 if isinstance(lag, bool | np.bool_) else operator.index(lag)
    except TypeError:
        number = 0
    if number < 1:
        raise SurfaceError(f"lag must be a whole number of pixels in [1, inf), got {_short(lag)}")
    return number


def _short(value: object) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else text[:57] + "..."
