"""Densities on grids of slopes: visible normals, and materials made of them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import microfacet as mf
from microfacet.testing import chi2, sidak
from slope_table_cases import MADE, Array, each_table, made, sphere, towards

# Samplers

INCIDENCES = ((60.0, 35.0), (89.9, 200.0), (110.0, 300.0))
SEEN = [
    (name, degrees, azimuth)
    for name in MADE
    for degrees, azimuth in INCIDENCES
    if name != "narrow" and made(name).sigma(towards(degrees, azimuth)) > 1e-9
]


@pytest.mark.parametrize(("name", "degrees", "azimuth"), SEEN)
def test_visible_normals(name: str, degrees: float, azimuth: float) -> None:
    ndf, w = made(name), towards(degrees, azimuth)
    seed = hash((degrees, azimuth, len(name))) % 2**32
    result = chi2(
        lambda xi: ndf.sample_visible(w, xi),
        lambda m: ndf.pdf_visible(m, w),
        n=100_000,
        resolution=(16, 16),
        seed=seed,
        tests=len(SEEN) + len(MADE),
    )
    assert result, result


@each_table
def test_all_normals(name: str) -> None:
    """Slopes count as cells say, and are even inside of them."""
    ndf = made(name)
    m = ndf.sample(np.random.default_rng(5).random((200_000, 2)))
    np.testing.assert_allclose(np.linalg.norm(m, axis=1), 1.0, rtol=1e-14)
    slopes = -m[:, :2] / m[:, 2:]
    edges = [
        np.interp(np.arange(0, len(e) - 0.5, 0.5), np.arange(len(e)), e) for e in (ndf.p_edges, ndf.q_edges)
    ]
    for e in edges:
        e[[0, -1]] += [-1e-9, 1e-9]
    counts, _, _ = np.histogram2d(*slopes.T, edges)
    expected = np.repeat(np.repeat(ndf.masses, 2, axis=0), 2, axis=1) * len(m) / 4
    assert counts.sum() == len(m)
    assert np.all(counts[expected == 0.0] == 0)
    enough = expected > 5
    statistic = ((counts - expected)[enough] ** 2 / expected[enough]).sum()
    from scipy.stats import chi2 as distribution

    assert distribution.sf(statistic, enough.sum() - 1) > sidak(0.01, len(SEEN) + len(MADE))


@each_table
def test_visible_normals_are_seen(name: str) -> None:
    ndf = made(name)
    w = sphere(2000, seed=7)
    xi = np.random.default_rng(8).random((2000, 2))
    xi[:40] = np.array([[a, b] for a in (0.0, 1 - 2**-53, 0.5, 1e-17) for b in (0.0, 1 - 2**-53)] * 5)
    m = ndf.sample_visible(w, xi)
    seen = ndf.sigma(w) > 0
    assert np.all(np.isnan(m[~seen]))
    assert np.all((m[seen] * w[seen]).sum(axis=1) > -1e-9)
    p, q = -m[seen, 0] / m[seen, 2], -m[seen, 1] / m[seen, 2]
    assert np.all((p >= ndf.p_edges[0] - 1e-12) & (p <= ndf.p_edges[-1] + 1e-12))
    assert np.all((q >= ndf.q_edges[0] - 1e-12) & (q <= ndf.q_edges[-1] + 1e-12))
    np.testing.assert_array_equal(m, ndf.sample_visible(w, xi, scheme="mixture"))


# Materials


def furnace(many: Any, once: Any, wi: Array, n: int = 150_000) -> tuple[float, float]:
    """Mean and standard error of what `many` sends everywhere.

    Half of the directions are even on the sphere, half are those of visible normals, if `once` draws any.
    """
    wo = sphere(n, seed=11)
    density = np.full(n, 0.25 / np.pi)
    if once is not None:
        wo[::2], _, _ = once.sample(wi, np.random.default_rng(13).random((n // 2, once.sample_dims)))
        density = 0.5 * density + 0.5 * once.pdf(wi, wo)
    values = many.eval(wi, wo, rng=12) / density
    return float(values.mean()), float(values.std() / np.sqrt(n))


@pytest.mark.parametrize("name", ["anisotropic", "tilted", "two lobes", "holes", "heavy tails"])
def test_white_furnaces(name: str) -> None:
    ndf = made(name)
    glass = [mf.Dielectric(ndf, 1.5, scattering=s, mode="importance") for s in ("multiple", "single")]
    metal = [mf.Conductor(ndf, scattering=s) for s in ("multiple", "single")]
    for wi in (towards(30, 80), towards(75, 250)):
        above = wi if wi @ ndf.mean_normal > 0 else -wi
        for many, once in (metal, glass, (mf.Diffuse(ndf, 1.0), None)):
            mean, error = furnace(many, once, above)
            assert abs(mean - 1.0) < 4 * error, (type(many).__name__, mean, error)
            assert error < 0.05, (type(many).__name__, error)
        mean, error = furnace(*glass, -above)
        assert abs(mean - 1.0) < 4 * error
        assert error < 0.05


@pytest.mark.parametrize("name", ["anisotropic", "tilted", "two lobes"])
def test_single_scattering_is_consistent(name: str) -> None:
    """Samples weigh eval/pdf, pdf integrates to 1, walks of one order are eval, and albedos agree."""
    ndf = made(name)
    wi = towards(40, 60)
    rng = np.random.default_rng(2)
    for material in (mf.Conductor(ndf, 1.2, 3.9), mf.Dielectric(ndf, 1.5, mode="importance")):
        wo, weight, pdf = material.sample(wi, rng.random((50_000, material.sample_dims)))
        np.testing.assert_allclose(material.pdf(wi, wo), pdf, rtol=1e-8)
        some = pdf > 1e-3
        np.testing.assert_allclose(material.eval(wi, wo)[some], (weight * pdf)[some], rtol=1e-8, atol=1e-12)
        albedo, error = material.albedo(wi, with_error=True)
        assert error < 2e-4
        assert albedo == pytest.approx(weight.mean(), abs=4 * weight.std() / np.sqrt(len(weight)) + 1e-4)
        even = sphere(30_000, seed=5)
        density = 4 * np.pi * material.pdf(wi, even)
        assert density.mean() == pytest.approx(1.0, abs=4 * density.std() / np.sqrt(len(even)))
    metal = mf.Conductor(ndf)
    walking = mf.Conductor(ndf, scattering="multiple")
    wo = sphere(8, seed=6)
    once = walking.eval(wi, wo, n=20_000, rng=3, orders=(1, 1))
    np.testing.assert_allclose(once, metal.eval(wi, wo), rtol=0.05, atol=1e-3)
    average, error = metal.average_albedo(with_error=True)
    n = 40_000
    xi = rng.random((n, 4))
    lobe = np.stack([np.sqrt(xi[:, 0]) * f(2 * np.pi * xi[:, 1]) for f in (np.cos, np.sin)], -1)
    lobe = np.concatenate([lobe, np.sqrt(1 - xi[:, :1])], -1)
    x, y, z = ndf.mean_normal
    axis = np.array([-y, x, 0.0])
    if np.linalg.norm(axis) > 0:  # turn +z to the mean normal
        axis /= np.linalg.norm(axis)
        across = np.cross(axis, lobe)
        lobe = lobe * z + across * np.sqrt(1 - z * z) + axis * (lobe @ axis)[:, None] * (1 - z)
    _, weight, _ = metal.sample(lobe, xi[:, 2:])
    assert average == pytest.approx(weight.mean(), abs=4 * weight.std() / np.sqrt(n) + error)


def test_tables_of_families_scatter_like_them() -> None:
    family = mf.Beckmann(alpha_x=0.3, alpha_y=0.6)
    ndf = mf.SlopeTable.from_distribution(family, bins=256, extent=((-1.5, 1.5), (-3, 3)))
    wi, wo = towards(50, 20), np.stack([towards(30, 190), towards(60, 240), towards(130, 200)])
    for make in (lambda d: mf.Conductor(d, 0.2, 3.9), lambda d: mf.Dielectric(d, 1.5)):
        np.testing.assert_allclose(make(ndf).eval(wi, wo), make(family).eval(wi, wo), rtol=0.03, atol=1e-6)
        np.testing.assert_allclose(make(ndf).albedo(wi), make(family).albedo(wi), rtol=3e-4)


def test_light_from_behind_an_opaque_surface() -> None:
    """Above the horizon of the frame, but behind the mean plane."""
    ndf = made("tilted").moved(2.0, 0.0)
    wi = towards(80, 0)
    assert wi[2] > 0 > wi @ ndf.mean_normal
    metal = mf.Conductor(ndf)
    assert np.all(metal.eval(wi, sphere(100)) == 0.0)
    assert metal.albedo(wi) == 0.0
    _, weight, pdf = metal.sample(wi, [0.3, 0.4])
    assert weight == pdf == 0.0
    clay = mf.Diffuse(ndf, 0.8)
    assert np.all(clay.pdf(wi, sphere(100)) == 0.0)


def test_what_needs_a_family_refuses() -> None:
    ndf = made("anisotropic")
    with pytest.raises(ValueError, match="roughness must be isotropic"):
        mf.KullaConty(mf.Conductor(ndf))
    with pytest.raises(ValueError, match="a SlopeTable cannot be exported: give a family or a RadialNDF"):
        mf.export("c", ndf, ["D"])
    with pytest.raises(ValueError, match="bounded=True is for GGX alone"):
        ndf.sample_visible([0, 0, 1], [0.5, 0.5], bounded=True)
