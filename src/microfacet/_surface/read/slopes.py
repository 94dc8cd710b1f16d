"""Slopes that were measured as slopes: tables of two columns, and normal maps."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from microfacet import _optional
from microfacet._surface.checks import MAX_PIXELS, SurfaceError, checked_file, short
from microfacet._surface.read import images, numpy_files, process, text_files
from microfacet._text import printable
from microfacet._value import Value

__all__ = ["SlopeSample", "read_normal_map", "read_slopes"]


@dataclass(frozen=True, eq=False)
class SlopeSample(Value):
    """Measured slopes, as `fit` takes them (``numpy.asarray`` makes an array of them).

    Attributes
    ----------
    values : ndarray, shape (N, 2)
        Slopes ``(p, q)`` along +x and +y.
    source : str
        Where they come from, for display.
    steps : tuple of str
        What was done to them, one phrase each.
    """

    values: NDArray[np.float64]
    source: str
    steps: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._keep(**self._state())

    def __len__(self) -> int:
        return len(self.values)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.values, dtype=dtype, copy=copy)


def read_slopes(path: str | os.PathLike[str]) -> SlopeSample:
    """Read slopes from a table of two columns, p along +x and q along +y.

    Parameters
    ----------
    path : path-like
        ``.npy``: an array (N, 2). ``.npz``: an array ``slopes`` (N, 2), or ``p`` and ``q``. ``.csv``,
        ``.tsv``, ``.txt``, ``.dat``: two numbers in every line, with or without a heading. ``.parquet``
        (extra ``parquet``): the columns ``p`` and ``q``, or the only two.

    Returns
    -------
    SlopeSample
        The rows that are finite; `steps` say how many are not.

    Raises
    ------
    SurfaceError
        One sentence: the file cannot be read or holds no slopes, or more than 2**26 of them.

    Examples
    --------
    >>> import os, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = os.path.join(folder, "slopes.csv")
    ...     with open(file, "w") as stream:
    ...         _ = stream.write("p,q\\n0.1,-0.2\\n0.3,nan\\n0.2,0.1\\n")
    ...     sample = read_slopes(file)
    >>> sample.values
    array([[ 0.1, -0.2],
           [ 0.2,  0.1]])
    >>> sample.steps
    ('1 of 3 rows left out, which are not finite',)
    """
    file = Path(path)
    with checked_file(file):
        suffix = file.suffix.lower()
        if suffix not in _READERS:
            raise SurfaceError(f"slopes come in {', '.join(_READERS)}, not in {short(suffix)}")
        table = np.asarray(_READERS[suffix](file))
        if table.ndim != 2 or table.shape[1] != 2 or table.dtype.kind not in "iuf":
            raise SurfaceError(
                f"slopes are two columns of real numbers, got {table.dtype} of shape {table.shape}"
            )
        if len(table) > MAX_PIXELS:
            raise SurfaceError(f"the file holds more than {MAX_PIXELS} slopes, which is the limit")
        values = table.astype(np.float64)
        finite = np.asarray(np.isfinite(values).all(axis=1))
        return _sample(file, values, finite, "rows", "which are not finite")


def read_normal_map(path: str | os.PathLike[str], convention: str = "opengl") -> SlopeSample:
    """Read a tangent-space normal map as slopes.

    Red, green and blue are the components of the normal, mapped from [-1, 1] to the range of the pixels; an
    EXR with a negative red or green holds the components themselves. The slopes are ``-x/z`` and ``-y/z``, so
    normals need not have length 1. Pixels whose z is not positive have no slope and are left out, which
    `steps` say. 8-bit maps hold slopes in steps of 1/127.

    Parameters
    ----------
    path : path-like
        A PNG or TIFF of 8, 16 or 32 bits, or an EXR (extra ``surface``).
    convention : {"opengl", "directx"}
        Whether green points up or down the image.

    Returns
    -------
    SlopeSample
        Slopes ``(p, q)`` along +x (right) and +y (up the image).

    Raises
    ------
    SurfaceError
        One sentence: the file cannot be read, has not three channels, or no pixel has a slope.

    Examples
    --------
    >>> import microfacet as mf
    >>> slopes = mf.read_normal_map("bricks.png", convention="directx")  # doctest: +SKIP
    >>> mf.fit(slopes)[0].family  # doctest: +SKIP
    'student_t'
    """
    if convention not in ("opengl", "directx"):
        raise SurfaceError(f"convention must be opengl or directx, got {short(convention)}")
    file = Path(path)
    with checked_file(file):
        if file.suffix.lower() not in images.SUFFIXES:
            raise SurfaceError(f"a normal map is one of {', '.join(images.SUFFIXES)}")
        facts, pixels = images.decode(file, normals=True)
        normals = pixels.reshape(-1, 3)
        if facts["signed"]:
            raise SurfaceError(
                "normal maps have unsigned or floating-point pixels, these are signed integers"
            )
        steps = [f"normal map of {pixels.shape[1]} x {pixels.shape[0]} pixels, {convention} convention"]
        if facts["bits"]:
            normals = normals * (2 / (2.0 ** facts["bits"] - 1)) - 1
        elif np.nanmin(normals[:, :2], initial=0.0) >= 0:
            normals = 2 * normals - 1
            steps.append("components taken to be mapped to [0, 1]")
        x, y, z = normals.T
        good = np.isfinite(normals).all(axis=1) & (z > 0)
        with np.errstate(all="ignore"):
            values = np.column_stack((-x / z, (-y if convention == "opengl" else y) / z))
        good &= np.isfinite(values).all(axis=1)
        sample = _sample(file, values, good, "pixels", "whose z is not positive")
        return SlopeSample(sample.values, sample.source, (*steps, *sample.steps))


def _sample(
    file: Path, values: NDArray[np.float64], good: NDArray[np.bool_], what: str, why: str
) -> SlopeSample:
    bad = int(np.count_nonzero(~good))
    if bad == len(values):
        raise SurfaceError(f"none of the {len(values)} {what} holds a slope")
    steps = (f"{bad} of {len(values)} {what} left out, {why}",) if bad else ()
    return SlopeSample(values[good], printable(file.name, 255), steps)


def _npz(file: Path) -> NDArray[Any]:
    arrays = numpy_files.read_npz(file, ("slopes", "p", "q"))
    if "slopes" in arrays:
        return arrays["slopes"]
    if "p" in arrays and "q" in arrays and arrays["p"].shape == arrays["q"].shape:
        return np.column_stack((arrays["p"].ravel(), arrays["q"].ravel()))
    raise SurfaceError("the file holds neither an array slopes (N, 2) nor two arrays p and q of one shape")


def _text(file: Path) -> NDArray[Any]:
    with file.open("rb") as stream:
        rows = (line for line in text_files.lines(stream) if line.partition("#")[0].strip())
        first = next(rows, None)
        if first is None:
            raise SurfaceError("the file holds no numbers")
        delimiter = text_files.separator(first)
        heading = text_files.is_heading(first.partition("#")[0], delimiter)
        table = itertools.chain(() if heading else (first,), rows)
        return text_files.table(table, delimiter, MAX_PIXELS + 1)


def _parquet(file: Path) -> NDArray[Any]:
    if not _optional.installed("pyarrow"):
        raise SurfaceError(_optional.sentence("a .parquet file needs", "pyarrow"))
    return process.run("parquet_child", file, file.stat().st_size)[1]


_READERS: dict[str, Callable[[Path], NDArray[Any]]] = {
    ".npy": numpy_files.read_npy,
    ".npz": _npz,
    ".csv": _text,
    ".tsv": _text,
    ".txt": _text,
    ".dat": _text,
    ".parquet": _parquet,
}
