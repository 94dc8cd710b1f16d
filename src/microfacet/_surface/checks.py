"""What every part of a measured surface agrees on: its limits, its units, its one error, its arguments."""

from __future__ import annotations

import math
import operator
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._text import printable

__all__ = [
    "MAX_PIXELS",
    "METRES_PER_UNIT",
    "SMALLEST_TRANSFORMED",
    "SurfaceError",
    "checked_file",
    "checked_lag",
    "height_array",
    "pixel_sizes",
    "positive",
    "short",
]

#: Largest map that is accepted (8192 x 8192 pixels, 512 MiB as float64): bounds the memory of everything
#: here.
MAX_PIXELS = 2**26

#: Pixels along the shorter side of a map from which its spectrum and autocorrelation say anything.
SMALLEST_TRANSFORMED = 16

#: Files larger than this are refused unread.
MAX_FILE_BYTES = 2**30

#: Length units that a file may state, in metres. Both micro signs (U+00B5, U+03BC) are in use.
METRES_PER_UNIT = {
    "km": 1e3, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "\u00b5m": 1e-6, "\u03bcm": 1e-6,
    "nm": 1e-9, "A": 1e-10, "\u00c5": 1e-10, "pm": 1e-12, "fm": 1e-15,
}  # fmt: skip


class SurfaceError(ValueError):
    """A height map that cannot be used; the message is one sentence that says why."""


def pixel_sizes(value: Any) -> tuple[float, float]:
    """``(dx, dy)`` from one number or two; `SurfaceError` unless both are positive and finite."""
    try:
        sizes = np.asarray(value)
    except (TypeError, ValueError):
        sizes = np.empty(0)
    if sizes.shape not in ((), (1,), (2,)) or sizes.dtype.kind not in "iuf":
        raise SurfaceError(f"pixel_size must be one number or (dx, dy), in metres, got {short(value)}")
    dx, dy = (float(size) for size in np.broadcast_to(sizes, (2,)))
    # The limits keep dx, dy and every quotient by them far from overflow; no map comes near them.
    if not (1e-30 < dx < 1e30 and 1e-30 < dy < 1e30):
        raise SurfaceError(f"pixel_size must lie in (1e-30, 1e30) metres, got ({dx:g}, {dy:g})")
    return dx, dy


def height_array(heights: ArrayLike) -> NDArray[np.float64]:
    """A float64 copy; ints become floats, everything that is not a real 2-D map is refused.

    A copy of what nobody writes to would only take memory: float64 that is read-only and no view stays.
    """
    try:
        array = np.asarray(heights)
    except (TypeError, ValueError):  # rows of different lengths
        array = np.empty(0, dtype=object)
    if array.dtype.kind not in "iuf":
        raise SurfaceError(f"heights must be a 2-D map of real numbers, got an array of {array.dtype}")
    if array.ndim != 2 or min(array.shape) < 3:
        raise SurfaceError(f"heights must be a 2-D map of at least 3 x 3 pixels, got shape {array.shape}")
    if array.size > MAX_PIXELS:
        raise SurfaceError(f"a map of {array.shape} exceeds the limit of {MAX_PIXELS} pixels")
    flags = array.flags
    if array.dtype == np.float64 and flags.owndata and flags.c_contiguous and not flags.writeable:
        return array
    with np.errstate(over="ignore"):  # a longdouble beyond float64 becomes inf, that is, invalid
        return np.array(array, dtype=np.float64, order="C")


def checked_lag(lag: Any) -> int:
    try:
        number = 0 if isinstance(lag, bool | np.bool_) else operator.index(lag)
    except TypeError:
        number = 0
    if number < 1:
        raise SurfaceError(f"lag must be a whole number of pixels in [1, inf), got {short(lag)}")
    return number


def short(value: object) -> str:
    return printable(" ".join(repr(value).split()))


def positive(value: Any, what: str) -> float:
    """A positive, finite number; `SurfaceError` says which argument is not."""
    try:
        number = math.nan if isinstance(value, bool | np.bool_ | str) else float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not 0 < number < math.inf:
        raise SurfaceError(f"{what} must be a positive, finite number, got {short(value)}")
    return number


@contextmanager
def checked_file(file: Path) -> Iterator[None]:
    """Around whatever reads a file that may be hostile: what goes wrong is one sentence that names the file.

    A regular file of sensible size; opening a pipe or a device would block or never end.
    """
    # There is no complete list of what a hostile file makes a parser raise.
    try:
        try:
            status = file.stat()
        except FileNotFoundError:
            raise SurfaceError("there is no such file") from None
        if not stat.S_ISREG(status.st_mode):
            raise SurfaceError("this is a folder" if stat.S_ISDIR(status.st_mode) else "this is not a file")
        if status.st_size == 0:
            raise SurfaceError("the file is empty")
        if status.st_size > MAX_FILE_BYTES:
            raise SurfaceError(f"the file has {status.st_size} bytes, the limit is {MAX_FILE_BYTES}")
        yield
    except SurfaceError as error:
        raise SurfaceError(f"{_one_line(file, 5000)}: {_one_line(error, 350)}") from None
    except MemoryError as error:
        raise SurfaceError(f"{_one_line(file, 5000)}: there is not enough memory for it") from error
    except Exception as error:
        reason = f"{type(error).__name__}: {_one_line(error, 200)}"
        raise SurfaceError(f"{_one_line(file, 5000)}: cannot be read ({reason})") from error


def _one_line(text: object, most: int) -> str:
    return printable(" ".join(str(text).split()), most)
