"""Height maps as text: ESRI ASCII grids, and plain tables of numbers with a stated pixel size.

Memory is bounded: no line is read beyond a limit, and no more numbers than a map may have.
"""

from __future__ import annotations

import itertools
import math
import re
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import MAX_PIXELS, SurfaceError

__all__ = [
    "SUFFIXES",
    "TextGrid",
    "has_heading",
    "is_esri",
    "is_heading",
    "lines",
    "read_esri",
    "read_plain",
    "separator",
    "table",
]

SUFFIXES = (".asc", ".txt", ".csv", ".tsv", ".dat")
#: Longest line: 65536 numbers with every digit.
MAX_LINE = 2**21
_HEADER = frozenset(("ncols", "nrows", "cellsize", "dx", "dy", "nodata_value"))
_HEADER |= {f"{axis}ll{place}" for axis in "xy" for place in ("corner", "center")}
_MAX_WORD = 100
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


@dataclass(frozen=True)
class TextGrid:
    """Heights with the lowest row first, and the pixel size if stated."""

    heights: NDArray[np.float64]
    pixel_size: tuple[float, float] | None
    in_degrees: bool = False


def is_esri(file: Path) -> bool:
    """Whether the file starts like an ESRI ASCII grid."""
    with file.open("rb") as stream:
        return stream.read(64).lstrip()[:5].lower() == b"ncols"


def read_esri(file: Path) -> TextGrid:
    """A grid under the header ncols, nrows, (xll..., yll...), cellsize, NODATA_value; north comes first."""
    with file.open("rb") as stream:
        header = _header(stream)
        nx, ny = (_count(header, name) for name in ("ncols", "nrows"))
        size = file.stat().st_size - stream.tell()
        if nx * ny > MAX_PIXELS:
            raise SurfaceError(f"a map of {nx} x {ny} pixels exceeds the limit of {MAX_PIXELS} pixels")
        if 2 * nx * ny - 1 > size:  # a digit and a space each
            raise SurfaceError(f"the header claims {nx} x {ny} numbers, {size} bytes cannot hold them")
        heights = _numbers(stream, nx * ny).reshape(ny, nx)
    if "nodata_value" in header:
        heights[heights == header["nodata_value"]] = math.nan
    if "cellsize" not in header and not {"dx", "dy"} <= header.keys():
        raise SurfaceError("the header states no cellsize")
    dx, dy = header.get("dx", header.get("cellsize", 0.0)), header.get("dy", header.get("cellsize", 0.0))
    return TextGrid(np.flipud(heights), (dx, dy), _in_degrees(header, nx, ny, dx))


def read_plain(file: Path) -> TextGrid:
    """A table of numbers, one line for each row of pixels, lowest first; lines of ``#`` are comments."""
    with file.open("rb") as stream:
        rows = lines(stream)
        first = next((line for line in rows if line.partition("#")[0].strip()), None)
        if first is None:
            raise SurfaceError("the file holds no numbers")
        delimiter = separator(first)
        columns = len(first.split(delimiter))
        stream.seek(0)
        heights = table(lines(stream), delimiter, MAX_PIXELS // columns + 1)
    return TextGrid(heights, None)


def table(rows: Iterable[str], delimiter: str | None, most: int) -> NDArray[np.float64]:
    """The numbers in at most so many rows, equally many in each; empty ones and comments do not count."""
    full = (row for row in rows if row.partition("#")[0].strip())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # there is no row
        try:
            # With max_rows NumPy would begin with room for all of them.
            return np.loadtxt(itertools.islice(full, most), delimiter=delimiter, ndmin=2)
        except SurfaceError:
            raise
        except ValueError as error:
            reason = " ".join(str(error).split())[:100]
    raise SurfaceError(f"this is not a table of numbers with equally many in every line ({reason})")


def lines(stream: IO[bytes]) -> Iterator[str]:
    """The lines of a text; one that is too long or no text is refused, before it fills the memory."""
    while line := stream.readline(MAX_LINE + 1):
        if len(line) > MAX_LINE:
            raise SurfaceError(f"a line is longer than {MAX_LINE} characters")
        try:
            text = line.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise SurfaceError("this is not a text file") from None
        if "\0" in text:
            raise SurfaceError("this is not a text file")
        yield text


def has_heading(file: Path) -> bool:
    """Whether the file starts with words, or a comment, rather than with numbers."""
    with file.open("rb") as stream:
        first = next((line for line in lines(stream) if line.strip()), "")
    return is_heading(first, separator(first))


def is_heading(line: str, delimiter: str | None) -> bool:
    """Whether the line holds anything but numbers."""
    try:
        for word in line.split(delimiter):
            float(word)
    except ValueError:
        return True
    return False


def separator(line: str) -> str | None:
    """What stands between the numbers of a line; None for any white space."""
    return next((mark for mark in (";", ",", "\t") if mark in line), None)


def _header(stream: IO[bytes]) -> dict[str, float]:
    """The lines of the header, which end where a number begins."""
    header: dict[str, float] = {}
    while True:
        place = stream.tell()
        line = stream.readline(200).decode("ascii", "replace").split()
        if len(line) != 2 or line[0].lower() not in _HEADER:
            stream.seek(place)
            return header
        if not _NUMBER.fullmatch(line[1]) and line[1].lower() != "nan":
            raise SurfaceError(f"the header states {line[0]} {line[1][:20]!r}, which is not a number")
        header[line[0].lower()] = float(line[1])


def _count(header: dict[str, float], name: str) -> int:
    value = header.get(name, 0.0)
    if not (1 <= value <= 1e12 and value == int(value)):
        raise SurfaceError(f"the header must state {name}, a positive whole number")
    return int(value)


def _numbers(stream: IO[bytes], count: int) -> NDArray[np.float64]:
    """Exactly so many numbers, and nothing after them."""
    values = np.empty(count)
    done, rest = 0, b""
    while block := stream.read(2**20):
        text = rest + block
        cut = max(text.rfind(b" "), text.rfind(b"\n"), text.rfind(b"\t"), text.rfind(b"\r"))
        text, rest = text[: cut + 1], text[cut + 1 :]
        if len(rest) > _MAX_WORD:
            raise SurfaceError(f"{rest[:20]!r} is not a number")
        done = _fill(values, done, text)
    done = _fill(values, done, rest)
    if done < count:
        raise SurfaceError(f"the file ends after {done} of {count} numbers")
    return values


def _fill(values: NDArray[np.float64], done: int, text: bytes) -> int:
    words = text.split()
    if done + len(words) > len(values):
        raise SurfaceError(f"the file holds more than the {len(values)} numbers that its header claims")
    if max(map(len, words), default=0) > _MAX_WORD:  # NumPy gives every word the room of the longest
        raise SurfaceError("the file holds what is not a number")
    try:
        values[done : done + len(words)] = np.array(words, dtype="S").astype(np.float64) if words else ()
    except ValueError as error:
        raise SurfaceError(f"the file holds what is not a number ({str(error)[:80]})") from None
    return done + len(words)


def _in_degrees(header: dict[str, float], nx: int, ny: int, cell: float) -> bool:
    """Whether the grid lies where a map in degrees would. The format does not say, metres are far larger."""
    west = header.get("xllcorner", header.get("xllcenter", 0.0))
    south = header.get("yllcorner", header.get("yllcenter", 0.0))
    inside = -180 <= west <= 180 and west + nx * cell <= 361 and south >= -90 and south + ny * cell <= 91
    return inside and 1e-5 <= cell <= 1 and not (west == 0 and south == 0)
