"""A measured surface: the options that describe it, and it read and prepared as they say."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import Any

import click

import microfacet as mf

__all__ = ["load", "load_map", "surface_options"]

Command = Callable[..., Any]

# How to read and prepare a measured surface, in the order in which it is done.
_SURFACE: dict[str, dict[str, Any]] = {
    "slopes": {
        "type": click.Choice(["table", "opengl", "directx"]),
        "help": "The file holds slopes, in two columns, or as a normal map of this convention.",
    },
    "channel": {"metavar": "NAME", "help": "Which map of a file that holds several: name or number."},
    "pixel_size": {"type": float, "metavar": "METRES", "help": "For a file that states none."},
    "unit": {"metavar": "NAME", "help": "Of the lengths in a file that states none."},
    "scale": {"type": float, "metavar": "X", "help": "Metres per grey level of a height image."},
    "outliers": {"type": float, "metavar": "X", "help": "Mask what sticks out by X robust deviations."},
    "level": {
        "metavar": "KIND",
        "help": "plane (default), three-point, none, or the degree of a polynomial.",
    },
    "level_point": {"multiple": True, "metavar": "COLUMN,ROW", "help": "A point of three-point; thrice."},
    "form": {"metavar": "KIND", "help": "Remove a sphere, a cylinder, or a polynomial of this degree."},
    "s_filter": {"type": float, "metavar": "METRES", "help": "Cut-off of a Gaussian S-filter."},
    "l_filter": {"type": float, "metavar": "METRES", "help": "Cut-off of a Gaussian L-filter."},
    "lag": {"type": click.IntRange(min=1), "metavar": "N", "help": "Pixels to either side of a slope."},
    "lag_length": {"type": float, "metavar": "METRES", "help": "The same as a length."},
}


def surface_options(command: Command) -> Command:
    """Options that read and prepare a measured surface; the command gets those given as `reading`."""

    @functools.wraps(command)
    def wrapped(**rest: Any) -> Any:
        values = {name: rest.pop(name) for name in _SURFACE}
        reading = {name: value for name, value in values.items() if value not in (None, ())}
        return command(reading=reading, **rest)

    for name, how in reversed(_SURFACE.items()):
        wrapped = click.option(f"--{name.replace('_', '-')}", **how)(wrapped)
    return wrapped


def load(file: str, *, slopes: str | None = None, **reading: Any) -> mf.Surface | mf.SlopeSample:
    """What the file holds: a prepared surface, or slopes, which need no preparation."""
    if slopes is None:
        return load_map(file, **reading)
    if reading:
        raise mf.SurfaceError(f"--{next(iter(reading)).replace('_', '-')} is for height maps, not for slopes")
    return mf.read_slopes(file) if slopes == "table" else mf.read_normal_map(file, slopes)


def load_map(
    file: str,
    *,
    channel: str | None = None,
    pixel_size: float | None = None,
    unit: str | None = None,
    scale: float | None = None,
    outliers: float | None = None,
    level: str = "plane",
    level_point: Sequence[str] = (),
    form: str | None = None,
    s_filter: float | None = None,
    l_filter: float | None = None,
    lag: int | None = None,
    lag_length: float | None = None,
) -> mf.Surface:
    """Read a surface and prepare it, in the order of the arguments; slopes will be taken at `lag`."""
    wanted = int(channel) if channel is not None and channel.isdecimal() else channel
    surface = mf.read_surface(file, channel=wanted, pixel_size=pixel_size, unit=unit, height_scale=scale)
    if outliers is not None:
        surface = surface.mask_outliers(outliers)
    surface = _level(surface, level, level_point)
    if form is not None:
        surface = surface.remove_form(int(form) if form.isdecimal() else form)
    if s_filter is not None or l_filter is not None:
        surface = surface.filtered(short=s_filter, long=l_filter)
    if lag is None and lag_length is None:
        return surface
    return surface.at_lag(lag, length=lag_length)


def _level(surface: mf.Surface, kind: str, points: Sequence[str]) -> mf.Surface:
    if points and kind != "three-point":
        raise mf.SurfaceError("--level-point goes with --level three-point")
    if kind == "three-point":
        return surface.level("three-point", points=[_pixel(point) for point in points])
    if kind == "none":
        return surface
    if kind.isdecimal():
        return surface.level(degree=int(kind))
    if kind != "plane":
        raise mf.SurfaceError(f"--level must be plane, three-point, none or a degree, got {kind[:40]!r}")
    return surface.level()


def _pixel(text: str) -> tuple[int, int]:
    column, _, row = text.partition(",")
    if not (column.isdecimal() and row.isdecimal()):
        raise mf.SurfaceError(f"--level-point must be COLUMN,ROW, such as 10,20, got {text[:40]!r}")
    return int(column), int(row)
