"""What speaks against the numbers of a fit: one sentence with figures each."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from microfacet._fit.halves import Halves
from microfacet._fit.missing import missing
from microfacet._fit.model import Model, State
from microfacet._fit.verdict import percent
from microfacet._profile import Profile
from microfacet._surface import SlopeSample, Surface

__all__ = ["cautions"]

Vector = NDArray[np.float64]

_STEEP, _FLAT = 20.0, 1e-8  # typical slopes that no surface has
_ATOM = 1e-11  # metres
_FEW_VALUES = 8  # that the middle half of the slopes takes, where they are quantised coarsely
_MOST = 20_000  # slopes that are looked at for steps


def cautions(
    source: Surface | SlopeSample | Profile | None,
    raw: Vector,
    lag: int | None,
    fitted: tuple[Model, State],
    halves: Halves | None,
    max_slope: float | None,
) -> tuple[str, ...]:
    """Of a source, its slopes (N, 2) at a lag, and the family that ranks first."""
    found = [*getattr(source, "warnings", ())]
    if isinstance(source, Surface | SlopeSample):
        found += missing(source)
    if halves is not None and not halves.agree:
        found.append(halves.sentence())
    found += _units(source, raw)
    found += _steps(source, raw, lag)
    if max_slope is not None:
        found += _range(raw, fitted, max_slope)
    return tuple(found)


def _units(source: Surface | SlopeSample | Profile | None, raw: Vector) -> Iterator[str]:
    """Slopes and pixels of sizes that cannot be."""
    typical = float(np.median(np.hypot(*(raw - np.median(raw, axis=0)).T)))
    angle = math.degrees(math.atan(typical))
    if typical > _STEEP:
        power = next((k for k in (3, 6, 9, 12) if typical / 10**k < 1), None)
        guess = (
            f" (of heights 1e{power} times smaller the typical slope would be {typical / 10**power:.2g})"
            if power is not None and isinstance(source, Surface)
            else ""
        )
        yield (
            f"a typical slope of {typical:.3g} ({angle:.4g} degrees) is that of no surface: the heights and "
            f"the pixel size are hardly in the units that were taken{guess}"
        )
    elif typical < _FLAT:
        yield (
            f"a typical slope of {typical:.3g} is flatter than any polished surface: the heights and the "
            f"pixel size are hardly in the units that were taken"
        )
    if isinstance(source, Surface) and min(source.pixel_size) < _ATOM:
        yield f"a pixel of {min(source.pixel_size):.3g} m is smaller than an atom: its unit is hardly right"


def _steps(source: Surface | SlopeSample | Profile | None, raw: Vector, lag: int | None) -> Iterator[str]:
    """Slopes that are whole numbers of a step which is not small."""
    for axis, name in enumerate("xy"):
        count, step = _values(raw[:: max(1, len(raw) // _MOST), axis])
        if not 1 <= count <= _FEW_VALUES:
            continue
        heights = (
            f" (heights of {step * 2 * (lag or 1) * source.pixel_size[axis]:.2g} m)"
            if isinstance(source, Surface)
            else ""
        )
        advice = "take a larger lag" if isinstance(source, Surface | Profile) else "take a finer map"
        yield (
            f"slopes along {name} come in steps of {step:.2g}{heights}, and the middle half of them takes "
            f"{count} {'value' if count == 1 else 'values'}: the roughness is near the resolution; {advice}"
        )
        return


def _values(column: Vector) -> tuple[int, float]:
    """How many values the middle half of the slopes takes, and their distance; 0 where there are no steps.

    Values that are equal but for a fiftieth of the half's width are one, as those of normals whose z is
    rounded, too.
    """
    low, high = np.quantile(column, [0.25, 0.75])
    if not high > low:
        gaps = np.diff(np.unique(column))
        gaps = gaps[gaps > 1e-9 * max(float(np.ptp(column)), 1e-300)]
        return 1, float(np.median(gaps)) if len(gaps) else math.nan
    middle = np.sort(column[(column >= low) & (column <= high)])
    gaps = np.diff(middle)
    wide = gaps[gaps > 0.02 * (high - low)]
    if np.sum(wide) < 0.5 * (high - low) or len(middle) < 4 * (len(wide) + 1):
        return 0, math.nan
    return len(wide) + 1, float(middle[-1] - middle[0]) / len(wide)


def _range(raw: Vector, fitted: tuple[Model, State], steepest: float) -> Iterator[str]:
    """Slopes beyond the range of the instrument, measured or only fitted."""
    beyond, expected = float(np.mean(np.hypot(*raw.T) > steepest)), _beyond(*fitted, steepest)
    if beyond > 0:
        yield (
            f"{percent(beyond)} of the slopes are steeper than {steepest:g}, which the instrument does not "
            f"measure: they are artefacts, and should be masked"
        )
    if expected > 0.001 and expected > 2 * beyond:
        yield (
            f"{fitted[0].family.name} puts {percent(expected)} of the slopes beyond {steepest:g}, the range "
            f"of the instrument, where {percent(beyond)} were measured: the tail of the surface is not known"
        )


def _beyond(model: Model, state: State, steepest: float) -> float:
    """The share of slopes that a fitted family has beyond a length."""
    alpha, shape = math.exp(state.log_alpha), model.shape(state)
    probabilities = (np.arange(2000) + 0.5) / 2000
    radius = np.asarray(model.family.kernels.sample_slope(probabilities, alpha, *shape))
    azimuth = (np.arange(64) + 0.5) * (np.pi / 64)
    stretch = model.slopes.stretch @ np.linalg.inv(state.inverse) if model.stretched else np.eye(2)
    along = stretch @ np.stack((np.cos(azimuth), np.sin(azimuth)))
    return float(np.mean(radius[:, np.newaxis] * np.hypot(*along) > steepest))
