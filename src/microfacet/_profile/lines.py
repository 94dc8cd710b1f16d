"""Which rows or columns of a map become traces."""

from __future__ import annotations

from typing import Any

import numpy as np

from microfacet._surface.checks import SurfaceError, short

__all__ = ["chosen_lines"]


def chosen_lines(name: str, where: Any, count: int) -> list[int]:
    """Numbers of the rows or columns that an index, a slice or a sequence of indices names."""
    if isinstance(where, slice):
        return list(range(count))[where] or _no_line(name, where, count)
    try:
        array = np.atleast_1d(np.asarray(where))
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim != 1 or array.dtype.kind not in "iu" or not array.size:
        return _no_line(name, where, count)
    if not ((array >= -count) & (array < count)).all():
        return _no_line(name, where, count)
    return [int(index) % count for index in array]


def _no_line(name: str, where: Any, count: int) -> list[int]:
    raise SurfaceError(f"{name} must name some of the {count} {name}s of the map, got {short(where)}")
