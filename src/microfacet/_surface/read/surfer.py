"""Surfer grids (Golden Software): text (DSAA), version 6 (DSBB) and version 7 (DSRB)."""

from __future__ import annotations

import math
import struct
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import SurfaceError
from microfacet._surface.read.raw import RawMap
from microfacet._surface.read.text_files.words import check_size, numbers, whole

__all__ = ["STARTS", "read_surfer"]

STARTS = (b"DSAA", b"DSBB", b"DSRB")
#: A node of this height or more has none; the text holds six digits of it.
_BLANK = 1.70141e38
_MOST_SECTIONS = 100
# Tags of version 7: these letters as an integer.
_GRID, _DATA = (int.from_bytes(letters, "little") for letters in (b"GRID", b"DATA"))


def read_surfer(file: Path) -> RawMap:
    """The grid, whose rows run north in the file; nodes stand at the ends, so n of them span n - 1 steps."""
    with file.open("rb") as stream:
        start = stream.read(4)
        rest = file.stat().st_size - 4
        read = {b"DSAA": _text, b"DSBB": _version_6, b"DSRB": _version_7}[start]
        heights, size = read(stream, rest)
    return RawMap(heights, "Surfer grid", size=size, usual="m", convention=False)


def _text(stream: IO[bytes], rest: int) -> tuple[NDArray[np.float64], tuple[float, float]]:
    words: list[float] = []
    while len(words) < 8:
        line = stream.readline(400)
        if not line:
            raise SurfaceError("the file ends within its header")
        try:
            words += [float(word) for word in line.replace(b",", b".").split()]
        except ValueError:
            raise SurfaceError(f"the header holds {line[:30]!r}, which are no numbers") from None
    if len(words) > 8:
        raise SurfaceError("the header must be five lines: DSAA, and two numbers in each of the others")
    nx, ny = whole(words[0], "the number of columns"), whole(words[1], "the number of rows")
    check_size(nx, ny, rest)
    heights = numbers(stream, nx * ny).reshape(ny, nx)
    heights[heights >= _BLANK] = math.nan
    return heights, _steps(nx, ny, (words[2], words[3], words[4], words[5]))


def _version_6(stream: IO[bytes], rest: int) -> tuple[NDArray[np.float64], tuple[float, float]]:
    nx, ny, *ends = _unpack(stream, "<hh6d")
    nx, ny = whole(nx, "the number of columns"), whole(ny, "the number of rows")
    check_size(nx, ny, rest, 4)
    heights = _array(stream, "<f4", nx, ny)
    heights[heights >= np.float32(_BLANK)] = math.nan
    return heights, _steps(nx, ny, (ends[0], ends[1], ends[2], ends[3]))


def _version_7(stream: IO[bytes], rest: int) -> tuple[NDArray[np.float64], tuple[float, float]]:
    size, version = _unpack(stream, "<ii")
    _skip(stream, size - 4)
    grid: tuple[float, ...] | None = None
    for _ in range(_MOST_SECTIONS):
        tag, size = _unpack(stream, "<ii")
        if tag == _GRID:
            grid = _unpack(stream, "<ii8d")
            _skip(stream, size - 72)
        elif tag == _DATA and grid is not None:
            rows, columns, _, _, dx, dy, _, _, rotation, blank = grid
            nx, ny = whole(columns, "the number of columns"), whole(rows, "the number of rows")
            check_size(nx, ny, int(min(rest, size)), 8)
            heights = _array(stream, "<f8", nx, ny)
            heights[heights >= blank if version == 1 else heights == blank] = math.nan
            if rotation:
                raise SurfaceError(f"the grid is turned by {rotation:g} degrees, which is not supported")
            return heights, (dx, dy)
        else:
            _skip(stream, size)
    raise SurfaceError("the file holds no grid")


def _unpack(stream: IO[bytes], form: str) -> tuple[float, ...]:
    data = stream.read(struct.calcsize(form))
    if len(data) < struct.calcsize(form):
        raise SurfaceError("the file ends within its header")
    return struct.unpack(form, data)


def _skip(stream: IO[bytes], size: float) -> None:
    if size < 0:
        raise SurfaceError("a section of the file states a negative size")
    stream.seek(int(size), 1)


def _array(stream: IO[bytes], dtype: str, nx: int, ny: int) -> NDArray[np.float64]:
    size = nx * ny * np.dtype(dtype).itemsize
    data = stream.read(size)
    if len(data) < size:
        raise SurfaceError(f"the file ends after {len(data)} of {size} bytes of heights")
    return np.frombuffer(data, dtype).astype(np.float64).reshape(ny, nx)


def _steps(nx: int, ny: int, ends: tuple[float, float, float, float]) -> tuple[float, float]:
    if min(nx, ny) < 2:
        raise SurfaceError(f"a grid of {nx} x {ny} nodes is no map")
    return (ends[1] - ends[0]) / (nx - 1), (ends[3] - ends[2]) / (ny - 1)
