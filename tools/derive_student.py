"""Derive the coefficients of include/microfacet/special/coefficients/student.hpp in arbitrary precision.

    python tools/derive_student.py > include/microfacet/special/coefficients/student.hpp

Both tails of Student's density are a hypergeometric function of order K = k + 10 and of q = log(1 + t^2/k).
With z = exp(-q), w = 1 - z, kappa = 1/K, xi = sqrt(q K) and r = Gamma(K + 1/2)/(Gamma(K) sqrt(K)):

    excess: kappa r 2F1(1, K - 1/2; K + 1; z)/(4 sqrt(pi))
                = (1/2 - kappa/4) sqrt(w/q) exp(xi^2) ierfc(xi) + kappa E(q, kappa)
    tail:   sqrt(w kappa) r 2F1(1, K + 1/2; K + 1; z)/(2 sqrt(pi))
                = exp(xi^2) erfc(xi)/2 + sqrt(q kappa) S(q, kappa)

The leading terms are the limit K -> inf, uniformly in q (N. M. Temme, SIAM J. Math. Anal. 13, 1982); E and S
are positive and so smooth that polynomials in q and kappa serve. They are fitted by least squares, weighed
with what an error contributes to the result: exp(-10 q) and less; q ends where that is below rounding.
"""

from __future__ import annotations

import sys

import mpmath
from flint import arb, ctx
from mpmath import mpf
from remez import FORMATS, Problem, array, minimax, powers, rounded
from surfaces import Shape, Surface, bivariate, bivariate_header, fitted

ctx.prec = 400
mpmath.mp.dps = 60
SHIFT = 10
HALF = arb(1) / 2
END = {32: arb(2), 64: arb(15) / 4}  # of q
EXCESS: dict[int, Shape] = {32: (4, 3, 1), 64: (11, 10, 8, 7, 6, 5, 4, 2)}
TAIL: dict[int, Shape] = {32: (4, 3, 1), 64: (11, 9, 8, 7, 5, 4, 3, 2)}
DEGREE = {32: 3, 64: 8}  # of r in kappa


def half_step(k: arb) -> arb:
    """Gamma(k + 1/2)/Gamma(k)."""
    return ((k + HALF).lgamma() - k.lgamma()).exp()


def erfc_scaled(x: arb) -> arb:
    return (x * x).exp() * x.erfc()


def hypergeometric(k: arb, order: arb, z: arb) -> arb:
    """2F1(1, k + order; k + 1; z); where that is slow, by the continued fraction of DLMF 15.7.5."""
    w = 1 - z
    if k * w < 20 or z < 0.3:
        return z.hypgeom_2f1(arb(1), k + order, k + 1)
    rest, y, a = arb(1), z / w, 1 - order
    for n in range(500, -1, -1):
        rest = 1 + (a + n) * (k + n) * y / ((k + 2 * n) * (k + 2 * n + 1)) / rest
        if n > 0:
            rest = 1 + n * (k - a + n) * y / ((k + 2 * n - 1) * (k + 2 * n)) / rest
    return 1 / (w * rest)


def weight(k: arb, z: arb, order: arb, value: arb) -> arb:
    """dU/dV over U, for U = 2F1(1, k + order; k + 1; z) by SHIFT terms and V, the same at k + SHIFT."""
    term, total = arb(1), arb(0)
    for j in range(SHIFT):
        total += term
        term *= z * (k + j + order) / (k + j + 1)
    return term / (total + term * value)


def excess(q: arb, kappa: arb) -> tuple[arb, arb]:
    """E, and the relative change of the result with it."""
    k, z = 1 / kappa, (-q).exp()
    value = hypergeometric(k, -HALF, z)
    xi = (q * k).sqrt()
    ierfc = 1 / arb.pi().sqrt() - xi * erfc_scaled(xi)
    scale = kappa * half_step(k) / k.sqrt() / (4 * arb.pi().sqrt())
    rest = scale * value - (HALF - kappa / 4) * ((1 - z) / q).sqrt() * ierfc
    return rest / kappa, weight(k - SHIFT, z, -HALF, value) * kappa / scale


def tail(q: arb, kappa: arb) -> tuple[arb, arb]:
    """S, and the relative change of the result with it."""
    k, z = 1 / kappa, (-q).exp()
    value = hypergeometric(k, HALF, z)
    scale = ((1 - z) * kappa).sqrt() * half_step(k) / k.sqrt() / (2 * arb.pi().sqrt())
    root = (q * kappa).sqrt()
    rest = scale * value - erfc_scaled((q * k).sqrt()) / 2
    return rest / root, weight(k - SHIFT, z, HALF, value) * root / scale


def surfaces(name: str, form: str, surface: Surface, shapes: dict[int, Shape]) -> list[str]:
    parts = []
    for bits, kind in FORMATS:
        end, shape = END[bits], shapes[bits]
        coefficients, error = fitted(surface, (arb(0), end), (arb(0), arb(1) / SHIFT), shape)
        comment = f"{form} in q - {float(end / 2)} and kappa, q <= {float(end)}: error {error:.1e}"
        parts.append(bivariate(f"student_{name}_{bits}", comment, shape, coefficients, kind))
    return parts


def half_step_series() -> list[str]:
    def r(kappa: mpf) -> mpf:
        if kappa == 0:
            return mpf(1)
        k = 1 / kappa
        return mpmath.exp(mpmath.loggamma(k + mpf(1) / 2) - mpmath.loggamma(k)) * mpmath.sqrt(kappa)

    parts = []
    for bits, kind in FORMATS:
        end = mpf(1) / SHIFT
        problem = Problem(lambda x: r(x) - 1, lambda x: 1 / r(x), mpf(0), end, powers(1, DEGREE[bits]))
        fit = rounded(problem, minimax(problem), kind)
        comment = f"Gamma(k + 1/2)/(Gamma(k) sqrt(k)) in 1/k <= 1/{SHIFT}: error {mpmath.nstr(fit.error, 2)}"
        parts.append(array(f"gamma_half_step_{bits}", comment, [mpf(1), *fit.numerator], kind))
    return parts


def text() -> str:
    parts = [
        *half_step_series(),
        *surfaces("excess", "E", excess, EXCESS),
        *surfaces("tail", "S", tail, TAIL),
    ]
    return bivariate_header("derive_student.py", parts)


if __name__ == "__main__":
    sys.stdout.write(text())
