"""A density of slopes between points at which it is known."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["BEYOND", "FEWEST", "Curve", "column", "smooth_variable"]

Array = NDArray[np.float64]

FEWEST = 8  # points that say anything of a density
BEYOND = ("power", "zero")
INTERPOLATIONS = ("cubic", "spline")
_DEGREE = 7
_LOCAL_DEGREE, _PARTS = 5, 4  # of the spline through so many points an interval
_NOTHING, _LAST_POWERS = 12.0, (0.0, -20.0)
_Ends = tuple[float | None, float | None]
_FLAT = 1e-8  # a power so small is rounding


def column(what: str, values: ArrayLike) -> Array:
    """A 1-D array of finite float64; ValueError says what it is instead."""
    try:
        array = np.asarray(values)
    except ValueError:  # rows of different lengths
        array = np.empty(0, dtype=object)
    if array.ndim != 1 or array.dtype.kind not in "iuf":
        raise ValueError(
            f"RadialNDF: {what} must be a 1-D array of real numbers, got {array.dtype} of shape {array.shape}"
        )
    array = array.astype(np.float64)
    if not np.all(np.isfinite(array)):
        raise ValueError(f"RadialNDF: {what} must be finite, got {array[~np.isfinite(array)][0]:g}")
    return array


def smooth_variable(r: ArrayLike, scale: float) -> Any:
    """Like r^2 near 0, where a density is smooth in it, and like log r far from there, to any slope."""
    ratio = np.asarray(r, dtype=np.float64) / scale
    with np.errstate(divide="ignore", over="ignore"):
        return np.where(ratio < 1e8, 0.5 * np.log1p(np.minimum(ratio, 1e8) ** 2), np.log(ratio))


class Curve:
    """P22 between points, by a polynomial of log P22 in log r.

    Parameters
    ----------
    name : str
        What the values are called in messages.
    r, values : array
        Slopes, increasing from 0 or more, and the density there, not negative. Where the last ones are 0,
        the density has fallen to exp(-12) of what it was at the first of them, and falls on as r^-20: that
        has tables as any other. Below the first ones it is as small.
    powers : array, optional
        d log(values) / d log(r) at these slopes.
    interpolation : {"cubic", "spline"}
        A cubic that keeps monotone stretches monotone, or has the given powers; or the spline of degree 7
        through the points, for values that are smooth to all their digits.
    beyond : {"power", "zero"}
        Whether the power law at the last point goes on, or the density ends at the last one.
    """

    def __init__(
        self,
        name: str,
        r: ArrayLike,
        values: ArrayLike,
        powers: ArrayLike | None = None,
        interpolation: str = "cubic",
        beyond: str = "power",
    ) -> None:
        if interpolation not in INTERPOLATIONS:
            raise ValueError(f'RadialNDF: interpolation must be "cubic" or "spline", got {interpolation!r}')
        if beyond not in BEYOND:
            raise ValueError(f'RadialNDF: beyond must be "power" or "zero", got {beyond!r}')
        x, y = column("the slopes r", r), column(f"the values of {name}", values)
        k = None if powers is None else column("powers", powers)
        if x.shape != y.shape or (k is not None and k.shape != x.shape):
            raise ValueError(
                f"RadialNDF: {name} needs as many values as slopes, got {len(y)} of {len(x)}"
                if k is None or k.shape == x.shape
                else f"RadialNDF: powers must be as many as slopes, got {len(k)} of {len(x)}"
            )
        if np.any(np.diff(x) <= 0.0) or (len(x) and x[0] < 0.0):
            raise ValueError("RadialNDF: the slopes r must increase from 0 or more")
        if np.any(y < 0.0):
            at = int(np.argmax(y < 0.0))
            raise ValueError(f"RadialNDF: {name} must not be negative, got {y[at]:g} at r = {x[at]:g}")
        positive = np.flatnonzero(y > 0.0)
        if len(positive) < FEWEST:
            raise ValueError(
                f"RadialNDF: {name} needs {FEWEST} positive values at least, got {len(positive)}"
            )
        first, last = int(positive[0]), int(positive[-1])
        if len(positive) != last + 1 - first:
            inside = first + int(np.argmax(y[first:last] == 0.0))
            raise ValueError(
                f"RadialNDF: {name} must be positive between its ends, it is 0 at r = {x[inside]:g}"
            )
        ends = (
            (x[first - 1] if first else None),
            (x[min(last + 1, len(x) - 1)] if last + 1 < len(x) or beyond == "zero" else None),
        )
        kept = slice(first, last + 1)
        self._fit(x[kept], np.log(y[kept]), None if k is None else k[kept], interpolation == "spline", ends)

    def _fit(self, r: Array, logs: Array, powers: Array | None, smooth: bool, ends: _Ends) -> None:
        from scipy.interpolate import CubicHermiteSpline, PchipInterpolator, make_interp_spline

        # From r = 0 on the variable is that of a smooth function of r^2, log r far beyond the next point.
        self._scale = float(r[1]) if r[0] == 0.0 else 0.0
        s = self._variable(r)
        if powers is not None:
            inner = slice(1 if self._scale else 0, None)  # at r = 0 the variable is r^2
            slopes = np.zeros_like(s)
            slopes[inner] = powers[inner] / self._along(r[inner])
            self._inside: Any = CubicHermiteSpline(s, logs, slopes)
        elif smooth:
            self._inside = make_interp_spline(s, logs, _DEGREE)
        else:
            self._inside = PchipInterpolator(s, logs)
        if (powers is None and not smooth) or ends != (None, None):
            # Tables of a function with corners are large and slow: a spline through points of it has none.
            parts = [np.linspace(low, high, _PARTS, endpoint=False) for low, high in pairwise(s)]
            dense = np.concatenate((*parts, s[-1:]))
            steep = (float(self._inside(s[0], 1)), float(self._inside(s[-1], 1)))
            below, above = (self._beyond(s, side, end) for side, end in zip((0, -1), ends, strict=True))
            slopes_at_ends = tuple(
                slope if end is None else power
                for slope, end, power in zip(steep, ends, _LAST_POWERS, strict=True)
            )
            places = np.concatenate((below[0][::-1], dense, above[0]))
            heights = np.concatenate((below[1][::-1], self._inside(dense), above[1]))
            self._inside = make_interp_spline(places, heights, _LOCAL_DEGREE)
            s = places
        else:
            slopes_at_ends = (float(self._inside(s[0], 1)), float(self._inside(s[-1], 1)))
        self._ends = tuple(0.0 if abs(slope) < _FLAT else slope for slope in slopes_at_ends)
        self._s = float(s[0]), float(s[-1])

    def _beyond(self, s: Array, side: int, end: float | None) -> tuple[Array, Array]:
        """Places beyond an end, and logs there: a straight line, or a fall where there is an end."""
        if side == 0 and self._scale:
            return np.empty(0), np.empty(0)
        step = s[1] - s[0] if side == 0 else s[-2] - s[-1]
        slope, height = float(self._inside(s[side], 1)), float(self._inside(s[side]))
        if end is None:
            away = -step / _PARTS * np.arange(1, 7)
            return s[side] + away, height + slope * away
        width = abs(float(self._variable(np.array(end))) - s[side]) if end > 0.0 else 0.0
        width = width or abs(step)
        # A cubic down to nearly nothing, and on with a power that is easily integrated.
        t = np.arange(1, 2 * _PARTS + 1) / (2 * _PARTS)
        away, power = math.copysign(width, -step), _LAST_POWERS[side]
        fallen = height - _NOTHING
        cubic = (
            (1 + 2 * t) * (1 - t) ** 2 * height
            + t * (1 - t) ** 2 * away * slope
            + t * t * (3 - 2 * t) * fallen
            - t * t * (1 - t) * away * power
        )
        beyond = np.arange(1, 7) / (2 * _PARTS)
        return (
            s[side] + away * np.concatenate((t, 1 + beyond)),
            np.concatenate((cubic, fallen + power * away * beyond)),
        )

    def _variable(self, r: Array) -> Any:
        return smooth_variable(r, self._scale) if self._scale else np.log(r)

    def _along(self, r: Array) -> Any:
        """Derivative of the variable by log r."""
        if not self._scale:
            return np.ones_like(r)
        return 1.0 / (1.0 + (self._scale / r) ** 2)

    def __call__(self, r: ArrayLike) -> Any:
        """The density, of any shape of `r`."""
        r = np.asarray(r, dtype=np.float64)
        with np.errstate(all="ignore"):
            s = self._variable(r)
            low, high = np.minimum(s - self._s[0], 0.0), np.maximum(s - self._s[1], 0.0)
            logs = self._inside(np.clip(s, *self._s))
            # It may be nan at 0: what no point says there, the power does.
            return np.exp(logs + self._ends[0] * low + self._ends[1] * high)
