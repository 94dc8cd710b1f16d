"""What only Dirac has: a ring of normals, infinite density on it, none elsewhere."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy import stats

import microfacet as mf

ALPHA = 0.6
RING = mf.Dirac(alpha=ALPHA)


def directions(n: int = 40) -> np.ndarray:
    u, azimuth = np.linspace(-0.5, 1.0, n), np.linspace(0.0, 9.0, n)
    s = np.sqrt((1 - u) * (1 + u))
    return np.stack([s * np.cos(azimuth), s * np.sin(azimuth), u], axis=-1)


def test_arcsine_law() -> None:
    arcsine = stats.arcsine(loc=-ALPHA, scale=2 * ALPHA)
    p = ALPHA * np.array([-2.0, -0.9, -0.3, 0.0, 0.5, 0.99, 1.01])
    assert_allclose(mf.dirac.P2(p, ALPHA), arcsine.pdf(p), rtol=1e-13)
    assert_allclose(mf.dirac.slope_cdf(p, ALPHA), arcsine.cdf(p), rtol=1e-13, atol=1e-15)


def test_density_is_infinite_on_the_ring_and_zero_elsewhere() -> None:
    assert np.isposinf(mf.dirac.P22(1.0, 0.0, 1.0))
    assert np.isposinf(mf.dirac.D(np.sqrt(0.5), 1.0)) or mf.dirac.D(np.sqrt(0.5), 1.0) == 0.0
    off = np.array([0.0, 0.3, 0.9, 1.1, 50.0, np.inf])
    assert_array_equal(mf.dirac.P22(off, 0.0, 1.0), 0.0)
    assert_array_equal(mf.dirac.D(np.array([1.0, 0.9, 0.1, 0.0, -1.0]), 1.0), 0.0)
    assert np.isnan(mf.dirac.D(np.nan, 1.0))
    assert np.isnan(mf.dirac.P22(np.nan, 0.0, 1.0))


def test_survival_is_a_step() -> None:
    r = ALPHA * np.array([0.0, 0.5, 1 - 1e-12, 1 + 1e-12, 2.0, np.inf])
    assert_array_equal(mf.dirac.survival(r, ALPHA), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    xi = np.array([0.0, 0.3, 1 - 2.0**-53])
    assert_array_equal(mf.dirac.sample_slope(xi, ALPHA), ALPHA)


def test_nothing_is_masked_from_above() -> None:
    u = np.array([0.9, 0.99, 1.0])  # cot(theta) > alpha
    assert_array_equal(mf.dirac.Lambda(u, ALPHA), 0.0)
    assert_array_equal(mf.dirac.sigma(u, ALPHA), u)
    assert_array_equal(mf.dirac.sigma(-u, ALPHA), 0.0)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_visible_normals(dtype: type[np.floating]) -> None:
    """Each on the ring; their azimuths as often as max(0, w . m) says, by Kolmogorov's test."""
    rng = np.random.default_rng(11)
    for w in directions(6).astype(dtype):
        if w[2] < -0.45:
            continue
        m = RING.sample_visible(w, rng.random((20_000, RING.visible_dims)).astype(dtype)).astype(float)
        tolerance = 2e-6 if dtype is np.float32 else 1e-14
        assert_allclose(np.hypot(m[:, 0], m[:, 1]) / m[:, 2], ALPHA, rtol=tolerance)
        assert np.all(m @ w > -1e-6)
        s = np.hypot(w[0], w[1])
        x = float(w[2]) / max(float(s) * ALPHA, 1e-9)
        towards = np.arctan2(w[1], w[0])
        f = np.abs((np.arctan2(m[:, 1], m[:, 0]) - towards + np.pi) % (2 * np.pi) - np.pi)
        last = np.pi if x >= 1 else np.arccos(-x)
        share = (x * f + np.sin(f)) / (x * last + np.sin(last))
        assert stats.kstest(share, "uniform").pvalue > 1e-4


def test_stretched() -> None:
    ndf = mf.Dirac(alpha_x=0.2, alpha_y=0.5, rotation=0.4)
    m = ndf.sample(np.random.default_rng(2).random((1000, 2)))
    p, q = -m[:, 0] / m[:, 2], -m[:, 1] / m[:, 2]
    c, s = np.cos(0.4), np.sin(0.4)
    assert_allclose(((c * p + s * q) / 0.2) ** 2 + ((c * q - s * p) / 0.5) ** 2, 1.0, rtol=1e-13)


def test_weights_of_a_material_are_finite() -> None:
    """`eval` and `pdf` are 0 or inf, their ratio is not: an ideal conductor loses what masking takes."""
    mirror = mf.Conductor(RING)
    wi = directions()[20:]
    xi = np.random.default_rng(3).random((*wi.shape[:-1], mirror.sample_dims))
    wo, weight, _ = mirror.sample(wi, xi)
    assert np.all((weight >= 0) & (weight <= 1 + 1e-12))
    assert np.all(np.isfinite(wo))
