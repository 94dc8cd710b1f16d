"""A measured surface: the options that describe it, and it read and prepared as they say."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import Any

import click

import microfacet as mf

__all__ = ["load", "load_map", "reading_options", "surface_options"]

Command = Callable[..., Any]


class _PixelSize(click.ParamType[Any]):
    """One number, or two of pixels that are no squares."""

    name = "pixel size"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float | tuple[float, float]:
        if not isinstance(value, str):
            return value  # type: ignore[no-any-return]
        try:
            sizes = [float(part) for part in value.split(",")]
        except ValueError:
            sizes = []
        if len(sizes) not in (1, 2):
            self.fail(f"{value[:40]!r} is neither DX nor DX,DY, such as 2e-6,1e-6", param, ctx)
        return sizes[0] if len(sizes) == 1 else (sizes[0], sizes[1])


# How to read a measured surface.
_READING: dict[str, dict[str, Any]] = {
    "channel": {"metavar": "NAME", "help": "Which map of a file that holds several: name or number."},
    "pixel_size": {
        "type": _PixelSize(),
        "metavar": "DX[,DY]",
        "help": "In metres, for a file that states none.",
    },
    "unit": {"metavar": "NAME", "help": "Of the lengths in a file that states none."},
    "scale": {"type": float, "metavar": "X", "help": "Metres per grey level of a height image."},
}
# How to read and prepare one, in the order in which it is done.
_SURFACE: dict[str, dict[str, Any]] = {
    "slopes": {
        "type": click.Choice(["table", "opengl", "directx"]),
        "help": "The file holds slopes, in two columns, or as a normal map of this convention.",
    },
    "profile": {
        "is_flag": True,
        "default": None,
        "help": "The file holds heights along lines; most are recognised without it.",
    },
    "resample": {
        "type": float,
        "metavar": "METRES",
        "help": "Interpolate a profile of uneven positions at this distance.",
    },
    **_READING,
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


def reading_options(command: Command) -> Command:
    """Options that read a measured surface; the command gets those given as `reading`, for `read_surface`."""

    @functools.wraps(command)
    def wrapped(**rest: Any) -> Any:
        values = {name: rest.pop(name) for name in _READING}
        reading = {name: value for name, value in values.items() if value is not None}
        if "channel" in reading:
            reading["channel"] = _channel(reading["channel"])
        if "scale" in reading:
            reading["height_scale"] = reading.pop("scale")
        return command(reading=reading, **rest)

    for name, how in reversed(_READING.items()):
        wrapped = click.option(f"--{name.replace('_', '-')}", **how)(wrapped)
    return wrapped


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


def load(
    file: str, *, slopes: str | None = None, profile: bool = False, **reading: Any
) -> mf.Surface | mf.SlopeSample | mf.Profile:
    """What the file holds: a prepared surface or profile, or slopes, which need no preparation."""
    from microfacet._profile import holds_profile
    from microfacet.cli import profiles

    if slopes is None and (profile or holds_profile(file)):
        return profiles.load(file, **reading)
    if slopes is None:
        own = {name: value for name, value in reading.items() if name != "resample"}
        try:
            surface = load_map(file, **own)
        except mf.SurfaceError as error:
            return profiles.fallback(file, reading, error)
        if own != reading:
            raise mf.SurfaceError("--resample is for profiles, and this file holds a map")
        return surface
    if profile:
        raise mf.SurfaceError("--profile and --slopes exclude each other")
    lag = reading.pop("lag", None) if slopes != "table" else None
    if reading:
        raise mf.SurfaceError(f"--{next(iter(reading)).replace('_', '-')} is for height maps, not for slopes")
    if slopes == "table":
        return mf.read_slopes(file)
    sample = mf.read_normal_map(file, slopes)
    return sample if lag is None else sample.at_lag(lag)


def load_map(
    file: str,
    *,
    channel: str | None = None,
    pixel_size: float | tuple[float, float] | None = None,
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
    surface = mf.read_surface(
        file, channel=_channel(channel), pixel_size=pixel_size, unit=unit, height_scale=scale
    )
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


def _channel(text: str | None) -> int | str | None:
    """The number of a channel, or its name."""
    return int(text) if text is not None and text.isdecimal() else text


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
