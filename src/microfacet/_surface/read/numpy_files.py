"""Height maps in ``.npy`` and ``.npz`` files, parsed as hostile: no pickles, no size believed before it is
checked.

Nothing is allocated on the word of a header: the bytes that an array claims must be there (in the file, or in
the zip directory, whose sizes are limited first) before they are read.
"""

from __future__ import annotations

import io
import math
import warnings
import zipfile
from collections.abc import Collection
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy_format
from numpy.typing import NDArray

from microfacet._surface.checks import MAX_PIXELS, SurfaceError, short

__all__ = ["MAX_ARCHIVE_BYTES", "check_archive", "is_npy", "npz_names", "npz_shapes", "read_npy", "read_npz"]

#: The members of a zip file (npz, x3p, …) may unpack to at most this many bytes together.
MAX_ARCHIVE_BYTES = 2**30
_MAX_MEMBERS = 10_000
# A header is a short dict, however many bytes it claims to take; NumPy itself writes less than 1 KiB.
_MAX_HEADER_BYTES = 2**16
_MAX_ITEM_BYTES = 16
_BLOCK = 2**20


def is_npy(path: Path) -> bool:
    """Whether the file starts like a ``.npy`` file."""
    with path.open("rb") as file:
        return file.read(len(npy_format.MAGIC_PREFIX)) == npy_format.MAGIC_PREFIX


def read_npy(path: Path) -> NDArray[Any]:
    """The array of a ``.npy`` file."""
    with path.open("rb") as file:
        return _read_array(file, path.stat().st_size)


def npz_names(path: Path) -> list[str]:
    """The names of the arrays in a ``.npz`` file, whose sizes are within the limits."""
    check_archive(path)
    with zipfile.ZipFile(path) as archive:
        return [info.filename.removesuffix(".npy") for info in archive.infolist()]


def npz_shapes(path: Path) -> dict[str, tuple[int, ...]]:
    """The shapes that the arrays in a ``.npz`` file claim, by name, without their numbers."""
    check_archive(path)
    shapes = {}
    with zipfile.ZipFile(path) as archive:
        for info in archive.infolist():
            with archive.open(info) as member:
                head = member.read(_MAX_HEADER_BYTES)
            shapes[info.filename.removesuffix(".npy")] = _parse_header(head)[0]
    return shapes


def read_npz(path: Path, names: Collection[str]) -> dict[str, NDArray[Any]]:
    """Those of the named arrays that a ``.npz`` file has."""
    check_archive(path)
    arrays = {}
    with zipfile.ZipFile(path) as archive:
        for info in archive.infolist():
            name = info.filename.removesuffix(".npy")
            if name in names:
                # The other methods are not NumPy's, and an LZMA header may ask for gigabytes.
                if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                    raise SurfaceError(
                        f"the array {short(name)} is compressed by method {info.compress_type}"
                    )
                with archive.open(info) as member:
                    arrays[name] = _read_array(member, info.file_size)
    return arrays


def check_archive(path: Path) -> int:
    """Refuse a zip file whose directory promises more than `MAX_ARCHIVE_BYTES`; return what it promises.

    The directory is enough: no more than the promised bytes of a member are ever unpacked.
    """
    with zipfile.ZipFile(path) as archive:
        members = archive.infolist()
    total = sum(member.file_size for member in members)
    if total > MAX_ARCHIVE_BYTES or len(members) > _MAX_MEMBERS:
        raise SurfaceError(
            f"the archive unpacks to {len(members)} members of {total} bytes together, "
            f"the limit is {_MAX_MEMBERS} members of {MAX_ARCHIVE_BYTES} bytes"
        )
    return total


def _read_array(file: IO[bytes], size: int) -> NDArray[Any]:
    """The array in the `size` bytes of `file`, which is at its start."""
    head = file.read(min(size, _MAX_HEADER_BYTES))
    shape, fortran_order, dtype, start = _parse_header(head)
    if dtype.hasobject:
        raise SurfaceError("the array holds Python objects (a pickle), which are never loaded")
    if dtype.kind not in "biufcU" or (dtype.kind != "U" and dtype.itemsize > 2 * _MAX_ITEM_BYTES):
        raise SurfaceError(f"the array holds {dtype}, not numbers")
    count = math.prod(shape)
    if any(extent < 0 for extent in shape) or count > MAX_PIXELS:
        raise SurfaceError(f"the header claims an array of shape {shape}, the limit is {MAX_PIXELS} elements")
    needed = count * dtype.itemsize
    if start + needed > size:
        raise SurfaceError(
            f"the header claims {needed} bytes of data ({dtype}, {shape}), only {size - start} are there"
        )
    array = np.empty(shape, dtype, order="F" if fortran_order else "C")
    if needed:
        got = _fill(array, head[start:], file)
        if got < needed:
            raise SurfaceError(f"the file ends after {got} of {needed} bytes of data")
    array.flags.writeable = False  # nobody else has it: a Surface need not copy it
    return array


def _fill(array: NDArray[Any], first: bytes, file: IO[bytes]) -> int:
    """As many bytes of `first`, and then of the file, as the array takes; how many there were."""
    room = array.reshape(-1, order="A").view(np.uint8)
    done = min(len(first), len(room))
    room[:done] = np.frombuffer(first, np.uint8, count=done)
    while block := file.read(min(_BLOCK, len(room) - done)):
        room[done : done + len(block)] = np.frombuffer(block, np.uint8)
        done += len(block)
    return done


def _parse_header(head: bytes) -> tuple[tuple[int, ...], bool, np.dtype[Any], int]:
    """Shape, order, dtype, and where the data start; NumPy's own parser, fed with bounded bytes."""
    stream = io.BytesIO(head)
    version = npy_format.read_magic(stream)
    readers = {(1, 0): npy_format.read_array_header_1_0, (2, 0): npy_format.read_array_header_2_0}
    if version not in readers:
        raise SurfaceError(f"the NumPy format version is {version}, expected (1, 0) or (2, 0)")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # headers written by Python 2
        shape, fortran_order, dtype = readers[version](stream)
    return shape, fortran_order, dtype, stream.tell()
