"""Derive the coefficients of include/microfacet/special/coefficients.hpp in arbitrary precision.

    python tools/derive_special.py > include/microfacet/special/coefficients.hpp

* erfc_scaled, ierfc_scaled: Chebyshev series on [0, inf) in t = (x - k)/(x + k) of (1 + 2 x) exp(x^2) erfc(x)
  and (1 + 2 x)^2 exp(x^2) ierfc(x), both of which are finite and smooth up to infinity (the mapping of
  Shepherd and Laframboise, Mathematics of Computation 36, 1981).
* reciprocal_gamma: the Taylor series of 1/Gamma(1 + mu), even and odd part, for Temme's K_nu (|mu| <= 1/2).
* debye_u, debye_v: Debye's polynomials of the expansions of K_nu and its derivative for large order, by their
  recurrence in rational arithmetic (DLMF 10.41.9 to 10.41.11): U_k = p^k times row k in p^2, likewise V_k.
"""

from __future__ import annotations

import sys
from fractions import Fraction

import mpmath

mpmath.mp.dps = 60
SCALE = mpmath.mpf("3.75")
BELOW_ROUNDING = mpmath.mpf("4e-18")


def erfc_scaled(x: mpmath.mpf) -> mpmath.mpf:
    return mpmath.exp(x * x) * mpmath.erfc(x)


def ierfc_scaled(x: mpmath.mpf) -> mpmath.mpf:
    """exp(x^2) times the integral of erfc over (x, inf), without cancellation (DLMF 7.18.10)."""
    return mpmath.hyperu(1, mpmath.mpf(1) / 2, x * x) / (2 * mpmath.sqrt(mpmath.pi))


def chebyshev(function, limit, degree: int = 60) -> list[mpmath.mpf]:
    """Chebyshev coefficients of function(x((t))) on [-1, 1], cut where they fall below rounding."""
    count = 2 * degree
    nodes = [mpmath.cos(mpmath.pi * (2 * j + 1) / (2 * count)) for j in range(count)]
    values = [limit if 1 - t < mpmath.mpf("1e-40") else function(SCALE * (1 + t) / (1 - t)) for t in nodes]
    out = []
    for k in range(degree):
        terms = (v * mpmath.cos(mpmath.pi * k * (2 * j + 1) / (2 * count)) for j, v in enumerate(values))
        out.append(mpmath.fsum(terms) * (1 if k == 0 else 2) / count)
    while abs(out[-1]) < BELOW_ROUNDING * abs(out[0]):
        out.pop()
    return out


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
    return tuple([[row[k + 2 * j] for j in range(k + 1)] for k, row in enumerate(rows)] for rows in (u, v))


def table(name: str, comment: str, rows: list[list[Fraction]]) -> str:
    size = len(rows)
    body = ""
    for row in rows:
        values = [mpmath.mpf(c.numerator) / c.denominator for c in row] + [mpmath.mpf(0)] * (size - len(row))
        body += "    {" + ", ".join(mpmath.nstr(v, 20, min_fixed=0, max_fixed=0) for v in values) + "},\n"
    kind = f"std::array<std::array<double, {size}>, {size}>"
    return f"// {comment}\ninline constexpr {kind} {name}{{{{\n{body}}}}};\n"


def array(name: str, comment: str, values: list[mpmath.mpf]) -> str:
    body = "".join(f"    {mpmath.nstr(v, 20, min_fixed=0, max_fixed=0)},\n" for v in values)
    return f"// {comment}\ninline constexpr std::array<double, {len(values)}> {name}{{\n{body}}};\n"


def main() -> None:
    two_over_root_pi = 2 / mpmath.sqrt(mpmath.pi)
    gamma_series = mpmath.taylor(mpmath.rgamma, 1, 24)
    debye_u, debye_v = debye(6)
    parts = [
        array(
            "erfc_scaled",
            "(1 + 2 x) exp(x^2) erfc(x), t = (x - 3.75)/(x + 3.75)",
            chebyshev(lambda x: (1 + 2 * x) * erfc_scaled(x), two_over_root_pi),
        ),
        array(
            "ierfc_scaled",
            "(1 + 2 x)^2 exp(x^2) ierfc(x), t = (x - 3.75)/(x + 3.75)",
            chebyshev(lambda x: (1 + 2 * x) ** 2 * ierfc_scaled(x), two_over_root_pi),
        ),
        array("reciprocal_gamma_even", "even part of 1/Gamma(1 + mu), in mu^2", gamma_series[0:22:2]),
        array("reciprocal_gamma_odd", "odd part of 1/Gamma(1 + mu) over mu, in mu^2", gamma_series[1:22:2]),
        table("debye_u", "U_k(p) = p^k times row k in p^2", debye_u),
        table("debye_v", "V_k(p) = p^k times row k in p^2", debye_v),
    ]
    sys.stdout.write(
        "// Derived by tools/derive_special.py in 60 digits; do not edit by hand.\n#pragma once\n\n"
        "#include <array>\n\nnamespace microfacet::coefficients {\n\n"
        + "\n".join(parts)
        + "\n}  // namespace microfacet::coefficients\n"
    )


if __name__ == "__main__":
    main()
