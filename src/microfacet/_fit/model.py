"""The likelihood of slopes under one family, with its first and second derivatives.

No density is written here: ``P22`` of the family's kernels is evaluated, at slopes that a linear map has
taken to standard space. A point of the search is a `State`; derivatives are by small changes of it (tangent
coordinates), so that one formula holds everywhere and no parametrisation has a singular place.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._family import Family
from microfacet._fit.density import log_alpha_of_median, log_density
from microfacet._fit.law import Law
from microfacet._fit.search import searches
from microfacet._fit.slopes import Chunk, Slopes
from microfacet._threads import threads

__all__ = ["ANISOTROPIC", "ISOTROPIC", "PROFILE", "Model", "State", "Sums", "make_state", "symmetries"]

#: What is fitted of a family: one roughness, one along each of two axes, or that along the line of a profile.
ISOTROPIC, ANISOTROPIC, PROFILE = "isotropic", "anisotropic", "profile"

Vector = NDArray[np.float64]
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


def symmetries(family: Family) -> tuple[str, ...]:
    """Those that a family can have, the one with fewer parameters first."""
    return (ISOTROPIC, ANISOTROPIC) if family.anisotropic else (ISOTROPIC,)


class Model:
    """One family of one symmetry and one sample of slopes.

    Tangent coordinates of a family that is stretched: (s, d, e) change standard slopes z to exp(-M) z with
    the symmetric matrix M = ((s + d, e), (e, s - d)), and s alone where the symmetry is isotropic; of the
    others: log alpha. Then the variables of the shape parameters (`Search`).
    """

    def __init__(self, family: Family, slopes: Slopes, symmetry: str) -> None:
        self.family, self.slopes, self.symmetry = family, slopes, symmetry
        self.law, self.searches = Law(family.kernels, symmetry == PROFILE), searches(family)
        self.stretched = family.anisotropic and symmetry != PROFILE
        self.first_shape = 3 if symmetry == ANISOTROPIC else 1  # coordinate of the first shape parameter
        self.size = self.first_shape + len(family.parameters) - 1
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
            bend = self._median(state, [0.0] * count) - self._median(state, change)
            for own, by in zip(_STEP * np.eye(count), change, strict=True):
                there, back = self._median(state, own.tolist()), self._median(state, (-own).tolist())
                bend += (there - back) / (2 * _STEP) * by
            # Where no alpha gives that median there is no such valley.
            scale += bend if self.family.anisotropic or abs(bend) < 1 else 0.0
            shapes = new
        if not self.stretched:
            return State(log_alpha + scale, inverse, shapes)
        d, e = (float(step[1]), float(step[2])) if self.first_shape == 3 else (0.0, 0.0)
        m = math.hypot(d, e)
        odd = math.sinh(m) / m if m > 0 else 1.0
        remaining = np.array([[math.cosh(m) - odd * d, -odd * e], [-odd * e, math.cosh(m) + odd * d]])
        return State(log_alpha, math.exp(-scale) * remaining @ inverse, shapes)

    def _median(self, state: State, change: Sequence[float]) -> float:
        """log median slope at a changed shape, for alpha 1; where alpha is no stretch, minus the log alpha
        that leaves the median where it is.
        """
        law, shape = Law(self.family.kernels, False), self.shape(state, change)
        if self.family.anisotropic:
            return math.log(law.quantile(0.5, 1.0, *shape))
        median = law.quantile(0.5, math.exp(state.log_alpha), *self.shape(state))
        return -log_alpha_of_median(law, shape, median)

    def value(self, state: State, only: int | None = None) -> Vector:
        """The log-likelihood of each group, of one fold or of all."""
        total = np.zeros(len(self.slopes.sizes))
        for chunk, sums in self._each(
            lambda chunk: np.add.reduceat(self._terms(state, chunk.where), chunk.starts), only=only
        ):
            total[chunk.groups] += sums
        return total

    def each(self, states: Sequence[State]) -> Vector:
        """The log-likelihood of each slope, under the state of its fold."""
        found = np.empty(self.slopes.n)
        for chunk, terms in self._each(lambda chunk: self._terms(states[chunk.fold], chunk.where)):
            found[chunk.where] = terms
        return found

    def _terms(self, state: State, where: slice) -> Vector:
        shape, alpha = self.shape(state), math.exp(state.log_alpha)
        radius = self._radius(state, where)[0]
        return log_density(lambda r: self.law.density(r, alpha, *shape), radius) + self._offset(state)

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
        with ThreadPoolExecutor(min(threads(), 16)) as pool:
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
        law, h = self.law, _STEP
        # The power of a density that is no stretch multiplies what a change of alpha does.
        g = h if self.family.anisotropic else h / (1 + sum(self.shape(state)))

        count = len(self.searches)
        units = (h * np.eye(count)).tolist()

        def at(u: float, change: Sequence[float] = ()) -> Vector:
            shape, alpha = self.shape(state, change), math.exp(state.log_alpha + u)
            return log_density(lambda r: law.density(r, alpha, *shape), radius)

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
        if self.symmetry != ANISOTROPIC:
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
    """The state that gives the slopes their median for a given shape, and no direction to whitened slopes or,
    where the symmetry is isotropic, those of the slopes as they are.
    """
    slopes, own = model.slopes, model.shape(State(0.0, np.eye(2), variables))
    if not model.stretched:
        log_alpha = log_alpha_of_median(model.law, own, float(np.median(slopes.radius)))
        return State(log_alpha, np.eye(2), variables)
    median = model.law.quantile(0.5, 1.0, *own)
    if model.symmetry == ISOTROPIC:
        return State(0.0, median / float(np.median(slopes.radius)) * slopes.stretch, variables)
    return State(0.0, median * np.eye(2), variables)
