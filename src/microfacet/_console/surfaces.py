"""A measured surface as the options of a command describe it."""

from __future__ import annotations

from dataclasses import replace

from microfacet._surface import Surface, read_surface

__all__ = ["load"]


def load(
    file: str, *, channel: str | None, pixel_size: float | None, unit: str | None, lag: int | None
) -> Surface:
    """Read a surface; slopes will be taken at `lag` where one is given."""
    wanted = int(channel) if channel is not None and channel.isdecimal() else channel
    surface = read_surface(file, channel=wanted, pixel_size=pixel_size, unit=unit)
    return surface if lag is None else replace(surface, lag=lag)
