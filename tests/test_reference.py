"""The reference itself: its integrals of P22 against closed forms, to its 20 digits, and its refusals."""

from __future__ import annotations

import pytest
from flint import arb, ctx

import reference

X = [1e-6, 0.3, 1.0, 4.0, 25.0]  # cotangent or slope in units of alpha
ALPHA = 0.7


def agree(family: str, quantity: str, expected: arb, *arguments: float) -> None:
    assert abs(reference.value(family, quantity, *arguments) / expected - 1) < 1e-20


def exact(x: float) -> tuple[float, arb, arb]:
    """A cosine, its exact cotangent over alpha, and alpha."""
    u = x * ALPHA / (1 + (x * ALPHA) ** 2) ** 0.5
    ball, alpha = arb(u), arb(ALPHA)
    return u, ball / ((1 - ball) * (1 + ball)).sqrt() / alpha, alpha


@pytest.mark.parametrize("x", X)
def test_beckmann(x: float) -> None:
    with ctx.workprec(400):
        u, y, alpha = exact(x)
        root = arb.pi().sqrt()
        masking = ((-y * y).exp() / (root * y) - y.erfc()) / 2
        agree("beckmann", "Lambda", masking, u, ALPHA)
        agree("beckmann", "sigma", arb(u) * masking, -u, ALPHA)
        agree("beckmann", "Lambda", -1 - masking, -u, ALPHA)
        t = arb(x) / alpha
        agree("beckmann", "P2", (-t * t).exp() / (root * alpha), x, ALPHA)
        agree("beckmann", "slope_cdf", t.erfc() / 2, -x, ALPHA)
        agree("beckmann", "survival", (-t * t).exp(), x, ALPHA)


@pytest.mark.parametrize("x", X)
def test_k0_and_bessel_k(x: float) -> None:
    with ctx.workprec(400):
        u, y, alpha = exact(x)
        agree("k0", "Lambda", (-2 * y).exp() / (4 * y), u, ALPHA)
        agree("bessel_k", "Lambda", (-2 * y).exp() * (2 * y + 3) / (8 * y), u, ALPHA, 2.0)
        t = arb(x) / alpha
        agree("k0", "slope_cdf", (-2 * t).exp() / 2, -x, ALPHA)
        a = arb(3.7)
        agree("bessel_k", "survival", 2 * t**a * (2 * t).bessel_k(a) / a.gamma(), x, ALPHA, 3.7)


@pytest.mark.parametrize("x", X)
def test_power_laws(x: float) -> None:
    with ctx.workprec(400):
        u, y, alpha = exact(x)
        agree("ggx", "Lambda", ((1 + 1 / y**2).sqrt() - 1) / 2, u, ALPHA)
        agree("gtr", "Lambda", ((1 + 1 / y**2).sqrt() - 1) / 2, u, ALPHA, 2.0)
        p, k = arb(x), arb(1.6) - 1
        agree("student_t", "survival", (1 + p**2 / (alpha**2 * k)) ** -k, x, ALPHA, 1.6)
        cdf = arb(0.5) - (p.asinh() - (p / alpha).asinh()) / (2 * alpha.log())
        agree("gtr", "slope_cdf", cdf, -x, ALPHA, 1.0)


@pytest.mark.parametrize("xi", [1e-200, 1e-9, 0.3, 0.999, 1 - 2.0**-53])
def test_inverse(xi: float) -> None:
    with ctx.workprec(1000):
        agree("beckmann", "sample_slope", arb(ALPHA) * (-((1 - arb(xi)).log())).sqrt(), xi, ALPHA)
        agree("ggx", "sample_slope", arb(ALPHA) * (arb(xi) / (1 - arb(xi))).sqrt(), xi, ALPHA)


def test_refuses_what_diverges() -> None:
    with pytest.raises(ArithmeticError):
        reference.value("student_t", "Lambda", 0.5, ALPHA, 1.5)


def test_relative_error() -> None:
    truth = reference.value("ggx", "D", 1.0, 1.0)
    assert reference.relative_error(float(truth), truth) < 2**-53
    assert reference.relative_error(float("nan"), truth) == float("inf")
    assert reference.relative_error(float("inf"), arb.pos_inf()) == 0.0
    assert reference.relative_error(1.0, arb.pos_inf()) == float("inf")
    assert reference.relative_error(0.0, arb(0)) == 0.0
    assert reference.relative_error(1e-300, arb(0)) == float("inf")
