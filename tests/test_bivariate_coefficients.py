"""The polynomials of two variables of Bessel K: in the forms of the headers each meets the error stated here.

The other side is mpmath's Bessel functions and, for the tails, tests/reference.py. All sums being exact, the
errors are those of the approximation and of the rounding of its coefficients.
"""

from __future__ import annotations

import pathlib
import re
from collections.abc import Callable, Iterator

import mpmath
import numpy as np
import pytest
from flint import arb, ctx
from mpmath import mpf

from reference import Reference, value

SPECIAL = pathlib.Path(__file__).parent.parent / "include/microfacet/special/coefficients"
HEADERS = ("bessel", "variance_gamma_tail", "variance_gamma_excess")

Rows = list[list[mpf]]
Table = Callable[[mpf, mpf], mpf]


def tables() -> dict[str, Rows]:
    """For every polynomial a row of powers of x for each power of y, as the compiler reads its numbers."""
    found: dict[str, Rows] = {}
    for header in HEADERS:
        text = (SPECIAL / f"{header}.hpp").read_text(encoding="utf-8")
        for kind, counts, name, body in re.findall(
            r"bivariate<(float|double), ([\d, ]+)> (\w+)\{\{([^{}]*)\}\}", text
        ):
            real = np.float32 if kind == "float" else np.float64
            values = iter([mpf(float(real(v.strip().rstrip("F")))) for v in body.split(",")])
            found[name] = [[next(values) for _ in range(int(n))] for n in counts.split(",")]
            assert next(values, None) is None, name
    return found


TABLES = tables()


def table(name: str) -> Table:
    rows = TABLES[name]
    return lambda x, y: mpmath.fsum(c * x**i * y**j for j, row in enumerate(rows) for i, c in enumerate(row))


def variable(y: mpf) -> mpf:
    """t of bessel_start.hpp, which is 1 at y = 1/4 and -1 at infinity."""
    return (3 - 2 * mpmath.sqrt(y)) / (1 + 2 * mpmath.sqrt(y))


def far_points(most: float) -> Iterator[mpf]:
    for t in np.cos(np.linspace(0, np.pi, 14)):
        y = ((3 - t) / (1 + t)) ** 2 / 4 if t > -1 else np.inf
        yield mpf(float(min(y, most)))


ORDERS = [mpf(float(x)) for x in (-0.5, -0.44, -0.3, -0.13, -1e-6, 1e-3, 0.2, 0.37, 0.5)]
both_formats = pytest.mark.parametrize("bits", [32, 64])


def near_errors(part: str, bits: int) -> Iterator[mpf]:
    even, odd = (table(f"bessel_near_{part}_{parity}_{bits}") for parity in ("even", "odd"))
    for mu in ORDERS:
        for y in (mpf(float(y)) for y in np.linspace(0.03, 0.25, 9)):
            w = y**2
            got = even(w - mpf(1) / 32, mu**2) + mu * odd(w - mpf(1) / 32, mu**2)
            if part == "f":
                exact = (mpmath.besseli(mu, 2 * y) / y**mu - mpmath.rgamma(1 + mu)) / w
            else:
                exact = mpmath.besseli(mu + 1, 2 * y) / y ** (mu + 1)
            yield abs(got - exact)


def far_errors(part: str, bits: int) -> Iterator[mpf]:
    polynomial = table(f"bessel_{part}_{bits}")
    for mu in ORDERS:
        for y in far_points(1e4):
            if part == "far":
                exact = mpmath.besselk(mu, 2 * y)
            else:
                exact = (mpmath.besselk(mu - 1, 2 * y) + mpmath.besselk(mu + 1, 2 * y)) / 2
            got = polynomial(variable(y), mu**2)
            yield abs(got / (2 * mpmath.sqrt(y) * mpmath.exp(2 * y) * exact) - 1)


def tail_errors(part: str, bits: int) -> Iterator[mpf]:
    polynomial = table(f"variance_gamma_{part}_{bits}")
    for a in (mpf(float(x)) for x in (1 / 16, 0.3, 0.5, 0.77, 1.0)):
        for y in far_points(300.0):
            if part == "tail":
                ball = value("bessel_k", "slope_cdf", -float(y), 1.0, float(a))
            else:
                with ctx.workprec(256):
                    ball = Reference("bessel_k", 1.0, float(a)).excess(arb(float(y)))
            exact = mpf(ball.str(30, radius=False))
            got = polynomial(variable(y), a - mpf(1) / 2)
            yield abs(got / (mpmath.gamma(a) * y ** (1 - a) * mpmath.exp(2 * y) * exact) - 1)


CASES: list[tuple[Callable[[str, int], Iterator[mpf]], str, dict[int, float]]] = [
    (near_errors, "f", {32: 5e-8, 64: 1e-16}),
    (near_errors, "g", {32: 2e-7, 64: 1e-16}),
    (far_errors, "far", {32: 4e-8, 64: 1.7e-16}),
    (far_errors, "far_slope", {32: 3e-8, 64: 7e-17}),
    (tail_errors, "tail", {32: 3.3e-8, 64: 1.3e-16}),
    (tail_errors, "excess", {32: 6e-8, 64: 1.5e-16}),
]


@both_formats
@pytest.mark.parametrize(("errors", "part", "bound"), CASES, ids=[part for _, part, _ in CASES])
def test_error(
    errors: Callable[[str, int], Iterator[mpf]], part: str, bound: dict[int, float], bits: int
) -> None:
    with mpmath.workdps(40):
        assert max(errors(part, bits)) <= bound[bits]


def test_every_table_is_measured() -> None:
    assert len(TABLES) == 16
