"""`read_profile`: from a path to a `Profile`, or to one sentence that says why not."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._profile.positions import evenly
from microfacet._profile.profile import Profile
from microfacet._profile.traces import checked_spacing
from microfacet._surface.checks import METRES_PER_UNIT, SurfaceError, checked_file, positive, short
from microfacet._surface.read import kinds, library, numpy_files, profile_text, x3p
from microfacet._surface.read.marks import suspicious_mark
from microfacet._surface.read.profile_columns import is_abscissa
from microfacet._surface.read.units import agreed_unit
from microfacet._text import printable

__all__ = ["holds_profile", "of_instrument", "read_profile"]

_KEYS = ("x", "spacing", "dx", "pixel_size", "unit")
_HEIGHTS = ("z", "heights", "profile")

Vector = NDArray[np.float64]
Traces = Sequence[tuple[Vector | None, Vector]]


def read_profile(
    path: str | os.PathLike[str],
    channel: int | str | None = None,
    pixel_size: float | None = None,
    unit: str | None = None,
    resample: float | None = None,
) -> Profile:
    """Read heights along a line, or along several.

    Text is read by what it holds: one column of heights; positions and heights, with further columns of
    heights at the same positions or further pairs; profiles one below the other, parted by empty lines,
    headings, or positions that begin anew; a column that numbers them. Units come from the heading, such as
    ``x [mm]; z [um]``, ``Lateral um``, ``z/nm`` or ``# Value units: nm``. ``.npy`` and ``.npz`` hold arrays.
    Dektak (``.opdx``), Mitutoyo SurfTest (``.xlsx``) and what else SurfaceTopography reads as line scans need
    the optional extra ``surface`` and are read in a process of their own with bounded memory and time.

    Parameters
    ----------
    path : path-like
        The file. A ``.npy`` holds heights (n,), or positions and heights (n, 2); a ``.npz`` ``z`` or
        ``heights`` (n,), or (k, n) for k traces, with ``x`` (n,), ``spacing`` or ``pixel_size``, and
        optionally ``unit``.
    channel : int or str, optional
        Which scan of a file with several: its index or name.
    pixel_size : float, optional
        Distance of neighbouring points in metres, for files that do not state it. It replaces what the
        file states; positions of the file then count as far as they skip points.
    unit : str, optional
        The unit of lengths in the file, for those that do not state one: km, m, cm, mm, um, nm, A, pm or fm;
        metres by default for ``.npy`` and ``.npz``, never for text. A file that states another unit is an
        error.
    resample : float, optional
        Positions that are not even are refused, unless this distance in metres is given: then heights are
        interpolated linearly at multiples of it, and gaps of more than three usual steps stay missing.

    Returns
    -------
    Profile
        Heights in metres, unlevelled.

    Raises
    ------
    SurfaceError
        One sentence: the file cannot be read or holds no profile, a distance of points or a unit is missing,
        positions are uneven, all heights are equal, or a limit is exceeded.

    Examples
    --------
    >>> import os, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = os.path.join(folder, "trace.csv")
    ...     with open(file, "w") as stream:
    ...         _ = stream.write("x [mm],z [um]\\n")
    ...         _ = stream.writelines(f"{i * 0.0005:.4f},{i % 3}\\n" for i in range(100))
    ...     profile = read_profile(file)
    >>> profile.points, f"{profile.spacing:.3g}", f"{profile.traces[0].max():.3g}", profile.unit
    (100, '5e-07', '2e-06', 'um')
    """
    file = Path(path)
    if unit is not None and unit not in METRES_PER_UNIT:
        raise SurfaceError(f"unit must be one of {', '.join(METRES_PER_UNIT)}, got {short(unit)}")
    given = None if pixel_size is None else _one_size(pixel_size)
    step = None if resample is None else positive(resample, "resample")
    if given is not None and step is not None:
        raise SurfaceError("resample needs the positions of the file, which pixel_size replaces")
    with checked_file(file), kinds.unpacked(file) as inner:
        kind = kinds.kind_of(inner)
        if kind == "npy":
            found = _npy(inner, channel, unit)
        elif kind == "npz":
            found = _npz(inner, channel, unit)
        elif kind == "x3p":
            found = _x3p(inner, channel, unit)
        elif kind == "text":
            found = _text(inner, channel, unit, given)
        elif kind == "other":
            found = _library(inner, channel, unit)
        else:
            raise SurfaceError(f"this is a map ({kind}), not a profile: read it with mf.read_surface")
        even = evenly(found.traces, found.spacing, given, step)
        profile = Profile(
            even.traces,
            even.spacing,
            unit=found.unit,
            source=printable(file.name, 255),
            steps=(*found.steps, *even.steps),
            warnings=(*even.warnings, *_marks(even.traces)),
        )
        if all(np.nanmin(trace) == np.nanmax(trace) for trace in profile.traces):
            raise SurfaceError("all heights are equal, which leaves no slopes to look at")
        return profile


def holds_profile(path: str | os.PathLike[str]) -> bool:
    """Whether text or a NumPy file can be read as a profile and as nothing else, by its content.

    Text of one column, or of positions that rise beside heights; an array of one dimension.
    """
    file = Path(path)
    try:
        with checked_file(file), kinds.unpacked(file) as inner:
            kind = kinds.kind_of(inner)
            if kind == "npy":
                shape = np.load(inner, mmap_mode="r", allow_pickle=False).shape
                return len(shape) == 1 or (len(shape) == 2 and shape[1] == 1)
            if kind == "npz":
                shapes = numpy_files.npz_shapes(inner)
                return any(len(shapes.get(name, ())) == 1 for name in _HEIGHTS)
            return kind == "text" and profile_text.holds_profile(inner)
    except SurfaceError:
        return False


def of_instrument(path: str | os.PathLike[str]) -> bool:
    """Whether a file is an instrument's, which may hold a profile: no text, no NumPy file, no picture."""
    file = Path(path)
    try:
        with checked_file(file), kinds.unpacked(file) as inner:
            return kinds.kind_of(inner) in ("x3p", "other")
    except SurfaceError:
        return False


def _marks(traces: Sequence[Vector]) -> tuple[str, ...]:
    """Doubts about numbers that look like marks of missing points."""
    heights = np.concatenate(traces)
    return tuple(text.replace("pixels", "points") for text in suspicious_mark(heights, np.isfinite(heights)))


class _Found(NamedTuple):
    """Positions in metres (or None) and heights in metres of each trace, and what is known of them."""

    traces: Traces
    unit: str
    spacing: float | None = None  # metres, as the file states it
    steps: tuple[str, ...] = ()


def _npy(file: Path, channel: int | str | None, unit: str | None) -> _Found:
    if channel is not None:
        raise SurfaceError(f"a .npy file holds one array, so there is no channel {short(channel)}")
    return _arrays({"z": numpy_files.read_npy(file)}, unit)


def _npz(file: Path, channel: int | str | None, unit: str | None) -> _Found:
    if channel is not None and not isinstance(channel, str):
        raise SurfaceError(f"the channel of a .npz file is the name of an array, got {short(channel)}")
    names = (channel,) if channel else _HEIGHTS
    arrays = numpy_files.read_npz(file, (*names, *_KEYS))
    wanted = next((name for name in names if name in arrays), None)
    if wanted is None:
        raise SurfaceError(f"there is no array of heights, which is called {' or '.join(names)}")
    return _arrays({**arrays, "z": arrays[wanted]}, unit)


def _arrays(arrays: dict[str, NDArray[Any]], unit: str | None) -> _Found:
    """Of the arrays that a NumPy file names."""
    z, x = arrays["z"], arrays.get("x")
    if z.dtype.kind not in "iuf" or z.ndim not in (1, 2):
        raise SurfaceError(f"heights must be real numbers, (n,) or (k, n), got {z.dtype} of shape {z.shape}")
    if x is None and z.ndim == 2 and z.shape[1] == 2 and is_abscissa(z[:, 0].astype(np.float64)):
        x, z = z.T
    if z.ndim == 2 and z.shape[1] == 1:
        z = z[:, 0]
    rows = np.atleast_2d(z).astype(np.float64)
    if x is not None and (x.ndim != 1 or x.dtype.kind not in "iuf" or x.size != rows.shape[1]):
        raise SurfaceError(f"x must be {rows.shape[1]} real numbers as the heights, got {x.dtype}, {x.shape}")
    unit = agreed_unit(str(arrays["unit"].item()) if "unit" in arrays else None, unit) or "m"
    factor = METRES_PER_UNIT[unit]
    stated = next((arrays[name] for name in ("spacing", "dx", "pixel_size") if name in arrays), None)
    spacing = None if stated is None else _one_size(stated) * factor
    places = None if x is None else x.astype(np.float64) * factor
    return _Found([(places, row * factor) for row in rows], unit, spacing)


def _x3p(file: Path, channel: int | str | None, unit: str | None) -> _Found:
    if channel not in (None, 0):
        raise SurfaceError(f"an .x3p file holds one measurement, so there is no channel {short(channel)}")
    x, heights = x3p.read_x3p_lines(file)
    return _Found([(x, row) for row in heights], agreed_unit("m", unit) or "m")


def _text(file: Path, channel: int | str | None, unit: str | None, given: float | None) -> _Found:
    if channel not in (None, 0):
        raise SurfaceError(f"text has no channels, so there is none {short(channel)}")
    found = profile_text.read(file, given is not None)
    heights = agreed_unit(found.height_unit, unit)
    if heights is None:
        raise SurfaceError("the text does not state the unit of its heights, give unit= (--unit)")
    spacing, along = given or found.spacing, found.position_unit
    factor: float | None = None
    if along == "px":
        if spacing is None:
            raise SurfaceError(
                "the text counts points, give their distance as pixel_size (--pixel-size) in metres"
            )
        factor = spacing
    elif along is not None or unit is not None:
        factor = METRES_PER_UNIT[along or unit or "m"]
    traces: list[tuple[Vector | None, Vector]] = []
    for x, z in found.traces:
        if x is not None and factor is None and given is not None:  # the unit does not matter
            x = x * (given / float(np.median(np.abs(np.diff(x)))))
        elif x is not None and factor is None:
            raise SurfaceError(
                "the text does not state the unit of its positions, give unit= (--unit), or pixel_size="
            )
        elif x is not None and factor is not None:
            x = x * factor
        traces.append((x, z * METRES_PER_UNIT[heights]))
    return _Found(traces, heights, found.spacing)


def _library(file: Path, channel: int | str | None, unit: str | None) -> _Found:
    answer, numbers = library.run("profile_child", file, channel=channel)
    unit = agreed_unit(answer["unit"], unit)
    if unit is None:
        raise SurfaceError("the file does not state its unit of length, give unit=, for example unit='um'")
    x, z = numbers * METRES_PER_UNIT[unit]
    step = f"read channel {short(answer['channel'])} as {short(answer['format'])} with SurfaceTopography"
    return _Found([(x if answer["sized"] else None, z)], unit, None, (step,))


def _one_size(value: Any) -> float:
    array = np.asarray(value)
    if array.size != 1 or array.dtype.kind not in "iuf":
        raise SurfaceError(f"pixel_size must be one number for a profile, in metres, got {short(value)}")
    return checked_spacing(array.item())
