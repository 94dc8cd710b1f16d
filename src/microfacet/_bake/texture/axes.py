"""Where the texels of a lookup texture lie: its axes, and what a coordinate between 0 and 1 stands for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["MAPPINGS", "Axis", "shape_axis", "texel_axis"]

Array = NDArray[Any]


@dataclass(frozen=True)
class _Mapping:
    """A function and its inverse, and how the function is written in every language of the snippets."""

    forward: Callable[[Array], Array]
    inverse: Callable[[Array], Array]
    text: str


def _same(x: Array) -> Array:
    return x


MAPPINGS = {
    "linear": _Mapping(_same, _same, "{}"),
    "sqrt": _Mapping(np.sqrt, np.square, "sqrt({})"),
    "log": _Mapping(np.log, np.exp, "log({})"),
    "reciprocal": _Mapping(np.reciprocal, np.reciprocal, "1.0 / {}"),
}


@dataclass(frozen=True)
class Axis:
    """Texels with equal steps in a function of a quantity.

    Attributes
    ----------
    name : str
        The quantity.
    mapping : {"linear", "sqrt", "log", "reciprocal"}
        The function of it that has equal steps.
    low, high : float
        The quantity where the coordinate is 0 and 1: at the edges of an image, whose texel i of n lies at
        (i + 0.5)/n, and in the first and last slice of the third axis.
    count : int
        How many texels, or slices.
    values : tuple of float
        The quantity in each of them.
    """

    name: str
    mapping: str
    low: float
    high: float
    count: int
    values: tuple[float, ...]

    def coordinate(self, value: ArrayLike) -> Array:
        """Between 0 and 1 inside the range, where a value lies."""
        if self.count == 1 and self.low == self.high:
            return np.zeros(np.shape(value))
        forward = MAPPINGS[self.mapping].forward
        low, high = forward(np.array(self.low)), forward(np.array(self.high))
        return np.asarray((forward(np.asarray(value, np.float64)) - low) / (high - low))

    def at(self, coordinate: ArrayLike) -> Array:
        """The value at a coordinate, the inverse of `coordinate`."""
        mapping = MAPPINGS[self.mapping]
        low, high = mapping.forward(np.array(self.low)), mapping.forward(np.array(self.high))
        return np.asarray(mapping.inverse(low + (high - low) * np.asarray(coordinate, np.float64)))


def texel_axis(name: str, mapping: str, count: int) -> Axis:
    """An axis of an image, from 0 to 1 of the quantity."""
    centres = MAPPINGS[mapping].inverse((np.arange(count) + 0.5) / count)
    return Axis(name, mapping, 0.0, 1.0, count, tuple(centres.tolist()))


def shape_axis(name: str, values: tuple[float, ...]) -> Axis:
    """The third axis: slices whose steps are equal in one of the mappings, which is found here."""
    grid = np.array(values)
    if len(grid) < 3:
        return Axis(name, "linear", values[0], values[-1], len(grid), values)
    for mapping in ("linear", "log", "reciprocal"):
        if mapping != "linear" and grid[0] <= 0:
            continue
        steps = np.diff(MAPPINGS[mapping].forward(grid))
        if np.ptp(steps) <= 1e-6 * np.abs(steps).max():
            return Axis(name, mapping, values[0], values[-1], len(grid), values)
    raise ValueError(
        f"lookup_texture: the steps of {name} must be equal, or those of its logarithm or reciprocal, got "
        f"{', '.join(f'{value:g}' for value in values)}"[:400]
    )
