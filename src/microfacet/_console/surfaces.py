"""A measured surface as the options of a command describe it: read, prepared, every step named."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from microfacet._surface import (
    SlopeSample,
    Surface,
    SurfaceError,
    read_normal_map,
    read_slopes,
    read_surface,
)

__all__ = ["load", "load_map"]


def load(file: str, *, slopes: str | None = None, **reading: Any) -> Surface | SlopeSample:
    """What the file holds: a prepared surface, or slopes, which need no preparation."""
    if slopes is None:
        return load_map(file, **reading)
    if reading:
        raise SurfaceError(f"--{next(iter(reading)).replace('_', '-')} is for height maps, not for slopes")
    return read_slopes(file) if slopes == "table" else read_normal_map(file, slopes)


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
) -> Surface:
    """Read a surface and prepare it, in the order of the arguments; slopes will be taken at `lag`."""
    wanted = int(channel) if channel is not None and channel.isdecimal() else channel
    surface = read_surface(file, channel=wanted, pixel_size=pixel_size, unit=unit, height_scale=scale)
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


def _level(surface: Surface, kind: str, points: Sequence[str]) -> Surface:
    if points and kind != "three-point":
        raise SurfaceError("--level-point goes with --level three-point")
    if kind == "three-point":
        return surface.level("three-point", points=[_pixel(point) for point in points])
    if kind == "none":
        return surface
    if kind.isdecimal():
        return surface.level(degree=int(kind))
    if kind != "plane":
        raise SurfaceError(f"--level must be plane, three-point, none or a degree, got {kind[:40]!r}")
    return surface.level()


def _pixel(text: str) -> tuple[int, int]:
    column, _, row = text.partition(",")
    if not (column.isdecimal() and row.isdecimal()):
        raise SurfaceError(f"--level-point must be COLUMN,ROW, such as 10,20, got {text[:40]!r}")
    return int(column), int(row)
