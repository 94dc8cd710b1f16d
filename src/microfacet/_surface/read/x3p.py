"""Height maps in ``.x3p`` files (ISO 25178-72, formerly ISO 5436-2), parsed as hostile like `numpy_files`.

An x3p file is a zip archive: ``main.xml`` describes the axes and the size of the matrix, and holds the points
or names the member that does, little-endian and x fastest. Lengths are metres.
"""

from __future__ import annotations

import math
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import MAX_PIXELS, SurfaceError, short
from microfacet._surface.read import x3p_index
from microfacet._surface.read.numpy_files import MAX_ARCHIVE_BYTES, check_archive
from microfacet._surface.read.raw import RawMap, profile_error
from microfacet._surface.read.text_files import points
from microfacet._surface.read.x3p_index import Index

__all__ = ["index_name", "read_x3p", "read_x3p_lines"]

_BLOCK = 2**20
_TYPES = {"I": "<i2", "L": "<i4", "F": "<f4", "D": "<f8"}


def index_name(names: list[str]) -> str | None:
    """The member that is the index of an x3p file, which some writers put into a folder."""
    found = [name for name in names if name.rpartition("/")[2].lower() == "main.xml"]
    return min(found, key=lambda name: name.count("/"), default=None)


def read_x3p(path: Path) -> RawMap:
    """Heights in metres with nan where invalid.

    Offsets of the axes are left out: a height map is taken for its slopes.
    """
    check_archive(path)
    with zipfile.ZipFile(path) as archive:
        name, record, (nx, ny) = _index(archive)
        if min(nx, ny) == 1 or record.text("Record1/FeatureType") == "PRF":
            raise profile_error(f"{nx} x {ny} points")
        if record.points is not None:
            return _as_text(record, nx, ny)
        size = _increment(record, "CX"), _increment(record, "CY")
        heights = _matrix(archive, record, name.rpartition("/")[0], nx, ny)
    heights.flags.writeable = False  # ours alone: a Surface need not copy it
    return RawMap(heights, "x3p", size=size, unit="m", size_unit="m")


def read_x3p_lines(path: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions (n,) along a profile and heights (k, n) of its traces, in metres, nan where invalid."""
    check_archive(path)
    with zipfile.ZipFile(path) as archive:
        name, record, (nx, ny) = _index(archive)
        if min(nx, ny) > 1 and record.text("Record1/FeatureType") != "PRF":
            raise SurfaceError(f"this is a map of {nx} x {ny} pixels, not a profile")
        if record.points is None:
            heights = _matrix(archive, record, name.rpartition("/")[0], nx, ny)
        elif record.count < nx * ny:
            raise SurfaceError(f"main.xml holds {record.count} points, {nx * ny} are asked for")
        else:
            heights = record.points[:, 2].reshape(ny, nx) * record.number("Record1/Axes/CZ/Increment", 1.0)
    across = nx == 1  # a trace along y
    axis = "CY" if across else "CX"
    if record.text(f"Record1/Axes/{axis}/AxisType") == "A" and record.points is not None and min(nx, ny) == 1:
        step = record.number(f"Record1/Axes/{axis}/Increment", 1.0)
        return record.points[:, int(across)] * step, heights.reshape(1, -1)
    places = _increment(record, axis) * np.arange(ny if across else nx, dtype=np.float64)
    return places, heights.T if across else heights


def _index(archive: zipfile.ZipFile) -> tuple[str, Index, tuple[int, int]]:
    """The name of the index, what it says, and the size of the matrix."""
    name = index_name(archive.namelist()) or "main.xml"
    with _opened(archive, name, MAX_ARCHIVE_BYTES) as stream:
        record = x3p_index.parse(stream, archive.getinfo(name).file_size)
    nx, ny, nz = (record.whole(f"Record3/MatrixDimension/Size{axis}") for axis in "XYZ")
    if nz != 1:
        raise SurfaceError(f"the file holds {nz} layers of heights, one is needed")
    if nx * ny > MAX_PIXELS:
        raise SurfaceError(f"a map of {nx} x {ny} pixels exceeds the limit of {MAX_PIXELS} pixels")
    return name, record, (nx, ny)


def _matrix(archive: zipfile.ZipFile, record: Index, folder: str, nx: int, ny: int) -> NDArray[np.float64]:
    dtype = np.dtype(_TYPES[record.choice("Record1/Axes/CZ/DataType", _TYPES)])
    link = record.text("Record3/DataLink/PointDataLink")
    if link is None:
        raise SurfaceError("the file names no member that holds its points, nor does main.xml hold them")
    heights = np.empty((ny, nx))
    _fill(heights.reshape(-1), archive, _member(archive, folder, link), dtype)
    heights *= record.number("Record1/Axes/CZ/Increment", 1.0)
    mask = record.text("Record3/DataLink/ValidPointsLink")
    if mask is not None:
        bits = np.empty((nx * ny + 7) // 8, np.uint8)
        _fill(bits, archive, _member(archive, folder, mask), bits.dtype)
        valid = np.unpackbits(bits, count=nx * ny, bitorder="little").view(np.bool_)
        np.copyto(heights, math.nan, where=~valid.reshape(ny, nx))
    return heights


def _as_text(record: Index, nx: int, ny: int) -> RawMap:
    """Points that stand in the index, as matrix of z or with positions on a grid."""
    values = record.points
    if values is None or record.count < nx * ny:
        raise SurfaceError(f"main.xml holds {record.count} points, its matrix of {nx} x {ny} asks for more")
    step = "points read as text"
    for column, axis in enumerate(("CX", "CY", "CZ")):
        values[:, column] *= record.number(f"Record1/Axes/{axis}/Increment", 1.0)
    if record.text("Record1/Axes/CX/AxisType") == record.text("Record1/Axes/CY/AxisType") == "A":
        gridded = points.grid(*values.T)
        heights, size = gridded.heights, gridded.size
        step += " and put on their grid"
    else:
        size = _increment(record, "CX"), _increment(record, "CY")
        heights = values[:, 2].reshape(ny, nx).copy()
    return RawMap(heights, "x3p", size=size, unit="m", size_unit="m", steps=(step,))


def _member(archive: zipfile.ZipFile, folder: str, link: str) -> str:
    """The member that a link means: seen from the folder of the index, or from the root."""
    near = f"{folder}/{link}" if folder else link
    return near if near in archive.NameToInfo else link


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


def _increment(record: Index, axis: str) -> float:
    if record.text(f"Record1/Axes/{axis}/AxisType") != "I":
        raise SurfaceError(f"the pixels are not equally spaced along {axis[1]}")
    return record.number(f"Record1/Axes/{axis}/Increment")
