"""What only Ei has: a uniform squared roughness, moments of a uniform number, a logarithm at the normal."""

import numpy as np
from numpy.testing import assert_allclose
from scipy import special

import microfacet as mf

ALPHA = 0.37
U = np.array([0.05, 0.4, 0.8, 0.95])
NODES, WEIGHTS = np.polynomial.legendre.leggauss(60)
NODES, WEIGHTS = (NODES + 1) / 2, WEIGHTS / 2


def test_mixture_of_beckmann() -> None:
    """Gauss' rule in m = n^4: what is square root and logarithm at 0 is smooth there."""
    m = NODES**4
    for name in ("sigma", "Lambda", "G1"):
        if name == "G1":
            mixed = 1 / (1 + mf.beckmann.Lambda(U[:, None], ALPHA * np.sqrt(m)) @ (WEIGHTS * 4 * NODES**3))
        else:
            mixed = getattr(mf.beckmann, name)(U[:, None], ALPHA * np.sqrt(m)) @ (WEIGHTS * 4 * NODES**3)
        assert_allclose(getattr(mf.ei, name)(U, ALPHA), mixed, rtol=1e-11, err_msg=name)


def test_moments() -> None:
    """E[p^2] = E[m] alpha^2/2 = alpha^2/4 and E[p^4] = 3/4 E[m^2] alpha^4 = alpha^4/4."""
    p = np.exp(np.arange(-60.0, 6.0, 0.02))
    for order, moment in ((2, ALPHA**2 / 4), (4, ALPHA**4 / 4)):
        assert_allclose(2 * 0.02 * np.sum(p ** (order + 1) * mf.ei.P2(p, ALPHA)), moment, rtol=1e-12)


def test_density_grows_like_a_logarithm() -> None:
    """E_1(y) = -log y - Euler's constant + y - ..."""
    r = ALPHA * np.array([1e-150, 1e-30, 1e-9])
    expected = (-2 * np.log(r / ALPHA) - np.euler_gamma) / (np.pi * ALPHA**2)
    assert_allclose(mf.ei.P22(r, 0.0, ALPHA), expected, rtol=1e-13)
    assert np.isposinf(mf.ei.D(1.0, ALPHA))
    assert np.isposinf(mf.ei.P22(0.0, 0.0, ALPHA))
    assert np.all(np.isfinite(mf.ei.D(np.nextafter(1.0, 0.0), [1e-4, ALPHA, 10.0])))


def test_exponential_integrals() -> None:
    y = np.array([1e-3, 0.1, 0.49, 0.51, 1.0, 4.0, 20.0, 25.0])
    assert_allclose(mf.ei.P22(y, 0.0, 1.0), special.exp1(y**2) / np.pi, rtol=3e-13)
    assert_allclose(mf.ei.survival(y, 1.0), special.expn(2, y**2), rtol=3e-13)


def test_tail_is_lighter_than_that_of_its_roughest_part() -> None:
    """Lambda over Beckmann's is (1 - 7/(2 x^2) + ...)/x^2 far out, where its printed form has no digits."""
    x = np.array([12.0, 18.0, 24.0])
    alpha = 1e-3  # so that x alpha is the cotangent to all digits
    u = x * alpha / np.hypot(1.0, x * alpha)
    quotient = mf.ei.Lambda(u, alpha) / mf.beckmann.Lambda(u, alpha)
    assert np.all(np.abs(quotient * x**2 - 1 + 3.5 / x**2) < 25 / x**4)
