"""Profiles among measured files: recognised by their content, read and prepared as the options say."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import microfacet as mf
from microfacet._profile import of_instrument
from microfacet._profile.parameters import PARAMETERS
from microfacet.cli.printing import show

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["fallback", "load", "print_parameters", "record", "roughness_record"]

_MOST_POINTS = 8192  # of the segments of a spectrum in JSON
# Options of maps that mean nothing on a line.
_OF_MAPS = {"scale": "--scale is for images", "level_point": "--level-point is for maps"}


def fallback(file: str, reading: dict[str, Any], error: mf.SurfaceError) -> mf.Profile:
    """A profile from an instrument's file in which no map was found, or else that error."""
    if of_instrument(file) and not _OF_MAPS.keys() & reading.keys():
        try:
            return load(file, **reading)
        except mf.SurfaceError:
            pass
    raise error


def load(
    file: str,
    *,
    channel: str | None = None,
    pixel_size: float | Sequence[float] | None = None,
    unit: str | None = None,
    resample: float | None = None,
    outliers: float | None = None,
    level: str = "plane",
    form: str | None = None,
    s_filter: float | None = None,
    l_filter: float | None = None,
    lag: int | None = None,
    lag_length: float | None = None,
    **others: Any,
) -> mf.Profile:
    """Read a profile and prepare it, in the order of the arguments; slopes will be taken at `lag`."""
    for name in others:
        raise mf.SurfaceError(f"{_OF_MAPS[name]}, and this file holds a profile")
    if pixel_size is not None and not isinstance(pixel_size, float | int):
        raise mf.SurfaceError("--pixel-size must be one number for a profile, the distance of its points")
    wanted = int(channel) if channel is not None and channel.isdecimal() else channel
    profile = mf.read_profile(file, wanted, pixel_size, unit, resample)
    if outliers is not None:
        profile = profile.mask_outliers(outliers)
    if level != "none":
        if level not in ("plane", "line") and not level.isdecimal():
            raise mf.SurfaceError(f"--level of a profile must be line, none or a degree, got {level[:40]!r}")
        profile = profile.level(int(level) if level.isdecimal() else 1)
    if form is not None:
        profile = profile.remove_form(int(form) if form.isdecimal() else form)
    if s_filter is not None or l_filter is not None:
        profile = profile.filtered(short=s_filter, long=l_filter)
    if lag is None and lag_length is None:
        return profile
    return profile.at_lag(lag, length=lag_length)


def roughness_record(values: mf.ProfileRoughness) -> dict[str, Any]:
    """The parts of a record for JSON that a map has, too."""
    return {
        "roughness": values._asdict(),
        "roughness_units": {name: PARAMETERS[name].unit for name in values._fields},
        "spectrum": None,
        "autocorrelation": None,
    }


def print_parameters(out: Console, values: mf.ProfileRoughness) -> None:
    """A table, one parameter a row."""
    rows = [
        [name, f"{value:.4g}", PARAMETERS[name].unit, PARAMETERS[name].meaning]
        for name, value in values._asdict().items()
    ]
    show(out, ["parameter", "value", "unit", "what it is"], rows, left=4)


def record(profile: mf.Profile) -> dict[str, Any]:
    """What JSON says of a profile besides its fits."""
    quarter = profile.length / 4
    shorter = quarter > _MOST_POINTS * profile.spacing
    spectrum = profile.psd(_MOST_POINTS * profile.spacing if shorter else None)
    return {
        "traces": len(profile),
        "points": [trace.size for trace in profile.traces],
        "spacing": profile.spacing,
        "length": profile.length,
        "valid_fraction": profile.valid_fraction,
        "cutoff": profile.cutoff,
        "roughness_of_traces": [profile.roughness(trace=k)._asdict() for k in range(len(profile))],
        "psd": {
            "frequencies": spectrum.frequencies.tolist(),
            "psd": spectrum.psd.tolist(),
            "segments": spectrum.segments,
        },
    }
