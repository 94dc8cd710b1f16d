"""Height maps in ``.x3p`` files (ISO 25178-72, formerly ISO 5436-2), parsed as hostile like `numpy_files`.

An x3p file is a zip archive: ``main.xml`` describes the axes and the size of the matrix, and names the member
that holds the heights, little-endian and x fastest. Lengths are metres.
"""

from __future__ import annotations

import math
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import MAX_PIXELS, SurfaceError, short
from microfacet._surface.read.numpy_files import check_archive

__all__ = ["read_x3p"]

_MAX_XML_BYTES = 2**20
_BLOCK = 2**20
_TYPES = {"I": "<i2", "L": "<i4", "F": "<f4", "D": "<f8"}


def read_x3p(path: Path) -> tuple[NDArray[np.float64], tuple[float, float]]:
    """Heights (ny, nx) in metres with nan where invalid, and the pixel size (dx, dy) in metres.

    Offsets of the axes are left out: a height map is taken for its slopes.
    """
    check_archive(path)
    with zipfile.ZipFile(path) as archive:
        with _opened(archive, "main.xml", _MAX_XML_BYTES) as index:
            record = ElementTree.fromstring(index.read(_MAX_XML_BYTES))
        nx, ny, nz = (_size(record, f"Record3/MatrixDimension/Size{axis}") for axis in "XYZ")
        if nz != 1:
            raise SurfaceError(f"the file holds {nz} layers of heights, one is needed")
        if nx * ny > MAX_PIXELS:
            raise SurfaceError(f"a map of {nx} x {ny} pixels exceeds the limit of {MAX_PIXELS} pixels")
        pixel_size = (_increment(record, "CX"), _increment(record, "CY"))
        dtype = np.dtype(_TYPES[_choice(record, "Record1/Axes/CZ/DataType", _TYPES)])
        link = _text(record, "Record3/DataLink/PointDataLink")
        if link is None:
            raise SurfaceError("the file keeps its points as text or as a list, not as a binary matrix")
        heights = np.empty((ny, nx))
        _fill(heights.reshape(-1), archive, link, dtype)
        heights *= _number(record, "Record1/Axes/CZ/Increment", 1.0)
        mask = _text(record, "Record3/DataLink/ValidPointsLink")
        if mask is not None:
            bits = np.empty((nx * ny + 7) // 8, np.uint8)
            _fill(bits, archive, mask, bits.dtype)
            valid = np.unpackbits(bits, count=nx * ny, bitorder="little").view(np.bool_)
            np.copyto(heights, math.nan, where=~valid.reshape(ny, nx))
    heights.flags.writeable = False  # ours alone: a Surface need not copy it
    return heights, pixel_size


@contextmanager
def _opened(archive: zipfile.ZipFile, name: str, most: int) -> Iterator[IO[bytes]]:
    try:
        info = archive.getinfo(name)
    except KeyError:
        raise SurfaceError(f"the archive has no member {short(name)}") from None
    if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise SurfaceError(f"{short(name)} is compressed by method {info.compress_type}")
    if info.file_size > most:
        raise SurfaceError(f"{short(name)} has {info.file_size} bytes, {most} are expected at most")
    with archive.open(info) as member:
        yield member


def _fill(values: NDArray[Any], archive: zipfile.ZipFile, name: str, dtype: np.dtype[Any]) -> None:
    """All of a member, which holds as many numbers of a type, block by block."""
    done, size = 0, values.size * dtype.itemsize
    with _opened(archive, name, size) as member:
        while block := member.read(min(_BLOCK, size - done * dtype.itemsize)):
            numbers = np.frombuffer(block, dtype, count=len(block) // dtype.itemsize)
            values[done : done + len(numbers)] = numbers
            done += len(numbers)
            if len(block) % dtype.itemsize:
                break
        if done < values.size:
            got = archive.getinfo(name).file_size
            raise SurfaceError(f"{short(name)} has {got} bytes, the size of the map asks for {size}")


def _text(record: ElementTree.Element, path: str) -> str | None:
    text = record.findtext(path)
    return text.strip() if text and text.strip() else None


def _choice(record: ElementTree.Element, path: str, choices: dict[str, str]) -> str:
    text = _text(record, path)
    if text not in choices:
        raise SurfaceError(f"main.xml: {path} must be one of {', '.join(choices)}, got {str(text)[:20]!r}")
    return text


def _number(record: ElementTree.Element, path: str, default: float | None = None) -> float:
    text = _text(record, path)
    if text is None and default is not None:
        return default
    try:
        return float(text or "")
    except ValueError:
        raise SurfaceError(f"main.xml: {path} must be a number, got {str(text)[:20]!r}") from None


def _increment(record: ElementTree.Element, axis: str) -> float:
    if _text(record, f"Record1/Axes/{axis}/AxisType") != "I":
        raise SurfaceError(f"the pixels are not equally spaced along {axis[1]}")
    return _number(record, f"Record1/Axes/{axis}/Increment")


def _size(record: ElementTree.Element, path: str) -> int:
    text = _text(record, path)
    if text is None or not text.isdecimal() or len(text) > 12 or int(text) < 1:
        raise SurfaceError(f"main.xml: {path} must be a positive whole number, got {str(text)[:20]!r}")
    return int(text)
