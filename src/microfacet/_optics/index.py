"""The complex refractive index at wavelengths, from numbers or from a small table in a file."""

from __future__ import annotations

import csv
import math
import os
import re
import stat
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._text import printable

__all__ = ["Index", "index_at", "read_refractive_index", "wavelengths_of"]

_MAX_BYTES = 2**20  # a table of indices is small
_UNITS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "\u00b5m": 1e-6, "\u03bcm": 1e-6, "nm": 1e-9}
_LONGEST = 1e-2  # metres: what is longer has been meant in another unit

Complex = NDArray[np.complex128]
#: A complex number or several, the path of a table, or (wavelengths in metres, complex numbers).
Index = ArrayLike | str | os.PathLike[str] | tuple[ArrayLike, ArrayLike]


def wavelengths_of(values: ArrayLike) -> NDArray[np.float64]:
    """Wavelengths in metres, one or several in a row; ValueError says what is wrong."""
    try:
        array = np.atleast_1d(np.asarray(values))
    except ValueError:
        array = np.empty(0, dtype=object)
    if array.ndim != 1 or array.dtype.kind not in "iuf" or array.size == 0:
        raise ValueError(f"wavelengths must be one number or several, in metres, got {values!r:.80}")
    array = array.astype(np.float64)
    bad = array[~((array > 0) & (array <= _LONGEST))]
    if bad.size:
        raise ValueError(
            f"wavelengths must lie in (0, {_LONGEST:g}] metres (550 nm is 550e-9), got {bad[0]:g}"
        )
    if len(np.unique(array)) < array.size:
        raise ValueError(f"wavelengths must differ from each other, got {values!r:.80}")
    return array


def index_at(index: Index, wavelengths: NDArray[np.float64]) -> Complex:
    """n + ik at each wavelength: k >= 0 whatever the sign convention; inf for a perfect mirror.

    Tables are interpolated linearly, and say so where they do not reach.
    """
    if isinstance(index, str | os.PathLike):
        where, values = read_refractive_index(index)
        return _interpolated(where, values, wavelengths, printable(os.fspath(index), 200))
    if isinstance(index, tuple) and len(index) == 2 and np.ndim(index[0]) == 1:
        where = wavelengths_of(index[0])
        values = _checked(index[1])
        if values.shape != where.shape:
            raise ValueError(
                f"index: as many numbers as wavelengths are needed, got {values.size} for {where.size}"
            )
        order = np.argsort(where)
        return _interpolated(where[order], values[order], wavelengths, "index")
    values = np.atleast_1d(_checked(index))
    if values.shape not in ((1,), wavelengths.shape):
        raise ValueError(
            f"index must be one number or one for each of {wavelengths.size} wavelengths, got {values.shape}"
        )
    return np.broadcast_to(values, wavelengths.shape).copy()


def read_refractive_index(path: str | os.PathLike[str]) -> tuple[NDArray[np.float64], Complex]:
    """Read a table of a refractive index: text of columns wavelength, n and, for an absorbing medium, k.

    The first line names the columns and the unit of the wavelength, as in ``wavelength_nm,n,k`` or
    ``wavelength (um)  n  k``; ``wl`` without a unit is in micrometres, as refractiveindex.info writes it.
    That site's files of two parts, first n and then k, are read too. ``#`` begins a comment; columns are
    separated by commas, semicolons, tabs or spaces.

    Parameters
    ----------
    path : path-like
        Of at most 1 MiB.

    Returns
    -------
    wavelengths : ndarray of float
        In metres, ascending.
    index : ndarray of complex
        n + ik.

    Raises
    ------
    ValueError
        One sentence: there is no unit, a column is missing, a number is none or out of range.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> import pathlib
    >>> import microfacet as mf
    >>> _ = pathlib.Path("gold.csv").write_text("wavelength_nm,n,k\\n500,0.97,1.87\\n600,0.25,2.90\\n")
    >>> mf.read_refractive_index("gold.csv")
    (array([5.e-07, 6.e-07]), array([0.97+1.87j, 0.25+2.9j ]))
    """
    file = Path(path)
    name = printable(str(file), 200)
    status = file.stat()
    if not stat.S_ISREG(status.st_mode):
        raise ValueError(f"{name}: this is not a file")
    if status.st_size > _MAX_BYTES:
        raise ValueError(f"{name}: a table of indices has at most {_MAX_BYTES} bytes, got {status.st_size}")
    try:
        text = file.read_text("utf-8-sig")
    except UnicodeDecodeError:
        text = file.read_text("latin-1")
    lines = [line for raw in text.splitlines() if (line := raw.partition("#")[0].strip())]
    parts = _parts(lines, name)
    first, found = parts[0]
    where = found[first[0]]
    columns = {key: values for key, values in found.items() if key in ("n", "k")}
    for names, other in parts[1:]:
        if not np.array_equal(other[names[0]], where):
            raise ValueError(f"{name}: n and k are given at different wavelengths")
        columns |= {key: values for key, values in other.items() if key in ("n", "k")}
    if "n" not in columns:
        raise ValueError(f"{name}: there is no column n, the columns are {', '.join(found)[:100]}")
    scale = _scale(first[0], name)
    order = np.argsort(where)
    values = columns["n"] + 1j * columns.get("k", np.zeros_like(where))
    return wavelengths_of(where[order] * scale), _checked(values[order])


def _parts(lines: list[str], name: str) -> list[tuple[list[str], dict[str, NDArray[np.float64]]]]:
    """Headings and columns; a line that is no numbers begins a new part."""
    parts: list[tuple[list[str], list[list[float]]]] = []
    for line in lines:
        cells = _cells(line)
        try:
            numbers = [float(cell) for cell in cells]
        except ValueError:
            parts.append((_headings(line), []))
            continue
        if not parts:
            raise ValueError(
                f"{name}: the first line must name the columns, such as wavelength_nm,n,k, got {line[:60]!r}"
            )
        if len(numbers) != len(parts[-1][0]):
            raise ValueError(f"{name}: {len(parts[-1][0])} numbers a line are needed, got {line[:60]!r}")
        parts[-1][1].append(numbers)
    if not parts or not all(rows for _, rows in parts):
        raise ValueError(f"{name}: there are no numbers in it")
    return [(names, dict(zip(names, np.array(rows).T, strict=True))) for names, rows in parts]


def _cells(line: str) -> list[str]:
    for separator in ",;\t":
        if separator in line:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=separator))]
    return line.split()


def _headings(line: str) -> list[str]:
    """Names in lower case; a unit in brackets belongs to its column."""
    return [cell.lower() for cell in _cells(re.sub(r"\s+(?=[(\[])", "", line))]


def _scale(heading: str, name: str) -> float:
    """Metres of the unit in the heading of the wavelength."""
    if heading == "wl":
        return 1e-6
    found = re.fullmatch(r"(?:wavelength|wl|lambda)[ _]*[(\[]?([a-z\u00b5\u03bc]+)[)\]]?", heading)
    if not found or found[1] not in _UNITS:
        raise ValueError(
            f"{name}: the first column must be the wavelength with its unit, such as wavelength_nm, "
            f"got {printable(heading, 40)!r}"
        )
    return _UNITS[found[1]]


def _checked(index: Any) -> Complex:
    try:
        array = np.asarray(index)
    except ValueError:
        array = np.empty(0, dtype=object)
    if array.dtype.kind not in "iufc" or array.ndim > 1 or array.size == 0:
        raise ValueError(f"index must be complex numbers n + ik, got {index!r:.80}")
    real = np.real(array).astype(np.float64)
    imaginary = np.abs(np.imag(array)).astype(np.float64)
    good = (real > 0) & (imaginary < math.inf)
    if not good.all():
        raise ValueError(f"index must have n in (0, inf] and finite k, got {array[~good].flat[0]}")
    result = np.empty(array.shape, dtype=np.complex128)
    result.real, result.imag = real, imaginary
    return result


def _interpolated(
    where: NDArray[np.float64], values: Complex, wavelengths: NDArray[np.float64], name: str
) -> Complex:
    rounding = 1e-9 * where[-1]
    outside = wavelengths[(wavelengths < where[0] - rounding) | (wavelengths > where[-1] + rounding)]
    if outside.size:
        raise ValueError(
            f"{name}: the index is known from {where[0]:g} to {where[-1]:g} m, not at {outside[0]:g} m"
        )
    return np.asarray(
        np.interp(wavelengths, where, values.real) + 1j * np.interp(wavelengths, where, values.imag)
    )
