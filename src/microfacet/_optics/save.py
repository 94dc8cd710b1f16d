"""Files of a table: which writer a path means, one file a wavelength where a format holds one."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from microfacet._files import replacing
from microfacet._optics import programs, records

if TYPE_CHECKING:
    from microfacet._optics.brdf import BrdfTable

__all__ = ["FORMATS", "check_format", "format_of", "save", "says_format"]

_WRITERS: dict[str, Callable[[BrdfTable, BinaryIO], None]] = {
    "csv": records.csv,
    "netcdf": records.netcdf,
    "astm": programs.astm,
}
_ONE_WAVELENGTH: dict[str, Callable[[BrdfTable, int, BinaryIO], None]] = {
    "zemax": programs.zemax,
    "lighttools": programs.lighttools,
}
FORMATS = (*_WRITERS, *_ONE_WAVELENGTH)
_OF_ENDING = {".csv": "csv", ".nc": "netcdf", ".astm": "astm"}


def format_of(path: str | os.PathLike[str], format: str | None = None) -> str:
    """The format that a path or a name means; ValueError says what is allowed."""
    if format is not None:
        if format not in FORMATS:
            raise ValueError(f"format must be one of {', '.join(FORMATS)}, got {format!r:.60}")
        return format
    suffix = Path(path).suffix.lower()
    if suffix == ".bsdf":
        raise ValueError('files of several programs end in .bsdf: give format "zemax" or "lighttools"')
    if suffix not in _OF_ENDING:
        endings = ", ".join((*_OF_ENDING, ".bsdf"))
        raise ValueError(f"path must end in {endings} or have a format, got {os.fspath(path)!r:.200}")
    return _OF_ENDING[suffix]


def says_format(path: str | os.PathLike[str]) -> bool:
    """Whether the ending of a path says its format."""
    return Path(path).suffix.lower() in _OF_ENDING


def check_format(table: BrdfTable, format: str) -> None:
    """ValueError where a format cannot hold the table."""
    if format == "netcdf":
        records.require_netcdf()
    if format == "zemax" and table.reference != "specular":
        raise ValueError('zemax: angles count from the specular direction, make the table with "specular"')
    if format in ("astm", "lighttools") and table.reference != "normal":
        raise ValueError(f'{format}: angles count from the normal, make the table with reference "normal"')


def save(table: BrdfTable, path: str | os.PathLike[str], format: str | None = None) -> list[str]:
    """What `BrdfTable.save` says."""
    chosen = format_of(path, format)
    check_format(table, chosen)
    if chosen in _WRITERS:
        with replacing(Path(path)) as stream:
            _WRITERS[chosen](table, stream)
        return [os.fspath(path)]
    paths = [_numbered(Path(path), wavelength, len(table.wavelengths)) for wavelength in table.wavelengths]
    for number, one in enumerate(paths):
        with replacing(one) as stream:
            _ONE_WAVELENGTH[chosen](table, number, stream)
    return paths


def _numbered(path: Path, wavelength: float, count: int) -> str:
    return str(path if count == 1 else path.with_name(f"{path.stem}_{1e9 * wavelength:g}nm{path.suffix}"))
