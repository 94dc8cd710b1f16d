"""What only Beckmann has: normal, independent slopes, of variance alpha^2/2."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats

import microfacet as mf

ALPHA = 0.37


def test_slopes_are_independent_normals() -> None:
    normal = stats.norm(scale=ALPHA / np.sqrt(2))
    p, q = np.linspace(-3, 3, 31), 0.2
    assert_allclose(mf.beckmann.P2(p, ALPHA), normal.pdf(p), rtol=1e-12)
    assert_allclose(mf.beckmann.slope_cdf(p, ALPHA), normal.cdf(p), rtol=1e-12)
    assert_allclose(mf.beckmann.P22(p, q, ALPHA), normal.pdf(p) * normal.pdf(q), rtol=1e-12)


def test_squared_slopes_are_exponential() -> None:
    xi = np.linspace(0, 0.999, 20)
    assert_allclose(mf.beckmann.sample_slope(xi, ALPHA) ** 2, stats.expon(scale=ALPHA**2).ppf(xi), rtol=1e-13)


@pytest.mark.parametrize("x", [5.0, 10.0, 20.0, 26.0])
def test_lambda_far_in_the_tail(x: float) -> None:
    """exp(-x^2)/(4 sqrt(pi) x^3) (1 - 3/(2 x^2) + 15/(4 x^4) - ...), enclosed by its partial sums."""
    leading = np.exp(-x * x) / (4 * np.sqrt(np.pi) * x**3)
    u = x * ALPHA / np.hypot(1, x * ALPHA)
    rounding = 1e-15 * x * x * (1 + (x * ALPHA) ** 2)  # of u, at most
    result = mf.beckmann.Lambda(u, ALPHA) / leading
    two_terms = 1 - 1.5 / x**2
    assert two_terms - rounding < result < two_terms + 3.75 / x**4 + rounding
