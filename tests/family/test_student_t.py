"""What only Student-T has: Student's t along a line, a mixture of Beckmann, and two domains of gamma."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import special, stats

import microfacet as mf

ALPHA = 0.37


@pytest.mark.parametrize("gamma", [1.05, 1.6, 2.0, 3.7, 40.0])
def test_slopes_are_students_t(gamma: float) -> None:
    """2 gamma - 2 degrees of freedom, scale alpha/sqrt(2)."""
    t = stats.t(df=2 * gamma - 2, scale=ALPHA / np.sqrt(2))
    p = np.linspace(-3, 3, 30)
    assert_allclose(mf.student_t.P2(p, ALPHA, gamma), t.pdf(p), rtol=1e-11)
    assert_allclose(mf.student_t.slope_cdf(p, ALPHA, gamma), t.cdf(p), rtol=1e-11)


@pytest.mark.parametrize("gamma", [1.7, 2.5, 6.0])
def test_mixture_of_beckmann(gamma: float) -> None:
    """alpha sqrt((gamma - 1)/b) with b ~ Gamma(gamma - 1): the trapezoidal rule in log b."""
    log_b = np.arange(-300.0, 6.0, 0.02)
    b = np.exp(log_b)
    weights = 0.02 * np.exp((gamma - 1) * log_b - b) / special.gamma(gamma - 1)
    alphas = ALPHA * np.sqrt((gamma - 1) / b)
    u = np.array([0.05, 0.4, 0.8, 0.95])
    for name in ("D", "sigma", "Lambda"):
        mixed = getattr(mf.beckmann, name)(u[:, None], alphas) @ weights
        assert_allclose(getattr(mf.student_t, name)(u, ALPHA, gamma), mixed, rtol=1e-10)


def test_domains_of_gamma() -> None:
    """The mean slope, and sigma with it, diverges at gamma = 3/2; the density exists above 1."""
    for gamma, density, area in (
        (1.0, False, False),
        (1.2, True, False),
        (1.5, True, False),
        (1.6, True, True),
    ):
        for name, x in (
            ("P22", (0.1, 0.2)),
            ("P2", (0.1,)),
            ("slope_cdf", (0.1,)),
            ("survival", (0.1,)),
            ("D", (0.5,)),
        ):
            assert np.isfinite(getattr(mf.student_t, name)(*x, ALPHA, gamma)) == density, (name, gamma)
        for name in ("sigma", "Lambda", "G1"):
            assert np.isfinite(getattr(mf.student_t, name)(0.5, ALPHA, gamma)) == area, (name, gamma)


@pytest.mark.parametrize("gamma", [1.5001, 2.0, 1e6])
def test_moments(gamma: float) -> None:
    """E[max(0, slope)] = alpha sqrt(k/pi) Gamma(gamma - 3/2)/(2 Gamma(k)), k = gamma - 1."""
    expected = np.log(ALPHA / 2) + 0.5 * np.log((gamma - 1) / np.pi)
    expected += special.gammaln(gamma - 1.5) - special.gammaln(gamma - 1)
    assert_allclose(
        mf.student_t.sigma(0.0, ALPHA, gamma), np.exp(expected), rtol=1e-8
    )  # gammaln of 1e6 cancels


@pytest.mark.parametrize("gamma", [1.6, 3.0, 1e4])
def test_no_slope_is_too_small(gamma: float) -> None:
    """Where the square of a slope is about the smallest normal number, sigma and slopes are as at 0."""
    x = np.sqrt((gamma - 1) * np.finfo(float).tiny) * np.geomspace(0.1, 10, 301)
    assert_allclose(mf.student_t.sigma(-x, 1.0, gamma), mf.student_t.sigma(0.0, 1.0, gamma), rtol=3e-15)
    assert_allclose(mf.student_t.slope_cdf(-x, 1.0, gamma), 0.5, rtol=3e-15)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_smallest_slopes(dtype: type[np.floating]) -> None:
    """Pr(slope < r) = (r/alpha)^2 near the normal, also for the smallest normal numbers."""
    xi = np.geomspace(1.01, 3, 50).astype(dtype) * np.finfo(dtype).tiny
    slope = mf.student_t.sample_slope(xi, dtype(1.0), dtype(2.0))
    assert_allclose(slope, np.sqrt(xi), rtol=4 * float(np.finfo(dtype).eps))
