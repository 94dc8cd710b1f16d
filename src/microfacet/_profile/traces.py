"""Heights along lines, and their slopes: what is measured, before anything is done to it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from microfacet._profile.lines import chosen_lines
from microfacet._surface import Surface
from microfacet._surface.checks import MAX_PIXELS, SurfaceError, checked_lag, positive, short
from microfacet._value import Value

__all__ = ["Traces", "checked_spacing"]

_FEWEST_POINTS, _FEWEST_VALID = 3, 9


@dataclass(frozen=True, eq=False)
class Traces(Value):
    """The data of a `Profile`, which documents them, and what is read off them."""

    traces: tuple[NDArray[np.float64], ...]
    spacing: float
    unit: str = "m"
    source: str = "array"
    steps: tuple[str, ...] = ()
    lag: int = 1
    cutoff: float | None = None
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        traces = tuple(_trace(trace) for trace in _listed(self.traces))
        total, valid = (sum(map(count, traces)) for count in (np.size, _valid))
        if total > MAX_PIXELS:
            raise SurfaceError(f"a profile of {total} points exceeds the limit of {MAX_PIXELS}")
        if valid < _FEWEST_VALID:
            raise SurfaceError(
                f"the profile has {valid} valid points of {total}, at least {_FEWEST_VALID} are needed"
            )
        self._keep(
            traces=traces,
            spacing=checked_spacing(self.spacing),
            steps=tuple(self.steps),
            warnings=tuple(self.warnings),
            lag=checked_lag(self.lag),
        )

    @classmethod
    def from_surface(
        cls,
        surface: Surface,
        *,
        row: int | slice | Sequence[int] | None = None,
        column: int | slice | Sequence[int] | None = None,
    ) -> Self:
        """Cut a height map along some of its rows, or of its columns.

        Neighbouring rows are nearly the same profile. Traces that count as independent of each other should
        lie farther apart than heights of the map depend on each other.

        Parameters
        ----------
        surface : Surface
            The map.
        row, column : int, slice or sequence of int
            One of the two: which rows (traces along +x) or columns (along +y), counted from 0.

        Returns
        -------
        Profile
            With the map's lag; `steps` name the cut.

        Examples
        --------
        >>> import microfacet as mf
        >>> profile = mf.Profile.from_surface(mf.sample_terrain(), row=slice(0, 344, 86))
        >>> len(profile), profile.points, profile.steps[-1]
        (4, 1612, 'cut along 4 rows: 0, 86, 172, 258')
        """
        if not isinstance(surface, Surface):
            raise SurfaceError(f"surface must be a Surface, got {type(surface).__name__}")
        if (row is None) == (column is None):
            raise SurfaceError("give either row or column: an index, a slice or a sequence of indices")
        name, where = ("row", row) if column is None else ("column", column)
        lines = surface.heights if column is None else surface.heights.T
        chosen = chosen_lines(name, where, len(lines))
        called = ", ".join(map(str, chosen[:8])) + (", ..." if len(chosen) > 8 else "")
        what = f"{name} {called}" if len(chosen) == 1 else f"{len(chosen)} {name}s: {called}"
        return cls(
            tuple(lines[index] for index in chosen if np.isfinite(lines[index]).any()),
            surface.pixel_size[0 if column is None else 1],
            unit=surface.unit,
            source=surface.source,
            steps=(*surface.steps, f"cut along {what}"),
            lag=surface.lag,
        )

    def __len__(self) -> int:
        return len(self.traces)

    @property
    def points(self) -> int:
        """Points of all traces together, valid or not."""
        return sum(trace.size for trace in self.traces)

    @property
    def valid_fraction(self) -> float:
        """The share of the points that have a height."""
        return sum(map(_valid, self.traces)) / self.points

    @property
    def length(self) -> float:
        """Of the longest trace, in metres: from its first point to its last."""
        return (max(trace.size for trace in self.traces) - 1) * self.spacing

    @property
    def lag_length(self) -> float:
        """The lag in metres."""
        return self.lag * self.spacing

    def at_lag(self, lag: int | None = None, *, length: float | None = None) -> Self:
        """The same profile, whose slopes are taken at another lag.

        Parameters
        ----------
        lag : int, optional
            Points to either side, at least 1.
        length : float, optional
            The same in metres: the nearest whole number of points.

        Returns
        -------
        Profile
            With this `lag`; `steps` name it where it comes from a length.

        Examples
        --------
        >>> import microfacet as mf
        >>> mf.Profile.from_surface(mf.sample_terrain(), row=10).at_lag(length=250.0).lag
        3
        """
        if (lag is None) == (length is None):
            raise SurfaceError("give either a lag in points or a length in metres")
        if lag is not None:
            return replace(self, lag=lag)
        points = round(min(positive(length, "the lag length") / self.spacing, 1e9))
        if points < 1:
            raise SurfaceError(f"a lag of {length:g} m is less than half the spacing of {self.spacing:g} m")
        step = f"slopes over a lag of {points} points for {length:g} m"
        return replace(self, lag=points, steps=(*self.steps, step))

    def slopes(self, lag: int | None = None) -> NDArray[np.float64]:
        """Slopes along the line by central differences over `lag` points on each side.

        .. math:: t_i = \\frac{h_{i + l} - h_{i - l}}{2 l\\,dx}

        The baseline is 2 `lag` points; a point of which one of the two is missing or beyond the end of its
        trace is left out.

        Parameters
        ----------
        lag : int, optional
            Points on each side, at least 1; the `lag` of the profile by default.

        Returns
        -------
        ndarray, shape (N,)
            Slopes along +x (dimensionless), trace by trace.

        Raises
        ------
        SurfaceError
            If `lag` is not a positive integer or no point has its two neighbours.

        Examples
        --------
        >>> import numpy as np
        >>> import microfacet as mf
        >>> mf.Profile(np.arange(12.0) ** 2, spacing=2.0).slopes(lag=4)
        array([4., 5., 6., 7.])
        """
        lag = self.lag if lag is None else checked_lag(lag)
        found = np.concatenate([slopes[np.isfinite(slopes)] for slopes in self.slopes_of_traces(lag)])
        if not found.size:
            raise SurfaceError(f"no point has both of its neighbours at lag {lag}")
        return found

    def slopes_of_traces(self, lag: int) -> Iterator[NDArray[np.float64]]:
        """For each trace the slopes at its points with two neighbours, nan where one of them is missing."""
        for trace in self.traces:
            if trace.size <= 2 * lag:
                yield np.empty(0)
            else:
                with np.errstate(over="ignore", invalid="ignore"):
                    yield (trace[2 * lag :] - trace[: -2 * lag]) / (2 * lag * self.spacing)


def checked_spacing(value: Any) -> float:
    """A distance of points in metres, as for the pixels of maps."""
    spacing = positive(value, "spacing")
    if not 1e-30 < spacing < 1e30:
        raise SurfaceError(f"spacing must lie in (1e-30, 1e30) metres, got {spacing:g}")
    return spacing


def _valid(trace: NDArray[np.float64]) -> int:
    return int(np.count_nonzero(np.isfinite(trace)))


def _listed(traces: Any) -> Sequence[Any]:
    """One trace, the rows of an array, or traces of any lengths, as a sequence of traces."""
    if isinstance(traces, np.ndarray):
        if traces.ndim not in (1, 2):
            raise SurfaceError(f"a profile is one trace or a sequence of them, got shape {traces.shape}")
        return [traces] if traces.ndim == 1 else list(traces)
    if not isinstance(traces, Sequence) or isinstance(traces, str | bytes) or len(traces) == 0:
        raise SurfaceError(f"a profile is one trace of heights or a sequence of them, got {short(traces)}")
    return [traces] if np.ndim(traces[0]) == 0 else traces


def _trace(heights: Any) -> NDArray[np.float64]:
    """A copy as float64, nan where it is not valid."""
    try:
        array = np.ma.asarray(heights)
    except (TypeError, ValueError):
        array = np.ma.asarray(None)
    if array.dtype.kind not in "iuf" or array.ndim != 1 or array.size < _FEWEST_POINTS:
        raise SurfaceError(
            f"a trace must be at least {_FEWEST_POINTS} real numbers in a row, "
            f"got {array.dtype} of shape {array.shape}"
        )
    with np.errstate(over="ignore"):
        result = np.array(np.ma.filled(array.astype(np.float64), math.nan))
    result[~np.isfinite(result)] = math.nan
    if _valid(result) and np.nanmax(np.abs(result)) > 1e30:  # squares must stay finite
        raise SurfaceError("heights must lie in [-1e30, 1e30] metres")
    return result
