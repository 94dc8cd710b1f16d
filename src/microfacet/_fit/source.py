"""Where slopes come from: a map, of whose slopes some may be drawn, a normal map, or slopes alone."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._fit import blocks
from microfacet._fit.draw import draw
from microfacet._surface import SlopeSample, Surface
from microfacet._surface.checks import checked_lag

__all__ = ["Source", "source_of"]


class Source(NamedTuple):
    """What was given if it has positions, its slopes at the lag, their cells, the lag, and remarks."""

    given: Surface | SlopeSample | None
    raw: ArrayLike
    cells: NDArray[np.int16] | None
    lag: int | None
    notes: tuple[str, ...] = ()


def source_of(given: Any, lag: int | None, most: int | None) -> Source:
    """Slopes of a map, drawn if there are more than so many, or those that were given."""
    if isinstance(given, Surface):
        lag = given.lag if lag is None else lag
        drawn = draw(given, checked_lag(lag), most)
        return Source(given, drawn.slopes, drawn.cells, lag, drawn.notes)
    if isinstance(given, SlopeSample) and given.grid is not None:
        sample = given if lag is None else given.at_lag(lag)
        cells = None if sample.grid is None else blocks.cells_of_grid(sample.grid)
        return Source(sample, sample.values, cells, sample.lag)
    if lag is not None:
        raise ValueError(f"lag applies to a Surface or a normal map, not to slopes alone, got {lag}")
    return Source(given if isinstance(given, SlopeSample) else None, given, None, None)
