"""Densities on grids of slopes: everything against sums over cells, and against families."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest

import microfacet as mf
from microfacet.testing import chi2, sidak

Array = np.ndarray


def _of(extent: tuple[float, float, float, float], masses: Any) -> mf.SlopeTable:
    masses = np.asarray(masses, dtype=float)
    p, q = np.linspace(*extent[:2], masses.shape[0] + 1), np.linspace(*extent[2:], masses.shape[1] + 1)
    return mf.SlopeTable(p, q, masses)


def _anisotropic() -> mf.SlopeTable:
    p, q = np.meshgrid(np.linspace(-1, 1, 12), np.linspace(-2, 2, 9), indexing="ij")
    return _of((-1.1, 1.1, -2.2, 2.2), np.exp(-4 * p**2 + 2 * p * q - q**2))


def _two_lobed() -> mf.SlopeTable:
    p, q = np.meshgrid(np.linspace(-1, 1, 14), np.linspace(-1, 1, 8), indexing="ij")
    return _of((-1.0, 1.0, -0.5, 0.5), np.exp(-12 * (abs(p) - 0.7) ** 2 - 3 * q**2) * (1.3 + p))


def _with_holes() -> mf.SlopeTable:
    rng = np.random.default_rng(8)
    return _of((-0.9, 1.4, -0.8, 0.7), np.where(rng.random((9, 11)) < 0.7, 0.0, rng.random((9, 11))))


def _heavy() -> mf.SlopeTable:
    slopes = np.random.default_rng(9).standard_t(3, size=(100_000, 2)) * [0.3, 0.1]
    return mf.SlopeTable.from_slopes(slopes, bins=(16, 10), extent=((-2, 2), (-1, 1)))


MADE: dict[str, Callable[[], mf.SlopeTable]] = {
    "anisotropic": _anisotropic,
    "tilted": lambda: _anisotropic().moved(0.8, -0.5),
    "two lobes": _two_lobed,
    "holes": _with_holes,
    "one cell": lambda: _of((0.1, 0.5, -0.3, 0.6), [[2.0]]),
    "heavy tails": _heavy,
    "narrow": lambda: _of((0.5, 0.5001, -0.2, -0.1999), [[1.0, 3.0], [2.0, 0.0], [1.0, 5.0]]),
}


@cache
def made(name: str) -> mf.SlopeTable:
    return MADE[name]()


each_table = pytest.mark.parametrize("name", MADE)


def towards(degrees: float, azimuth: float) -> Array:
    a, f = np.radians(degrees), np.radians(azimuth)
    return np.array([np.sin(a) * np.cos(f), np.sin(a) * np.sin(f), np.cos(a)])


def sphere(n: int, seed: int = 1) -> Array:
    w = np.random.default_rng(seed).normal(size=(n, 3))
    return w / np.linalg.norm(w, axis=1, keepdims=True)


def exact_sigma(ndf: mf.SlopeTable, w: Array) -> Any:
    """Sum over cells in 60 digits: the mean of max(t + u + v, 0), u, v uniform, is a difference of cubes."""
    with mpmath.workdps(60):
        x, y, z = map(mpmath.mpf, map(float, w))

        def cells(edges: Array) -> tuple[Any, list[Any]]:
            first, last, n = mpmath.mpf(float(edges[0])), mpmath.mpf(float(edges[-1])), len(edges) - 1
            return (last - first) / n, [first + (last - first) * (2 * i + 1) / (2 * n) for i in range(n)]

        (dp, ps), (dq, qs) = cells(ndf.p_edges), cells(ndf.q_edges)
        a, b = abs(x) * dp / 2, abs(y) * dq / 2

        def mean(t: Any) -> Any:
            if abs(t) >= a + b:
                return max(t, 0)
            cube = [max(t + s * a + r * b, 0) ** 3 * s * r for s in (1, -1) for r in (1, -1)]
            if a > 0 and b > 0:
                return sum(cube) / (24 * a * b)
            return max(t + a + b, 0) ** 2 / (4 * (a + b))

        return mpmath.fsum(
            mpmath.mpf(float(ndf.masses[i, j])) * mean(z - x * p - y * q)
            for i, p in enumerate(ps)
            for j, q in enumerate(qs)
        ) / mpmath.fsum(map(float, ndf.masses.ravel()))


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


# Objects


def test_they_are_values() -> None:
    ndf = made("tilted")
    for other in (copy.copy(ndf), copy.deepcopy(ndf), pickle.loads(pickle.dumps(ndf))):
        assert other == ndf
        assert hash(other) == hash(ndf)
        w = sphere(50)
        np.testing.assert_array_equal(other.sigma(w), ndf.sigma(w))
        assert not other.masses.flags.writeable
    assert ndf != made("anisotropic")
    assert ndf.moved(0.0, 0.0) == ndf
    assert ndf.parameters == {}
    with pytest.raises(AttributeError, match="SlopeTable is frozen"):
        ndf.error = 0.0
    with pytest.raises(ValueError, match="read-only"):
        ndf.masses[0, 0] = 1.0
    assert "12 x 9 cells" in repr(ndf)
    assert "mean slope (0.8, -0.5)" in repr(ndf)
    metal = mf.Conductor(ndf, 1.5, 2.0)
    assert pickle.loads(pickle.dumps(metal)) == metal


def test_given_arrays_stay_as_they_are() -> None:
    p, masses = np.linspace(-1, 1, 4), np.ones((3, 3))
    ndf = mf.SlopeTable(p, p, masses)
    masses[0, 0] = 5.0
    p[0] = -7.0
    assert ndf.p_edges[0] == -1.0
    assert ndf.masses[0, 0] == pytest.approx(1 / 9)


def test_histograms() -> None:
    slopes = np.random.default_rng(1).normal([0.1, -0.2], [0.2, 0.4], (50_000, 2))
    ndf = mf.SlopeTable.from_slopes(slopes, bins=(32, 48))
    counts, p, q = np.histogram2d(*slopes.T, bins=(32, 48))
    assert ndf == mf.SlopeTable(p, q, counts)
    assert ndf.mean == pytest.approx(slopes.mean(axis=0), abs=5e-3)
    by_rule = mf.SlopeTable.from_slopes(slopes)
    step = 3.5 * slopes.std(axis=0) * 50_000**-0.25
    assert np.diff(by_rule.p_edges)[0] == pytest.approx(step[0], rel=0.05)
    assert np.diff(by_rule.q_edges)[0] == pytest.approx(step[1], rel=0.05)
    sample = mf.SlopeSample(slopes, "test")
    assert mf.SlopeTable.from_slopes(sample) == by_rule
    terrain = mf.sample_terrain()
    assert mf.SlopeTable.from_slopes(terrain, bins=40) == mf.SlopeTable.from_slopes(terrain.slopes(), bins=40)


E = np.linspace(-1.0, 1.0, 4)
M = np.ones((3, 3))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((E, E, -M), "masses must be finite and not negative, got -1"),
        ((E, E, M * np.nan), "masses must be finite and not negative, got nan"),
        ((E, E, M * np.inf), "masses must be finite and not negative, got inf"),
        ((E, E, 0 * M), "masses must not all be 0"),
        ((E, E, M[:2]), r"masses must have shape \(3, 3\), one less than edges each way, got \(2, 3\)"),
        ((E, E, "text"), "masses must be an array of real numbers with 2 axes, got str"),
        ((E, E, [[1.0], [1.0, 2.0]]), "masses must be an array of real numbers"),
        ((E, E, 1j * M), "masses must be an array of real numbers"),
        ((E[::-1], E, M), "p_edges must increase strictly"),
        ((E, [-1.0, 0.0, 0.0, 1.0], M), "q_edges must increase strictly"),
        (([-1.0, 0.0, 0.5, 1.0], E, M), "p_edges must be evenly spaced, got steps from 0.5 to 1"),
        ((E * np.inf, E, M), r"p_edges must lie in \[-1e\+06, 1e\+06\], got -inf"),
        ((E, [0.0, np.nan, 1.0], M), r"q_edges must lie in .* got nan"),
        ((E * 1e7, E, M), "p_edges must lie in"),
        ((1.0 + E * 1e-12, E, M), "the steps of p_edges must be at least 1e-09 of its largest edge"),
        (([1.0], E, M), "p_edges must be 2 to 513 edges of cells, got 1"),
        ((np.linspace(0, 1, 514), E, M), "p_edges must be 2 to 513 edges of cells, got 514"),
        ((M, E, M), "p_edges must be an array of real numbers with 1 axis, got ndarray of shape"),
    ],
)
def test_bad_tables(arguments: tuple[Any, ...], message: str) -> None:
    with pytest.raises(ValueError, match="SlopeTable: " + message):
        mf.SlopeTable(*arguments)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: mf.SlopeTable.from_slopes(np.zeros((50, 2))), "at least 100 pairs"),
        (lambda: mf.SlopeTable.from_slopes(np.zeros((200, 3))), r"pairs \(p, q\), got shape \(200, 3\)"),
        (lambda: mf.SlopeTable.from_slopes(np.zeros((200, 2))), "all slopes p are the same"),
        (lambda: mf.SlopeTable.from_slopes(np.full((200, 2), np.nan)), "slopes must lie in .* got nan"),
        (lambda: mf.SlopeTable.from_slopes("file"), "slopes must be an array of real numbers"),
        (lambda: mf.SlopeTable.from_slopes(sphere(200)[:, :2], bins=0), "bins must be a whole number in"),
        (lambda: mf.SlopeTable.from_slopes(sphere(200)[:, :2], bins=(3, 513)), "bins must be a whole number"),
        (lambda: mf.SlopeTable.from_slopes(sphere(200)[:, :2], extent=(1, 2)), "extent must be"),
        (lambda: mf.SlopeTable.from_slopes(sphere(200)[:, :2], extent=((5, 6), (5, 6))), "must not all be 0"),
        (lambda: mf.SlopeTable.from_distribution("ggx"), "ndf must be a distribution, got 'ggx'"),
        (
            lambda: mf.SlopeTable.from_distribution(mf.GGX(alpha=0.3), mean=(np.nan, 0)),
            "mean must be two slopes",
        ),
        (lambda: mf.SlopeTable.from_distribution(mf.GGX(alpha=0.3), bins=1.5), "bins must be a whole number"),
        (lambda: made("holes").moved(np.inf, 0.0), "p_edges must lie in"),
    ],
)
def test_bad_input(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(ValueError, match=r"SlopeTable.(from_\w+|moved): .*" + message):
        call()


def test_tiny_and_huge_masses() -> None:
    whole = mf.SlopeTable(E, E, M)
    for factor in (1e-308, 1e300):
        np.testing.assert_allclose(mf.SlopeTable(E, E, M * factor).masses, whole.masses, rtol=1e-14)


def test_largest_table() -> None:
    """512 x 512 cells, in which nothing overflows and sums keep their digits."""
    edges = np.linspace(-1.0, 1.0, 513)
    centre = (edges[1:] + edges[:-1]) / 2
    ndf = mf.SlopeTable(edges, edges, np.exp(-20 * (centre[:, None] ** 2 + centre**2)))
    assert ndf.error < 1e-11
    assert ndf.sigma([0, 0, 1]) == pytest.approx(1.0, rel=1e-13)
    w = sphere(100)
    family = mf.Beckmann(alpha=20**-0.5)
    steep = np.abs(w[:, 2]) < 0.9
    np.testing.assert_allclose(ndf.sigma(w)[steep], family.sigma(w)[steep], rtol=2e-3, atol=1e-6)
    m = ndf.sample_visible(w, np.random.default_rng(1).random((100, 2)))
    assert np.all((m * w).sum(axis=1)[ndf.sigma(w) > 0] > -1e-12)
