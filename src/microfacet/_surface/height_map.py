"""A grid of heights and its slopes: what is measured, before anything is done to it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import SurfaceError, checked_lag, height_array, pixel_sizes, positive
from microfacet._value import Value

__all__ = ["HeightMap", "PrincipalAxes"]


class PrincipalAxes(NamedTuple):
    """The axes of the slope covariance: `angle` of the larger one in radians, counter-clockwise from +x, in
    (-pi/2, pi/2], and the standard deviations of the slopes along it and across."""

    angle: float
    along: float
    across: float


@dataclass(frozen=True, eq=False)
class HeightMap(Value):
    """The data of a `Surface`, which documents them, and what is read off them."""

    heights: NDArray[np.float64]
    pixel_size: tuple[float, float]
    mask: NDArray[np.bool_] = None  # type: ignore[assignment]  # __post_init__ fills it in
    unit: str = "m"
    source: str = "array"
    steps: tuple[str, ...] = ()
    lag: int = 1
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        heights = height_array(self.heights)
        valid = np.isfinite(heights)
        least, most = (find(heights, where=valid, initial=0.0) for find in (np.min, np.max))
        if max(-least, most) > 1e30:  # squares must stay finite
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
        if not np.array_equal(valid, ~np.isnan(heights)):
            heights = heights if heights.flags.writeable else heights.copy()
            heights[~valid] = math.nan
        heights.flags.writeable = valid.flags.writeable = False
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "mask", valid)
        object.__setattr__(self, "pixel_size", pixel_sizes(self.pixel_size))
        object.__setattr__(self, "steps", tuple(self.steps))
        object.__setattr__(self, "warnings", tuple(self.warnings))
        object.__setattr__(self, "lag", checked_lag(self.lag))

    def at_lag(self, lag: int | None = None, *, length: float | None = None) -> Self:
        """The same map, whose slopes are taken at another lag.

        Parameters
        ----------
        lag : int, optional
            Pixels to either side, at least 1.
        length : float, optional
            The same in metres: the nearest whole number of pixels (of the geometric mean of their sides).

        Returns
        -------
        Surface
            With this `lag`; `steps` name it where it comes from a length.

        Examples
        --------
        >>> import microfacet as mf
        >>> mf.sample_terrain().at_lag(length=250.0).lag
        3
        """
        if (lag is None) == (length is None):
            raise SurfaceError("give either a lag in pixels or a length in metres")
        if lag is not None:
            return replace(self, lag=lag)
        side = math.sqrt(self.pixel_size[0] * self.pixel_size[1])
        pixels = round(min(positive(length, "the lag length") / side, 1e9))
        if pixels < 1:
            raise SurfaceError(f"a lag of {length:g} m is less than half a pixel of {side:g} m")
        step = f"slopes over a lag of {pixels} pixels for {length:g} m"
        return replace(self, lag=pixels, steps=(*self.steps, step))

    @property
    def lag_length(self) -> float:
        """The lag in metres (of the geometric mean of the pixel's sides)."""
        return self.lag * math.sqrt(self.pixel_size[0] * self.pixel_size[1])

    def principal_axes(self, lag: int | None = None) -> PrincipalAxes:
        """The axes along which the slopes vary most and least.

        Parameters
        ----------
        lag : int, optional
            As for `slopes`.

        Returns
        -------
        PrincipalAxes
            ``angle`` (radians, counter-clockwise from +x) of the axis of the steepest slopes, which is across
            the grooves of a ground surface, and the standard deviations ``along`` and ``across`` it.

        Examples
        --------
        >>> import microfacet as mf
        >>> import numpy as np
        >>> y, x = np.mgrid[0:64, 0:64] * 1.0
        >>> grooves = mf.Surface(np.sin(0.3 * x + 0.3 * y), pixel_size=1.0)
        >>> print(f"{np.degrees(grooves.principal_axes().angle):.0f} degrees")
        45 degrees
        """
        values, axes = np.linalg.eigh(np.cov(self.slopes(lag).T))
        x, y = axes[:, 1]
        angle = math.atan2(y, x)
        angle -= math.pi * math.ceil(angle / math.pi - 0.5)  # an axis has no sign
        across, along = np.sqrt(np.maximum(values, 0.0))
        return PrincipalAxes(angle, float(along), float(across))

    def slopes(self, lag: int | None = None, *, principal: bool = False) -> NDArray[np.float64]:
        """Slopes by central differences over `lag` pixels on each side.

        .. math:: p = \\frac{h(x + l\\,dx, y) - h(x - l\\,dx, y)}{2 l\\,dx},\\quad
                  q = \\frac{h(x, y + l\\,dy) - h(x, y - l\\,dy)}{2 l\\,dy}

        The baseline is 2 `lag` pixels. Both slopes belong to the same pixel; a pixel for which one of the
        four neighbours is missing or outside the map is left out.

        Parameters
        ----------
        lag : int, optional
            Pixels on each side, at least 1; the `lag` of the surface by default.
        principal : bool
            Turn the axes to the principal ones of the slope covariance: p along the steepest.

        Returns
        -------
        ndarray, shape (N, 2)
            Slopes ``(p, q)`` along +x and +y (dimensionless), row by row.

        Raises
        ------
        SurfaceError
            If `lag` is not a positive integer or no pixel has its four neighbours.
        """
        lag = self.lag if lag is None else checked_lag(lag)
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
        slopes = np.column_stack((p[known], q[known]))
        if not principal:
            return slopes
        angle = self.principal_axes(lag).angle
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        return np.asarray(slopes @ turn)
