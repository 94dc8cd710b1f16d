"""What only Exponential has: it is Bessel K at a = 3/2, whose Lambda its notebook calls unknown."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import integrate

import microfacet as mf

ALPHA = 0.37
U = np.array([1e-6, 0.05, 0.4, 0.8, 0.95])
P = ALPHA * np.array([1e-9, 0.3, 1.0, 4.0])
ARGUMENTS = {
    "D": (U,), "P22": (P, P[::-1]), "P2": (P,), "slope_cdf": (-P,), "sigma": (-U,), "Lambda": (U,),
    "G1": (U,), "survival": (P,), "sample_slope": (U,), "sample_u": (U,),
}  # fmt: skip


@pytest.mark.parametrize("quantity", ARGUMENTS)
def test_bessel_k_of_three_halves(quantity: str) -> None:
    ours, theirs = (getattr(family, quantity) for family in (mf.exponential, mf.bessel_k))
    assert_allclose(ours(*ARGUMENTS[quantity], ALPHA), theirs(*ARGUMENTS[quantity], ALPHA, 1.5), rtol=2e-13)


def test_elementary_density() -> None:
    r = np.hypot(P, P[::-1])
    expected = 2 * np.exp(-2 * r / ALPHA) / (np.pi * ALPHA**2)
    assert_allclose(mf.exponential.P22(P, P[::-1], ALPHA), expected, rtol=1e-13)
    assert_allclose(
        mf.exponential.survival(P, ALPHA), (1 + 2 * P / ALPHA) * np.exp(-2 * P / ALPHA), rtol=1e-13
    )


def test_mean_slope_is_alpha() -> None:
    """E r = int (1 + 2y) exp(-2y) dy = 1, and sigma at the horizon is half of E|p| = 2 E r/pi."""
    assert_allclose(mf.exponential.sigma(0.0, ALPHA), ALPHA / np.pi, rtol=1e-14)
    mean = integrate.quad(lambda r: mf.exponential.survival(r, ALPHA), 0, 40 * ALPHA)[0]
    assert_allclose(mean, ALPHA, rtol=1e-10)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_roughness_that_varies(dtype: type[np.floating]) -> None:
    """One table serves every roughness: each element is what it is alone."""
    rng = np.random.default_rng(5)
    u, alpha = rng.random(5000).astype(dtype), np.exp(rng.uniform(-6, 2, 5000)).astype(dtype)
    for quantity in ("D", "sigma", "Lambda", "sample_slope"):
        together = getattr(mf.exponential, quantity)(u, alpha)
        exact = getattr(mf.bessel_k, quantity)(u.astype(float), alpha.astype(float), 1.5)
        within = (exact < 4e8) & (exact > 3e-9)
        assert_allclose(together[within], exact[within], rtol=4e-13 if dtype is np.float64 else 4e-6)
