"""Derive the start of the inverse of erfc: include/microfacet/special/erfc_inverse_coefficients.hpp.

    python tools/derive_erfc_inverse.py > include/microfacet/special/erfc_inverse_coefficients.hpp

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

mpmath.mp.dps = 40
DEGREE, POINTS, ROUNDS = 5, 200, 25


def samples(largest: float) -> tuple[list[mpf], list[mpf]]:
    """depth and t^2/depth at points that are dense near t = 0."""
    angles = (np.arange(POINTS) + 0.5) / POINTS * np.pi
    depth, ratio = [], []
    for t in (mpf(x) for x in largest * ((1 - np.cos(angles)) / 2) ** 1.5):
        v = mpmath.erfc(t) / 2
        depth.append(-mpmath.log(4 * v * (1 - v)))
        ratio.append(t * t / depth[-1])
    return depth, ratio


def fit(largest: float) -> tuple[float, list[float], list[float]]:
    depth, ratio = samples(largest)
    weight, denominator = [mpf(1)] * POINTS, [mpf(1)] * POINTS
    best: tuple[float, list[float], list[float]] = (np.inf, [], [])
    for _ in range(ROUNDS):
        rows = np.zeros((POINTS, 2 * DEGREE + 1))
        right = np.zeros(POINTS)
        for i in range(POINTS):
            scale = weight[i] / (denominator[i] * ratio[i])
            powers = [depth[i] ** k for k in range(DEGREE + 1)]
            rows[i] = [float(p * scale) for p in powers] + [float(-ratio[i] * p * scale) for p in powers[1:]]
            right[i] = float(ratio[i] * scale)
        size = np.abs(rows).max(axis=0)
        solution = np.linalg.lstsq(rows / size, right, rcond=1e-16)[0] / size
        above = [mpf(c) for c in solution[: DEGREE + 1]]
        below = [mpf(1), *(mpf(c) for c in solution[DEGREE + 1 :])]
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
