"""Images whose grey levels are heights: PNG, TIFF, GeoTIFF and EXR, decoded in a process of their own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet import _optional
from microfacet._surface.checks import SurfaceError, positive
from microfacet._surface.read import process

__all__ = ["SUFFIXES", "HeightImage", "decode", "read"]

SUFFIXES = (".png", ".tif", ".tiff", ".exr")


@dataclass(frozen=True)
class HeightImage:
    """Heights with the lowest row first, in metres where `in_metres`, and the pixel size where stated."""

    heights: NDArray[np.float64]
    pixel_size: tuple[float, float] | None
    in_metres: bool
    steps: tuple[str, ...]


def decode(file: Path, *, normals: bool, channel: int | str | None = None) -> tuple[dict[str, Any], Any]:
    """What the file says about its pixels, and the pixels."""
    for library in ("OpenImageIO", "tifffile"):
        if not _optional.installed(library):
            raise SurfaceError(_optional.sentence("reading images needs", library))
    return process.run("image_child", file, file.stat().st_size, normals=normals, channel=channel)


def read(
    file: Path, channel: int | str | None, height_scale: float | None, stated_unit: bool, sized: bool
) -> HeightImage | None:
    """The heights of an image; None for a microscope's file, which is an image by its suffix alone."""
    scale = None if height_scale is None else positive(height_scale, "height_scale")
    facts, pixels = decode(file, normals=False, channel=channel)
    geographic = "pixel_size" in facts
    if facts.get("microscope"):
        return None
    if facts["bits"] == 8:
        raise SurfaceError("8 bits hold 256 heights, too few for slopes: export 16 bits or floating point")
    if height_scale is None and facts["bits"] and not geographic:
        raise SurfaceError(
            "grey levels are no lengths, give height_scale (--scale), the metres per grey level"
        )
    if height_scale is None and not geographic and not stated_unit:
        raise SurfaceError(
            "the image does not state its unit of length, give unit= (--unit) or height_scale="
        )
    if geographic and not sized:
        _refuse_what_is_not_metres(facts)
    steps: tuple[str, ...] = ("rows turned so that y runs up the image",)
    if scale is not None:
        pixels = pixels * scale
        steps += (f"heights of {scale:g} m per grey level, as given by the caller",)
    size = facts.get("pixel_size")
    return HeightImage(
        np.flipud(pixels),
        None if size is None else (size[0], size[1]),
        in_metres=height_scale is not None,
        steps=steps,
    )


def _refuse_what_is_not_metres(facts: dict[str, Any]) -> None:
    if facts["geographic"]:
        raise SurfaceError(
            "the pixels are in degrees, give pixel_size (--pixel-size) in metres or project the map first"
        )
    if not facts["metric"]:
        raise SurfaceError("the pixels are not in metres, give pixel_size (--pixel-size) in metres")
