"""Profile parameters of ISO 21920-2 that describe heights and slopes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._profile.traces import Traces
from microfacet._surface.checks import SurfaceError
from microfacet._surface.parameters import Parameter

__all__ = ["PARAMETERS", "ProfileRoughness", "roughness"]

#: The unit and the meaning of each parameter.
PARAMETERS = {
    "Rq": Parameter("m", "root mean square height"),
    "Ra": Parameter("m", "mean absolute height"),
    "Rsk": Parameter("1", "skewness of the heights"),
    "Rku": Parameter("1", "kurtosis of the heights, 3 if normal"),
    "Rp": Parameter("m", "highest peak above the mean line, mean over section lengths"),
    "Rv": Parameter("m", "deepest pit below the mean line, mean over section lengths"),
    "Rz": Parameter("m", "highest peak to deepest pit, mean over section lengths"),
    "Rt": Parameter("m", "highest peak to deepest pit of the whole trace"),
    "Rdq": Parameter("1", "root mean square slope, by seven points, as the standard has it"),
    "Rdr": Parameter("1", "developed length over the projected one, minus one"),
    "rms_slope": Parameter("1", "root mean square slope, central differences over the lag (that is fitted)"),
}

Trace = NDArray[np.float64]

# The derivative at the middle of seven points of the polynomial of degree six through them.
_SEVEN = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60


class ProfileRoughness(NamedTuple):
    r"""Profile parameters of ISO 21920-2; all but `Rsk`, `Rku`, `Rdq`, `Rdr` and `rms_slope` are metres.

    With z from the mean line of its trace, over the valid points:

    .. math:: R_q^2 = \overline{z^2},\quad R_a = \overline{|z|},\quad R_{sk} = \overline{z^3}/R_q^3,\quad
              R_{ku} = \overline{z^4}/R_q^4,\quad R_{dq}^2 = \overline{(dz/dx)^2},\quad R_{dr} = L/L_0 - 1

    Attributes
    ----------
    Rq, Ra : float
        Root mean square and mean absolute height.
    Rsk, Rku : float
        Skewness and kurtosis (3 for a normal distribution).
    Rp, Rv, Rz : float
        Highest peak, depth of the deepest pit (positive) and their sum, each the mean over section lengths.
    Rt : float
        Highest peak above deepest pit of the whole trace.
    Rdq : float
        Root mean square slope, with the derivative from seven points,
        ``(z[3] - 9 z[2] + 45 z[1] - 45 z[-1] + 9 z[-2] - z[-3])/(60 spacing)``, as standards define it.
    Rdr : float
        Developed length L of the polyline through the points over its projection L_0, minus one.
    rms_slope : float
        Root mean square slope by central differences over the profile's lag, the slopes that `fit` sees.
        Steep short waves count less in it than in `Rdq`.

    Notes
    -----
    ISO 21920-2:2021, Geometrical product specifications: Surface texture, Profile, Terms, definitions and
    surface texture parameters. Their symbols begin with R for a profile that has passed an L-filter; for one
    that has not (the primary profile) the same numbers are called Pq, Pa, ... Section lengths are the cut-off
    of the L-filter, or else the whole trace. Rdq grows without bound for finer spacings on many surfaces:
    state the spacing and the cut-off of the S-filter with it.

    Examples
    --------
    >>> import numpy as np
    >>> import microfacet as mf
    >>> x = np.arange(4000) * 1e-6
    >>> values = mf.Profile(1e-6 * np.sin(2 * np.pi * x / 40e-6), spacing=1e-6).roughness()
    >>> f"{values.Rq:.4g} {values.Ra:.4g} {values.Rku:.4g} {values.Rz:.3g} {values.Rdq:.4g}"
    '7.071e-07 6.353e-07 1.5 2e-06 0.111'
    """

    Rq: float
    Ra: float
    Rsk: float
    Rku: float
    Rp: float
    Rv: float
    Rz: float
    Rt: float
    Rdq: float
    Rdr: float
    rms_slope: float


def roughness(profile: Traces, chosen: Sequence[int], section_length: float | None) -> ProfileRoughness:
    """The parameters of the chosen traces, each the mean over them."""
    each = [_of_trace(profile.traces[k], profile, section_length) for k in chosen]
    return ProfileRoughness(*(float(np.mean(values)) for values in zip(*each, strict=True)))


def _of_trace(trace: Trace, profile: Traces, section_length: float | None) -> ProfileRoughness:
    dx = profile.spacing
    valid = np.isfinite(trace)
    if not valid.any():
        raise SurfaceError("a trace has no valid point")
    heights = trace - float(np.mean(trace[valid]))
    scale = float(np.max(np.abs(heights[valid])))
    if scale == 0:
        raise SurfaceError("all heights of a trace are equal, which leaves no roughness to describe")
    z = heights[valid] / scale  # so that no power over- or underflows
    variance = float(np.mean(z * z))
    peaks, pits = _extremes(heights, dx, section_length)
    return ProfileRoughness(
        Rq=scale * math.sqrt(variance),
        Ra=scale * float(np.mean(np.abs(z))),
        Rsk=float(np.mean(z**3)) / variance**1.5,
        Rku=float(np.mean(z**4)) / variance**2,
        Rp=peaks,
        Rv=pits,
        Rz=peaks + pits,
        Rt=float(np.max(heights[valid]) - np.min(heights[valid])),
        Rdq=_rms(np.convolve(heights, _SEVEN[::-1], mode="valid") / dx),
        Rdr=_developed(np.diff(heights) / dx),
        rms_slope=_rms((trace[2 * profile.lag :] - trace[: -2 * profile.lag]) / (2 * profile.lag * dx)),
    )


def _extremes(heights: Trace, dx: float, section_length: float | None) -> tuple[float, float]:
    """Mean height of the highest peak and mean depth of the deepest pit of the sections."""
    points = heights.size if section_length is None else max(round(section_length / dx), 1)
    count = max(heights.size // points, 1)
    sections = [heights[k * points : (k + 1) * points] for k in range(count)]
    known = [section[np.isfinite(section)] for section in sections if np.isfinite(section).any()]
    return float(np.mean([np.max(part) for part in known])), -float(np.mean([np.min(part) for part in known]))


def _rms(slopes: Trace) -> float:
    known = slopes[np.isfinite(slopes)]
    if not known.size:
        raise SurfaceError("too few neighbouring points of a trace are valid, so its slopes are unknown")
    return math.sqrt(float(np.mean(known * known)))


def _developed(slopes: Trace) -> float:
    """The mean of sqrt(1 + t^2) - 1, without cancellation for a flat line."""
    square = slopes[np.isfinite(slopes)] ** 2
    if not square.size:
        raise SurfaceError("no two neighbouring points of a trace are valid, so its length is unknown")
    return float(np.mean(square / (np.sqrt(1 + square) + 1)))
