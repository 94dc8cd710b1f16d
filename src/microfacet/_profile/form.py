"""What is subtracted from the heights along a line: a straight line, a polynomial, a circle."""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial import Legendre
from numpy.typing import NDArray
from scipy.optimize import least_squares

from microfacet._surface.checks import SurfaceError

__all__ = ["circle", "polynomial"]

Trace = NDArray[np.float64]


def polynomial(heights: Trace, degree: int) -> Trace:
    """The least-squares polynomial through the valid heights, at every point."""
    valid = np.isfinite(heights)
    if np.count_nonzero(valid) <= degree:
        raise SurfaceError(
            f"a trace of {np.count_nonzero(valid)} valid points is too short for a polynomial of degree "
            f"{degree}"
        )
    x = np.linspace(-1.0, 1.0, heights.size)
    middle = float(np.mean(heights[valid]))
    fitted = Legendre.fit(x[valid], heights[valid] - middle, degree, domain=[-1.0, 1.0])
    return np.asarray(middle + fitted(x))


def circle(heights: Trace, spacing: float) -> tuple[Trace, float]:
    """The least-squares circle (of vertical distances) at every point, and its radius, negative for a hollow.

    Lengths are in units of half the trace while it is searched, from the parabola of the same curvature.
    """
    valid = np.isfinite(heights)
    scale = spacing * (heights.size - 1) / 2
    x = np.linspace(-1.0, 1.0, heights.size)
    middle = float(np.mean(heights[valid]))
    z = (heights - middle) / scale
    offset, tilt, bend = np.polynomial.polynomial.polyfit(x[valid], z[valid], 2)
    bend *= 2
    if abs(bend) < 1e-12:
        raise SurfaceError("the trace has no curvature, so no circle fits it: level it instead")
    bend = math.copysign(min(abs(bend), 0.7), bend)  # the whole trace fits onto the circle, as a start

    def arc(parameters: Trace, at: Trace) -> Trace:
        height, apex, curvature = parameters
        square = (at - apex) ** 2
        root = np.sqrt(np.maximum(1 - curvature**2 * square, 0.0))
        return np.asarray(height + curvature * square / (1 + root))  # regular where it is nearly flat

    start = np.array([offset - tilt**2 / (2 * bend), -tilt / bend, bend])

    def residual(parameters: Trace) -> Trace:
        return arc(parameters, x[valid]) - z[valid]

    found = np.asarray(least_squares(residual, start, x_scale=np.abs(start) + 1e-3).x)
    return middle + scale * arc(found, x), -scale / float(found[2])
