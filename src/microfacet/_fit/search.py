"""The variables in which shape parameters are searched: without ends, where their intervals have some."""

from __future__ import annotations

import math
from dataclasses import dataclass

from microfacet._family import Family, Parameter
from microfacet._family.registry import UNBOUNDED

__all__ = ["Search", "edge_notes", "searches"]


@dataclass(frozen=True)
class Search:
    """log(shape - lower), or log((shape - lower)/(upper - shape)) in an interval with two ends.

    Attributes
    ----------
    parameter : Parameter
        The shape.
    """

    parameter: Parameter

    @property
    def ends(self) -> tuple[float, float]:
        """The variable at the ends of the range that is searched."""
        low, high = self.parameter.fitted
        return self.variable(low), self.variable(high)

    @property
    def _open(self) -> bool:
        return self.parameter.upper >= UNBOUNDED

    def variable(self, shape: float) -> float:
        """Of a value of the shape."""
        above = shape - self.parameter.lower
        return math.log(above) if self._open else math.log(above / (self.parameter.upper - shape))

    def shape(self, variable: float) -> float:
        """The inverse of `variable`."""
        if self._open:
            return self.parameter.lower + math.exp(variable)
        width = self.parameter.upper - self.parameter.lower
        return self.parameter.lower + width / (1 + math.exp(-variable))

    def slope(self, variable: float) -> float:
        """The derivative of `shape`."""
        above = self.shape(variable) - self.parameter.lower
        if self._open:
            return above
        return above * (1 - above / (self.parameter.upper - self.parameter.lower))

    def at(self, share: float) -> float:
        """The variable at a share of the way from one end to the other."""
        low, high = self.ends
        return low + share * (high - low)


def searches(family: Family) -> tuple[Search, ...]:
    """Of the shape parameters of a family, in their order."""
    return tuple(map(Search, family.parameters[1:]))


def edge_notes(family: Family, variables: tuple[float, ...]) -> tuple[str, ...]:
    """What is to be said of shapes at an end of the range that is searched."""
    notes = []
    for search, variable in zip(searches(family), variables, strict=True):
        low, high = search.ends
        if not low < variable < high:
            end = "lower" if variable <= low else "upper"
            notes.append(f"{search.parameter.name} is at the {end} end of the range that is searched")
    return tuple(notes)
