"""Tabulate the special functions in arbitrary precision, for the C++ tests.

python tools/tabulate_special.py > tests/cpp/special_values.hpp

Each value comes from mpmath's own functions or from quadrature of the definition, never from the form in
which the headers compute it. The arguments are float32 numbers, so that one table serves float and double.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Sequence
from itertools import product

import mpmath
from mpmath import mpf

mpmath.mp.dps = 32

Function = Callable[..., mpf]
HALF_LINE = (0, 1e-6, 0.01, 0.3, 0.75, 1, 1.5, 2, 2.5, 3.75, 5, 8, 9.5, 13, 40, 1e3, 1e6)


def single(x: float) -> float:
    """The float32 next to x."""
    return float(struct.unpack("f", struct.pack("f", x))[0])


def h(nu: mpf, y: mpf) -> mpf:
    return 2 * y**nu * mpmath.besselk(nu, 2 * y)


def over_density(k: mpf, t: mpf, integrand: Callable[[mpf], mpf]) -> mpf:
    """int_t^inf integrand A(x)^(-k-1/2) dx over A(t)^(-k-1/2), A(x) = 1 + x^2/k."""

    def ratio(x: mpf) -> mpf:
        return integrand(x) * ((k + t * t) / (k + x * x)) ** (k + mpf(1) / 2)

    # x = t + w exp(v) turns the algebraic tail into an exponential one.
    width = mpmath.sqrt(k) + t
    return mpmath.quad(
        lambda v: ratio(t + width * mpmath.exp(v)) * width * mpmath.exp(v),
        [-260, -60, -30, -15, -8, -4, -2, -1, 0, 1, 2, 4, 8, 16, 40, 100, 400],
    )


def tail(k: mpf, t: mpf) -> mpf:
    return over_density(k, t, lambda x: mpf(1))


def excess(k: mpf, t: mpf) -> mpf:
    return over_density(k, t, lambda x: x - t)


SHAPES = (0.0625, 0.5, 0.75, 1, 1.5, 2.5, 10, 150, 1e4, 1e6)
ORDERS = [
    (nu, y)
    for nu, y in product(
        (-0.45, -0.25, 0, 0.3, 0.5, 0.8, 1, 1.5, 2.3, 10, 60.7, 149.5), (0.001, 0.2, 1, 1.5, 6, 30, 300)
    )
]
# Where orders are Debye's expansion; y up to where h_nu is 1e-6 of its value at 0.
LARGE_ORDERS = [(nu, c * nu**0.5) for nu, c in product((500, 512.25, 1e4, 1e6), (0.01, 0.5, 2, 3.75))]
SLOPES = [
    (k, t * max(1.0, min(2.0, 0.5 * k) ** 0.5)) for k, t in product(SHAPES, (1e-4, 0.3, 0.7, 1.01, 2, 5))
]

TABLES: dict[str, tuple[Function, Iterable[Sequence[float]]]] = {
    "erfc_scaled": (lambda x: mpmath.exp(x * x) * mpmath.erfc(x), [(x,) for x in HALF_LINE]),
    "ierfc_scaled": (
        lambda x: (
            mpmath.quad(lambda t: t * mpmath.exp(-t * t - 2 * x * t), [0, 1, 3, 12])
            * 2
            / mpmath.sqrt(mpmath.pi)
        ),
        [(x,) for x in HALF_LINE if x < 50],
    ),
    "exponential_integral_1": (mpmath.e1, [(y,) for y in HALF_LINE if 0 < y < 50]),
    "exponential_integral_2": (lambda y: mpmath.expint(2, y), [(y,) for y in HALF_LINE if y < 50]),
    "reciprocal_gamma": (lambda mu: mpmath.rgamma(1 + mu), [(mu / 8,) for mu in range(-4, 5)]),
    "gamma_half_step": (
        lambda k: mpmath.gammaprod([k + mpf(1) / 2], [k]) / mpmath.sqrt(k),
        [(k,) for k in (1e-4, 0.05, *SHAPES)],
    ),
    "beta_one_plus": (
        lambda a, b: mpmath.beta(1 + a, 1 + b),
        [
            (0, 0),
            (0.01, 0.3),
            (0.5, 0.5),
            (1, 2),
            (3, 7.5),
            (30, 0.2),
            (12, 40),
            (1e4, 0.3),
            (1e9, 0.01),
            (1e12, 1.5),
        ],
    ),
    "bessel_below": (lambda nu, y: mpmath.exp(2 * y) * y * y * h(nu - 1, y) * mpmath.rgamma(nu + 1), ORDERS),
    "bessel_at": (lambda nu, y: mpmath.exp(2 * y) * h(nu, y) * mpmath.rgamma(nu + 1), ORDERS),
    "bessel_above": (lambda nu, y: mpmath.exp(2 * y) * h(nu + 1, y) * mpmath.rgamma(nu + 2), ORDERS),
    "bessel_complement_above": (
        lambda nu, y: 1 - h(nu + 1, y) * mpmath.rgamma(nu + 1),
        [(nu, y) for nu, y in ORDERS if y < 10],
    ),
    "debye_below": (lambda nu, y: y * y * h(nu - 1, y) * mpmath.rgamma(nu + 1), LARGE_ORDERS),
    "debye_at": (lambda nu, y: h(nu, y) * mpmath.rgamma(nu + 1), LARGE_ORDERS),
    "debye_above": (lambda nu, y: h(nu + 1, y) * mpmath.rgamma(nu + 2), LARGE_ORDERS),
    "student_tail": (tail, SLOPES),
    "student_excess": (excess, [(k, t) for k, t in SLOPES if k > 0.5]),
}


def header() -> str:
    lines = [
        "// Written by tools/tabulate_special.py in 32 digits; do not edit by hand.",
        "#pragma once",
        "",
        "#include <vector>",
        "",
        "namespace special_values {",
        "",
        "struct row {",
        "  double a, b, value;  // b is 0 for a function of one argument",
        "};",
    ]
    for name, (function, points) in TABLES.items():
        lines += ["", f"inline const std::vector<row> {name}{{"]
        for point in points:
            exact = [single(x) for x in point]
            value = mpmath.nstr(mpf(function(*map(mpf, exact))), 18, min_fixed=-3, max_fixed=6)
            first, second = [*exact, 0.0][:2]
            lines.append(f"    {{{first!r}, {second!r}, {value}}},")
        lines.append("};")
    return "\n".join([*lines, "", "}  // namespace special_values"])


if __name__ == "__main__":
    print(header())
