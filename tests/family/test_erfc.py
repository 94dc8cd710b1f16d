"""What only Erfc has: a uniform roughness, its moments, and a marginal that is infinite at 0."""

import numpy as np
from numpy.testing import assert_allclose
from scipy import special

import microfacet as mf

ALPHA = 0.37
U = np.array([0.05, 0.4, 0.8, 0.95])


def test_mixture_of_beckmann() -> None:
    nodes, weights = np.polynomial.legendre.leggauss(60)
    m, weights = (nodes + 1) / 2, weights / 2
    for name in ("D", "sigma", "Lambda"):
        mixed = getattr(mf.beckmann, name)(U[:, None], ALPHA * m) @ weights
        assert_allclose(getattr(mf.erfc, name)(U, ALPHA), mixed, rtol=1e-11, err_msg=name)


def test_moments() -> None:
    """E[p^2] = E[m^2] alpha^2/2 = alpha^2/6 and E[p^4] = 3/4 E[m^4] alpha^4 = 3 alpha^4/20."""
    p = np.exp(np.arange(-60.0, 6.0, 0.02))
    for order, moment in ((2, ALPHA**2 / 6), (4, 3 * ALPHA**4 / 20)):
        assert_allclose(2 * 0.02 * np.sum(p ** (order + 1) * mf.erfc.P2(p, ALPHA)), moment, rtol=1e-12)


def test_singularities() -> None:
    """P22 like 1/r and P2 like a logarithm, down to the smallest slopes."""
    r = ALPHA * np.array([1e-150, 1e-30, 1e-17])
    assert_allclose(mf.erfc.P22(r, 0.0, ALPHA), 1 / (2 * np.sqrt(np.pi) * ALPHA * r), rtol=1e-13)
    logarithm = (-2 * np.log(r / ALPHA) - np.euler_gamma) / (2 * np.sqrt(np.pi) * ALPHA)
    assert_allclose(mf.erfc.P2(r, ALPHA), logarithm, rtol=1e-13)
    for value in (mf.erfc.D(1.0, ALPHA), mf.erfc.P22(0.0, 0.0, ALPHA), mf.erfc.P2(0.0, ALPHA)):
        assert np.isposinf(value)
    assert mf.erfc.slope_cdf(0.0, ALPHA) == 0.5


def test_complementary_error_function() -> None:
    r = np.array([1e-3, 0.1, 0.49, 0.51, 1.0, 4.0, 20.0, 25.0])
    assert_allclose(mf.erfc.P22(r, 0.0, 1.0), special.erfc(r) / (2 * np.sqrt(np.pi) * r), rtol=3e-13)
    assert_allclose(mf.erfc.P2(r, 1.0), special.exp1(r**2) / (2 * np.sqrt(np.pi)), rtol=3e-13)


def test_least_radii() -> None:
    """Pr(slope < r) = sqrt(pi) y - y^2, y = r/alpha, so the radius is xi alpha/sqrt(pi) to the end."""
    xi = np.geomspace(1e-285, 1e-17, 50)
    assert_allclose(mf.erfc.sample_slope(xi, 1.0), xi / np.sqrt(np.pi), rtol=1e-12)
