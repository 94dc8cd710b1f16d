"""What only the generalised exponential has: its members, its moments, a steep edge, tails of any weight."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import special

import microfacet as mf

ALPHA = 0.37
U = np.array([0.05, 0.4, 0.8, 0.95])
P = ALPHA * np.array([1e-9, 0.3, 1.0, 2.5])
ARGUMENTS = {
    "D": (U,), "P22": (P, P[::-1]), "P2": (P,), "slope_cdf": (-P,), "sigma": (-U,), "Lambda": (U,),
    "G1": (U,), "survival": (P,), "sample_slope": (U,), "sample_u": (U,),
}  # fmt: skip
POWERS = (0.401, 0.5, 1.0, 1.3, 2.0, 3.0, 4.49)


@pytest.mark.parametrize("quantity", ARGUMENTS)
def test_beckmann_and_exponential(quantity: str) -> None:
    ours = getattr(mf.generalised_exponential, quantity)
    x = ARGUMENTS[quantity]
    assert_allclose(ours(*x, ALPHA, 2.0), getattr(mf.beckmann, quantity)(*x, ALPHA), rtol=2e-13)
    assert_allclose(ours(*x, ALPHA, 1.0), getattr(mf.exponential, quantity)(*x, 2 * ALPHA), rtol=2e-13)


@pytest.mark.parametrize("quantity", ARGUMENTS)
def test_smooth_in_g(quantity: str) -> None:
    """Where the variable of the integrals changes, at g = 1: the value is the mean of its neighbours."""
    f, x = getattr(mf.generalised_exponential, quantity), ARGUMENTS[quantity]
    mean = (f(*x, ALPHA, 1 - 1e-9) + f(*x, ALPHA, 1 + 1e-9)) / 2
    assert_allclose(mean, f(*x, ALPHA, 1.0), rtol=2e-13)


@pytest.mark.parametrize("g", POWERS)
def test_moments(g: float) -> None:
    """E r = Gamma(3/g)/Gamma(2/g) in units of alpha, and E|p| is 2/pi of that; P2(0) is an integral, too."""
    c = 1 / g
    mean = ALPHA * np.exp(special.gammaln(3 * c) - special.gammaln(2 * c))
    assert_allclose(mf.generalised_exponential.sigma(0.0, ALPHA, g), mean / np.pi, rtol=3e-14)
    density = 2 * np.exp(special.gammaln(1 + c) - special.gammaln(1 + 2 * c)) / (np.pi * ALPHA)
    assert_allclose(mf.generalised_exponential.P2(0.0, ALPHA, g), density, rtol=3e-14)


@pytest.mark.parametrize("g", POWERS)
def test_incomplete_gamma(g: float) -> None:
    z = np.array([1e-9, 0.1, 1.0, 1.5, 3.0, 11.0, 12.0, 40.0, 300.0])
    r = ALPHA * z ** (1 / g)
    condition = 1 + g * z  # of r^g
    error = mf.generalised_exponential.survival(r, ALPHA, g) / special.gammaincc(2 / g, z) - 1
    assert np.all(np.abs(error) < 1e-15 * condition + 2e-13)
    xi = np.array([1e-280, 1e-9, 0.3, 0.4999, 0.5001, 0.9, 1 - 1e-9])
    drawn = mf.generalised_exponential.sample_slope(xi, ALPHA, g) / ALPHA
    expected = np.exp((np.log(xi) + special.gammaln(1 + 2 / g)) / 2)  # of few
    assert_allclose(drawn[:1], expected[:1], rtol=1e-12)
    assert_allclose(special.gammainc(2 / g, drawn[1:] ** g), xi[1:], rtol=1e-11)


def test_marginal_of_fourth_powers() -> None:
    """g = 4: sqrt(2) t exp(-t^4/2) K_1/4(t^4/2)/pi^(3/2), the notebook's."""
    t = np.array([1e-3, 0.1, 0.7, 1.0, 2.0, 3.0])
    expected = np.sqrt(2) * t * special.kve(0.25, t**4 / 2) * np.exp(-(t**4)) / np.pi**1.5
    assert_allclose(mf.generalised_exponential.P2(t, 1.0, 4.0), expected, rtol=1e-12)


def test_visible_normals_come_from_tables() -> None:
    """Up to both ends of the interval, in both precisions: no other way is as fast."""
    for g in (0.41, 1.0, 3.0, 4.4):
        for float64 in (False, True):
            assert mf.GeneralisedExponential.kernels.tables(float64, g) is not None


@pytest.mark.parametrize("g", POWERS)
def test_nothing_is_left_at_infinity(g: float) -> None:
    for slope in (1e160, 1e300, np.inf):
        for alpha in (1e-4, 1.0, 10.0):
            f = mf.generalised_exponential
            assert f.P2(slope, alpha, g) == f.P22(slope, 0.0, alpha, g) == 0
            assert f.survival(slope, alpha, g) == f.slope_cdf(-slope, alpha, g) == 0
