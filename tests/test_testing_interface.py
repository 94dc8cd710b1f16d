"""The sampler tests as an interface: arguments, results, bad input, visible slopes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import microfacet as mf
from microfacet.testing import chi2, ks_visible_slope, sidak, visible_slope_cdf
from testing_cases import QUICK, Array, caps, cosine, lambert, towards

# Interface


def test_directions_may_be_given() -> None:
    m = cosine(np.random.default_rng(5).random((200_000, 2)))
    result = chi2(m, lambert, resolution=(16, 16))
    assert result
    assert result.n == 200_000 - 64 * 256
    assert not chi2(m, lambda m: 1.5 * lambert(m) * m[..., 2], resolution=(16, 16))


def test_a_seed_repeats_and_a_generator_goes_on() -> None:
    first, again, other = (chi2(cosine, lambert, **QUICK, seed=seed) for seed in (7, 7, 8))
    assert first == again
    assert first.statistic != other.statistic
    rng = np.random.default_rng(7)
    assert chi2(cosine, lambert, **QUICK, seed=rng) == first
    assert chi2(cosine, lambert, **QUICK, seed=rng) != first


def test_single_precision_uniforms() -> None:
    seen = []

    def sample(xi: Array) -> Array:
        seen.append(xi.dtype)
        return cosine(xi)

    assert chi2(sample, lambert, **QUICK, dtype=np.float32)
    assert set(seen) == {np.dtype(np.float32)}


def test_sidak() -> None:
    assert 1.0 - (1.0 - sidak(0.01, 500)) ** 500 == pytest.approx(0.01)
    assert chi2(cosine, lambert, **QUICK, tests=500).threshold == sidak(0.01, 500)
    for arguments in ((0.0, 1), (1.0, 1), (0.1, 0)):
        with pytest.raises(ValueError, match="must"):
            sidak(*arguments)


@pytest.mark.parametrize(
    ("samples", "density", "options", "words"),
    [
        (cosine, lambert, {"domain": "disk"}, "domain must be 'hemisphere' or 'sphere', got 'disk'"),
        (cosine, lambert, {"resolution": (1, 1)}, "at least 2 cells"),
        (cosine, lambert, {"significance": 2.0}, "significance"),
        (cosine, lambert, {"n": 0}, "n must be at least 1"),
        (lambda xi: xi, lambert, {}, r"shape \(16384, 3\), got \(16384, 2\)"),
        (np.zeros((5, 2)), lambert, {}, r"shape \(N, 3\), got \(5, 2\)"),
        (cosine, lambda m: m, {}, "the density of directions"),
        (cosine, lambda m: lambert(m) - 0.1, {}, "finite and not negative"),
        (cosine, lambda m: lambert(m) * np.nan, {}, "finite and not negative"),
        (cosine, lambert, {"n": 4}, "more samples"),
        (cosine, lambda m: np.random.default_rng(1).random(m.shape[:-1]), {}, "cannot be integrated"),
    ],
)
def test_bad_input_is_one_sentence(samples: Any, density: Any, options: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        chi2(samples, density, **{"resolution": (16, 16), **options})


# Visible slopes


@pytest.mark.parametrize(
    "ndf",
    [
        mf.Beckmann(alpha_x=0.2, alpha_y=0.6, rotation=0.5),
        mf.BesselK(alpha_x=0.6, alpha_y=0.1, a=0.7),
        mf.GTR(alpha=0.2, gamma=1.4),
        mf.RadialNDF(lambda r: np.exp(-(r**4)), alpha_x=0.3, alpha_y=0.5, rotation=-0.3),
    ],
    ids=repr,
)
@pytest.mark.parametrize(("degrees", "azimuth"), [(0, 0), (50, 20), (88, 100), (97, 250)])
def test_the_slope_cdf_is_the_integral_of_the_visible_density(
    ndf: Any, degrees: float, azimuth: float
) -> None:
    """Of D_visible over slopes across the plane of incidence, and along it up to p."""
    w = towards(degrees, azimuth)
    e = w[:2] / np.hypot(*w[:2]) if degrees else np.array([1.0, 0.0])
    nodes, weights = np.polynomial.legendre.leggauss(500)
    limit = np.inf if degrees == 0 else w[2] / np.hypot(*w[:2])
    for a, b in ((-0.6, -0.25), (-0.25, -0.1), (0.01, 0.3)):
        low, high = min(a, limit), min(b, limit)
        p = (low + (high - low) * 0.5 * (nodes + 1.0))[:, None]
        q = np.sinh(20.0 * nodes) / 1e3
        slopes = p[..., None] * e + q[:, None] * np.array([-e[1], e[0]])
        visible = (
            np.maximum(0.0, w[2] - slopes @ w[:2]) * ndf.P22(slopes[..., 0], slopes[..., 1]) / ndf.sigma(w)
        )
        inner = (visible * weights * 20.0 * np.cosh(20.0 * nodes) / 1e3).sum(axis=-1)
        expected = float(inner @ weights) * 0.5 * (high - low)
        between = np.diff(visible_slope_cdf(ndf, w, [a, b]))[0]
        assert between == pytest.approx(expected, abs=2e-6)
    assert visible_slope_cdf(ndf, w, 1e300) == pytest.approx(1.0, abs=1e-12)


def test_results_speak_for_themselves() -> None:
    result = ks_visible_slope(mf.GGX(alpha=0.5), towards(60), sampler=caps(towards(60), 0.5), dims=2, n=1000)
    assert repr(result).startswith("SlopeResult(passed: p = ")
    with pytest.raises(ValueError, match=r"w must have shape \(3,\)"):
        visible_slope_cdf(mf.GGX(alpha=0.5), [0.0, 1.0], 0.0)
