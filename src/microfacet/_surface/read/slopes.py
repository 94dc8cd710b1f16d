"""Slopes that were measured as slopes: tables of two columns, and normal maps."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import DTypeLike, NDArray

from microfacet._surface.checks import MAX_PIXELS, SurfaceError, checked_file, checked_lag, short
from microfacet._surface.lagged import averaged
from microfacet._surface.read import images, kinds, slope_tables
from microfacet._text import printable
from microfacet._value import Value

__all__ = ["SlopeSample", "read_normal_map", "read_slopes"]

_LOSSY = (
    "the normal map is a JPEG, whose compression changes normals and adds some of its own: prefer the PNG "
    "that it was made from"
)


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
    warnings : tuple of str
        What is doubtful about them, a sentence each.
    grid : ndarray of bool, shape (ny, nx), optional
        Of a normal map: which pixels have a slope. They hold `values` row by row, so that a fit knows which
        of them are neighbours.
    lag : int, optional
        The lag in pixels over which they are averaged; None as they were measured.
    """

    values: NDArray[np.float64]
    source: str
    steps: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    grid: NDArray[np.bool_] | None = None
    lag: int | None = None

    def __post_init__(self) -> None:
        if self.grid is not None and np.count_nonzero(self.grid) != len(self.values):
            raise SurfaceError(
                f"grid must be True for as many pixels as there are slopes, {len(self.values)}, got "
                f"{np.count_nonzero(self.grid)}"
            )
        self._keep(**self._state())

    def at_lag(self, lag: int) -> Self:
        """The slopes of the same normal map over a longer baseline.

        A slope at lag l is the mean of those between the pixels l to the left and to the right, respectively
        above and below, as differences of heights over 2 l pixels are.

        Parameters
        ----------
        lag : int
            Pixels on each side, at least 1.

        Returns
        -------
        SlopeSample
            With this `lag`; a pixel is left out where one of those that it needs is missing.

        Examples
        --------
        >>> import numpy as np
        >>> p = np.tile([0.0, 0.2], 12)
        >>> stripes = SlopeSample(np.column_stack((p, p)), "stripes", grid=np.ones((4, 6), bool))
        >>> stripes.at_lag(1).values[0]
        array([0.1, 0.2])
        """
        if self.grid is None or self.lag is not None:
            what = "slopes without positions have" if self.grid is None else "these slopes have already"
            raise SurfaceError(f"{what} {'no' if self.grid is None else 'a'} lag, got lag {short(lag)}")
        values, known = averaged(self.values, self.grid, checked_lag(lag))
        step = f"slopes averaged over a lag of {lag} pixels"
        return replace(self, values=values, grid=known, lag=lag, steps=(*self.steps, step))

    def __len__(self) -> int:
        return len(self.values)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.values, dtype=dtype, copy=copy)


def read_slopes(path: str | os.PathLike[str]) -> SlopeSample:
    """Read slopes from a table of two columns, p along +x and q along +y.

    Columns go by their names, p and q (or slope_x and slope_y, dz/dx and dz/dy), in any order and among
    others; two columns of other names, or without, are p and q in this order. The content decides what a
    file is, not its name; ``.gz`` is unpacked.

    Parameters
    ----------
    path : path-like
        NumPy's ``.npy``: an array (N, 2). ``.npz``: an array ``slopes`` (N, 2), or ``p`` and ``q``. Text
        (``.csv``, ``.tsv``, ``.txt``, ...): a row in every line, with or without a heading. Parquet (extra
        ``parquet``).

    Returns
    -------
    SlopeSample
        The rows that are finite; `steps` say how many are not, and which columns were left out.

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
    with checked_file(file), np.errstate(over="ignore", invalid="ignore"):
        with kinds.unpacked(file) as inner:
            columns, remarks = slope_tables.read_columns(inner)
        table = np.asarray(columns)
        if table.ndim != 2 or table.shape[1] != 2 or table.dtype.kind not in "iuf":
            raise SurfaceError(
                f"slopes are two columns of real numbers, got {table.dtype} of shape {table.shape}"
            )
        if len(table) > MAX_PIXELS:
            raise SurfaceError(f"the file holds more than {MAX_PIXELS} slopes, which is the limit")
        values = table.astype(np.float64)
        finite = np.asarray(np.isfinite(values).all(axis=1))
        return _sample(file, values, finite, "rows", "which are not finite", remarks)


def read_normal_map(path: str | os.PathLike[str], convention: str = "opengl") -> SlopeSample:
    """Read a tangent-space normal map as slopes.

    Red, green and blue are the components of the normal, mapped from [-1, 1] to the range of the pixels; an
    EXR with a negative red or green holds the components themselves. The slopes are ``-x/z`` and ``-y/z``, so
    normals need not have length 1. Pixels whose z is not positive have no slope and are left out, which
    `steps` say. 8-bit maps hold slopes in steps of 1/127.

    Parameters
    ----------
    path : path-like
        A PNG or TIFF of 8, 16 or 32 bits, an EXR, or a JPEG, which gets a warning (extra ``surface``).
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
        if kinds.kind_of(file) != "image":
            raise SurfaceError("a normal map is a PNG, TIFF, EXR or JPEG image, and this is none of them")
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
        warnings = (_LOSSY,) if facts["format"] == "jpeg" else ()
        sample = _sample(file, values, good, "pixels", "whose z is not positive", steps, warnings)
        return replace(sample, grid=good.reshape(pixels.shape[:2]))


def _sample(
    file: Path,
    values: NDArray[np.float64],
    good: NDArray[np.bool_],
    what: str,
    why: str,
    steps: Sequence[str] = (),
    warnings: tuple[str, ...] = (),
) -> SlopeSample:
    bad = int(np.count_nonzero(~good))
    if bad == len(values):
        raise SurfaceError(f"none of the {len(values)} {what} holds a slope")
    left_out = (f"{bad} of {len(values)} {what} left out, {why}",) if bad else ()
    return SlopeSample(values[good], printable(file.name, 255), (*steps, *left_out), warnings)
