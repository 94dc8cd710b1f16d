"""What the report's figures of samples and materials show is true."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import special

import microfacet as mf
from microfacet._report.families import cross, materials, sampling


@pytest.mark.parametrize("degrees", [0.0, 75.0, 95.0])
def test_the_density_of_visible_slopes_is_that_of_their_distribution_function(degrees: float) -> None:
    ndf, w = mf.StudentT(alpha=0.5, gamma=2.2), sampling.towards(degrees)
    p = np.linspace(-3.0, 1.0, 4001)
    density = sampling.visible_slope_density(ndf, w, p)
    grown = np.diff(mf.testing.visible_slope_cdf(ndf, w, p))
    smooth = np.abs(w[0] * p[1:] - w[2]) > 2e-3  # the density has a kink where facets turn away
    steps = 0.5 * (density[1:] + density[:-1]) * np.diff(p)
    np.testing.assert_allclose(steps[smooth], grown[smooth], atol=2e-7)


def test_the_picture_of_normals_has_equal_areas() -> None:
    centres, inside, area = sampling._disc()
    np.testing.assert_allclose(np.linalg.norm(centres[inside], axis=-1), 1.0, rtol=1e-14)
    assert np.count_nonzero(inside) * area == pytest.approx(2.0 * np.pi, rel=5e-3)
    assert np.mean(centres[inside][:, 2]) == pytest.approx(0.5, abs=5e-3), "of an even density"


def test_both_samplers_estimate_the_same_light_and_visible_normals_with_less_noise() -> None:
    points = np.random.default_rng(2).random((200_000, 3))
    for ndf in (mf.GGX(alpha=0.4), mf.K0(alpha=0.4)):
        for degrees in (20.0, 80.0):
            seen, every = (
                sampling.conductor_noise(ndf, degrees, visible, points) for visible in (True, False)
            )
            error = np.hypot(seen[1], every[1]) / np.sqrt(len(points))
            assert abs(seen[0] - every[0]) < 4.5 * error
            assert 0.5 < seen[0] < 1.0, "what a metal reflects"
            assert seen[1] < every[1]


def test_light_that_meets_one_facet_is_the_albedo_of_one_order() -> None:
    points = np.random.default_rng(3).random((100_000, 3))
    for ndf in (mf.GGX(alpha=0.8), mf.K0(alpha=0.8)):
        shares = materials.shares_of_orders(ndf, 60.0)
        assert sum(shares) == pytest.approx(1.0)
        assert shares[0] == pytest.approx(materials.single_albedo(ndf, 60.0, points), abs=0.025)


def test_a_white_sphere_vanishes_when_all_orders_are_seen() -> None:
    one, every = (materials.furnace_picture(mf.GGX(alpha=0.8), s, 24, 60) for s in ("single", "multiple"))
    assert np.isnan(every[0, 0])
    assert np.nanmean(every) == pytest.approx(1.0, abs=0.03)
    assert np.nanmean(one) < 0.6


@pytest.mark.parametrize("alpha", [0.2, 5.0])
def test_k0_towards_the_mirror_direction_is_drawn_as_the_caption_says(alpha: float) -> None:
    off = np.geomspace(1e-8, 0.1, 30)
    over_beckmann = cross.reflectance(mf.K0(alpha=alpha), off) * 4 * np.pi * alpha**2
    x = 1 / (np.tan(off) * alpha)
    shown = np.cos(off / 2) ** -4 / np.cos(off) / (1 + np.exp(-2 * x) / (4 * x))
    law = 2 * special.k0(2 * np.tan(off / 2) / alpha) * shown
    np.testing.assert_allclose(over_beckmann, law, rtol=1e-11)
    rise = -np.diff(over_beckmann[:10]) / np.diff(np.log(off[:10]))
    np.testing.assert_allclose(rise, 2.0, rtol=1e-6)
    flat = cross.reflectance(mf.Beckmann(alpha=alpha), off[:10]) * 4 * np.pi * alpha**2
    np.testing.assert_allclose(flat, 1.0, rtol=1e-6)
