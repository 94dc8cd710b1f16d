"""Every format that is not ours, through SurfaceTopography in a process of its own."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

from microfacet import _optional
from microfacet._surface.checks import SurfaceError, short
from microfacet._surface.read import numpy_files, process
from microfacet._surface.read.raw import Channel, RawMap, profile_error
from microfacet._surface.read.units import unit_name

__all__ = ["TEXT_FORMATS", "channels", "read", "run"]

#: Formats of the library that are text, by what such a file begins with, or holds near its beginning.
TEXT_FORMATS = {
    "sdf": (b"aBCR-1.0", b"aISO-1.0"),
    "asc": (
        b"Wyko ASCII Data File", b"File Format = ASCII", b"x-pixels", b"Bit2nm", b"height conversion factor",
        b"Scale X",
    ),
}  # fmt: skip


def read(file: Path, channel: int | str | None, formats: tuple[str, ...] = ()) -> RawMap:
    """Read `file` with SurfaceTopography; `SurfaceError` when it cannot, for whatever reason."""
    answer, heights = run("library_child", file, channel=channel, formats=list(formats))
    if answer.get("profile"):
        raise profile_error(f"{short(answer['channels'][0]['name'])}, a scan along a line")
    size, unit = answer["pixel_size"], answer["unit"]
    unit = None if unit is None else unit_name(unit)
    return RawMap(
        heights,
        f"{answer['format']} file of an instrument",
        size=None if size is None else (size[0], size[1]),
        unit=unit,
        size_unit=unit,
        channel=answer["channel"],
        microscope=True,
        warnings=(f"channel {short(answer['channel'])} holds no heights, by its name",)
        if answer["doubtful"]
        else (),
        steps=(f"read channel {short(answer['channel'])} with SurfaceTopography",),
    )


def channels(file: Path, formats: tuple[str, ...] = ()) -> list[Channel]:
    """What the file says of its channels."""
    answer, _ = run("library_child", file, channel=None, formats=list(formats), list=True)
    return [Channel(**(found | {"pixels": tuple(found["pixels"])})) for found in answer["channels"]]


def run(child: str, file: Path, **request: Any) -> tuple[dict[str, Any], Any]:
    """What the library says, in a process whose memory follows from the size of the file."""
    if not _optional.installed("SurfaceTopography"):
        what = "any format but .npy, .npz, .x3p, text, Surfer grids and images needs"
        raise SurfaceError(_optional.sentence(what, "SurfaceTopography"))
    size_on_disk = file.stat().st_size
    unpacked = numpy_files.check_archive(file) if zipfile.is_zipfile(file) else 0
    # Heights pack a few times, a bomb packs a thousand times: that alone earns no memory.
    content = max(size_on_disk, min(unpacked, 20 * size_on_disk))
    return process.run(child, file, content, **request)
