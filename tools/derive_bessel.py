"""Derive the coefficients of include/microfacet/special/coefficients/bessel.hpp in arbitrary precision.

    python tools/derive_bessel.py > include/microfacet/special/coefficients/bessel.hpp

* near: for w = y^2 <= 1/16 and abs(mu) <= 1/2, F(mu) = (I_mu(2y)/y^mu - 1/Gamma(1 + mu))/w and
  G(mu) = I_{mu+1}(2y)/y^(mu+1), each as even + mu odd, in w - 1/32 and mu^2.
* far: for y >= 1/4, 2 sqrt(y) exp(2y) times K_mu(2y) and -K'_mu(2y), which are even in mu, in
  t = (3 - r)/(1 + r), r = sqrt(4y), and mu^2. t is 1 at y = 1/4 and -1 at infinity.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection
from functools import cache

from flint import arb, ctx
from surfaces import Interval, Shape, Surface, bivariate_header, both_formats, relative

ctx.prec = 300
HALF = arb(1) / 2
SQUARES: Interval = (arb(0), arb(1) / 4)
NEAR_W: Interval = (arb(0), arb(1) / 16)
NEAR: dict[int, Shape] = {32: (3, 3, 2, 1), 64: (6, 6, 5, 5, 4, 3, 2, 1)}
T: Interval = (arb(-1), arb(1))
FAR: dict[int, Shape] = {32: (10, 10, 9, 7, 4), 64: (23, 23, 21, 17, 16, 14, 12, 8)}
FAR_SLOPE: dict[int, Shape] = {32: (13, 13, 12, 10, 7), 64: (25, 25, 24, 22, 20, 18, 15, 11)}


def series(mu: arb, w: arb, first: int) -> arb:
    """sum_j w^j/((j + 1 - first)! Gamma(j + 2 + mu)), j >= 0: F for first = 0, G for first = 1."""
    total, term = arb(0), (mu + 2).rgamma()
    for j in range(60):
        total += term
        term *= w / ((j + 2 - first) * (j + 2 + mu))
    return total


def even(first: int) -> Surface:
    return lambda w, v: ((series(v.sqrt(), w, first) + series(-v.sqrt(), w, first)) / 2, arb(1))


def odd(first: int) -> Surface:
    return lambda w, v: ((series(v.sqrt(), w, first) - series(-v.sqrt(), w, first)) / (2 * v.sqrt()), arb(1))


def y_of(t: arb) -> arb:
    return ((3 - t) / (1 + t)) ** 2 / 4


@cache
def bessel(y: arb, mu: arb) -> tuple[arb, arb]:
    """2 sqrt(y) exp(2y) times K_mu(2y) and -K'_mu(2y), by the trapezoidal rule: it converges exponentially.

    K_mu(z) = int_0^inf exp(-z cosh s) cosh(mu s) ds (DLMF 10.32.9).
    """
    step = arb(min(0.05, 0.35 / float((2 * y).sqrt())))
    value, slope, j = HALF, HALF, 0
    while True:
        j += 1
        c = (j * step).cosh()
        term = (-2 * y * (c - 1)).exp() * (mu * j * step).cosh()
        value, slope = value + term, slope + term * c
        if term * c < arb(10) ** -40:
            return 2 * y.sqrt() * step * value, 2 * y.sqrt() * step * slope


def far(index: int) -> Surface:
    return relative(lambda t, v: bessel(y_of(t).mid(), v.sqrt().mid())[index])


GROUPS: dict[str, Callable[[], list[str]]] = {
    "near": lambda: [
        *both_formats("bessel_near_f_even", "F, even, in w - 1/32 and mu^2", even(0), NEAR_W, SQUARES, NEAR),
        *both_formats("bessel_near_f_odd", "F, odd", odd(0), NEAR_W, SQUARES, NEAR),
        *both_formats("bessel_near_g_even", "G, even", even(1), NEAR_W, SQUARES, NEAR),
        *both_formats("bessel_near_g_odd", "G, odd", odd(1), NEAR_W, SQUARES, NEAR),
    ],
    "far": lambda: [
        *both_formats("bessel_far", "K_mu, in t and mu^2", far(0), T, SQUARES, FAR),
        *both_formats("bessel_far_slope", "-K'_mu", far(1), T, SQUARES, FAR_SLOPE),
    ],
}


def text(names: Collection[str] = tuple(GROUPS)) -> str:
    """The header, or as much of it as concerns some groups."""
    parts = [part for name in names for part in GROUPS[name]()]
    return bivariate_header("derive_bessel.py", parts)


if __name__ == "__main__":
    sys.stdout.write(text(sys.argv[1:] or tuple(GROUPS)))
