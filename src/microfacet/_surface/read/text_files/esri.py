"""ESRI and GRASS ASCII grids: a header in any order, then rows from north to south."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

import numpy as np

from microfacet._surface.checks import SurfaceError, short
from microfacet._surface.read.raw import RawMap
from microfacet._surface.read.text_files.words import check_size, numbers, whole

__all__ = ["is_esri", "read_esri"]

_ESRI = frozenset((
    "ncols", "nrows", "cellsize", "dx", "dy", "xdim", "ydim", "nodata_value", "nodata", "xllcorner",
    "yllcorner", "xllcenter", "yllcenter", "byteorder",
))  # fmt: skip
_GRASS = frozenset(("north", "south", "east", "west", "rows", "cols", "null", "type", "multiplier"))
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
#: What stands for missing data where the header does not say: the default of the format.
_ESRI_DEFAULT = -9999.0
_MOST_LINES = 40


def is_esri(start: bytes) -> bool:
    """Whether a file that begins like this is an ESRI or a GRASS grid: their lines come in any order."""
    text = start[:2048].decode("utf-8-sig", "replace").lower()
    first = next(iter(text.split()), "")
    if first in _ESRI:
        return "ncols" in text or "nrows" in text
    return first.endswith(":") and first[:-1] in _GRASS and ("rows:" in text or "cols:" in text)


@dataclass
class _Header:
    numbers: dict[str, float] = field(default_factory=dict)
    grass: bool = False
    null: str = ""
    geographic: bool = False


def read_esri(file: Path) -> RawMap:
    """The grid with the southernmost row first."""
    with file.open("rb") as stream:
        header = _header(stream)
        found = header.numbers
        names = ("cols", "rows") if header.grass else ("ncols", "nrows")
        nx, ny = (whole(found.get(name), name) for name in names)
        check_size(nx, ny, file.stat().st_size - stream.tell())
        heights = numbers(stream, nx * ny).reshape(ny, nx)
    steps = ["rows turned so that y runs north"]
    missing = found.get("nodata_value", found.get("nodata"))
    if missing is None and header.null:
        missing = math.nan if not _NUMBER.fullmatch(header.null) else float(header.null)
    if missing is None and not header.grass:
        missing = _ESRI_DEFAULT
        if np.any(heights == missing):
            steps.append("-9999 taken for missing, the default of the format, whose header names none")
    if missing is not None:
        heights[heights == missing] = math.nan
    heights *= found.get("multiplier", 1.0)
    size = _cell(header, nx, ny)
    degrees = header.geographic or _in_degrees(found, nx, ny, size[0])
    return RawMap(
        np.flipud(heights),
        "GRASS grid" if header.grass else "ESRI grid",
        size=None if degrees else size,
        usual="m",
        no_size="the cells are in degrees by their size and place, give pixel_size (--pixel-size) in metres",
        steps=tuple(steps),
    )


def _cell(header: _Header, nx: int, ny: int) -> tuple[float, float]:
    found = header.numbers
    if header.grass:
        if header.geographic:
            return 1.0, 1.0
        if not {"north", "south", "east", "west"} <= found.keys():
            raise SurfaceError("the header must state north, south, east and west")
        return (found["east"] - found["west"]) / nx, (found["north"] - found["south"]) / ny
    dx = found.get("dx", found.get("xdim", found.get("cellsize")))
    dy = found.get("dy", found.get("ydim", found.get("cellsize")))
    if dx is None or dy is None:
        raise SurfaceError("the header states no cellsize")
    return dx, dy


def _header(stream: IO[bytes]) -> _Header:
    """The lines of the header, which end where a number begins."""
    header = _Header()
    for _ in range(_MOST_LINES):
        place = stream.tell()
        line = stream.readline(200).decode("utf-8-sig", "replace").replace(",", ".").split()
        if not line and stream.tell() > place:
            continue
        name = line[0].lower().rstrip(":") if line else ""
        known = name in _GRASS if line and line[0].endswith(":") else name in _ESRI
        if len(line) < 2 or not known:
            stream.seek(place)
            return header
        _take(header, name, line[1])
    raise SurfaceError(f"the header has more than {_MOST_LINES} lines")


def _take(header: _Header, name: str, text: str) -> None:
    header.grass |= name in _GRASS
    if name in ("type", "byteorder"):
        return
    if name == "null":
        header.null = text
    elif _NUMBER.fullmatch(text) or text.lower() == "nan":
        header.numbers[name] = float(text)
    elif header.grass and re.fullmatch(r"[\d:.]+[NSEW]", text, re.IGNORECASE):  # degrees, minutes, seconds
        header.geographic = True
    elif text.lower() in ("na", "null", "-") and name.startswith("nodata"):
        header.numbers[name] = math.nan
    else:
        raise SurfaceError(f"the header states {name} {short(text[:20])}, which is not a number")


def _in_degrees(header: dict[str, float], nx: int, ny: int, cell: float) -> bool:
    """Whether the grid lies where a map in degrees would. The format does not say, metres are far larger."""
    west = header.get("xllcorner", header.get("xllcenter", 0.0))
    south = header.get("yllcorner", header.get("yllcenter", 0.0))
    inside = -180 <= west <= 180 and west + nx * cell <= 361 and south >= -90 and south + ny * cell <= 91
    return inside and 1e-5 <= cell <= 1 and not (west == 0 and south == 0)
