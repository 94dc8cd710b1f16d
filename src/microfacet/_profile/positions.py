"""From positions along a line to heights at equal distances: checked, filled with gaps, or resampled."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import MAX_PIXELS, SurfaceError

__all__ = ["Even", "evenly"]

_JITTER = 0.02  # of the spacing, beyond what the rounding of the numbers explains
_EQUAL = 1e-3  # relative difference of the spacings of traces that count as one
_REPLACED = 0.01  # relative difference of distances above which replacing one is a warning
_MOST_MISSING = 20  # points of the filled trace for each that is there
_GAP = 3  # usual steps; beyond, what is resampled stays missing

Vector = NDArray[np.float64]


class Even(NamedTuple):
    """Heights of each trace, their distance in metres, what was done, and what is doubtful."""

    traces: tuple[Vector, ...]
    spacing: float
    steps: tuple[str, ...]
    warnings: tuple[str, ...] = ()


def evenly(
    traces: Sequence[tuple[Vector | None, Vector]],
    stated: float | None,
    given: float | None,
    resample: float | None,
) -> Even:
    """Heights at equal distances. `stated` by the file and `given` by the caller
    are distances of points, `resample` the one to interpolate at.
    """
    positioned = [(x, z) for x, z in traces if x is not None]
    if len(positioned) < len(traces):
        spacing = given or stated
        if spacing is None:
            raise SurfaceError(
                "the file does not state the distance of its points, give pixel_size (--pixel-size) in metres"
            )
        if resample is not None:
            raise SurfaceError("resample needs positions, and the file has heights alone")
        doubts = () if stated is None else _doubt(stated, given)
        return Even(tuple(z for _, z in traces), spacing, _by_caller(given), doubts)
    rising = [(x, z) if x[-1] > x[0] else (x[::-1], z[::-1]) for x, z in positioned]
    steps: tuple[str, ...] = ()
    turned = sum(bool(x[-1] < x[0]) for x, _ in positioned)
    if turned:
        steps = (f"{turned} trace{'s' * (turned != 1)} turned so that x rises",)
    if resample is not None:
        resampled = tuple(_resampled(x, z, resample) for x, z in rising)
        done = f"heights interpolated linearly every {resample:g} m"
        return Even(resampled, resample, (*steps, done))
    filled = [_filled(x, z) for x, z in rising]
    spacings = [spacing for _, spacing in filled]
    if max(spacings) > (1 + _EQUAL) * min(spacings):
        raise SurfaceError(
            f"the traces have spacings from {min(spacings):.4g} to {max(spacings):.4g} m, give resample "
            "(--resample), the distance in metres at which to interpolate"
        )
    missing = sum(z.size for z, _ in filled) - sum(z.size for _, z in rising)
    if missing:
        steps += (f"{missing} missing point{'s' * (missing != 1)} where the positions skip them",)
    mean = float(np.mean(spacings))
    return Even(tuple(z for z, _ in filled), given or mean, (*steps, *_by_caller(given)), _doubt(mean, given))


def _doubt(stated: float, given: float | None) -> tuple[str, ...]:
    """A warning where the caller replaces another distance."""
    if given is None or abs(stated - given) <= _REPLACED * given:
        return ()
    return (f"the positions are {stated:.6g} m apart, which the caller replaced by {given:.6g} m",)


def _by_caller(given: float | None) -> tuple[str, ...]:
    return () if given is None else (f"points {given:g} m apart, as given by the caller",)


def _filled(x: Vector, z: Vector) -> tuple[Vector, float]:
    """Heights with nan where even positions skip a point, and the spacing."""
    steps = np.diff(x)
    if not (steps > 0).all():
        raise SurfaceError("the positions of a trace neither rise nor fall throughout")
    mean, usual = float((x[-1] - x[0]) / steps.size), float(np.median(steps))
    tolerance = _JITTER * mean + _rounding(x)
    if np.max(np.abs(x - x[0] - mean * np.arange(x.size))) <= tolerance:
        return z, mean
    numbers = np.concatenate(([0.0], np.cumsum(np.maximum(np.rint(steps / usual), 1))))
    spacing = float((x[-1] - x[0]) / numbers[-1])
    if np.max(np.abs(x - x[0] - spacing * numbers)) > _JITTER * spacing + _rounding(x):
        raise SurfaceError(
            f"the positions are uneven, with steps from {steps.min():.4g} to {steps.max():.4g} m: give "
            "resample (--resample), the distance in metres at which to interpolate"
        )
    if numbers[-1] >= min(_MOST_MISSING * x.size, MAX_PIXELS):
        raise SurfaceError(f"the positions skip {numbers[-1] + 1 - x.size:.0f} points, more than are there")
    heights = np.full(int(numbers[-1]) + 1, math.nan)
    heights[numbers.astype(np.intp)] = z
    return heights, spacing


def _rounding(x: Vector) -> float:
    """Half a unit of the last decimal place of the positions, 0 where they have seven and more."""
    scale = 10.0 ** math.floor(math.log10(max(float(np.max(np.abs(x))), 1e-300)))
    for digits in range(7):
        unit = scale * 10.0**-digits
        if np.max(np.abs(x / unit - np.rint(x / unit))) < 1e-6:
            return 0.5 * unit
    return 0.0


def _resampled(x: Vector, z: Vector, step: float) -> Vector:
    """Heights at multiples of the step from the first position, nan in wide gaps."""
    if not (np.diff(x) > 0).all():
        raise SurfaceError("the positions of a trace neither rise nor fall throughout")
    known = np.isfinite(z)
    count = int(min((x[-1] - x[0]) / step * (1 + 1e-12), 1e12)) + 1
    if not 3 <= count <= MAX_PIXELS:
        raise SurfaceError(f"resample {step:g} m leaves {count} points of a trace of {x[-1] - x[0]:.4g} m")
    places = x[0] + step * np.arange(count)
    heights = np.interp(places, x[known], z[known], left=math.nan, right=math.nan)
    after = np.clip(np.searchsorted(x[known], places), 1, max(int(np.count_nonzero(known)) - 1, 1))
    gaps = np.diff(x[known])
    heights[gaps[after - 1] > _GAP * float(np.median(np.diff(x)))] = math.nan
    return np.asarray(heights)
