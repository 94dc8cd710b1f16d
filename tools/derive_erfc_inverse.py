"""Derive the inverses of erfc and of its integral: include/microfacet/special/coefficients/erfc_inverse.hpp.

    python tools/derive_erfc_inverse.py > include/microfacet/special/coefficients/erfc_inverse.hpp

With erfc(t)/2 = v and the depth -log(4v(1 - v)), t^2 over the depth rises from pi/4 to 1. A rational
function of the depth with positive coefficients has it to 2.4e-7 as far as float32 reaches and to 3e-6 as
far as float64 does, where a step of Halley's method follows. For float32 another one has t over log(1 + v),
where t = v ierfc(t)/2, to 1e-7. The exchange of remez.py does not settle over so wide ranges; Lawson's
iteration of weighted least squares does.
"""

from __future__ import annotations

from collections.abc import Callable

import mpmath
import numpy as np
from mpmath import mpf
from remez import FORMATS, array, header

mpmath.mp.dps = 60
POINTS, ROUNDS = 200, 60


def depth_and_square(t: mpf) -> tuple[mpf, mpf]:
    """The depth of erfc(t)/2, and t^2 over it."""
    v = mpmath.erfc(t) / 2
    depth = -mpmath.log(4 * v * (1 - v))
    return depth, t * t / depth


def logarithm_and_slope(t: mpf) -> tuple[mpf, mpf]:
    """log(1 + v) with v = t over ierfc(t)/2, and t over it."""
    excess = mpmath.exp(-t * t) / (2 * mpmath.sqrt(mpmath.pi)) - t * mpmath.erfc(t) / 2
    logarithm = mpmath.log1p(t / excess)
    return logarithm, t / logarithm


def least_squares(rows: list[list[mpf]], right: list[mpf]) -> list[mpf]:
    """By the normal equations, whose conditioning so many digits bear; so no library's rounding decides."""
    columns = list(zip(*rows, strict=True))
    normal = mpmath.matrix([[mpmath.fdot(a, b) for a in columns] for b in columns])
    return list(mpmath.lu_solve(normal, mpmath.matrix([mpmath.fdot(a, right) for a in columns])))


def fit(
    variable_and_ratio: Callable[[mpf], tuple[mpf, mpf]], largest: float, degree: int
) -> tuple[float, list[float], list[float]]:
    angles = (np.arange(POINTS) + 0.5) / POINTS * np.pi
    slopes = largest * ((1 - np.cos(angles)) / 2) ** 1.5  # dense near 0
    variable, ratio = zip(*(variable_and_ratio(mpf(t)) for t in slopes), strict=True)
    weight, denominator = [mpf(1)] * POINTS, [mpf(1)] * POINTS
    best: tuple[float, list[float], list[float]] = (np.inf, [], [])
    for _ in range(ROUNDS):
        rows, right = [], []
        for x, r, w, d in zip(variable, ratio, weight, denominator, strict=True):
            scale, powers = w / (d * r), [x**k for k in range(degree + 1)]
            rows.append([p * scale for p in powers] + [-r * p * scale for p in powers[1:]])
            right.append(r * scale)
        solution = least_squares(rows, right)
        above, below = solution[: degree + 1], [mpf(1), *solution[degree + 1 :]]
        denominator = [mpmath.polyval(below[::-1], x) for x in variable]
        errors = [
            float(abs(mpmath.polyval(above[::-1], x) / d / r - 1))
            for x, d, r in zip(variable, denominator, ratio, strict=True)
        ]
        if max(errors) < best[0]:
            best = (max(errors), [float(c) for c in above], [float(c) for c in below])
        weight = [w * mpf(e / max(errors) + 1e-3) ** mpf("0.3") for w, e in zip(weight, errors, strict=True)]
    return best


def text() -> str:
    parts = []
    for (bits, kind), largest in zip(FORMATS, (9.3, 26.5), strict=True):
        error, numerator, denominator = fit(depth_and_square, largest, 5)
        comment = f"t^2/depth, t <= {largest}: relative error {error:.1e}"
        parts.append(array(f"erfc_inverse_numerator_{bits}", comment, numerator, kind))
        parts.append(array(f"erfc_inverse_denominator_{bits}", "", denominator, kind))
    error, numerator, denominator = fit(logarithm_and_slope, 9.4, 6)
    comment = f"t/log(1 + v), t <= 9.4: relative error {error:.1e}"
    parts.append(array("ierfc_inverse_numerator_32", comment, numerator, FORMATS[0][1]))
    parts.append(array("ierfc_inverse_denominator_32", "", denominator, FORMATS[0][1]))
    return header("derive_erfc_inverse.py", parts)


if __name__ == "__main__":
    print(text(), end="")
