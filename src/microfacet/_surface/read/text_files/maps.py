"""Height maps as text: what a table of numbers is, by its shape, its heading and its numbers."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import METRES_PER_UNIT, SurfaceError, short
from microfacet._surface.read.raw import Channel, NoMap, RawMap, profile_error, slopes_error
from microfacet._surface.read.text_files import points
from microfacet._surface.read.text_files.numbers import number
from microfacet._surface.read.text_files.tables import Table, blocks

__all__ = ["channels", "read_map"]

_X = ("x", "xpos", "xposition", "xcoordinate", "xcoord", "easting", "posx", "positionx", "xaxis")
_Y = ("y", "ypos", "yposition", "ycoordinate", "ycoord", "northing", "posy", "positiony", "yaxis")
_Z = (
    "z",
    "height",
    "heights",
    "elevation",
    "depth",
    "zpos",
    "zposition",
    "zcoordinate",
    "h",
    "altitude",
    "zvalue",
)
_SLOPES_X, _SLOPES_Y = {"p", "slopex", "dzdx", "sx"}, {"q", "slopey", "dzdy", "sy"}
_FEW = 6  # columns of what may be a list rather than a map
_NO_SIZE_UNIT = (
    "the text states positions or a pixel size without their unit, give pixel_size (--pixel-size) in metres"
)
_NO_SIZE = "the text does not state the pixel size, give pixel_size (--pixel-size) in metres"


def read_map(file: Path, channel: int | str | None) -> RawMap:
    """The map of a text: a table of heights, or points x, y, z on a grid."""
    table, name = _chosen(file, channel)
    names = {_plain(name) for name in table.layout.names}
    if names & _SLOPES_X and names & _SLOPES_Y:
        raise slopes_error()
    table = _with_positions(table)
    columns = _xyz(table)
    if columns is not None:
        return _points(table, columns)
    _refuse_what_is_no_map(table)
    return _grid(table, name)


def channels(file: Path) -> list[Channel]:
    """What the tables of a text are called."""
    return [
        Channel(table.header.channel or "", index, table.values.shape[::-1], table.header.unit)
        for index, table in enumerate(blocks(file))
    ]


def _chosen(file: Path, channel: int | str | None) -> tuple[Table, str | None]:
    names = []
    refused: SurfaceError | None = None
    for index, table in enumerate(blocks(file)):
        name = table.header.channel
        names.append(name or str(index))
        unit = table.header.unit
        if channel is None and unit is not None and unit not in METRES_PER_UNIT:
            refused = refused or SurfaceError(
                f"the file states the unit {short(unit[:20])} for its values, which is not a known length"
            )
        elif channel is None or channel in (name, index):
            return table, name
    if refused:
        raise refused
    raise SurfaceError(
        f"there is no channel {short(channel)}, the text has {', '.join(map(short, names[:8]))}"
    )


def _with_positions(table: Table) -> Table:
    """The same, with positions that stand above the columns, after one word, as its first row."""
    try:
        above = [number(name, table.layout.decimal_comma) for name in table.layout.names[1:]]
    except ValueError:
        return table
    if len(above) < 3 or not np.isfinite(above).all():
        return table
    values = np.vstack(([math.nan, *above], table.values))
    return replace(table, values=values, layout=replace(table.layout, names=(), units=()))


def _plain(name: str) -> str:
    return "".join(character for character in name.casefold() if character.isalpha())


def _xyz(table: Table) -> tuple[int, int, int] | None:
    """The columns of x, y and z, if the table is a list of points."""
    form, values = table.layout, table.values
    names = [_plain(name) for name in form.names]
    found = [next((i for i, name in enumerate(names) if name in known), None) for known in (_X, _Y, _Z)]
    x, y, z = found
    if x is not None and y is not None and form.columns >= 3:
        rest = [column for column in range(form.columns) if column not in (x, y)]
        return x, y, rest[0] if z is None else z
    if x is not None and form.columns >= 2:
        raise profile_error("x and heights, by the names of its columns")
    rows = len(values)
    if form.columns < 3 or rows < 9:
        return None
    if form.columns > _FEW:
        _refuse_profiles(values)
        return None
    guess = points.lattice_columns(values)
    if guess is None:
        _refuse_profiles(values)
    if guess is None and form.columns == 3:
        raise SurfaceError(
            "three columns are taken for points x, y, z, and these lie on no regular grid: resample them "
            "onto one first (a map only three pixels wide holds no roughness)"
        )
    return guess


def _refuse_profiles(values: NDArray[np.float64]) -> None:
    """Refuse positions that rise in equal steps beside columns of heights, which do not."""
    first, second = (points.even_step(values[1:, column]) for column in (0, 1))
    # Even steps in the first row as well are the positions of a map's columns.
    if first and not second and not points.even_step(values[0, 1:]):
        raise profile_error(f"positions and {values.shape[1] - 1} columns of heights")


def _points(table: Table, columns: tuple[int, int, int]) -> RawMap:
    x, y, z = columns
    form, values = table.layout, table.values
    gridded = points.grid(values[:, x], values[:, y], values[:, z])
    units = [form.units[column] if form.units else None for column in columns]
    lateral = units[0] or units[1] or table.header.size_unit
    if units[0] and units[1] and units[0] != units[1]:
        raise SurfaceError(f"x is in {short(units[0])} and y in {short(units[1])}, one unit is needed")
    named = ", ".join(short(form.names[column]) if form.names else str(column + 1) for column in columns)
    ny, nx = gridded.heights.shape
    steps = [f"{len(values)} points x, y, z (columns {named}) put on their grid of {nx} x {ny} pixels"]
    if form.columns > 3:
        steps.append(f"{form.columns - 3} other column{'s' * (form.columns > 4)} left out")
    return RawMap(
        gridded.heights,
        "points x, y, z",
        size=gridded.size,
        unit=units[2] or table.header.unit,
        size_unit=lateral,
        one_unit=False,
        firm=lateral is not None,
        no_size=_NO_SIZE_UNIT,
        steps=(*steps, *table.remarks),
    )


def _refuse_what_is_no_map(table: Table) -> None:
    rows, columns = table.values.shape
    if columns == 1 and rows > 3:
        raise profile_error("one column of heights")
    if columns == 2 and rows > 3:
        if np.all(np.diff(table.values[:, 0]) > 0):
            raise profile_error("two columns, x and heights")
        raise NoMap(
            "two columns",
            "two columns are no map: slopes go with mf.read_slopes (--slopes table), positions and "
            "heights with mf.read_profile (microfacet fit --profile)",
        )
    if rows <= 2 < columns - 1:
        raise profile_error(f"{rows} row{'s' * (rows > 1)} of {columns} numbers")


def _grid(table: Table, name: str | None) -> RawMap:
    header, form = table.header, table.layout
    heights, steps = table.values, list(table.remarks)
    ny, nx = heights.shape
    size = header.pixel
    if header.whole is not None and header.size_unit is not None:  # or they may count pixels
        whole = header.whole[0] / nx, header.whole[1] / ny
        size = whole if size is None else size
    if size is not None:
        steps.append("pixel size from the heading of the text")
    edges = _axes(heights)
    if edges is not None:
        size = edges
        heights = heights[1:, 1:]
        steps.append("the first row and the first column taken for the positions of the pixels")
    elif form.names:
        steps.append("the line of names above the numbers left out")
    return RawMap(
        heights,
        "table of numbers" if name is None else f"table of numbers with a heading, {name[:40]}",
        size=size,
        unit=header.unit,
        size_unit=header.size_unit if size is not None else None,
        usual="m" if size is None else None,
        one_unit=False,
        convention=False,
        channel=name,
        firm=header.size_unit is not None,
        no_size=_NO_SIZE if size is None else _NO_SIZE_UNIT,
        steps=tuple(steps),
    )


def _axes(values: NDArray[np.float64]) -> tuple[float, float] | None:
    """The pixel size, where the first row and the first column count positions in equal steps."""
    if min(values.shape) < 5:
        return None
    dx, dy = points.even_step(values[0, 1:]), points.even_step(values[1:, 0])
    if not (dx and dy) or (points.even_step(values[1, 1:]) and points.even_step(values[1:, 1])):
        return None  # an even slope has such edges too, and goes on inside
    if dx < 0 or dy < 0:
        raise SurfaceError("the positions above and beside the heights fall: turn the table round first")
    return dx, dy
