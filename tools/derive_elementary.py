"""Derive the polynomials of core/elementary.hpp: minimax in relative error, in 60 digits, then rounded.

    python tools/derive_elementary.py > include/microfacet/core/elementary_coefficients.hpp

* exp: e^r = 1 + r + r^2 P(r) for |r| <= ln(2)/2.
* log: log((1 + s)/(1 - s)) = 2 s + s^3 R(s^2), where (1 + s)/(1 - s) lies in [sqrt(1/2), sqrt(2)].
* log_of_quotient: the same, where (1 + s)/(1 - s) lies in [2/3, 3/2].
* log_polynomial: log(1 + f) = f - f^2/2 + f^3 Q(f), 1 + f as above; no division.
* sin, cos: sin(pi y/2) = y S(y^2) and cos(pi y/2) = C(y^2) for |y| <= 1/2.
"""

from __future__ import annotations

import sys
from collections.abc import Collection
from dataclasses import dataclass

import mpmath
from mpmath import mpf
from remez import FORMATS, Function, Problem, array, header, minimax, powers, rounded

mpmath.mp.dps = 60

HALF_PI = mpmath.pi / 2
MARGIN = mpf("1.001")  # the reduction of an argument rounds, too
LOG_END = (mpmath.sqrt(2) - 1) / (mpmath.sqrt(2) + 1)  # s at the ends of log's interval


def near_zero(start: list[mpf], elsewhere: Function) -> Function:
    """A function whose form elsewhere cancels near 0, where its Taylor series begins with ``start``."""

    def f(x: mpf) -> mpf:
        if abs(x) > mpf("1e-25"):
            return elsewhere(x)
        return mpmath.fsum(c * x**k for k, c in enumerate(start))

    return f


def log_of_ratio(u: mpf) -> mpf:
    """log((1 + s)/(1 - s))/s for u = s^2."""
    s = mpmath.sqrt(u)
    return 2 * mpmath.atanh(s) / s if s else mpf(2)


def sin_over_y(v: mpf) -> mpf:
    return HALF_PI * mpmath.sinc(HALF_PI * mpmath.sqrt(v))


def cos(v: mpf) -> mpf:
    return mpmath.cos(HALF_PI * mpmath.sqrt(v))


@dataclass(frozen=True)
class Series:
    """What remains of a function once its first terms are taken away.

    The weight makes the error of the remainder that of the whole function. ``first`` are the terms that the
    array holds before the fitted ones; the degrees are those in float32 and in float64.
    """

    form: str
    target: Function
    weight: Function
    interval: tuple[mpf, mpf]
    degrees: tuple[int | None, int | None]
    first: tuple[int, ...] = ()

    def text(self, name: str) -> str:
        parts = []
        for (bits, kind), degree in zip(FORMATS, self.degrees, strict=True):
            if degree is not None:
                problem = Problem(self.target, self.weight, *self.interval, powers(0, degree))
                fit = rounded(problem, minimax(problem), kind)
                comment = f"{self.form}: relative error {mpmath.nstr(fit.error, 2)}"
                parts.append(array(f"{name}_{bits}", comment, [*self.first, *fit.numerator], kind))
        return "\n".join(parts)


SERIES = {
    "exp": Series(
        "exp(r) = 1 + r + r^2 P(r), |r| <= ln(2)/2",
        near_zero([mpf(1) / 2, mpf(1) / 6], lambda r: (mpmath.expm1(r) - r) / r**2),
        lambda r: r**2 * mpmath.exp(-r),
        (-MARGIN * mpmath.log(2) / 2, MARGIN * mpmath.log(2) / 2),
        (4, 9),
    ),
    "log": Series(
        "log((1 + s)/(1 - s)) = 2 s + s^3 R(s^2), |s| <= 0.1717",
        near_zero([mpf(2) / 3, mpf(2) / 5], lambda u: (log_of_ratio(u) - 2) / u),
        lambda u: u / log_of_ratio(u),
        (mpf(0), MARGIN * LOG_END**2),
        (2, 6),
    ),
    "log_of_quotient": Series(
        "log((1 + s)/(1 - s)) = 2 s + s^3 R(s^2), |s| <= 1/5",
        near_zero([mpf(2) / 3, mpf(2) / 5], lambda u: (log_of_ratio(u) - 2) / u),
        lambda u: u / log_of_ratio(u),
        (mpf(0), MARGIN / 25),
        (2, 7),
    ),
    "log_polynomial": Series(
        "log(1 + f) = f - f^2/2 + f^3 Q(f), sqrt(1/2) <= 1 + f <= sqrt(2)",
        near_zero([mpf(1) / 3, -mpf(1) / 4], lambda f: (mpmath.log1p(f) - f + f**2 / 2) / f**3),
        near_zero([mpf(0), mpf(0), mpf(1)], lambda f: f**3 / mpmath.log1p(f)),
        (mpmath.sqrt(mpf(1) / 2) - 1, mpmath.sqrt(2) - 1),
        (7, None),
    ),
    "sin": Series(
        "sin(pi y/2) = y S(y^2), |y| <= 1/2",
        sin_over_y,
        lambda v: 1 / sin_over_y(v),
        (mpf(0), mpf(1) / 4),
        (3, 6),
    ),
    "cos": Series(
        "cos(pi y/2) = C(y^2), |y| <= 1/2",
        near_zero([-(HALF_PI**2) / 2], lambda v: (cos(v) - 1) / v),
        lambda v: v / cos(v),
        (mpf(0), mpf(1) / 4),
        (3, 6),
        first=(1,),
    ),
}


def text(names: Collection[str] = tuple(SERIES)) -> str:
    """The header, or as much of it as concerns some names."""
    return header("derive_elementary.py", [SERIES[name].text(name) for name in names])


if __name__ == "__main__":
    sys.stdout.write(text(sys.argv[1:] or tuple(SERIES)))
