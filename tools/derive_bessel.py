"""Derive the coefficients of include/microfacet/special/bessel_coefficients.hpp in arbitrary precision.

    python tools/derive_bessel.py > include/microfacet/special/bessel_coefficients.hpp

* For w = y^2 <= 1/16 and abs(mu) <= 1/2: F(mu) = (I_mu(2y)/y^mu - 1/Gamma(1 + mu))/w and
  G(mu) = I_{mu+1}(2y)/y^(mu+1), each as even + mu odd, in w and mu^2.
* For y >= 1/4, in t = (3 - r)/(1 + r), r = sqrt(4y), which is 1 at 1/4 and -1 at infinity:
  2 sqrt(y) exp(2y) K_mu(2y) and -2 sqrt(y) exp(2y) K'_mu(2y), both even in mu, in t and mu^2;
  and the tails of the variance-gamma density of a = mu + 1/2, Gamma(a) y^(1-a) exp(2y) Pr(slope > y) and
  Gamma(a) y^(1-a) exp(2y) E[(slope - y)_+], in t and mu.

Integrals by the trapezoidal rule, which converges exponentially: K_mu(z) = int_0^inf exp(-z cosh s) cosh(mu s) ds
(DLMF 10.32.9), and for the tails those of Gaussians of variance m/2, averaged over m = y exp(s) with the weight
m^(a-1) exp(-m).
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache

from flint import arb, ctx
from remez import FORMATS, header
from surfaces import Interval, Shape, Surface, bivariate, fitted

ctx.prec = 300
SMALL = arb(10) ** -40
START = arb(1) / 4
HALF = arb(1) / 2
SPREAD = 2  # t = (SPREAD + 1 - r)/(SPREAD - 1 + r)

NEAR = {32: (3, 2, 2), 64: (5, 5, 4, 3, 2)}
FAR: dict[str, dict[int, Shape]] = {
    "bessel_far": {32: (10, 10, 9, 7, 4), 64: (23, 23, 21, 17, 16, 14, 12, 8)},
    "bessel_far_slope": {32: (13, 13, 12, 10, 7), 64: (25, 25, 24, 22, 20, 18, 15, 11)},
    "variance_gamma_tail": {
        32: (14, 14, 12, 11, 9, 7, 7, 7, 5),
        64: (31, 31, 30, 28, 26, 24, 22, 19, 17, 16, 15, 14, 12, 11, 9, 6),
    },
    "variance_gamma_excess": {
        32: (15, 15, 13, 12, 10, 9, 7, 7, 6),
        64: (33, 33, 31, 30, 28, 26, 22, 20, 18, 16, 15, 14, 13, 11, 9, 7),
    },
}


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


def slope(t: arb) -> arb:
    """y."""
    return START * (1 + SPREAD * (1 - t) / (1 + t)) ** 2


@cache
def bessel(y: arb, mu: arb) -> tuple[arb, arb]:
    """2 sqrt(y) exp(2y) times K_mu(2y) and -K'_mu(2y)."""
    step = arb(min(0.05, 0.35 / float((2 * y).sqrt())))
    value, slope_, j = HALF, HALF, 0
    while True:
        j += 1
        c = (j * step).cosh()
        term = (-2 * y * (c - 1)).exp() * (mu * j * step).cosh()
        value, slope_ = value + term, slope_ + term * c
        if term * c < SMALL:
            return 2 * y.sqrt() * step * value, 2 * y.sqrt() * step * slope_


@cache
def tails(y: arb, a: arb) -> tuple[arb, arb]:
    """Gamma(a) y^(1-a) exp(2y) times Pr(slope > y) and E[(slope - y)_+]."""
    step = arb(min(0.16, 0.24 / float(y.sqrt())))
    sf, excess = arb(0), arb(0)
    for direction in (1, -1):
        j = 0 if direction > 0 else -1
        while True:
            s = step * j
            root, x = y.sqrt() * (s / 2).exp(), y.sqrt() * (-s / 2).exp()  # sqrt(m), y/sqrt(m)
            weight = (s * a - (root - x) * (root - x)).exp()
            if weight < SMALL and abs(j) > 5:
                break
            erfc = (x * x).exp() * x.erfc()
            sf += weight * erfc / 2
            excess += weight * root * (1 / arb.pi().sqrt() - x * erfc) / 2
            j += direction
    return sf * y * step, excess * y * step


def relative(function: Callable[[arb, arb], arb]) -> Surface:
    def surface(t: arb, v: arb) -> tuple[arb, arb]:
        value = function(slope(t).mid(), v).mid()
        return value, 1 / value

    return surface


def parts(name: str, comment: str, surface: Surface, x: Interval, y: Interval, shapes: dict[int, Shape]) -> list[str]:
    text = []
    for bits, kind in FORMATS:
        coefficients, error = fitted(surface, x, y, shapes[bits])
        text.append(bivariate(f"{name}_{bits}", f"{comment}: error {error:.1e}", shapes[bits], coefficients, kind))
    return text


def text() -> str:
    squares, signed = (arb(0), arb(1) / 4), (-HALF, HALF)
    w, t = (arb(0), arb(1) / 16), (arb(-1), arb(1))
    near = [
        *parts("bessel_near_f_even", "F, even, in w - 1/32 and mu^2", even(0), w, squares, NEAR),
        *parts("bessel_near_f_odd", "F, odd", odd(0), w, squares, NEAR),
        *parts("bessel_near_g_even", "G, even", even(1), w, squares, NEAR),
        *parts("bessel_near_g_odd", "G, odd", odd(1), w, squares, NEAR),
    ]
    functions: dict[str, tuple[str, Callable[[arb, arb], arb], Interval]] = {
        "bessel_far": ("K_mu in t and mu^2", lambda y, v: bessel(y, v.sqrt().mid())[0], squares),
        "bessel_far_slope": ("-K'_mu", lambda y, v: bessel(y, v.sqrt().mid())[1], squares),
        "variance_gamma_tail": ("Pr(slope > y) in t and mu", lambda y, mu: tails(y, (mu + HALF).mid())[0], signed),
        "variance_gamma_excess": ("E[(slope - y)_+]", lambda y, mu: tails(y, (mu + HALF).mid())[1], signed),
    }
    far = [
        part
        for name, (comment, function, v) in functions.items()
        for part in parts(name, comment, relative(function), t, v, FAR[name])
    ]
    return header("derive_bessel.py", [*near, *far]).replace(
        "#include <array>\n", '#include "microfacet/special/bivariate.hpp"\n', 1
    )


if __name__ == "__main__":
    sys.stdout.write(text())
