"""`read_density`: densities of slopes in files, which are parsed as hostile."""

from __future__ import annotations

import os
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet._densities.curve import Curve
from microfacet._densities.documents import PARTS, described, slopes_of_angles
from microfacet._files import read_json
from microfacet._radial import RadialNDF
from microfacet._surface.checks import SurfaceError, checked_file
from microfacet._surface.read.numpy_files import npz_names, read_npz
from microfacet._text import listed

__all__ = ["read_density"]

_MOST_CHARACTERS = 2**23  # of JSON
_MOST_NUMBERS = 2**17  # in an array
_MOST_BYTES = 2**24  # of an archive that is unpacked


def read_density(
    path: str | os.PathLike[str],
    *,
    alpha: float | None = None,
    alpha_x: float | None = None,
    alpha_y: float | None = None,
    rotation: float | None = None,
) -> RadialNDF:
    """Read a density of slopes from a file that `RadialNDF.save` or anybody else has written.

    Parameters
    ----------
    path : path-like
        A JSON document, or an npz file with the same names; docs/radial.md describes both. At most 8 MB of
        JSON, and 131072 numbers in an array.
    alpha, alpha_x, alpha_y, rotation : float, optional
        Roughness in place of that in the file.

    Returns
    -------
    RadialNDF

    Raises
    ------
    ValueError
        One sentence: the file cannot be read, is no such document, or holds no density.

    Examples
    --------
    >>> import os, tempfile
    >>> import microfacet as mf
    >>> text = '''{"kind": "microfacet density", "version": 1, "alpha": 0.3, "D": {
    ...     "theta": [0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4], "values": [9, 7, 5, 3, 2, 1, 0.5, 0.2]}}'''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = os.path.join(folder, "own.json")
    ...     with open(file, "w") as stream:
    ...         _ = stream.write(text)
    ...     ndf = mf.read_density(file)
    >>> print(f"{ndf.alpha_x} {ndf.D([0.0, 0.0, 1.0]) * 0.3**2 * ndf.norm:.6g}")
    0.3 9
    """
    file = Path(path)
    given = {"alpha": alpha, "alpha_x": alpha_x, "alpha_y": alpha_y, "rotation": rotation}
    axes = {name: value for name, value in given.items() if value is not None}
    with checked_file(file):
        try:
            part, content, roughness = described(_document(file))
            return _made(part, content, _merged(roughness, axes))
        except (ValueError, TypeError, LookupError, zipfile.BadZipFile, EOFError, OSError) as error:
            if isinstance(error, SurfaceError | OSError) or not isinstance(error, ValueError):
                raise
            raise SurfaceError(str(error).removeprefix("RadialNDF: ")) from None


def _document(file: Path) -> Any:
    with file.open("rb") as stream:
        archive = stream.read(2) == b"PK"
    if archive:
        return _unpacked(file)
    with file.open(encoding="utf-8") as text:
        try:
            return read_json(text, _MOST_CHARACTERS)
        except UnicodeDecodeError:
            raise SurfaceError("it is neither JSON nor an npz file") from None
        except ValueError as error:
            raise SurfaceError(f"it is no JSON: {error}") from None


def _unpacked(file: Path) -> dict[str, Any]:
    """An npz file as a document."""
    with zipfile.ZipFile(file) as archive:
        if sum(member.file_size for member in archive.infolist()) > _MOST_BYTES:
            raise SurfaceError(f"the archive unpacks to more than {_MOST_BYTES} bytes")
    names = npz_names(file)
    document: dict[str, Any] = {}
    for name, array in read_npz(file, names).items():
        if array.size > _MOST_NUMBERS:
            raise SurfaceError(f"{listed([name])} has {array.size} numbers, the limit is {_MOST_NUMBERS}")
        value = array.item() if array.ndim == 0 else array
        part, dot, key = name.partition(".")
        if dot and part in PARTS:
            document.setdefault(part, {})[key] = value
        else:
            document[name] = value
    return document


def _merged(roughness: dict[str, float], given: dict[str, float]) -> dict[str, Any]:
    """The roughness of the file, unless one is given: alpha in place of axes, or axes in place of alpha."""
    if "alpha" in given or "alpha_x" in given or "alpha_y" in given:
        kept = {"rotation"} if "alpha" not in given else set()
        roughness = {name: value for name, value in roughness.items() if name in kept}
    return roughness | given


def _made(part: str, content: dict[str, Any], roughness: dict[str, Any]) -> RadialNDF:
    for name, value in content.items():
        if name not in ("interpolation", "beyond"):
            content[name] = _numbers(f"{part}.{name}", value)
        elif not isinstance(value, str) or len(value) > 20:
            raise ValueError(f"{part}.{name} must be a word")
    needed = {"P22": ("r", "values"), "D": ("values",), "histogram": ("edges", "counts")}[part]
    for name in needed:
        if name not in content:
            raise ValueError(f"{part} lacks {name}")
    if part == "histogram":
        return RadialNDF.from_histogram(content["edges"], content["counts"], **roughness)
    beyond = content.get("beyond", "power")
    if part == "P22":
        how = content.get("interpolation", "cubic")
        curve = Curve("P22", content["r"], content["values"], content.get("powers"), how, beyond)
    else:
        r, values = slopes_of_angles(content.get("theta"), content.get("u"), content["values"])
        curve = Curve("P22", r, values, beyond=beyond)
    return RadialNDF(curve, **roughness)


def _numbers(name: str, value: Any) -> NDArray[np.float64]:
    """A list of numbers, without strings that NumPy would read as numbers."""
    if not isinstance(value, list | np.ndarray) or len(value) > _MOST_NUMBERS:
        raise ValueError(f"{name} must be a list of at most {_MOST_NUMBERS} numbers")
    if isinstance(value, list):
        if not all(isinstance(x, int | float) and not isinstance(x, bool) for x in value):
            raise ValueError(f"{name} must be a list of numbers alone")
        try:
            return np.array([float(x) for x in value])
        except OverflowError:
            raise ValueError(f"{name} holds a number that is too large") from None
    if value.ndim != 1 or value.dtype.kind not in "iuf":
        raise ValueError(f"{name} must be a list of numbers, got {value.dtype} of shape {value.shape}")
    return value.astype(np.float64)
