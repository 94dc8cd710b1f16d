"""Images whose grey levels are heights: PNG, TIFF, GeoTIFF and EXR, decoded in a process of their own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from microfacet import _optional
from microfacet._surface.checks import SurfaceError
from microfacet._surface.read import process
from microfacet._surface.read.raw import Channel, RawMap

__all__ = ["STARTS", "channels", "decode", "read"]

#: What PNG, TIFF (with BigTIFF), EXR and JPEG begin with.
STARTS = (
    b"\x89PNG\r\n\x1a\n", b"II*\0", b"MM\0*", b"II+\0", b"MM\0+", b"\x76\x2f\x31\x01", b"\xff\xd8\xff",
)  # fmt: skip
_NO_SIZE = "the image does not state its pixel size, give pixel_size (--pixel-size) in metres"
_DEGREES = "the pixels are in degrees, give pixel_size (--pixel-size) in metres or project the map first"
_FEET = "the pixels are not in metres, give pixel_size (--pixel-size) in metres"


def decode(
    file: Path, *, normals: bool, channel: int | str | None = None, only_list: bool = False
) -> tuple[dict[str, Any], Any]:
    """What the file says about its pixels, and the pixels."""
    for library in ("OpenImageIO", "tifffile"):
        if not _optional.installed(library):
            raise SurfaceError(_optional.sentence("reading images needs", library))
    size = file.stat().st_size
    return process.run("image_child", file, size, normals=normals, channel=channel, list=only_list)


def read(file: Path, channel: int | str | None) -> RawMap | None:
    """The heights of an image; None for a microscope's file, which is an image by its beginning alone."""
    facts, pixels = decode(file, normals=False, channel=channel)
    if facts.get("microscope"):
        return None
    if "geographic" in facts and not facts["metric_heights"]:
        raise SurfaceError("the heights are not in metres, convert them first")
    geographic = "geographic" in facts
    size, no_size = facts.get("pixel_size"), _NO_SIZE
    if geographic and size is not None and (facts["geographic"] or not facts["metric"]):
        size, no_size = None, _DEGREES if facts["geographic"] else _FEET
    return RawMap(
        np.flipud(pixels),
        "GeoTIFF" if geographic else f"{facts['format']} image",
        size=None if size is None else (size[0], size[1]),
        size_unit=None if size is None else "m",
        usual="m" if geographic else None,
        channel=facts.get("channel"),
        image=True,
        bits=facts["bits"],
        no_size=no_size,
        steps=("rows turned so that y runs up the image",),
    )


def channels(file: Path) -> list[Channel] | None:
    """The pages of a TIFF of several, or the channels of an image; None for a microscope's file."""
    facts, _ = decode(file, normals=False, only_list=True)
    if facts.get("microscope"):
        return None
    if len(facts.get("pages", ())) > 1:
        return [Channel(f"page {page}", page, (nx, ny)) for page, nx, ny in facts["pages"]]
    return [Channel(name, index, tuple(facts["pixels"])) for index, name in enumerate(facts["channels"])]
