"""What only Bessel K has: a Gamma mixture of Beckmann, elementary cases, singularities set by a."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import special

import microfacet as mf

ALPHA = 0.37
U = np.array([0.05, 0.4, 0.8, 0.95])
X = U / np.sqrt((1 - U) * (1 + U)) / ALPHA


@pytest.mark.parametrize("a", [0.3, 0.5, 1.0, 2.6, 20.0])
def test_mixture_of_beckmann(a: float) -> None:
    """alpha sqrt(m) with m ~ Gamma(a): the trapezoidal rule in log m."""
    log_m = np.arange(-90.0 / min(a, 1.0), 6.0, 0.02)
    m = np.exp(log_m)
    weights = 0.02 * np.exp(a * log_m - m - special.gammaln(a))
    for name in ("D", "sigma", "Lambda"):
        mixed = getattr(mf.beckmann, name)(U[:, None], ALPHA * np.sqrt(m)) @ weights
        assert_allclose(getattr(mf.bessel_k, name)(U, ALPHA, a), mixed, rtol=1e-11)


@pytest.mark.parametrize(
    ("a", "polynomial"),
    [
        (1, [1]),
        (2, [2, 3]),
        (3, [4, 14, 15]),
    ],  # of 2 x exp(-2 x)/x, descending, found by integrating P2 twice
)
def test_lambda_is_elementary_for_integer_a(a: int, polynomial: list[float]) -> None:
    scale = {1: 4, 2: 8, 3: 32}[a]
    expected = np.exp(-2 * X) / (scale * X) * np.polyval(polynomial, X)
    assert_allclose(mf.bessel_k.Lambda(U, ALPHA, float(a)), expected, rtol=1e-12)


def test_second_moment() -> None:
    """E[p^2] = a alpha^2/2: the mean of m times that of Beckmann."""
    p = np.exp(np.arange(-60.0, 8.0, 0.02))
    for a in (0.3, 1.0, 7.5, 60.0):
        moment = 2 * 0.02 * np.sum(p**3 * mf.bessel_k.P2(p, 0.1, a))
        assert_allclose(moment, a * 0.1**2 / 2, rtol=1e-11)


def test_values_at_zero_slope() -> None:
    """P22 = 1/(pi alpha^2 (a - 1)), a > 1; P2 = Gamma(a - 1/2)/(sqrt(pi) Gamma(a) alpha), a > 1/2."""
    a = np.array([0.05, 0.3, 0.5, 0.7, 1.0, 1.4, 2.0, 30.0])
    with np.errstate(divide="ignore"):
        normal = np.where(a > 1, 1 / (np.pi * ALPHA**2 * (a - 1)), np.inf)
        central = np.where(a > 0.5, special.poch(a - 0.5, 0.5) ** -1.0, np.inf) / ALPHA / np.sqrt(np.pi)
    assert_allclose(mf.bessel_k.P22(0.0, 0.0, ALPHA, a), normal, rtol=1e-13)
    assert_allclose(mf.bessel_k.D(1.0, ALPHA, a), normal, rtol=1e-13)
    assert_allclose(mf.bessel_k.P2(0.0, ALPHA, a), central, rtol=1e-13)


def test_rounding_lifts_no_probability_above_its_limit() -> None:
    """The recurrence may round 1 up by a few units; a distribution function must not notice."""
    a = np.geomspace(0.05, 300.0, 4001)
    for slope in (1e-300, 1e-40, 1e-17):
        assert np.all(mf.bessel_k.survival(slope, 0.3, a) <= 1)
        assert np.all(mf.bessel_k.slope_cdf(-slope, 0.3, a) <= 0.5)


@pytest.mark.parametrize("a", [1e-5, 1e-3, 0.03, 0.12, 0.126, 0.3])
def test_tail_of_a_small_order(a: float) -> None:
    """Pr(slope > t) is about a E_1(2t) and far below 1/2: it has its digits all the same.

    P2 integrated over log t by the trapezoidal rule.
    """
    t = np.array([1e-30, 1e-6, 0.02, 0.2, 0.2499, 0.25, 0.2501, 0.7])
    log_slope = np.log(t)[:, None] + 0.01 * np.arange(10_000)
    weight = np.where(np.arange(10_000) == 0, 0.5, 1.0) * 0.01
    slope = np.exp(np.minimum(log_slope, 8.0))
    ordinates = slope * mf.bessel_k.P2(slope, 1.0, a)
    # Euler and Maclaurin: the derivative of the integrand t P2 by log t at the lower end.
    step = np.array([-2, -1, 1, 2])
    stencil = t[:, None] * np.exp(1e-3 * step)
    derivative = (stencil * mf.bessel_k.P2(stencil, 1.0, a)) @ (np.array([1, -8, 8, -1]) / 12e-3)
    expected = ordinates @ weight + 0.01**2 / 12 * derivative
    assert_allclose(mf.bessel_k.slope_cdf(-t, 1.0, a), expected, rtol=1e-9)


def test_tends_to_beckmann() -> None:
    """At fixed E[p^2] like 1/a: Richardson's extrapolation from two large a."""
    coarse, fine = (mf.bessel_k.sigma(U, ALPHA / np.sqrt(a), a) for a in (70.0, 140.0))
    expected = mf.beckmann.sigma(U, ALPHA)
    assert_allclose(fine, expected, rtol=5e-3)
    assert_allclose(2 * fine - coarse, expected, rtol=5e-5)


@pytest.mark.parametrize("a", [399.7, 400.2, 400.5, 401.0, 1e4, 1e6])
def test_orders_beyond_the_recurrence(a: float) -> None:
    """From order 400 on K_nu is Debye's expansion. By the characteristic function (1 + k^2/4)^-a the second
    derivative of J_a = x Lambda, which is P2, equals 4 (J_a - J_{a-1})."""
    x = np.array([0.3, 0.69, 0.71, 1.5, 3.0]) * np.sqrt(a)
    u = x / np.hypot(1.0, x)
    excess = [x * mf.bessel_k.Lambda(u, 1.0, order) for order in (a - 1, a)]
    # J changes by a share of about 1/a, and x/u is rounded at u near 1: what the difference can resolve.
    assert_allclose(4 * (excess[1] - excess[0]), mf.bessel_k.P2(x, 1.0, a), rtol=3e-14 * a)


def test_beckmann_limit_without_bound() -> None:
    alpha, a = 0.3, 1e20
    for name, value in (("D", 0.9), ("Lambda", 0.2), ("slope_cdf", -0.5), ("sample_slope", 0.3), ("P2", 0.1)):
        ours = getattr(mf.bessel_k, name)(value, alpha / np.sqrt(a), a)
        assert_allclose(ours, getattr(mf.beckmann, name)(value, alpha), rtol=2e-14, err_msg=name)


@pytest.mark.parametrize("a", [0.3, 0.7, 1.0, 20.0, 399.9, 450.0, 1e6])
def test_nothing_is_left_at_infinity(a: float) -> None:
    for slope in (1e160, 1e300, np.inf):
        for alpha in (1e-4, 1.0, 10.0):
            assert mf.bessel_k.P2(slope, alpha, a) == mf.bessel_k.P22(slope, 0.0, alpha, a) == 0
            assert mf.bessel_k.survival(slope, alpha, a) == mf.bessel_k.slope_cdf(-slope, alpha, a) == 0
