"""GGX as textbooks have it, and how many operations that is: the measure of what is exported.

Each addition, multiplication, division, function, comparison and choice counts as one, as in graphs, where a
product and a sum in one are one as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

__all__ = ["TEXTBOOK", "operations"]


class Counted:
    """A number that counts in `tally` what is done with it."""

    tally = 0

    def __init__(self, value: float = 0.5, product: bool = False) -> None:
        self.value, self.product = value, product

    def _done(self, value: float, product: bool = False) -> Counted:
        Counted.tally += 1
        return Counted(value, product)

    def _sum(self, other: Any, sign: float) -> Counted:
        other = other if isinstance(other, Counted) else Counted(other)
        fused = next((term for term in (self, other) if term.product), None)
        if fused is not None:  # a product is added as it is made
            fused.product = False
            Counted.tally -= 1
        return self._done(self.value + sign * other.value)

    def __add__(self, other: Any) -> Counted:
        return self._sum(other, 1.0)

    def __sub__(self, other: Any) -> Counted:
        return self._sum(other, -1.0)

    def __rsub__(self, other: float) -> Counted:
        return Counted(other)._sum(self, -1.0)

    def __mul__(self, other: Any) -> Counted:
        return self._done(self.value * (other.value if isinstance(other, Counted) else other), True)

    def __truediv__(self, other: Any) -> Counted:
        return self._done(self.value / (other.value if isinstance(other, Counted) else other))

    def __rtruediv__(self, other: float) -> Counted:
        return self._done(other / self.value)

    def of(self, function: Callable[[float], float]) -> Counted:
        return self._done(function(self.value))

    __radd__, __rmul__ = __add__, __mul__


def density(x: Any, y: Any, z: Any, alpha: Any) -> Any:
    """D of Walter et al. 2007 in Cartesian coordinates; 0 below the horizon."""
    a2 = alpha * alpha
    d = (x * x + y * y) / a2 + z * z
    value = 1.0 / (math.pi * a2 * (d * d))
    return z.of(abs), value.of(abs)  # which stand for the comparison and the choice


def masking(x: Any, y: Any, z: Any, alpha: Any) -> Any:
    """Lambda of Heitz 2014."""
    tangent = (x * x + y * y) / (z * z)
    return 0.5 * ((1.0 + alpha * alpha * tangent).of(math.sqrt) - 1.0)


def visible(x: Any, y: Any, z: Any, alpha: Any, u: Any, v: Any) -> Any:
    """A visible normal, of Dupuy and Benyoub 2023: a point of a spherical cap."""
    a, b = alpha * x, alpha * y
    scale = 1.0 / (a * a + b * b + z * z).of(math.sqrt)
    a, b, c = a * scale, b * scale, z * scale
    phi = 2.0 * math.pi * u
    height = (1.0 - v) * (1.0 + c) - c
    sine = (1.0 - height * height).of(abs).of(math.sqrt)  # abs stands for max(..., 0)
    p, q = sine * phi.of(math.cos) + a, sine * phi.of(math.sin) + b
    p, q, r = alpha * p, alpha * q, height + c
    length = 1.0 / (p * p + q * q + r * r).of(math.sqrt)
    return p * length, q * length, r * length


#: Functions under the names of exports, and how many numbers they take.
TEXTBOOK = {"D": (density, 4), "Lambda": (masking, 4), "sample_visible": (visible, 6)}


def operations(name: str) -> int:
    """How many the textbook's form has."""
    function, count = TEXTBOOK[name]
    Counted.tally = 0
    function(*(Counted() for _ in range(count)))
    return Counted.tally
