"""Whether the halves of a map agree, and how much its regions differ: is the surface one population?

Nothing is fitted again: scores and information of the cells of the map give the maximum of each part to first
order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from microfacet._fit import blocks
from microfacet._fit.errors import jacobian, parameters
from microfacet._fit.model import Model
from microfacet._fit.newton import Maximum
from microfacet._value import Value

__all__ = ["Halves", "halves", "part_of"]

# Probabilities of halves as different as these by chance, below which they hardly agree and do not. For the
# eight differences of four parameters the first means a root mean square of 1.3 standard errors.
_HARDLY, _NOT = 0.1, 0.01
_REGIONS = 4  # along each side
_FEWEST_SLOPES = 400

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Halves(Value):
    """How the two halves of a map differ, left from right and lower from upper, and its regions.

    Attributes
    ----------
    names : tuple of str
        The parameters that are compared.
    values : tuple of four tuples of float
        The parameters of the left, right, lower and upper half.
    deviations : tuple of two tuples of float
        Differences between left and right, and between lower and upper, in standard errors.
    spread : tuple of float
        Standard deviation of each parameter between 4 x 4 regions of the map, beyond what chance explains, in
        parts of the parameter (of the rotation: in radians).
    """

    names: tuple[str, ...]
    values: tuple[tuple[float, ...], ...]
    deviations: tuple[tuple[float, ...], ...]
    spread: tuple[float, ...]

    @property
    def rms(self) -> float:
        """Root mean square of the differences, in standard errors."""
        numbers = [one for each in self.deviations for one in each]
        return math.sqrt(sum(one * one for one in numbers) / max(len(numbers), 1))

    @property
    def p_value(self) -> float:
        """How often halves of one population differ as much, if parameters were independent of each other."""
        numbers = [one for each in self.deviations for one in each]
        return float(stats.chi2.sf(sum(one * one for one in numbers), len(numbers)))

    @property
    def agree(self) -> bool:
        """Whether that is no more than chance explains: with a probability of at least 0.1."""
        return not self.p_value < _HARDLY

    def sentence(self) -> str:
        """What it means, with the parameter that differs most."""
        axis, column = max(
            ((axis, column) for axis in range(2) for column in range(len(self.names))),
            key=lambda place: abs(self.deviations[place[0]][place[1]]),
        )
        sides = ("the left half", "the right half") if axis == 0 else ("the lower half", "the upper half")
        first, second = self.values[2 * axis][column], self.values[2 * axis + 1][column]
        widest = max(range(len(self.names)), key=lambda k: self.spread[k])
        size = (
            f"{self.spread[widest]:.2g} rad"
            if self.names[widest] == "rotation"
            else (f"{self.spread[widest]:.0%}")
        )
        between = (
            f"; between sixteen regions {self.names[widest]} varies by {size} (standard deviation)"
            if self.spread[widest] > 0
            else ""
        )
        said = "is not" if self.p_value < _NOT else "may not be"
        return (
            f"the surface {said} one population: {self.names[column]} is about {first:.4g} in {sides[0]} and "
            f"{second:.4g} in {sides[1]}, {abs(self.deviations[axis][column]):.1f} standard errors apart "
            f"(root mean square of all such differences: {self.rms:.1f}){between}"
        )


def halves(model: Model, found: Maximum) -> Halves | None:
    """The comparison under one fitted family; None where there is nothing to compare."""
    sizes = model.slopes.sizes
    if not model.slopes.on_map or model.slopes.shape != blocks.WHOLE or not found.free.any():
        return None
    cells = np.arange(blocks.CELLS**2).reshape(blocks.WHOLE)
    middle = blocks.CELLS // 2
    parts = [cells[:, :middle], cells[:, middle:], cells[:middle], cells[middle:]]
    if min(sizes[part].sum() for part in parts) < _FEWEST_SLOPES:
        return None
    values = parameters(model, found.state)
    ways = jacobian(model, found.state)[:, found.free]
    measured = [part_of(found, part, ways) for part in parts]
    if any(one is None for one in measured):
        return None
    kept = [k for k, name in enumerate(values) if all(one[1][k] > 0 for one in measured if one)]
    names, whole = [list(values)[k] for k in kept], np.array([list(values.values())[k] for k in kept])
    changes = [(one[0][kept], one[1][kept]) for one in measured if one]
    deviations = [
        tuple(((b[0] - a[0]) / np.hypot(a[1], b[1])).tolist()) for a, b in (changes[:2], changes[2:])
    ]
    scale = np.array([1.0 if name == "rotation" else abs(values[name]) for name in names])
    return Halves(
        tuple(names),
        tuple(tuple((whole + change).tolist()) for change, _ in changes),
        tuple(deviations),
        tuple((_spread(found, cells, ways)[kept] / scale).tolist()),
    )


def part_of(found: Maximum, part: NDArray[np.intp], ways: Vector) -> tuple[Vector, Vector] | None:
    """By how much the parameters of a rectangle of cells differ from those of the map, and their errors."""
    free = found.free
    gradient = found.sums.gradient[part.ravel()][:, free]
    hessian = found.sums.hessian[part.ravel()][:, free][:, :, free]
    try:
        inverse = np.linalg.inv(-hessian.sum(axis=0))
    except np.linalg.LinAlgError:
        return None
    step = inverse @ gradient.sum(axis=0)
    influence = (gradient + hessian @ step) @ (ways @ inverse).T
    errors = np.array([one.error for one in blocks.variances(influence, True, part.shape)])
    return ways @ step, errors


def _spread(found: Maximum, cells: NDArray[np.intp], ways: Vector) -> Vector:
    """Standard deviations of the parameters between square regions, without those that chance makes."""
    width = blocks.CELLS // _REGIONS
    regions = [
        part_of(found, cells[row : row + width, column : column + width], ways)
        for row in range(0, blocks.CELLS, width)
        for column in range(0, blocks.CELLS, width)
    ]
    known = [one for one in regions if one is not None and np.isfinite(one[0]).all()]
    if len(known) < 2:
        return np.zeros(len(ways))
    changes, errors = (np.array([one[k] for one in known]) for k in range(2))
    beyond = np.var(changes, axis=0, ddof=1) - np.mean(errors**2, axis=0)
    return np.asarray(np.sqrt(np.maximum(beyond, 0.0)))
