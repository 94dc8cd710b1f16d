"""Densities on grids of slopes: values against sums over cells, and against families."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest

import microfacet as mf
from slope_table_cases import each_table, exact_sigma, made, sphere, towards

# Values


@each_table
def test_areas_are_sums_over_cells(name: str) -> None:
    ndf = made(name)
    directions = [*sphere(24), *np.eye(3), *-np.eye(3), towards(89.999, 20), towards(90.5, 200)]
    # Far below the horizon: only a corner of the grid is seen.
    corner = max(
        ([-p, -q, 1.0] for p in ndf.p_edges[[0, -1]] for q in ndf.q_edges[[0, -1]]),
        key=lambda m: float(np.hypot(*m[:2])),
    )
    edge = np.array([*(np.array(corner[:2]) / np.hypot(*corner[:2])), 0.0])
    directions += [edge - [0, 0, share * np.hypot(*corner[:2])] for share in (0.5, 0.9, 0.99)]
    rounding = 1e-15 * max(1.0, np.abs(ndf.p_edges).max() / np.diff(ndf.p_edges)[0])
    for w in directions:
        sigma, below = exact_sigma(ndf, w), exact_sigma(ndf, -w)
        up = sigma - below
        # The end of the grid is known to rounding: the third root of what is near it.
        far = 100 * rounding * (1 + float(sigma) ** (-1 / 3)) if sigma > 0 else 1.0
        assert float(ndf.sigma(w)) == pytest.approx(float(sigma), rel=far, abs=1e-40), w
        if up > 1e-3 and below > 1e-6:
            assert float(ndf.Lambda(w)) == pytest.approx(float(below / up), rel=1e3 * rounding + 1e-12)
            assert float(ndf.Lambda(-w)) == pytest.approx(float(-1 - below / up), rel=1e3 * rounding + 1e-12)
            assert float(ndf.G1(w)) == pytest.approx(float(up / sigma), rel=1e3 * rounding + 1e-12)
            assert ndf.G1(-w) == 0.0


@each_table
def test_error_is_that_of_sums(name: str) -> None:
    ndf = made(name)
    assert 0.0 <= ndf.error < 1e-10
    for w in sphere(12, seed=4):
        sigma = float(exact_sigma(ndf, w))
        if sigma > 1e-3:
            assert float(ndf.sigma(w)) == pytest.approx(sigma, rel=max(10 * ndf.error, 1e-14))


@each_table
def test_densities_are_cells(name: str) -> None:
    ndf = made(name)
    p, q = ((edges[1:] + edges[:-1]) / 2 for edges in (ndf.p_edges, ndf.q_edges))
    dp, dq = np.diff(ndf.p_edges).mean(), np.diff(ndf.q_edges).mean()
    assert ndf.masses.sum() == pytest.approx(1.0, rel=1e-14)
    density = ndf.masses / (dp * dq)
    np.testing.assert_allclose(ndf.P22(p[:, None], q), density, rtol=1e-10)
    np.testing.assert_allclose(ndf.P2(p), ndf.masses.sum(axis=1) / dp, rtol=1e-10, atol=1e-300)
    np.testing.assert_allclose(ndf.slope_cdf(ndf.p_edges[1:]), np.cumsum(ndf.masses.sum(axis=1)), rtol=1e-10)
    assert ndf.slope_cdf(-9.0) == ndf.P2(9.0) == ndf.P2(-9.0) == ndf.P22(9.0, 0.0) == 0.0
    assert ndf.slope_cdf(9.0) == pytest.approx(1.0, rel=1e-14)
    m = np.stack(np.broadcast_arrays(-p[:, None], -q, 1.0), -1)
    cosine = 1 / np.linalg.norm(m, axis=-1)
    np.testing.assert_allclose(ndf.D(m), density / cosine**4, rtol=1e-10)
    np.testing.assert_allclose(ndf.pdf(m), density / cosine**3, rtol=1e-10)
    assert np.all(ndf.D(-m) == 0.0)
    w = towards(50.0, 30.0)
    seen = np.maximum(m @ w * cosine, 0.0) * ndf.D(m) / ndf.sigma(w)
    np.testing.assert_allclose(ndf.D_visible(m, w), seen, rtol=1e-14)
    np.testing.assert_array_equal(ndf.pdf_visible(m, w), ndf.D_visible(m, w))
    assert ndf.mean == pytest.approx((ndf.masses.sum(axis=1) @ p, ndf.masses.sum(axis=0) @ q), abs=1e-12)


@each_table
def test_masking_is_about_the_mean_plane(name: str) -> None:
    ndf = made(name)
    wi, wo = sphere(300, seed=2), sphere(300, seed=3)
    normal = np.array([-ndf.mean[0], -ndf.mean[1], 1.0])
    np.testing.assert_allclose(ndf.sigma(wi) - ndf.sigma(-wi), wi @ normal, rtol=0, atol=1e-10)
    np.testing.assert_allclose(ndf.mean_normal, normal / np.linalg.norm(normal), rtol=1e-14, atol=1e-16)
    up, out = wi @ normal, wo @ normal
    inner = np.where(out[:, None] > 0, wo, -wo)
    lambda_i, lambda_o = ndf.Lambda(wi), ndf.Lambda(inner)
    expected = np.zeros(len(wi))
    for k in np.flatnonzero(up > 0):
        a, b = lambda_i[k], lambda_o[k]
        expected[k] = 1 / (1 + a + b) if out[k] > 0 else float(mpmath.beta(1 + a, 1 + b))
    sure = (np.abs(up) > 1e-3) & (np.abs(out) > 1e-3)
    np.testing.assert_allclose(ndf.G2(wi, wo)[sure], expected[sure], rtol=1e-9)
    alone = ndf.G2(wi, wo, correlated=False)
    np.testing.assert_allclose(alone, ndf.G1(wi) * ndf.G1(inner), rtol=1e-14)


def test_float32_computes_in_double() -> None:
    ndf = made("two lobes")
    w, xi = sphere(200).astype(np.float32), np.random.default_rng(3).random((200, 2), dtype=np.float32)
    for quantity in (ndf.sigma, ndf.D, ndf.Lambda, ndf.G1):
        assert quantity(w).dtype == np.float32
        np.testing.assert_allclose(quantity(w), quantity(w.astype(float)), rtol=1e-7, atol=0)
    assert ndf.sample(xi).dtype == ndf.sample_visible(w, xi).dtype == np.float32
    np.testing.assert_allclose(ndf.sample_visible(w, xi), ndf.sample_visible(w.astype(float), xi), atol=1e-7)


def test_no_direction_gives_no_number() -> None:
    ndf = made("tilted")
    for bad in (np.nan, np.inf, -np.inf):
        for axis in range(3):
            w = np.array([0.6, 0.0, 0.8])
            w[axis] = bad
            assert np.isnan(ndf.sigma(w))
            assert np.isnan(ndf.sample_visible(w, [0.5, 0.5])).all()
    assert np.isnan(ndf.D([0.0, np.nan, 1.0]))
    for xi in ([1.0, 0.5], [0.5, 1.0], [-0.1, 0.5], [np.nan, 0.5]):
        assert np.isnan(ndf.sample(xi)).all()
        assert np.isnan(ndf.sample_visible([0.0, 0.0, 1.0], xi)).all()
    assert np.isnan(ndf.sample_visible([0.0, 0.0, -1.0], [0.5, 0.5])).all()  # sees nothing


# Families


@pytest.mark.parametrize(
    "family",
    [
        mf.Beckmann(alpha_x=0.2, alpha_y=0.5, rotation=0.4),
        mf.GGX(alpha=0.3),
        mf.StudentT(alpha_x=0.3, alpha_y=0.1, gamma=4.0),
    ],
    ids=lambda ndf: ndf.family,
)
def test_tables_of_families_converge(family: Any) -> None:
    """The error falls like the square of a cell, on the same part of the plane."""
    extent = ((-40.0, 40.0), (-40.0, 40.0)) if family.family == "ggx" else ((-3.0, 3.0), (-3.0, 3.0))
    w = np.stack([towards(degrees, 25.0) for degrees in (20, 60, 80, 95)])
    truth = family.sigma(w)
    errors = [
        np.abs(mf.SlopeTable.from_distribution(family, bins=bins, extent=extent).sigma(w) - truth).max()
        for bins in (128, 512)
    ]
    floor = 2e-3 if family.family == "ggx" else 1e-5  # the tail that lies outside
    assert errors[1] < max(errors[0] / 8, floor)
    assert errors[1] < 5 * floor


def test_default_extent_and_mean() -> None:
    family = mf.Beckmann(alpha_x=0.2, alpha_y=0.5, rotation=0.4)
    central, moved = (mf.SlopeTable.from_distribution(family, mean=mean) for mean in ((0, 0), (0.3, -0.1)))
    w = np.stack([towards(degrees, 25.0) for degrees in (20, 60, 80)])
    np.testing.assert_allclose(central.sigma(w), family.sigma(w), rtol=2e-4)
    assert central.mean == (0.0, 0.0)
    assert moved.mean == pytest.approx((0.3, -0.1), rel=1e-9)
    np.testing.assert_allclose(moved.moved(-0.3, 0.1).sigma(w), central.sigma(w), rtol=1e-9)
    # A slope that is moved is a sheared surface: sigma knows it by another direction.
    sheared = w.copy()
    sheared[:, 2] -= w[:, :2] @ [0.3, -0.1]
    np.testing.assert_allclose(moved.sigma(w), central.sigma(sheared), rtol=1e-9)
