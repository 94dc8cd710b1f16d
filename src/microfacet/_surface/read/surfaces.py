"""`read_surface`: from a path to a `Surface`, or to one sentence that says why not."""

from __future__ import annotations

import contextlib
import os
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet import _optional
from microfacet._surface.checks import METRES_PER_UNIT, SurfaceError, checked_file, pixel_sizes, short
from microfacet._surface.read import images, library, numpy_files, text_files, x3p
from microfacet._surface.surface import Surface
from microfacet._text import listed, printable

__all__ = ["read_surface"]

_NPZ_KEYS = ("pixel_size", "dx", "dy", "mask", "unit")


def read_surface(
    path: str | os.PathLike[str],
    channel: int | str | None = None,
    pixel_size: float | tuple[float, float] | None = None,
    unit: str | None = None,
    height_scale: float | None = None,
) -> Surface:
    """Read a measured height map.

    ``.npy`` and ``.npz`` (never unpickling anything), ``.x3p`` (ISO 25178-72, a matrix of binary heights),
    ESRI ASCII grids and plain tables of numbers are read here. Images (PNG, TIFF, GeoTIFF, EXR) and every
    other format (Bruker ``.di`` and ``.spm``, Park ``.tiff``, Wyko ``.opd``, ``.sur``, ``.al3d``, ``.gwy``,
    …, about 40) are read by the libraries of the optional extra ``surface``, in a process of
    their own with bounded memory and time. What is not finite in the file or marked as invalid there becomes
    a masked pixel.

    Parameters
    ----------
    path : path-like
        The file. A ``.npy`` file holds the heights alone. A ``.npz`` file holds ``heights`` (ny, nx) and
        optionally ``pixel_size`` (one number or two) or ``dx`` and ``dy``, ``mask`` (True = valid) and
        ``unit`` (a string, the unit of the heights and of the pixel size). The heights may have another name
        if no other array has one.
    channel : int or str, optional
        Which map of a file with several: its index or name; in a ``.npz`` file the name of the array of
        heights. By default the first map of heights.
    pixel_size : float or (float, float), optional
        Pixel size ``(dx, dy)`` in metres, for files that do not state one. It replaces what the file states.
    unit : str, optional
        The unit of lengths in the file, for files that do not state one: km, m, cm, mm, um, nm, A, pm or fm;
        metres by default for ``.npy``, ``.npz``, text and GeoTIFF. A file that states another unit is an
        error.
    height_scale : float, optional
        Metres per grey level, for images: PNG and TIFF of 16 or 32 bits, or EXR. (8 bits are refused: 256
        heights leave no slopes to look at.) GeoTIFF heights are metres without it.

    Returns
    -------
    Surface
        Heights in metres, unlevelled.

    Raises
    ------
    SurfaceError
        One sentence: the file cannot be read or is not a height map, a pixel size or unit is missing, no
        height is valid, all heights are equal, or a limit is exceeded (files of 1 GiB, archives that unpack
        to 1 GiB, maps of 2**26 pixels).

    Examples
    --------
    >>> import numpy, os, tempfile
    >>> heights = numpy.add.outer(numpy.arange(5.0) ** 2, numpy.arange(4.0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = os.path.join(folder, "map.npz")
    ...     numpy.savez(file, heights=heights, pixel_size=20.0, unit="nm")
    ...     surface = read_surface(file)
    >>> surface.heights.shape, surface.pixel_size, surface.unit
    ((5, 4), (2e-08, 2e-08), 'nm')
    """
    file = Path(path)
    if unit is not None and unit not in METRES_PER_UNIT:
        raise SurfaceError(f"unit must be one of {', '.join(METRES_PER_UNIT)}, got {short(unit)}")
    size = None if pixel_size is None else pixel_sizes(pixel_size)
    if height_scale is not None and (unit is not None or file.suffix.lower() not in images.SUFFIXES):
        raise SurfaceError("height_scale is for images, in metres per grey level and without a unit")
    with checked_file(file):
        if file.suffix.lower() == ".npz":
            surface = _from_npz(file, channel, size, unit)
        elif file.suffix.lower() == ".npy" or numpy_files.is_npy(file):
            surface = _from_npy(file, channel, size, unit)
        elif file.suffix.lower() == ".x3p":
            surface = _from_x3p(file, channel, size, unit)
        else:
            surface = (
                _from_image(file, channel, size, unit, height_scale)
                or _from_text(file, channel, size, unit)
                or _from_library(file, channel, size, unit)
            )
        valid: dict[str, Any] = {"where": surface.mask}
        if np.min(surface.heights, initial=np.inf, **valid) == np.max(
            surface.heights, initial=-np.inf, **valid
        ):
            raise SurfaceError("all heights are equal, which leaves no slopes to look at")
        return surface


def _from_npy(
    file: Path, channel: int | str | None, size: tuple[float, float] | None, unit: str | None
) -> Surface:
    if channel is not None:
        raise SurfaceError(f"a .npy file holds one array, so there is no channel {short(channel)}")
    if size is None:
        raise SurfaceError(
            "a .npy file does not state the pixel size, give pixel_size (--pixel-size) in metres"
        )
    return _surface(file, numpy_files.read_npy(file), size, unit or "m", ("pixel size given by the caller",))


def _from_npz(
    file: Path, channel: int | str | None, size: tuple[float, float] | None, unit: str | None
) -> Surface:
    wanted = _npz_channel(numpy_files.npz_names(file), channel)
    arrays = numpy_files.read_npz(file, (wanted, *_NPZ_KEYS))
    unit = _agreed_unit(str(arrays["unit"].item()) if "unit" in arrays else None, unit) or "m"
    steps: tuple[str, ...] = ("pixel size given by the caller",)
    if size is None:
        steps = ()
        stated = arrays.get("pixel_size")
        if stated is None and "dx" in arrays and "dy" in arrays:
            stated = np.array([arrays["dx"].item(), arrays["dy"].item()])
        if stated is None:
            raise SurfaceError(
                "the file states neither pixel_size nor dx and dy, give pixel_size (--pixel-size) in metres"
            )
        size = _in_metres(pixel_sizes(stated), unit)
    return _surface(file, arrays[wanted], size, unit, steps, arrays.get("mask"))


def _npz_channel(names: list[str], channel: int | str | None) -> str:
    """The array that holds the heights: the named one, ``heights``, or the only one of an unknown name."""
    if channel is not None and not isinstance(channel, str):
        raise SurfaceError(f"the channel of a .npz file is the name of an array, got {short(channel)}")
    wanted = channel or "heights"
    others = [name for name in names if name not in _NPZ_KEYS]
    if wanted in names:
        return wanted
    if channel is None and len(others) == 1:
        return others[0]
    found = listed(sorted(names)) or "nothing"
    raise SurfaceError(f"there is no array {short(wanted)} (found: {found}), name the heights with channel=")


def _from_x3p(
    file: Path, channel: int | str | None, size: tuple[float, float] | None, unit: str | None
) -> Surface:
    if channel not in (None, 0):
        raise SurfaceError(f"a .x3p file holds one map, so there is no channel {short(channel)}")
    heights, stated = x3p.read_x3p(file)
    steps = () if size is None else ("pixel size given by the caller",)
    return _surface(file, heights, size or stated, _agreed_unit("m", unit) or "m", steps)


def _from_image(
    file: Path,
    channel: int | str | None,
    size: tuple[float, float] | None,
    unit: str | None,
    height_scale: float | None,
) -> Surface | None:
    if file.suffix.lower() not in images.SUFFIXES:
        return None
    image = images.read(file, channel, height_scale, stated_unit=unit is not None, sized=size is not None)
    if image is None:
        return None
    steps = image.steps if size is None else (*image.steps, "pixel size given by the caller")
    if size is None and image.pixel_size is None:
        raise SurfaceError(
            "the image does not state its pixel size, give pixel_size (--pixel-size) in metres"
        )
    size = size or pixel_sizes(image.pixel_size)  # GeoTIFF: metres
    return _surface(file, image.heights, size, "m" if image.in_metres else unit or "m", steps)


def _from_text(
    file: Path, channel: int | str | None, size: tuple[float, float] | None, unit: str | None
) -> Surface | None:
    if file.suffix.lower() not in text_files.SUFFIXES:
        return None
    esri = text_files.is_esri(file)
    if not esri and size is None:
        if text_files.has_heading(file) and _optional.installed("SurfaceTopography"):  # it may state the size
            with contextlib.suppress(SurfaceError):
                return _from_library(file, channel, size, unit)
        raise SurfaceError("the text does not state the pixel size, give pixel_size (--pixel-size) in metres")
    if channel not in (None, 0):
        raise SurfaceError(f"a grid of numbers is one map, so there is no channel {short(channel)}")
    grid = text_files.read_esri(file) if esri else text_files.read_plain(file)
    if grid.in_degrees and size is None:
        raise SurfaceError(
            "the cells are in degrees by their size and place, give pixel_size (--pixel-size) in metres"
        )
    unit = unit or "m"
    steps: tuple[str, ...] = ("rows turned so that y runs north",) if esri else ()
    if size is not None:
        steps += ("pixel size given by the caller",)
    return _surface(file, grid.heights, size or _in_metres(pixel_sizes(grid.pixel_size), unit), unit, steps)


def _from_library(
    file: Path, channel: int | str | None, size: tuple[float, float] | None, unit: str | None
) -> Surface:
    size_on_disk = file.stat().st_size
    unpacked = numpy_files.check_archive(file) if zipfile.is_zipfile(file) else 0
    # Heights pack a few times, a bomb packs a thousand times: that alone earns no memory.
    content = max(size_on_disk, min(unpacked, 20 * size_on_disk))
    found = library.read(file, channel, bytes_to_read=content)
    unit = _agreed_unit(found.unit, unit)
    if unit is None:
        raise SurfaceError("the file does not state its unit of length, give unit=, for example unit='um'")
    steps: tuple[str, ...] = (f"read channel {short(found.channel)} with SurfaceTopography",)
    if size is not None:
        steps += ("pixel size given by the caller",)
    elif found.pixel_size is not None:
        size = _in_metres(found.pixel_size, unit)
    else:
        raise SurfaceError("the file does not state its pixel size, give pixel_size (--pixel-size) in metres")
    return _surface(file, found.heights, size, unit, steps)


def _agreed_unit(stated: str | None, given: str | None) -> str | None:
    if stated is not None and stated not in METRES_PER_UNIT:
        raise SurfaceError(f"the file states the unit {stated[:20]!r}, which is not a known length")
    if stated is not None and given is not None and METRES_PER_UNIT[stated] != METRES_PER_UNIT[given]:
        raise SurfaceError(f"the file states the unit {stated}, not {given}")
    return stated or given


def _in_metres(size: tuple[float, float], unit: str) -> tuple[float, float]:
    return size[0] * METRES_PER_UNIT[unit], size[1] * METRES_PER_UNIT[unit]


def _surface(
    file: Path,
    heights: NDArray[Any],
    size: tuple[float, float],
    unit: str,
    steps: tuple[str, ...],
    mask: NDArray[Any] | None = None,
) -> Surface:
    surface = Surface(heights, size, mask, unit=unit, source=printable(file.name, 255), steps=steps)  # type: ignore[arg-type]
    factor = METRES_PER_UNIT[unit]
    return surface if factor == 1.0 else replace(surface, heights=surface.heights * factor)
