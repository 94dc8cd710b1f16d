"""What a likelihood asks of a density: its logarithm beyond the underflow, and alpha from a median."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from microfacet._fit.law import Law

__all__ = ["log_alpha_of_median", "log_density"]

Vector = NDArray[np.float64]
_SMALLEST = 1e-280  # below, the density is about to underflow


def log_alpha_of_median(law: Law, shape: tuple[float, ...], median: float) -> float:
    """alpha from the median slope, which grows with it, by bisection; an end of the range if there is
    none.
    """
    low, high = math.log(median) - 20.0, math.log(median) + 20.0
    for _ in range(60):
        middle = (low + high) / 2
        below = law.quantile(0.5, math.exp(middle), *shape) < median
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
