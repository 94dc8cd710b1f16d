"""The tests of samplers are right themselves: they pass what is correct and fail what is not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import stats

import microfacet as mf
from microfacet.testing import chi2, ks_visible_slope, visible_slope_cdf
from microfacet.testing._cells import DOMAINS, Cells, coordinates, theta
from microfacet.testing._quadrature import integrate
from testing_cases import QUICK, Array, caps, cosine, lambert, towards

TOP = DOMAINS["hemisphere"]


# What is correct passes


@pytest.mark.parametrize("alpha", [1e-3, 0.01, 0.3, 3.0])
@pytest.mark.parametrize("degrees", [0, 60, 89.9, 95, 170])
def test_a_correct_sampler_passes(alpha: float, degrees: float) -> None:
    ndf, w = mf.GGX(alpha=alpha), towards(degrees, 40)
    result = chi2(caps(w, alpha), lambda m: ndf.D_visible(m, w), **QUICK, tests=20)
    assert result, result
    assert abs(result.mass - 1.0) < 1e-4
    assert result.expected.sum() == pytest.approx(result.n * result.mass)
    assert result.histogram.sum() == result.n == 100_000
    slopes = ks_visible_slope(ndf, w, sampler=caps(w, alpha), dims=2, n=100_000, tests=20)
    assert slopes, slopes


@pytest.mark.parametrize(
    "ndf",
    [
        mf.K0(alpha=0.01),
        mf.BesselK(alpha=0.5, a=0.3),
        mf.BesselK(alpha=0.5, a=0.05),
        mf.GTR(alpha=0.01, gamma=0.5),
        mf.StudentT(alpha=3.0, gamma=1.55),
        mf.Beckmann(alpha_x=0.02, alpha_y=0.9, rotation=0.7),
        mf.GGX(alpha_x=1e-3, alpha_y=2.0, rotation=-0.3),
    ],
    ids=repr,
)
def test_singular_stretched_and_heavy_densities_are_integrated(ndf: Any) -> None:
    result = chi2(ndf.sample, ndf.pdf, **QUICK, tests=7)
    assert result, result
    assert abs(result.mass - 1.0) < 1e-4


def test_p_values_are_uniform() -> None:
    """A correct sampler fails as often as the significance says, not less and not more."""
    ndf, w = mf.GGX(alpha=0.4), towards(85)
    runs = range(200)
    p_values = [
        [
            chi2(caps(w, 0.4), lambda m: ndf.D_visible(m, w), n=20_000, resolution=(8, 8), seed=seed).p_value,
            ks_visible_slope(ndf, w, sampler=caps(w, 0.4), dims=2, n=20_000, seed=seed).p_value,
        ]
        for seed in runs
    ]
    for column in np.transpose(p_values):
        assert stats.kstest(column, "uniform").pvalue > 0.001


def test_mass_within_a_rounding_of_the_horizon_is_seen() -> None:
    """Student-T near its limit, from far below: a tenth of all visible slopes exceeds 1e10."""
    ndf, w = mf.StudentT(alpha=0.5, gamma=1.55), towards(170)
    p = np.array([-1e10, -1e12])
    assert visible_slope_cdf(ndf, w, p[0]) > 0.05
    s = 1.0 / np.hypot(1.0, p)
    m = np.stack([-p * s, 0.0 * s, s], axis=-1)
    assert coordinates(m)[0] == pytest.approx(np.log(-p))
    pilot = np.concatenate(
        [np.stack([np.cos(a) * m[:, 0], np.sin(a) * m[:, 0], m[:, 2]], -1) for a in range(6)]
    )
    cells = Cells.around(pilot, TOP, 3, 3)
    assert integrate(lambda m: ndf.D_visible(m, w), cells, 1e-6).sum() == pytest.approx(1.0, abs=1e-4)


# What is wrong fails


@pytest.mark.parametrize("degrees", [0, 60, 89])
def test_a_roughness_off_by_two_percent_fails(degrees: float) -> None:
    ndf, w = mf.GGX(alpha=0.3), towards(degrees)
    wrong = caps(w, 0.306)
    assert not chi2(wrong, lambda m: ndf.D_visible(m, w))
    assert not ks_visible_slope(ndf, w, sampler=wrong, dims=2)


def test_a_wrong_jacobian_fails() -> None:
    """Both densities have mass 1, or nearly: the counts tell, not the mass."""
    ndf, w = mf.GGX(alpha=0.3), towards(60)
    sample = caps(w, 0.3)
    assert not chi2(sample, lambda m: ndf.pdf(m), **QUICK), "all normals are not the visible ones"
    tilted = chi2(sample, lambda m: ndf.D_visible(m, w) * m[..., 2] / 0.873, **QUICK)
    assert tilted.mass == pytest.approx(1.0, abs=0.02)
    assert tilted.p_value < 1e-6


def test_a_density_that_does_not_integrate_to_one_fails() -> None:
    assert chi2(cosine, lambert, **QUICK)
    # So few samples that the counts alone would not tell.
    result = chi2(cosine, lambda m: 1.01 * lambert(m), n=3000, resolution=(8, 8))
    assert result.p_value > 0.01
    assert not result
    assert "integrates to 1.01" in repr(result)


def test_one_sample_outside_fails() -> None:
    for lost in (np.nan, -1.0):

        def sample(xi: Array, lost: float = lost) -> Array:
            m = cosine(xi)
            m[0, 2] = lost
            return m

        result = chi2(sample, lambert, **QUICK)
        assert not result
        assert result.outside == 1
        assert "1 outside" in repr(result)


def test_a_lossy_density_counts_what_is_lost() -> None:
    def sample(xi: Array) -> Array:
        m = cosine(xi[:, :2])
        m[xi[:, 2] < 0.25, 2] = np.nan
        return m

    options: dict[str, Any] = {**QUICK, "dims": 3}
    assert chi2(sample, lambda m: 0.75 * lambert(m), **options, lossy=True)
    assert not chi2(sample, lambda m: 0.74 * lambert(m), **options, lossy=True)
    assert not chi2(sample, lambda m: 0.75 * lambert(m), **options), "unless that is said"
    assert not chi2(sample, lambert, **options, lossy=True)


def test_the_whole_sphere() -> None:
    def uniform(xi: Array) -> Array:
        z, phi = 1.0 - 2.0 * xi[:, 0], 2.0 * np.pi * xi[:, 1]
        s = np.sqrt(1.0 - z * z)
        return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)

    def density(m: Array) -> Array:
        return np.full(m.shape[:-1], 0.25 / np.pi)

    assert chi2(uniform, density, domain="sphere", **QUICK)
    assert not chi2(uniform, density, domain="hemisphere", **QUICK)


def test_a_sampler_that_always_says_the_same_fails() -> None:
    result = chi2(lambda xi: np.tile(towards(30), (len(xi), 1)), lambert, **QUICK)
    assert not result
    assert result.p_value == 0.0


# Quadrature


def test_a_coarse_quadrature_rejects_a_correct_sampler() -> None:
    """Why expected counts are integrated finely: one point in each cell's middle is another distribution."""
    ndf, w = mf.GGX(alpha=0.1), towards(88)
    result = chi2(caps(w, 0.1), lambda m: ndf.D_visible(m, w))
    assert result
    t0, t1, p0, p1 = result.cells.T
    middle, phi = 0.5 * (t0 + t1), 0.5 * (p0 + p1)
    m = np.stack([np.sin(middle) * np.cos(phi), np.sin(middle) * np.sin(phi), np.cos(middle)], axis=-1)
    coarse = result.n * ndf.D_visible(m, w) * np.sin(middle) * (t1 - t0) * (p1 - p0)
    enough = (coarse >= 5) & (result.expected >= 5)
    for expected, right in ((result.expected, True), (coarse, False)):
        counts = result.histogram[enough]
        share = expected[enough] * counts.sum() / expected[enough].sum()
        assert (stats.chisquare(counts, share).pvalue > 1e-3) is np.bool_(right)


def test_integrals_of_cells_are_exact() -> None:
    """Of a density with a closed integral over rectangles: cos(theta)/pi, and a kink across them."""
    cells = Cells.around(cosine(np.random.default_rng(1).random((4000, 2))), TOP, 6, 7)
    t0, t1, p0, p1 = cells.rectangles.T
    t0, t1 = theta(t0), theta(t1)
    exact = (np.sin(t1) ** 2 - np.sin(t0) ** 2) * (p1 - p0) / (2.0 * np.pi)
    np.testing.assert_allclose(integrate(lambert, cells, 1e-9), exact, atol=1e-12)
    kinked = integrate(lambda m: np.abs(m[..., 0]) / np.pi, cells, 1e-7)
    assert kinked.sum() == pytest.approx(1.0, abs=1e-6)


def test_a_lobe_in_the_corner_of_a_wide_cell_is_found() -> None:
    """Two cells: the lobe of width 1e-3 fills a millionth of the first."""
    ndf, w = mf.GGX(alpha=1e-3), towards(95, 170)
    cells = Cells.around(caps(w, 1e-3)(np.random.default_rng(1).random((4000, 2))), TOP, 2, 1)
    assert integrate(lambda m: ndf.D_visible(m, w), cells, 1e-6).sum() == pytest.approx(1.0, abs=1e-4)


# Cells


@pytest.mark.parametrize("degrees", [0, 30, 89, 95])
def test_cells_cover_the_hemisphere_once_and_hold_like_shares(degrees: float) -> None:
    sample, rng = caps(towards(degrees, 200), 0.2), np.random.default_rng(3)
    cells = Cells.around(sample(rng.random((20_000, 2))), TOP, 12, 10)
    t0, t1, p0, p1 = cells.rectangles.T
    assert np.sum((np.cos(theta(t0)) - np.cos(theta(t1))) * (p1 - p0)) == pytest.approx(
        2.0 * np.pi, rel=1e-12
    )
    m = sample(rng.random((50_000, 2)))
    counts, outside = cells.count(m)
    assert outside == 0
    assert counts.sum() == len(m)
    assert counts.min() > 0.5 * len(m) / 120
    t, phi = coordinates(m, cells.phi[0, 0])
    found = cells.find(t, phi)
    inside = (t >= t0[found]) & (t <= t1[found]) & (phi >= p0[found]) & (phi <= p1[found])
    assert inside.all()


def test_cells_with_few_samples_are_pooled() -> None:
    result = chi2(cosine, lambert, n=2000, resolution=(32, 32))
    assert result, result
    assert np.median(result.expected) < 5.0
    assert 1 <= result.dof < 500
