"""Derive the coefficients of include/microfacet/special/coefficients/special.hpp in arbitrary precision.

    python tools/derive_special.py > include/microfacet/special/coefficients/special.hpp

* erfc_*, ierfc_*: minimax rationals for exp(x^2) erfc(x) and exp(x^2) ierfc(x), all of whose coefficients are
  positive, as far as exp(-x^2) is a normal number.
* k0_*, k1_*: h_0(y) = 2 K_0(2y) and h_1(y) = 2y K_1(2y). For y <= 9/16, with l = -gamma - log(y), v = y^2
  (gamma: Euler's constant), they are l A(v) + v B(v) and 1 - v (l A(v) + B(v)), and with l >= 0 no term is
  negative; A and B are fitted together. Beyond, they are exp(-2y) times y^(-1/2) and y^(1/2) times a minimax
  rational with positive coefficients, as far as exp(-2y) is a normal number.
* reciprocal_gamma: the Taylor series of 1/Gamma(1 + mu), even and odd part, for Temme's K_nu (|mu| <= 1/2).
* debye_u, debye_v: Debye's polynomials of the expansions of K_nu and its derivative for large order, by their
  recurrence in rational arithmetic (DLMF 10.41.9 to 10.41.11): U_k = p^k times row k in p^2, likewise V_k.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection
from fractions import Fraction
from functools import cache

import mpmath
from mpmath import mpf
from remez import FORMATS, Function, Problem, array, header, minimax, powers, rounded

mpmath.mp.dps = 60
NEAR_END = mpf(9) / 16  # just above exp(-gamma), where l = 0

Parts = list[str]  # C++ text of arrays


@cache
def erfc_scaled(x: mpf) -> mpf:
    return mpmath.exp(x * x) * mpmath.erfc(x)


@cache
def ierfc_scaled(x: mpf) -> mpf:
    """exp(x^2) times the integral of erfc over (x, inf), without cancellation (DLMF 7.18.10)."""
    return mpmath.hyperu(1, mpf(1) / 2, x * x) / (2 * mpmath.sqrt(mpmath.pi))


@cache
def bessel_scaled(order: int, y: mpf) -> mpf:
    """exp(2y) K_order(2y) for order 0 or 1 and y >= 1/2, by the trapezoidal rule.

    It is the integral of exp(-2y (cosh t - 1)) cosh(order t) over t > 0 (DLMF 10.32.9).
    """
    z = 2 * y
    step = min(mpf("0.065"), mpf("0.35") / mpmath.sqrt(z))
    total, j = mpf(1) / 2, 0
    while True:
        j += 1
        c = mpmath.cosh(j * step)
        term = mpmath.exp(-z * (c - 1)) * c**order
        total += term
        if term < mpf("1e-62"):
            return step * total


@cache
def h(order: int, v: mpf) -> mpf:
    """h_0 or h_1 of y = sqrt(v) (special/bessel.hpp)."""
    y = mpmath.sqrt(v)
    return 2 * y**order * mpmath.besselk(order, 2 * y)


def minus_log(v: mpf) -> mpf:
    return -mpmath.euler - mpmath.log(v) / 2


def times_log(f: Function) -> Function:
    return lambda v: minus_log(v) * f(v)


Degrees = tuple[tuple[int, int], tuple[int, int]]  # in float32 and in float64


def rational(
    name: str, form: str, f: Function, lower: mpf, upper: tuple[int | float, int | float], degrees: Degrees
) -> Parts:
    """Numerator and denominator for f with relative error, from lower up to an end for each format."""
    parts = []
    for (bits, kind), end, (n, m) in zip(FORMATS, upper, degrees, strict=True):
        problem = Problem(f, lambda x: 1 / f(x), lower, mpf(end), powers(0, n), powers(0, m), scale=mpf(2))
        fit = rounded(problem, minimax(problem), kind)
        comment = f"{form} <= {end}: relative error {mpmath.nstr(fit.error, 2)}"
        parts.append(array(f"{name}_numerator_{bits}", comment, fit.numerator, kind))
        parts.append(array(f"{name}_denominator_{bits}", "", fit.denominator, kind))
    return parts


def near(order: int, form: str, degrees: Degrees) -> Parts:
    """A and B, fitted together; A(0) = 2 is exact."""

    def series(v: mpf) -> mpf:
        """l A(v) + v B(v) of h_0, l A(v) + B(v) of h_1."""
        return h(0, v) if order == 0 else (1 - h(1, v)) / v

    parts = []
    for (bits, kind), (a, b) in zip(FORMATS, degrees, strict=True):
        problem = Problem(
            lambda v: series(v) - 2 * minus_log(v),
            lambda v: 1 / series(v),
            mpf("1e-12"),
            NEAR_END**2,
            [times_log(p) for p in powers(1, a)] + powers(1 - order, b),
        )
        fit = rounded(problem, minimax(problem), kind)
        comment = f"{form}: relative error {mpmath.nstr(fit.error, 2)}"
        parts.append(array(f"k{order}_near_log_{bits}", comment, [2, *fit.numerator[:a]], kind))
        parts.append(array(f"k{order}_near_{bits}", "", fit.numerator[a:], kind))
    return parts


def debye(terms: int) -> tuple[list[list[Fraction]], list[list[Fraction]]]:
    """Rows of U_k and V_k, each as the coefficients of p^k, p^(k+2), ..., p^(3k)."""
    u = [{0: Fraction(1)}]
    for _ in range(terms - 1):
        new: dict[int, Fraction] = {}
        for power, c in u[-1].items():
            # p^2 (1 - p^2) U'/2 + (1/8) int (1 - 5 t^2) U dt
            for shift, factor in (
                (1, Fraction(power, 2) + Fraction(1, 8 * (power + 1))),
                (3, -Fraction(power, 2) - Fraction(5, 8 * (power + 3))),
            ):
                new[power + shift] = new.get(power + shift, Fraction(0)) + c * factor
        u.append(new)
    v = [dict(u[0])]
    for k in range(1, terms):
        # U_k - p (1 - p^2) (U_{k-1}/2 + p U'_{k-1})
        new = dict(u[k])
        for power, c in u[k - 1].items():
            for shift, sign in ((1, -1), (3, 1)):
                change = sign * c * (Fraction(1, 2) + power)
                new[power + shift] = new.get(power + shift, Fraction(0)) + change
        v.append(new)
    u_rows, v_rows = (
        [[row[k + 2 * j] for j in range(k + 1)] for k, row in enumerate(rows)] for rows in (u, v)
    )
    return u_rows, v_rows


def table(name: str, comment: str, rows: list[list[Fraction]]) -> str:
    size = len(rows)
    body = ""
    for row in rows:
        values = [mpmath.mpf(c.numerator) / c.denominator for c in row] + [mpmath.mpf(0)] * (size - len(row))
        body += "    {" + ", ".join(mpmath.nstr(v, 20, min_fixed=0, max_fixed=0) for v in values) + "},\n"
    kind = f"std::array<std::array<double, {size}>, {size}>"
    return f"// {comment}\ninline constexpr {kind} {name}{{{{\n{body}}}}};\n"


def gamma() -> Parts:
    taylor = mpmath.taylor(mpmath.rgamma, 1, 24)
    return [
        array("reciprocal_gamma_even", "even part of 1/Gamma(1 + mu), in mu^2", taylor[0:22:2]),
        array("reciprocal_gamma_odd", "odd part of 1/Gamma(1 + mu) over mu, in mu^2", taylor[1:22:2]),
    ]


def debye_tables() -> Parts:
    u, v = debye(6)
    return [
        table("debye_u", "U_k(p) = p^k times row k in p^2", u),
        table("debye_v", "V_k(p) = p^k times row k in p^2", v),
    ]


GROUPS: dict[str, Callable[[], Parts]] = {
    "erfc": lambda: rational(
        "erfc", "exp(x^2) erfc(x), 0 <= x", erfc_scaled, mpf(0), (9.5, 27), ((4, 5), (9, 10))
    ),
    "ierfc": lambda: rational(
        "ierfc", "exp(x^2) ierfc(x), 0 <= x", ierfc_scaled, mpf(0), (9.5, 27), ((4, 6), (9, 11))
    ),
    "k0_near": lambda: near(
        0, "2 K_0(2y) = l A(y^2) + y^2 B(y^2), l = -gamma - log(y), y <= 9/16", ((3, 3), (6, 6))
    ),
    "k0_far": lambda: rational(
        "k0_far",
        "exp(2y) y^(1/2) 2 K_0(2y), 9/16 <= y",
        lambda y: 2 * mpmath.sqrt(y) * bessel_scaled(0, y),
        NEAR_END,
        (44, 355),
        ((3, 3), (8, 8)),
    ),
    "k1_near": lambda: near(1, "1 - 2y K_1(2y) = y^2 (l A(y^2) + B(y^2)), y <= 9/16", ((2, 3), (5, 6))),
    "k1_far": lambda: rational(
        "k1_far",
        "exp(2y) y^(-1/2) 2y K_1(2y), 9/16 <= y",
        lambda y: 2 * mpmath.sqrt(y) * bessel_scaled(1, y),
        NEAR_END,
        (44, 355),
        ((3, 3), (8, 8)),
    ),
    "gamma": gamma,
    "debye": debye_tables,
}


def text(names: Collection[str] = tuple(GROUPS)) -> str:
    """The header, or as much of it as concerns some groups."""
    return header("derive_special.py", [part for name in names for part in GROUPS[name]()])


if __name__ == "__main__":
    sys.stdout.write(text(sys.argv[1:] or tuple(GROUPS)))
