"""Derive the start of the inverse of erfc: include/microfacet/special/coefficients/erfc_inverse.hpp.

    python tools/derive_erfc_inverse.py > include/microfacet/special/coefficients/erfc_inverse.hpp

With erfc(t)/2 = v and the depth -log(4v(1 - v)), t^2 over the depth rises from pi/4 to 1. A rational
function of the depth with positive coefficients has it to 2.4e-7 as far as float32 reaches and to 3e-6 as
far as float64 does, where a step of Halley's method follows. The exchange of remez.py does not settle over
so wide a range; Lawson's iteration of weighted least squares does.
"""

from __future__ import annotations

import mpmath
import numpy as np
from mpmath import mpf
from remez import FORMATS, array, header

mpmath.mp.dps = 60
DEGREE, POINTS, ROUNDS = 5, 200, 60


def samples(largest: float) -> tuple[list[mpf], list[mpf]]:
    """depth and t^2/depth at points that are dense near t = 0."""
    angles = (np.arange(POINTS) + 0.5) / POINTS * np.pi
    depth, ratio = [], []
    for t in (mpf(x) for x in largest * ((1 - np.cos(angles)) / 2) ** 1.5):
        v = mpmath.erfc(t) / 2
        depth.append(-mpmath.log(4 * v * (1 - v)))
        ratio.append(t * t / depth[-1])
    return depth, ratio


def least_squares(rows: list[list[mpf]], right: list[mpf]) -> list[mpf]:
    """By the normal equations, whose conditioning so many digits bear; so no library's rounding decides."""
    columns = list(zip(*rows, strict=True))
    normal = mpmath.matrix([[mpmath.fdot(a, b) for a in columns] for b in columns])
    return list(mpmath.lu_solve(normal, mpmath.matrix([mpmath.fdot(a, right) for a in columns])))


def fit(largest: float) -> tuple[float, list[float], list[float]]:
    depth, ratio = samples(largest)
    weight, denominator = [mpf(1)] * POINTS, [mpf(1)] * POINTS
    best: tuple[float, list[float], list[float]] = (np.inf, [], [])
    for _ in range(ROUNDS):
        rows, right = [], []
        for x, r, w, d in zip(depth, ratio, weight, denominator, strict=True):
            scale, powers = w / (d * r), [x**k for k in range(DEGREE + 1)]
            rows.append([p * scale for p in powers] + [-r * p * scale for p in powers[1:]])
            right.append(r * scale)
        solution = least_squares(rows, right)
        above, below = solution[: DEGREE + 1], [mpf(1), *solution[DEGREE + 1 :]]
        denominator = [mpmath.polyval(below[::-1], x) for x in depth]
        errors = [
            float(abs(mpmath.polyval(above[::-1], x) / d / r - 1))
            for x, d, r in zip(depth, denominator, ratio, strict=True)
        ]
        if max(errors) < best[0]:
            best = (max(errors), [float(c) for c in above], [float(c) for c in below])
        weight = [w * mpf(e / max(errors) + 1e-3) ** mpf("0.3") for w, e in zip(weight, errors, strict=True)]
    return best


def text() -> str:
    parts = []
    for (bits, kind), largest in zip(FORMATS, (9.3, 26.5), strict=True):
        error, numerator, denominator = fit(largest)
        comment = f"t^2/depth, t <= {largest}: relative error {error:.1e}"
        parts.append(array(f"erfc_inverse_numerator_{bits}", comment, numerator, kind))
        parts.append(array(f"erfc_inverse_denominator_{bits}", "", denominator, kind))
    return header("derive_erfc_inverse.py", parts)


if __name__ == "__main__":
    print(text(), end="")
