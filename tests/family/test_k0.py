"""What only K0 has: Laplace slopes, a product of two exponentials, a singular normal."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import special, stats

import microfacet as mf

ALPHA = 0.37


def test_slopes_are_laplace() -> None:
    laplace = stats.laplace(scale=ALPHA / 2)
    p = np.linspace(-4, 4, 31)
    assert_allclose(mf.k0.P2(p, ALPHA), laplace.pdf(p), rtol=1e-13)
    assert_allclose(mf.k0.slope_cdf(p, ALPHA), laplace.cdf(p), rtol=1e-13)


def test_infinite_at_the_normal() -> None:
    assert np.isposinf(mf.k0.D(1.0, ALPHA))
    assert np.isposinf(mf.k0.P22(0.0, 0.0, ALPHA))
    assert np.isposinf(mf.K0(alpha=ALPHA).D([0.0, 0.0, 1.0]))
    assert np.all(np.isfinite(mf.k0.D(np.nextafter(1.0, 0.0), [1e-4, ALPHA, 10.0])))


def test_density_grows_like_a_logarithm() -> None:
    """K_0(z) = -log(z/2) - Euler's constant + O(z^2 log z)."""
    r = ALPHA * np.array([1e-150, 1e-30, 1e-9])
    expected = 2 * (-np.log(r / ALPHA) - np.euler_gamma) / (np.pi * ALPHA**2)
    assert_allclose(mf.k0.P22(r, 0.0, ALPHA), expected, rtol=1e-13)


def test_squared_slope_is_a_product_of_exponentials() -> None:
    """slope^2 = alpha^2 E E' with exponential E, E': Pr(slope > r) = int exp(-m - r^2/(alpha^2 m)) dm."""
    log_m = np.arange(-60.0, 6.0, 0.02)
    m = np.exp(log_m)
    r = ALPHA * np.array([1e-3, 0.1, 1.0, 5.0, 12.0])
    integral = 0.02 * np.sum(np.exp(-m - (r[:, None] / ALPHA) ** 2 / m) * m, axis=-1)
    assert_allclose(mf.k0.survival(r, ALPHA), integral, rtol=1e-12)
    assert_allclose(mf.k0.survival(r, ALPHA), 2 * r / ALPHA * special.k1(2 * r / ALPHA), rtol=1e-12)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_smallest_slopes(dtype: type[np.floating]) -> None:
    """Pr(slope < r) = x^2 (1 - 2 gamma - 2 log x), x = r/alpha, down to the smallest normal number."""
    xi = np.geomspace(1.01 * float(np.finfo(dtype).tiny), 1e-25, 200).astype(dtype)
    x = mf.k0.sample_slope(xi, dtype(1.0)).astype(float)
    assert_allclose(
        2 * np.log(x) + np.log(1 - 2 * np.euler_gamma - 2 * np.log(x)), np.log(xi.astype(float)), rtol=3e-7
    )
