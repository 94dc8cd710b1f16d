"""Which columns of a table are positions along a line and which are heights, and where a trace ends."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import SurfaceError
from microfacet._surface.read.profile_headings import Heading

__all__ = ["is_abscissa", "rises", "traces_of"]

Vector = NDArray[np.float64]


def is_abscissa(x: Vector) -> bool:
    """Whether these are positions along a line: finite, and all rising or all falling."""
    steps = np.diff(x)
    return bool(x.size > 2 and np.isfinite(x).all() and ((steps > 0).all() or (steps < 0).all()))


def traces_of(tables: Iterable[Vector], heading: Heading, sized: bool) -> list[tuple[Vector | None, Vector]]:
    """Positions and heights of every trace of every table."""
    found: list[tuple[Vector | None, Vector]] = []
    for table in tables:
        for x, z in _of_block(table, heading, sized):
            found += [(x, z)] if x is None else _restarted(x, z)
    kept = [(x, z) for x, z in (_trimmed(x, z) for x, z in found) if z.size >= 3]
    if not kept:
        raise SurfaceError("the file holds no trace of three heights in a row")
    return kept


def _of_block(table: Vector, heading: Heading, sized: bool) -> list[tuple[Vector | None, Vector]]:
    """By the heading where it names the columns, else by which of them rise like positions."""
    places = [k for k in range(table.shape[1]) if k not in (heading.valid, heading.group)]
    places.sort(key=lambda k: (k != heading.position, k))
    chosen = table[:, places]
    if heading.valid is not None:
        chosen[table[:, heading.valid] == 0, 1:] = math.nan
    if heading.group is None:
        return _columns(chosen, heading, sized)
    numbers = table[:, heading.group]
    return [one for k in np.unique(numbers) for one in _columns(chosen[numbers == k], heading, sized)]


def _columns(table: Vector, heading: Heading, sized: bool) -> list[tuple[Vector | None, Vector]]:
    width = table.shape[1]
    if width == 1:
        return [(None, table[:, 0])]
    if heading.heights_alone:
        return [(None, column) for column in table.T]
    rising = [rises(column) for column in table.T]
    if width % 2 == 0 and width > 2 and all(rising[::2]) and (heading.pairs or not any(rising[1::2])):
        return [(table[:, k], table[:, k + 1]) for k in range(0, width, 2)]
    if not rising[0] and _doubled(table[:, 0]):
        raise SurfaceError(f"two points lie at the position {_doubled(table[:, 0])[0]:g}")
    if not rising[0] and sized:
        return [(None, column) for column in table.T]
    if not rising[0]:
        raise SurfaceError(
            "the first column does not rise like positions along a line, so this is no table of x and z "
            "(--slopes table reads two columns of slopes)"
        )
    x, *heights = table.T
    if width > 2 and not heading.of_profiles and (_begins_anew(x) or any(map(_constant, heights))):
        raise SurfaceError(
            f"these {width} columns look like points of a map, x y z, and no heading says that they are "
            "profiles"
        )
    return [(x, column) for column in heights]


def rises(column: Vector) -> bool:
    """Whether a column holds positions, of one trace or of several one after the other."""
    x = column[np.isfinite(column)]
    if x.size < 3:
        return False
    steps = np.diff(x)
    back = min(np.count_nonzero(steps <= 0), np.count_nonzero(steps >= 0))
    return bool(back <= x.size // 10)


def _doubled(column: Vector) -> list[float]:
    """Positions that occur twice in a column that never falls."""
    steps = np.diff(column[np.isfinite(column)])
    never = steps.size > 0 and bool((steps >= 0).all() and (steps > 0).any())
    return column[np.isfinite(column)][1:][steps == 0].tolist() if never else []


def _begins_anew(x: Vector) -> bool:
    steps = np.diff(x[np.isfinite(x)])
    return bool((steps > 0).any() and (steps <= 0).any())


def _constant(column: Vector) -> bool:
    known = column[np.isfinite(column)]
    return known.size > 0 and bool((known == known[0]).all())


def _restarted(x: Vector, z: Vector) -> list[tuple[Vector, Vector]]:
    """The traces of a column in which the positions begin anew."""
    known = np.isfinite(x)
    x, z = x[known], z[known]
    steps = np.diff(x)
    forward = 1 if np.count_nonzero(steps > 0) >= np.count_nonzero(steps < 0) else -1
    places = np.flatnonzero(forward * steps <= 0) + 1
    if (steps[places - 1] == 0).any():
        where = int(x.size and places[np.argmax(steps[places - 1] == 0)])
        raise SurfaceError(f"two points lie at the position {x[where]:g}")
    return list(zip(np.split(x, places), np.split(z, places), strict=True))


def _trimmed(x: Vector | None, z: Vector) -> tuple[Vector | None, Vector]:
    """Without missing heights at the ends."""
    known = np.flatnonzero(np.isfinite(z))
    if not known.size:
        return x, z[:0]
    inner = slice(int(known[0]), int(known[-1]) + 1)
    return None if x is None else x[inner], z[inner]
