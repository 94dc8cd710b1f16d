"""The likelihood of slopes under one family, with its first and second derivatives.

No density is written here: ``P22`` of the family's kernels is evaluated, at slopes that a linear map has
taken to standard space. A point of the search is a `State`; derivatives are by small changes of it (tangent
coordinates), so that one formula holds everywhere and no parametrisation has a singular place.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._family import Family
from microfacet._fit.search import searches
from microfacet._fit.slopes import Chunk, Slopes

__all__ = ["Model", "Sums", "make_state"]

Vector = NDArray[np.float64]
_SMALLEST = 1e-280  # below, the density is about to underflow
# Step of central differences in logarithmic variables: truncation of the first about 1e-7, and 1e-7 of
# rounding of the kernels in the second.
_STEP = 3e-4
_MANY = 100_000  # slopes for which threads pay


@dataclass(frozen=True, eq=False)
class State:
    """alpha, the map from whitened slopes to standard space, and the variables in which the shape parameters
    are searched, if there are any.

    Families that a linear map stretches keep alpha at 1 and are stretched by `inverse`; for the others
    `inverse` is the unit matrix.
    """

    log_alpha: float
    inverse: NDArray[np.float64]
    shapes: tuple[float, ...]


class Sums(NamedTuple):
    """Over each group: log-likelihood, its gradient and matrix of second derivatives; over all the squares of
    the single slopes' gradients.
    """

    value: Vector
    gradient: Vector
    hessian: Vector
    squares: Vector


class Model:
    """One family and one sample of slopes.

    Tangent coordinates of a family that is stretched: (s, d, e) change standard slopes z to exp(-M) z with
    the symmetric matrix M = ((s + d, e), (e, s - d)); of the others: log alpha. Then the variables of the
    shape parameters (`Search`).
    """

    def __init__(self, family: Family, slopes: Slopes) -> None:
        self.family, self.slopes = family, slopes
        self.stretched, self.searches = family.anisotropic, searches(family)
        self.size = (3 if self.stretched else 1) + len(family.parameters) - 1
        self._log_stretch = math.log(abs(np.linalg.det(slopes.stretch))) if self.stretched else 0.0

    def shape(self, state: State, change: Sequence[float] = ()) -> tuple[float, ...]:
        """The shape parameters, of which there are none or one in the library."""
        changes = change or (0.0,) * len(self.searches)
        return tuple(
            search.shape(variable + by)
            for search, variable, by in zip(self.searches, state.shapes, changes, strict=True)
        )

    def moved(self, state: State, step: Vector) -> State:
        """The state at these tangent coordinates. With the shape, alpha follows so that the median slope
        stays where the step would take it to first order: the likelihood is steep across that valley and
        curved along it.
        """
        log_alpha, inverse, shapes = state.log_alpha, state.inverse, state.shapes
        scale, count = float(step[0]), len(shapes)
        if count:
            new = tuple(
                float(np.clip(variable + by, *search.ends))
                for search, variable, by in zip(self.searches, shapes, step[-count:], strict=True)
            )
            change = [after - before for after, before in zip(new, shapes, strict=True)]
            for own, by in zip(_STEP * np.eye(count), change, strict=True):
                there, back = self._median(state, own.tolist()), self._median(state, (-own).tolist())
                scale += (there - back) / (2 * _STEP) * by
            scale -= self._median(state, change) - self._median(state, [0.0] * count)
            shapes = new
        if not self.stretched:
            return State(log_alpha + scale, inverse, shapes)
        d, e = float(step[1]), float(step[2])
        m = math.hypot(d, e)
        odd = math.sinh(m) / m if m > 0 else 1.0
        remaining = np.array([[math.cosh(m) - odd * d, -odd * e], [-odd * e, math.cosh(m) + odd * d]])
        return State(log_alpha, math.exp(-scale) * remaining @ inverse, shapes)

    def _median(self, state: State, change: Sequence[float]) -> float:
        """log median slope at a changed shape; flat where the family has no closed way to it."""
        if not self.stretched:
            return 0.0
        return math.log(float(self.family.kernels.sample_slope(0.5, 1.0, *self.shape(state, change))))

    def value(self, state: State, only: int | None = None) -> Vector:
        """The log-likelihood of each group, of one fold or of all."""
        shape, offset = self.shape(state), self._offset(state)
        kernels, alpha = self.family.kernels, math.exp(state.log_alpha)

        def work(chunk: Chunk) -> Vector:
            radius = self._radius(state, chunk.where)[0]
            terms = log_density(lambda r: kernels.P22(r, 0.0, alpha, *shape), radius) + offset
            return np.add.reduceat(terms, chunk.starts)

        total = np.zeros(len(self.slopes.sizes))
        for chunk, sums in self._each(work, only=only):
            total[chunk.groups] += sums
        return total

    def sums(self, state: State, without: int | None = None) -> Sums:
        """Log-likelihood and derivatives by the tangent coordinates at a state, without one fold if so
        wished.
        """
        k, groups = self.size, len(self.slopes.sizes)
        upper = np.triu_indices(k)

        def work(chunk: Chunk) -> tuple[Vector, Vector]:
            radius, cosine, sine = self._radius(state, chunk.where)
            terms, first, second = self._derivatives(state, radius, cosine, sine)
            columns = np.stack((terms, *first, *second))
            squares = columns[1 : k + 1] @ columns[1 : k + 1].T
            return np.add.reduceat(columns, chunk.starts, axis=1), squares

        table = np.zeros((groups, 1 + k + len(upper[0])))
        outer = np.zeros((k, k))
        for chunk, (sums, squares) in self._each(work, without=without):
            table[chunk.groups] += sums.T
            outer += squares
        hessian = np.zeros((groups, k, k))
        hessian[:, upper[0], upper[1]] = hessian[:, upper[1], upper[0]] = table[:, 1 + k :]
        return Sums(table[:, 0], table[:, 1 : k + 1], hessian, outer)

    def _each(
        self, work: Callable[[Chunk], Any], without: int | None = None, only: int | None = None
    ) -> Collection[tuple[Chunk, Any]]:
        """The work on every chunk, in order whatever the threads do: the same bits for any number of them."""
        wanted = [c for c in self.slopes.chunks if c.fold != without and (only is None or c.fold == only)]
        if self.slopes.n < _MANY:
            return [(chunk, work(chunk)) for chunk in wanted]
        with ThreadPoolExecutor(min(os.cpu_count() or 1, 16)) as pool:
            return list(zip(wanted, pool.map(work, wanted), strict=True))

    def radius(self, state: State) -> tuple[Vector, Vector, Vector]:
        """`_radius` of all slopes; for a family that is not stretched, radius thrice."""
        return self._radius(state, slice(None))

    def _radius(self, state: State, where: slice) -> tuple[Vector, Vector, Vector]:
        """Lengths of the slopes in standard space, cosine and sine of twice their azimuth there."""
        data = self.slopes
        if not self.stretched:
            radius = np.maximum(data.radius[where], 1e-300)
            return radius, radius, radius
        (a, b), (c, d) = state.inverse
        xx, yy, xy = data.xx[where], data.yy[where], data.xy[where]
        first = a * a * xx + (2 * a * b) * xy + b * b * yy
        second = c * c * xx + (2 * c * d) * xy + d * d * yy
        # Positive but for rounding: slopes.py leaves no slope at zero.
        squared = np.maximum(first + second, 1e-30)
        product = a * c * xx + (a * d + b * c) * xy + b * d * yy
        return np.sqrt(squared), (first - second) / squared, 2 * product / squared

    def _offset(self, state: State) -> float:
        """What the determinants of the maps add to each log density."""
        if not self.stretched:
            return 0.0
        return math.log(abs(np.linalg.det(state.inverse))) - self._log_stretch

    def _derivatives(
        self, state: State, radius: Vector, cosine: Vector, sine: Vector
    ) -> tuple[Vector, list[Vector], list[Vector]]:
        """log P22, its first derivatives, and the upper triangle of the second, at each slope.

        F = log P22(r; exp(u), shape) is a function of log r - u, but for -2 u, where the family can be
        stretched, and exp(-M) changes log r by -s - d cos 2 phi - e sin 2 phi + (d sin 2 phi - e cos 2 phi)^2
        to second order.
        """
        kernels, h = self.family.kernels, _STEP
        # The power of a density that is no stretch multiplies what a change of alpha does.
        g = h if self.stretched else h / (1 + sum(self.shape(state)))

        count = len(self.searches)
        units = (h * np.eye(count)).tolist()

        def at(u: float, change: Sequence[float] = ()) -> Vector:
            shape, alpha = self.shape(state, change), math.exp(state.log_alpha + u)
            return log_density(lambda r: kernels.P22(r, 0.0, alpha, *shape), radius)

        def mixed(both: Vector, first: tuple[Vector, Vector], second: tuple[Vector, Vector]) -> Vector:
            return both - sum(first) - sum(second) + 2 * middle

        middle, alpha_ways = at(0.0), (at(g), at(-g))
        up, down = alpha_ways
        du, duu = (up - down) / (2 * g), (up - 2 * middle + down) / g**2
        terms = middle + self._offset(state)
        ways = [(at(0.0, own), at(0.0, [-x for x in own])) for own in units]
        dk = [(more - less) / (2 * h) for more, less in ways]
        with_alpha = [
            mixed(at(g, own) + at(-g, [-x for x in own]), alpha_ways, way) / (2 * g * h)
            for own, way in zip(units, ways, strict=True)
        ]
        among: list[Vector] = []
        for i, (more, less) in enumerate(ways):
            among.append((more - 2 * middle + less) / h**2)
            for j in range(i + 1, count):
                both = [a + b for a, b in zip(units[i], units[j], strict=True)]
                pair = at(0.0, both) + at(0.0, [-x for x in both])
                among.append(mixed(pair, ways[i], ways[j]) / (2 * h * h))
        if not self.stretched:
            return terms, [du, *dk], [duu, *with_alpha, *among]
        steepness = du + 2  # minus the derivative by log r
        first = [du, steepness * cosine, steepness * sine, *dk]
        second = [
            *(duu, duu * cosine, duu * sine, *with_alpha),
            *(duu * cosine**2 - 2 * steepness * sine**2, (duu + 2 * steepness) * cosine * sine),
            *(own * cosine for own in with_alpha),
            *(duu * sine**2 - 2 * steepness * cosine**2, *(own * sine for own in with_alpha)),
            *among,
        ]
        return terms, first, second


def make_state(model: Model, variables: tuple[float, ...]) -> State:
    """The state that gives the slopes their median, and whitened slopes no direction, for a given shape."""
    family, state = model.family, State(0.0, np.eye(2), variables)
    own = model.shape(state)
    if model.stretched:
        median = float(family.kernels.sample_slope(0.5, 1.0, *own))
        return State(0.0, median * np.eye(2), variables)
    return State(_log_alpha(family, own, float(np.median(model.slopes.radius))), np.eye(2), variables)


def _log_alpha(family: Family, shape: tuple[float, ...], median: float) -> float:
    """alpha from the median slope, which grows with it, by bisection; an end of the range if there is
    none.
    """
    low, high = math.log(median) - 20.0, math.log(median) + 20.0
    for _ in range(60):
        middle = (low + high) / 2
        below = float(family.kernels.sample_slope(0.5, math.exp(middle), *shape)) < median
        low, high = (middle, high) if below else (low, middle)
    return (low + high) / 2


def log_density(density: Callable[[Vector], Vector], radius: Vector) -> Vector:
    """log density(radius), also where the density underflows (outliers under a family with light tails).

    There, the logarithm is continued by the parabola through three points short of the underflow. That is
    exact for Beckmann (-r^2) and close for exponential tails; power laws do not fall so far.
    """
    values = density(radius)
    if values.min() > _SMALLEST:
        return np.log(values)
    low, high = math.log(radius.min()), math.log(radius.max())
    for _ in range(60):
        middle = (low + high) / 2
        fine = density(np.array([math.exp(middle)]))[0] > _SMALLEST
        low, high = (middle, high) if fine else (low, middle)
    edge = math.exp(low)
    nodes = density(edge * np.array([0.5, 0.75, 1.0]))
    if not nodes.min() > 0:  # nothing of the sample lies where this density does
        return np.full_like(radius, -1e9)
    y0, y1, y2 = np.log(nodes)
    curvature = min(y2 - 2 * y1 + y0, 0.0)
    steps = (radius - edge) / (edge / 4)
    continued = y2 + steps * (y2 - y1) + curvature * steps * (steps + 1) / 2
    with np.errstate(divide="ignore"):
        return np.where(radius <= edge, np.log(values), continued)
