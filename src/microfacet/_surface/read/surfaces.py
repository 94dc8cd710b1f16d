"""`read_surface`: from a path to a `Surface`, or to one sentence that says why not."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from microfacet import _optional
from microfacet._surface.checks import SurfaceError, checked_file, pixel_sizes, short
from microfacet._surface.read import images, kinds, library, numpy_files, surfer, text_files, x3p
from microfacet._surface.read.complete import Options, all_equal, complete
from microfacet._surface.read.raw import RawMap, profile_error, slopes_error
from microfacet._surface.read.units import unit_name
from microfacet._surface.surface import Surface
from microfacet._text import listed

__all__ = ["NPZ_KEYS", "raw_map", "read_surface"]

NPZ_KEYS = ("pixel_size", "dx", "dy", "mask", "unit")
_ONE_MAP = {
    "x3p": "a .x3p file",
    "surfer": "a Surfer grid",
    "esri": "a grid of numbers",
    "npy": "a .npy file",
}


def read_surface(
    path: str | os.PathLike[str],
    channel: int | str | None = None,
    pixel_size: float | tuple[float, float] | None = None,
    unit: str | None = None,
    height_scale: float | None = None,
) -> Surface:
    """Read a measured height map.

    The content decides what a file is, not its name; ``.gz`` is unpacked. NumPy's ``.npy`` and ``.npz``
    (never unpickling anything), ``.x3p`` (ISO 25178-72), ESRI, GRASS and Surfer grids, tables of numbers and
    lists of points x, y, z as text are read here. Images (PNG, TIFF, GeoTIFF, EXR) and every other format
    (Bruker ``.di`` and ``.spm``, MetroPro ``.dat``, Park ``.tiff``, Wyko ``.opd``, ``.sur``, ``.al3d``,
    ``.gwy``, …, about 40) are read by the libraries of the optional extra ``surface``, in a process of
    their own with bounded memory and time. What is not finite in the file, marked as invalid there, or a word
    instead of a number, becomes a masked pixel.

    Parameters
    ----------
    path : path-like
        The file. A ``.npy`` file holds the heights alone. A ``.npz`` file holds ``heights`` (ny, nx) and
        optionally ``pixel_size`` (one number or two) or ``dx`` and ``dy``, ``mask`` (True = valid) and
        ``unit`` (a string, the unit of the heights and of the pixel size). The heights may have another name
        if no other array has one. Sizes and units that stand in the heading of a text are heeded.
    channel : int or str, optional
        Which map of a file with several: its index or name; in a ``.npz`` file the name of the array of
        heights, in a TIFF of several pages ``"page 2"`` or 2. By default the first map of heights.
    pixel_size : float or (float, float), optional
        Pixel size ``(dx, dy)`` in metres, for files that do not state one. It replaces what the file states,
        with a warning; a heading of text that states another size is an error.
    unit : str, optional
        The unit of lengths in the file, for files that do not state one: km, m, cm, mm, um, nm, A, pm or fm;
        metres by default for ``.npy``, ``.npz``, tables of text (with a warning), grids and GeoTIFF. Points
        x, y, z have no default. A file that states another unit is an error.
    height_scale : float, optional
        Metres per grey level, for images: PNG and TIFF of 8, 16 or 32 bits (8 with a warning that gives the
        step), or EXR. GeoTIFF heights are metres without it.

    Returns
    -------
    Surface
        Heights in metres, unlevelled. `Surface.steps` say what was done, `Surface.warnings` what is doubtful.

    Raises
    ------
    SurfaceError
        One sentence: the file cannot be read or is not a height map, a pixel size or unit is missing or
        contradicts the file, no height is valid, all heights are equal, or a limit is exceeded (files of
        1 GiB, archives that unpack to 1 GiB, maps of 2**26 pixels).

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
    options = Options.checked(pixel_size, unit, height_scale)
    with checked_file(file), np.errstate(over="ignore", invalid="ignore"):  # what overflows is no height
        with kinds.unpacked(file) as inner:
            surface = complete(file, raw_map(inner, channel), options)
        if all_equal(surface):
            raise SurfaceError("all heights are equal, which leaves no slopes to look at")
        return surface


def raw_map(file: Path, channel: int | str | None) -> RawMap:
    """What the file states, whatever it is."""
    kind = kinds.kind_of(file)
    if kind in _ONE_MAP and channel not in (None, 0):
        raise SurfaceError(f"{_ONE_MAP[kind]} holds one map, so there is no channel {short(channel)}")
    return _READERS[kind](file, channel)


def _npy(file: Path, _: int | str | None) -> RawMap:
    array = numpy_files.read_npy(file)
    if array.ndim == 1 or (array.ndim == 2 and array.shape[1] == 1):
        raise profile_error(f"an array of shape {array.shape}, and a map is 2-D")
    asks = "a .npy file does not state the pixel size, give pixel_size (--pixel-size) in metres"
    return RawMap(array, "array", usual="m", no_size=asks)


def _npz(file: Path, channel: int | str | None) -> RawMap:
    wanted = _npz_channel(numpy_files.npz_names(file), channel)
    arrays = numpy_files.read_npz(file, (wanted, *NPZ_KEYS))
    unit = unit_name(str(arrays["unit"].item())) if "unit" in arrays else None
    stated = arrays.get("pixel_size")
    if stated is None and "dx" in arrays and "dy" in arrays:
        stated = np.array([arrays["dx"].item(), arrays["dy"].item()])
    return RawMap(
        arrays[wanted],
        "arrays",
        size=None if stated is None else pixel_sizes(stated),
        unit=unit,
        usual="m",
        channel=wanted,
        mask=arrays.get("mask"),
        no_size="the file states neither pixel_size nor dx and dy, give pixel_size (--pixel-size) in metres",
    )


def _npz_channel(names: list[str], channel: int | str | None) -> str:
    """The array that holds the heights: the named one, ``heights``, or the only one of an unknown name."""
    if channel is not None and not isinstance(channel, str):
        raise SurfaceError(f"the channel of a .npz file is the name of an array, got {short(channel)}")
    wanted = channel or "heights"
    others = [name for name in names if name not in NPZ_KEYS]
    if wanted in names:
        return wanted
    if channel is None and (others == ["slopes"] or sorted(others) == ["p", "q"]):
        raise slopes_error()
    if channel is None and len(others) == 1:
        return others[0]
    found = listed(sorted(names)) or "nothing"
    raise SurfaceError(f"there is no array {short(wanted)} (found: {found}), name the heights with channel=")


def _image(file: Path, channel: int | str | None) -> RawMap:
    return images.read(file, channel) or library.read(file, channel)


def _text(file: Path, channel: int | str | None) -> RawMap:
    form = kinds.text_format(file)
    if form is not None:
        return library.read(file, channel, (form,))
    try:
        return text_files.read_map(file, channel)
    except text_files.NoTable as error:  # some instruments write much text before their data
        if not _optional.installed("SurfaceTopography") and file.suffix.lower() in text_files.SUFFIXES:
            raise
        try:
            return library.read(file, channel)
        except SurfaceError:
            if file.suffix.lower() in text_files.SUFFIXES:
                raise error from None
            raise


def _alone(read: Callable[[Path], RawMap]) -> Callable[[Path, Any], RawMap]:
    """The reader of a format with one map."""
    return lambda file, _: read(file)


_READERS: dict[str, Callable[[Path, Any], RawMap]] = {
    "npy": _npy,
    "npz": _npz,
    "x3p": _alone(x3p.read_x3p),
    "image": _image,
    "surfer": _alone(surfer.read_surfer),
    "esri": _alone(text_files.read_esri),
    "text": _text,
    "other": lambda file, channel: library.read(file, channel),
}
