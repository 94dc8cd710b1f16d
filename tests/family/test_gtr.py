"""What only GTR has: its limits, and its structure as a mixture of GGX or a sum of Student-T."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import special

import microfacet as mf

U = np.linspace(0.05, 1.0, 20)
P = np.linspace(0.0, 4.0, 20)


@pytest.mark.parametrize("gamma", [0.25, 1.0, 1.5, 2.0, 15.0])
def test_uniform_normals_at_alpha_1(gamma: float) -> None:
    """D = 1/pi, sigma = (1 + u)/2."""
    assert_allclose(mf.gtr.D(U, 1.0, gamma), 1 / np.pi, rtol=1e-14)
    assert_allclose(mf.gtr.sigma(U, 1.0, gamma), (1 + U) / 2, rtol=1e-13)
    assert_allclose(mf.gtr.sigma(-U, 1.0, gamma), (1 - U) / 2, rtol=1e-13)
    assert_allclose(mf.gtr.sample_u(U[:-1], 1.0, gamma) ** 2, 1 - U[:-1], rtol=1e-13)


@pytest.mark.parametrize("alpha", [0.1, 0.6, 3.0])
@pytest.mark.parametrize("gamma", [0.3, 1.0, 1.7])
def test_mixture_of_ggx(alpha: float, gamma: float) -> None:
    """For 0 < gamma < 2: GGX of squared roughness A = 1 + w (alpha^2 - 1), w ~ Beta(gamma, 2 - gamma)/A."""
    logit = np.arange(-150.0, 150.0, 0.05)  # of w: dw = w (1 - w) d(logit)
    w, rest = special.expit(logit), special.expit(-logit)
    squared = w * alpha**2 + rest
    weights = w**gamma * rest ** (2 - gamma) / squared
    weights /= weights.sum()  # proportional to 1/C
    for name in ("sigma", "Lambda", "D"):
        mixed = getattr(mf.ggx, name)(U[:, None], np.sqrt(squared)) @ weights
        assert_allclose(getattr(mf.gtr, name)(U, alpha, gamma), mixed, rtol=1e-12, atol=1e-15)
    assert_allclose(mf.gtr.P2(P, alpha, gamma), mf.ggx.P2(P[:, None], np.sqrt(squared)) @ weights, rtol=1e-12)


@pytest.mark.parametrize("alpha", [0.1, 0.6])
@pytest.mark.parametrize("gamma", [3, 4, 7])
def test_sum_of_student_t(alpha: float, gamma: int) -> None:
    """Integer gamma > 2: (1 + r^2)^(gamma-2) is expanded in 1 - alpha^2 and r^2 + alpha^2."""
    k = np.arange(2, gamma + 1)  # exponents of the components: (r^2 + alpha^2)^-k
    masses = (
        special.binom(gamma - 2, gamma - k) * (1 - alpha**2) ** (k - 2.0) * alpha ** (2.0 - 2.0 * k) / (k - 1)
    )
    weights = masses / masses.sum()
    widths = alpha / np.sqrt(k - 1.0)
    for name, x in (("sigma", U), ("sigma", -U), ("D", U), ("P2", P), ("slope_cdf", -P), ("survival", P)):
        mixed = getattr(mf.student_t, name)(x[:, None], widths, k.astype(float)) @ weights
        assert_allclose(getattr(mf.gtr, name)(x, alpha, float(gamma)), mixed, rtol=1e-12, atol=1e-15)


def test_henyey_greenstein_at_gamma_three_halves() -> None:
    """D is proportional to the phase function of 2 theta with g = (1 - alpha)/(1 + alpha)."""
    alpha = 0.3
    g = (1 - alpha) / (1 + alpha)
    phase = (1 - g * g) / (1 + g * g - 2 * g * (2 * U**2 - 1)) ** 1.5
    ratio = mf.gtr.D(U, alpha, 1.5) / phase
    assert_allclose(ratio, ratio[0], rtol=1e-13)


@pytest.mark.parametrize("gamma", [0.4, 1.0, 2.5, 15.0])
@pytest.mark.parametrize("alpha", [1e-4, 0.3, 1.0, 10.0])
def test_the_smallest_slopes_are_sampled(alpha: float, gamma: float) -> None:
    """About the normal xi = pi slope^2 P22(0), also where the square of the slope underflows."""
    xi = np.array([1e-300, 1e-280, 1e-200, 1e-100])
    expected = np.sqrt(xi) / np.sqrt(np.pi * mf.gtr.P22(0.0, 0.0, alpha, gamma))
    assert_allclose(mf.gtr.sample_slope(xi, alpha, gamma), expected, rtol=1e-13)
