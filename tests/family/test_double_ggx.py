"""What only Double GGX has: a mixture of GGX, logarithms in its tail, no mean square slope."""

import numpy as np
from numpy.testing import assert_allclose
from scipy import special

import microfacet as mf

ALPHA = 0.37
U = np.array([0.05, 0.4, 0.8, 0.95])


def test_mixture_of_ggx() -> None:
    """alpha/sqrt(b), b exponentially distributed: the trapezoidal rule in log b."""
    b = np.exp(np.arange(-80.0, 6.0, 0.02))
    weights = 0.02 * b * np.exp(-b)
    for name in ("D", "sigma", "Lambda"):
        mixed = getattr(mf.ggx, name)(U[:, None], ALPHA / np.sqrt(b)) @ weights
        assert_allclose(getattr(mf.double_ggx, name)(U, ALPHA), mixed, rtol=1e-11, err_msg=name)


def test_mean_slope() -> None:
    """E|p| = 2 sigma(0) is alpha E[b^(-1/2)] = sqrt(pi) alpha."""
    assert_allclose(2 * mf.double_ggx.sigma(0.0, ALPHA), np.sqrt(np.pi) * ALPHA, rtol=1e-13)


def test_density_at_the_normal_is_that_of_ggx() -> None:
    assert_allclose(mf.double_ggx.D(1.0, ALPHA), mf.ggx.D(1.0, ALPHA), rtol=1e-13)


def test_tail_is_that_of_ggx_times_a_logarithm() -> None:
    """survival = w (-log w - gamma + ...), P22 = w^2 (-log w - gamma - 1 + ...)/pi, w = (alpha/r)^2."""
    r = 10.0 ** np.array([9.0, 12.0, 17.0, 20.0, 40.0, 59.0])
    logarithm = 2 * np.log(r) - np.euler_gamma
    assert_allclose(mf.double_ggx.survival(r, 1.0), logarithm / r**2, rtol=1e-12)
    assert_allclose(mf.double_ggx.P22(r, 0.0, 1.0), (logarithm - 1) / (np.pi * r**4), rtol=1e-12)


def test_mean_square_slope_grows_like_a_squared_logarithm() -> None:
    """2 pi r^4 P22 -> 2 (2 log r - gamma - 1), whose integral over log r has no bound."""
    r = np.exp(np.arange(np.log(1e6), np.log(1e8), 0.001))
    integrand = 2 * np.pi * r**4 * mf.double_ggx.P22(r, 0.0, 1.0)
    got = np.trapezoid(integrand, dx=0.001)
    ends = np.log(r[[0, -1]])
    expected = np.diff(2 * ends**2 - 2 * (np.euler_gamma + 1) * ends)[0]
    assert_allclose(got, expected, rtol=1e-9)


def test_bessel_functions() -> None:
    p = np.array([1e-3, 0.3, 1.0, 3.9, 4.1, 30.0, 1e3])
    z = 1 / (2 * p[1:] ** 2)
    density = z / p[1:] * ((1 + 2 * z) * special.k0e(z) - 2 * z * special.k1e(z))
    assert_allclose(mf.double_ggx.P2(p[1:], 1.0), density, rtol=3e-12)
    assert_allclose(mf.double_ggx.P2(p[0], 1.0), np.sqrt(np.pi) / 4, rtol=1e-5)


def test_least_radii() -> None:
    """Pr(slope < r) = y - 2 y^2 + ..., y = (r/alpha)^2: the mean of s y/(1 + s y)."""
    xi = np.geomspace(1e-300, 1e-17, 50)
    assert_allclose(mf.double_ggx.sample_slope(xi, ALPHA), ALPHA * np.sqrt(xi), rtol=1e-12)
