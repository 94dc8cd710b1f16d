"""Tables of slopes: which columns are p and q, by their names whatever the format."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet import _optional
from microfacet._surface.checks import MAX_PIXELS, SurfaceError, short
from microfacet._surface.read import kinds, numpy_files, process, text_files
from microfacet._surface.read.raw import profile_error
from microfacet._text import listed

__all__ = ["read_columns"]

Columns = tuple[NDArray[Any], tuple[str, ...]]

# Names of the slopes along x and y, without case and without what is neither a letter nor a digit.
_P = ("p", "slopex", "xslope", "sx", "dzdx", "zx", "gradx", "gradientx", "px", "dhdx")
_Q = ("q", "slopey", "yslope", "sy", "dzdy", "zy", "grady", "gradienty", "py", "dhdy")
_PURE = (None, "", "1", "-", "m/m", "um/um", "nm/nm", "mm/mm", "rad/rad")
_PARQUET = b"PAR1"
# Fewer numbers than these may rise evenly by chance.
_LEAST_POINTS = 9


def read_columns(file: Path) -> Columns:
    """The slopes (N, 2) and remarks on how they were found."""
    with file.open("rb") as stream:
        start = stream.read(len(_PARQUET))
    kind = "parquet" if start == _PARQUET or file.suffix.lower() == ".parquet" else kinds.kind_of(file)
    if kind not in _READERS:
        raise SurfaceError(
            "slopes come in .npy, .npz, .parquet and text such as .csv, and this is none of them"
        )
    return _READERS[kind](file)


def _plain(name: str) -> str:
    return "".join(character for character in name.casefold() if character.isalnum())


def _places(names: Sequence[str]) -> tuple[tuple[int, int] | None, tuple[str, ...]]:
    """Which of the named columns are p and q, and a remark on the others; None without such names."""
    plain = [_plain(name) for name in names]
    found = [[i for i, name in enumerate(plain) if name in known] for known in (_P, _Q)]
    for places, what in zip(found, ("along x", "along y"), strict=True):
        if len(places) > 1:
            raise SurfaceError(
                f"several columns may be the slopes {what}: {listed([names[place] for place in places])}"
            )
    if not (found[0] and found[1]):
        return None, ()
    chosen = found[0][0], found[1][0]
    rest = [name for place, name in enumerate(names) if place not in chosen]
    return chosen, (f"columns left out: {listed(rest)}",) if rest else ()


def _text(file: Path) -> Columns:
    table = text_files.read_table(file, 4 * MAX_PIXELS)
    form = table.layout
    chosen, remarks = _places(form.names)
    if chosen is None:
        if form.columns != 2:
            named = f" named {listed(form.names)}" if form.names else ""
            raise SurfaceError(
                f"slopes are two columns, and the table has {form.columns}{named}: name two of them p and q"
            )
        chosen = 0, 1
        if len(table.values) >= _LEAST_POINTS and text_files.even_step(table.values[:, 0]):
            raise profile_error("positions that rise evenly, and heights")
        if any(form.names):
            remarks = (f"columns {listed(form.names)} taken for p and q",)
    units = [form.units[place] for place in chosen] if form.units else []
    for unit in units:
        if unit not in _PURE:
            raise SurfaceError(f"the file states the unit {short(unit)}, and slopes are pure numbers")
    return table.values[:, list(chosen)], (*remarks, *table.remarks)


def _npy(file: Path) -> Columns:
    return numpy_files.read_npy(file), ()


def _npz(file: Path) -> Columns:
    names = numpy_files.npz_names(file)
    chosen, remarks = _places(names)
    if "slopes" in names:
        rest = [name for name in names if name != "slopes"]
        remarks = (f"arrays left out: {listed(rest)}",) if rest else ()
        return numpy_files.read_npz(file, ("slopes",))["slopes"], remarks
    if chosen is not None:
        wanted = [names[place] for place in chosen]
        arrays = numpy_files.read_npz(file, wanted)
        p, q = (arrays[name] for name in wanted)
        if p.shape == q.shape:
            return np.column_stack((p.ravel(), q.ravel())), remarks
    raise SurfaceError("the file holds neither an array slopes (N, 2) nor two arrays p and q of one shape")


def _parquet(file: Path) -> Columns:
    if not _optional.installed("pyarrow"):
        raise SurfaceError(_optional.sentence("a .parquet file needs", "pyarrow"))
    answer, _ = process.run("parquet_child", file, file.stat().st_size, columns=None)
    names = answer["names"]
    chosen, remarks = _places(names)
    if chosen is None:
        if len(names) != 2:
            raise SurfaceError(f"the file has the columns {listed(names)}, and not p and q")
        chosen, remarks = (0, 1), (f"columns {listed(names)} taken for p and q",)
    wanted = [names[place] for place in chosen]
    return process.run("parquet_child", file, file.stat().st_size, columns=wanted)[1], remarks


_READERS: dict[str, Callable[[Path], Columns]] = {
    "npy": _npy,
    "npz": _npz,
    "text": _text,
    "parquet": _parquet,
}
