"""What a file is, by its content: its ending decides only where the content does not."""

from __future__ import annotations

import gzip
import tempfile
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from microfacet._surface.checks import MAX_FILE_BYTES, SurfaceError
from microfacet._surface.read import images, library, numpy_files, surfer, text_files, x3p

__all__ = ["kind_of", "text_format", "unpacked"]

_GZIP = b"\x1f\x8b"
_START = 2**14
_BLOCK = 2**20
# Text packs ten times, a bomb packs a thousand times: what is small may unpack to this much all the same.
_PACKED, _SMALL = 100, 2**26
_ARCHIVES = (b"PK\x03\x04", b"PK\x05\x06")
_BY_ENDING = {
    ".npy": "npy", ".npz": "npz", ".x3p": "x3p", ".png": "image", ".tif": "image", ".tiff": "image",
    ".exr": "image", ".jpg": "image", ".jpeg": "image",
}  # fmt: skip


def kind_of(file: Path) -> str:
    """npy, npz, x3p, image, surfer, esri, text, or other, which libraries know."""
    with file.open("rb") as stream:
        start = stream.read(_START)
    ending = _BY_ENDING.get(file.suffix.lower())
    if numpy_files.is_npy(file):
        return "npy"
    if start.startswith(_ARCHIVES):
        return _archive(file, ending)
    if start.startswith(images.STARTS):
        return "image"
    if start.startswith(surfer.STARTS):
        return "surfer"
    if ending is not None:
        return ending
    if text_files.is_esri(start):
        return "esri"
    return "text" if text_files.is_text(file) else "other"


def text_format(file: Path) -> str | None:
    """The format of the library that a text is in, where it is none of ours."""
    with file.open("rb") as stream:
        start = stream.read(_START)
    for name, marks in library.TEXT_FORMATS.items():
        if start.startswith(marks) if name == "sdf" else any(mark in start for mark in marks):
            return name
    return None


@contextmanager
def unpacked(file: Path) -> Iterator[Path]:
    """The file, or what a .gz file holds, in a folder that goes again."""
    with file.open("rb") as stream:
        if stream.read(2) != _GZIP:
            yield file
            return
    most = min(MAX_FILE_BYTES, max(_SMALL, _PACKED * file.stat().st_size))
    name = file.stem if file.suffix.lower() == ".gz" else file.name
    with tempfile.TemporaryDirectory(prefix="microfacet-") as folder:
        inner = Path(folder, f"map{Path(name).suffix[:16]}")
        _unpack(file, inner, most)
        if inner.stat().st_size == 0:
            raise SurfaceError("the packed file is empty")
        yield inner


def _unpack(file: Path, inner: Path, most: int) -> None:
    done = 0
    try:
        with gzip.open(file) as source, inner.open("wb") as target:
            while block := source.read(_BLOCK):
                done += len(block)
                if done > most:
                    raise SurfaceError(f"the file unpacks to more than {most} bytes")
                target.write(block)
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise SurfaceError(f"the packed file is damaged ({error})") from None


def _archive(file: Path, ending: str | None) -> str:
    if not zipfile.is_zipfile(file):
        return ending or "other"
    with zipfile.ZipFile(file) as archive:
        names = archive.namelist()
    if x3p.index_name(names) and ending != "npz":
        return "x3p"
    if any(name.endswith(".npy") for name in names):
        return "npz"
    return ending or "other"
