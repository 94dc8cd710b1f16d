"""Derive the coefficients of include/microfacet/special/variance_gamma_*.hpp in arbitrary precision.

    python tools/derive_variance_gamma.py tail > include/.../special/coefficients/variance_gamma_tail.hpp
    (likewise excess)

Gamma(a) y^(1-a) exp(2y) times the tails Pr(slope > y) and E[(slope - y)_+] of the variance-gamma density of
order a = mu + 1/2 (special/variance_gamma.hpp), for y >= 1/4 and 0 <= a <= 1, in mu and the t of
derive_bessel.py. And log(Gamma(1/2 - a)/(sqrt(pi) Gamma(1 + a)))/a for a <= 1/8, with which the tail of small
a does not cancel near the centre.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache

import mpmath
from derive_bessel import HALF, T, y_of
from flint import arb, ctx
from mpmath import mpf
from remez import FORMATS, Problem, array, minimax, powers, rounded
from surfaces import Interval, Shape, Surface, bivariate_header, both_formats, relative

ctx.prec = 300
mpmath.mp.dps = 60
CENTRE = {32: 5, 64: 14}  # degree
ORDERS: Interval = (-HALF, HALF)
TAIL: dict[int, Shape] = {
    32: (14, 14, 12, 11, 9, 7, 7, 7, 5),
    64: (31, 31, 30, 28, 26, 24, 22, 19, 17, 16, 15, 14, 12, 11, 9, 6),
}
EXCESS: dict[int, Shape] = {
    32: (15, 15, 13, 12, 10, 9, 7, 7, 6),
    64: (33, 33, 31, 30, 28, 26, 22, 20, 18, 16, 15, 14, 13, 11, 9, 7),
}


@cache
def tails(y: arb, a: arb) -> tuple[arb, arb]:
    """By the trapezoidal rule, which converges exponentially.

    The density is that of Gaussians of variance m/2, m distributed as Gamma(a, 1): averages of their tails
    over s = log(m/y).
    """
    step = arb(min(0.16, 0.24 / float(y.sqrt())))
    sf, excess = arb(0), arb(0)
    for direction in (1, -1):
        j = 0 if direction > 0 else -1
        while True:
            s = step * j
            root, x = y.sqrt() * (s / 2).exp(), y.sqrt() * (-s / 2).exp()  # sqrt(m), y/sqrt(m)
            weight = (s * a - (root - x) * (root - x)).exp()
            if weight < arb(10) ** -40 and abs(j) > 5:
                break
            erfc = (x * x).exp() * x.erfc()
            sf += weight * erfc / 2
            excess += weight * root * (1 / arb.pi().sqrt() - x * erfc) / 2
            j += direction
    return sf * y * step, excess * y * step


def of_order(index: int) -> Surface:
    return relative(lambda t, mu: tails(y_of(t).mid(), (mu + HALF).mid())[index])


def centre() -> list[str]:
    def exponent(a: mpf) -> mpf:
        if a == 0:
            return 2 * (mpmath.euler + mpmath.log(2))
        gammas = mpmath.loggamma(mpf(1) / 2 - a) - mpmath.loggamma(1 + a)
        return (gammas - mpmath.log(mpmath.pi) / 2) / a

    parts = []
    for bits, kind in FORMATS:
        problem = Problem(exponent, lambda a: 1 / exponent(a), mpf(0), mpf(1) / 8, powers(0, CENTRE[bits]))
        fit = rounded(problem, minimax(problem), kind)
        comment = (
            f"log(Gamma(1/2 - a)/(sqrt(pi) Gamma(1 + a)))/a, a <= 1/8: error {mpmath.nstr(fit.error, 2)}"
        )
        parts.append(array(f"variance_gamma_centre_{bits}", comment, fit.numerator, kind))
    return parts


GROUPS: dict[str, Callable[[], list[str]]] = {
    "tail": lambda: [
        *centre(),
        *both_formats("variance_gamma_tail", "Pr(slope > y), in t and mu", of_order(0), T, ORDERS, TAIL),
    ],
    "excess": lambda: both_formats(
        "variance_gamma_excess", "E[(slope - y)_+], in t and mu", of_order(1), T, ORDERS, EXCESS
    ),
}


if __name__ == "__main__":
    (group,) = sys.argv[1:]
    sys.stdout.write(bivariate_header("derive_variance_gamma.py", GROUPS[group]()))
