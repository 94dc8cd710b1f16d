"""The laws of frozen distributions: functions of directions, isotropic and anisotropic, for every family."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy import special, stats

import microfacet as mf

Array = NDArray[np.float64]

SHAPES = {"alpha_x": 0.25, "alpha_y": 0.7, "rotation": 0.6}
FAMILIES = [pytest.param(family, id=family.name) for family in mf.families()]
WITH_A_DENSITY = [pytest.param(family, id=family.name) for family in mf.families() if not family.singular]
STRETCHED = [pytest.param(family, id=family.name) for family in mf.families() if family.anisotropic]


def shape_parameters(family: Any) -> dict[str, float]:
    return {p.name: p.lower + min(1.3, (p.upper - p.lower) / 2) for p in family.parameters[1:]}


def isotropic(family: Any, alpha: float = 0.4) -> Any:
    return family.cls(alpha=alpha, **shape_parameters(family))


def anisotropic(family: Any, **changes: float) -> Any:
    """The stretched and turned distribution; gtr has none and stays isotropic."""
    if not family.anisotropic:
        return isotropic(family)
    return family.cls(**{**SHAPES, **changes}, **shape_parameters(family))


def direction(theta: Any, phi: Any) -> Array:
    theta, phi = np.broadcast_arrays(theta, phi)
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def turned(w: Array, angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * w[..., 0] - s * w[..., 1], s * w[..., 0] + c * w[..., 1], w[..., 2]], axis=-1)


def random_directions(count: int, seed: int = 3) -> Array:
    rng = np.random.default_rng(seed)
    return direction(np.arccos(rng.uniform(-1, 1, count)), rng.uniform(-np.pi, np.pi, count))


UPPER = direction(np.array([0.0, 0.3, 0.8, 1.3, 1.5]), np.array([0.0, 1.0, -2.0, 0.4, 3.0]))
DIRECTIONS = np.concatenate([UPPER, direction(np.array([1.7, 2.5]), np.array([2.0, -0.5]))])


def normals(p: Array, q: Array) -> tuple[Array, Array]:
    """The normals of slopes (p, q) and their solid angle per dp dq."""
    p, q = np.broadcast_arrays(p, q)
    cosine = 1 / np.sqrt(1 + p * p + q * q)
    return np.stack([-p, -q, np.ones_like(p)], axis=-1) * cosine[..., None], cosine**3


def over_slopes(f: Any, w: Array) -> float:
    """int f(m) max(0, w.m) dm over the hemisphere, as a sum over slopes r (cos phi, sin phi), phi from the
    azimuth of w.

    There w.m is proportional to mu - r cos phi, mu = cot(theta): it is positive on the whole circle r < mu,
    and beyond abs(mu) on the arc phi0 < phi < 2 pi - phi0, cos(phi0) = mu/r.
    """
    sine, azimuth = np.hypot(w[0], w[1]), np.arctan2(w[1], w[0])
    mu = w[2] / sine
    x, x_weights = np.polynomial.legendre.leggauss(160)
    t = np.arange(-60.0, 50.0, 0.1)

    def rings(r: Array, r_weights: Array) -> float:
        phi0 = np.arccos(np.clip(mu / r, -1, 1))[:, None]
        phi = np.pi + (np.pi - phi0) * x
        m, solid_angle = normals(r[:, None] * np.cos(phi), r[:, None] * np.sin(phi))
        m = turned(m, azimuth)
        weights = (r * r_weights)[:, None] * (np.pi - phi0) * x_weights * solid_angle
        return float(np.sum(f(m) * (m @ w) * weights))

    outside = rings(abs(mu) + np.exp(t), 0.1 * np.exp(t))
    if mu < 0:
        return outside
    fraction = special.expit(t)  # of the disc r < mu
    return outside + rings(mu * fraction, 0.1 * mu * fraction * (1 - fraction))


# Normalisation and projected area.


@pytest.mark.parametrize("family", WITH_A_DENSITY)
def test_projected_area_of_the_plane_is_one(family: Any) -> None:
    """int D(m) cos(theta_m) dm = 1, in polar coordinates of the slope."""
    ndf = anisotropic(family)
    radius, phi = np.exp(np.arange(-45.0, 40.0, 0.1))[:, None], np.arange(200) * (2 * np.pi / 200)
    m, solid_angle = normals(radius * np.cos(phi), radius * np.sin(phi))
    weight = 0.1 * (2 * np.pi / 200) * radius**2 * solid_angle * m[..., 2]
    with np.errstate(invalid="ignore"):  # D is infinite at the normal for k0
        integrand = np.where(radius > 1e-17, ndf.D(m), 0.0) * weight
    assert_allclose(np.sum(integrand), 1.0, rtol=1e-9)


@pytest.mark.parametrize("family", WITH_A_DENSITY)
@pytest.mark.parametrize("w", DIRECTIONS[1:], ids=lambda w: f"z={w[2]:.2f}")
def test_sigma_is_the_projected_area(family: Any, w: Array) -> None:
    """sigma(w) = int max(0, w.m) D(m) dm, above and below the horizon."""
    ndf = anisotropic(family)
    assert_allclose(ndf.sigma(w), over_slopes(ndf.D, w), rtol=1e-8)


@pytest.mark.parametrize("family", WITH_A_DENSITY)
def test_visible_normals(family: Any) -> None:
    """D_visible(m, w) = max(0, w.m) D(m)/sigma(w) is a density of normals."""
    ndf, m = anisotropic(family), random_directions(200)
    for w in DIRECTIONS:
        expected = np.maximum(0.0, m @ w) * ndf.D(m) / ndf.sigma(w)
        assert_allclose(ndf.D_visible(m, w), expected, rtol=1e-12, atol=1e-300)


# Elementwise functions and directions.


@pytest.mark.parametrize("family", FAMILIES)
def test_isotropic_functions_are_the_elementwise_ones(family: Any) -> None:
    ndf, m = isotropic(family), random_directions(300)
    u, parameters = m[:, 2], (0.4, *shape_parameters(family).values())
    rtol = 1e-13 * (1 + 100 / 0.4**2)  # u is rounded
    for name in ("D", "sigma", "Lambda", "G1"):
        assert_allclose(getattr(ndf, name)(m), getattr(family.kernels, name)(u, *parameters), rtol=rtol)
    p, q = np.linspace(-2, 2, 9), np.linspace(0, 3, 9)
    assert_allclose(ndf.P22(p, q), family.kernels.P22(p, q, *parameters), rtol=1e-13)
    assert_allclose(ndf.P2(p), family.kernels.P2(p, *parameters), rtol=1e-13)
    assert_allclose(ndf.slope_cdf(p), family.kernels.slope_cdf(p, *parameters), rtol=1e-13)


@pytest.mark.parametrize("family", WITH_A_DENSITY)
def test_slopes_of_the_stretched_surface(family: Any) -> None:
    """P22(p, q) = D(m) cos(theta)^4; P2 and slope_cdf along x are its marginals."""
    ndf = anisotropic(family)
    p, q = np.array([-1.2, -0.3, 0.1, 0.8]), np.array([0.2, -0.6, 0.05, 1.0])
    m, _ = normals(p, q)
    assert_allclose(ndf.P22(p, q), ndf.D(m) * m[:, 2] ** 4, rtol=1e-12)
    b = np.arange(-25.0, 25.0, 0.02)
    assert_allclose(
        ndf.P2(p), np.sum(ndf.P22(p[:, None], np.sinh(b)) * np.cosh(b), axis=1) * 0.02, rtol=1e-11
    )
    tail = np.exp(np.arange(-60.0, 60.0, 0.05))
    below = 0.05 * np.sum(ndf.P2(-np.abs(p)[:, None] - tail) * tail, axis=1)
    assert_allclose(ndf.slope_cdf(-np.abs(p)), below, rtol=1e-11)


@pytest.mark.parametrize("family", WITH_A_DENSITY)
def test_masking(family: Any) -> None:
    """sigma(w) = z (1 + Lambda), sigma(-w) = z Lambda, and the definitions of G1 and G2."""
    ndf = anisotropic(family)
    wi, wo = UPPER[:, None], DIRECTIONS
    z, lambda_i, lambda_o = UPPER[:, 2], ndf.Lambda(wi), ndf.Lambda(wo)
    assert_allclose(ndf.sigma(UPPER), z * (1 + ndf.Lambda(UPPER)), rtol=1e-12)
    assert_allclose(ndf.sigma(-UPPER), z * ndf.Lambda(UPPER), rtol=1e-12)
    assert_allclose(ndf.Lambda(-UPPER), -1 - ndf.Lambda(UPPER), rtol=1e-12)
    assert_allclose(
        ndf.G1(DIRECTIONS), np.where(DIRECTIONS[:, 2] > 0, 1 / (1 + ndf.Lambda(DIRECTIONS)), 0), rtol=1e-12
    )

    reflected = 1 / (1 + lambda_i + lambda_o)
    transmitted = special.beta(1 + lambda_i, 1 + ndf.Lambda(-wo))
    expected = np.where(wo[:, 2] > 0, reflected, transmitted)
    assert_allclose(ndf.G2(wi, wo), expected, rtol=1e-12)
    assert_allclose(ndf.G2(-wi[1:], wo), np.zeros((len(wi) - 1, len(wo))))
    product = ndf.G1(wi) * ndf.G1(np.where(wo[:, 2:] > 0, wo, -wo))
    assert_allclose(ndf.G2(wi, wo, correlated=False), product, rtol=1e-12)


@pytest.mark.parametrize("family", FAMILIES)
def test_single_precision(family: Any) -> None:
    """float32 in, float32 out, near the float64 result at the same directions."""
    ndf, w = anisotropic(family), random_directions(200).astype(np.float32)
    for name in ("D", "sigma", "Lambda", "G1", "pdf"):
        result, expected = getattr(ndf, name)(w), getattr(ndf, name)(w.astype(np.float64))
        assert result.dtype == np.float32
        assert_allclose(result, expected, rtol=5e-5, atol=1e-37)


# Symmetries.


@pytest.mark.parametrize("family", FAMILIES)
def test_length_of_a_normal_cancels(family: Any) -> None:
    ndf, m = anisotropic(family), random_directions(100)
    for scale in (0.25, 3.0, 1e3):
        assert_allclose(ndf.D(scale * m), ndf.D(m), rtol=1e-12, atol=1e-300)
        for name in ("Lambda", "G1"):
            assert_allclose(getattr(ndf, name)(scale * m), getattr(ndf, name)(m), rtol=1e-12)


@pytest.mark.parametrize("family", STRETCHED)
def test_rotation(family: Any) -> None:
    """Functions turn with the surface; a quarter turn swaps the roughnesses, half a turn changes nothing."""
    ndf, straight = anisotropic(family), anisotropic(family, rotation=0.0)
    w = random_directions(100)
    swapped = family.cls(alpha_x=0.7, alpha_y=0.25, rotation=0.6 - np.pi / 2, **shape_parameters(family))
    for name in ("D", "sigma", "Lambda", "G1"):
        values = getattr(ndf, name)(turned(w, 0.6))
        assert_allclose(values, getattr(straight, name)(w), rtol=2e-12)
        assert_allclose(getattr(swapped, name)(turned(w, 0.6)), values, rtol=2e-12)
        assert_allclose(getattr(ndf, name)(turned(w, 0.6 + np.pi)), values, rtol=2e-12)


@pytest.mark.parametrize("family", STRETCHED)
def test_equal_roughnesses_are_isotropic(family: Any) -> None:
    ndf, w = isotropic(family), random_directions(50)
    same = family.cls(alpha_x=0.4, alpha_y=0.4, rotation=1.0, **shape_parameters(family))
    for name in ("D", "sigma", "Lambda", "G1"):
        assert_allclose(getattr(same, name)(w), getattr(ndf, name)(w), rtol=2e-12)


# Sampling.


@pytest.mark.parametrize("family", WITH_A_DENSITY)
def test_samples_follow_the_density(family: Any) -> None:
    """sample(xi) has the density pdf(m) = D(m) cos(theta): chi-square over 12 x 10 cells of radius and
    azimuth.

    The cells are those of the unstretched slopes, whose masses are equal.
    """
    ndf = anisotropic(family)
    m = ndf.sample(np.random.default_rng(5).random((50_000, 2)))
    assert_allclose(np.linalg.norm(m, axis=-1), 1.0, rtol=1e-12)
    assert np.all(m[:, 2] > 0)
    some = m[:100]
    assert_allclose(ndf.pdf(some), ndf.D(some) * some[:, 2], rtol=1e-12)

    stretch, parameters = (1.0, 1.0), ndf.parameters
    if family.anisotropic:
        stretch = (SHAPES["alpha_x"], SHAPES["alpha_y"])
        m, parameters = turned(m, -SHAPES["rotation"]), {"alpha": 1.0, **shape_parameters(family)}
    p, q = -m[:, 0] / m[:, 2] / stretch[0], -m[:, 1] / m[:, 2] / stretch[1]
    rank = family.kernels.survival(np.hypot(p, q), *parameters.values())
    counts, *_ = np.histogram2d(rank, np.arctan2(q, p), bins=(12, 10), range=((0, 1), (-np.pi, np.pi)))
    assert counts.sum() == len(m)
    assert stats.chisquare(counts.ravel()).pvalue > 1e-4


@pytest.mark.parametrize("z", [0.5, 1e-4, 1e-6, 1e-9, 1e-12])
def test_transmission_keeps_its_digits_at_grazing_angles(z: float) -> None:
    """Euler's Beta function where one Lambda is huge, against arbitrary precision."""
    ndf, wi, wo = mf.GGX(alpha=3.0), [1.0, 0.0, z], [0.6, 0.0, -0.8]
    with mpmath.workdps(40):
        lambdas = [mpmath.mpf(float(ndf.Lambda(w))) for w in (wi, [0.6, 0.0, 0.8])]
        expected = float(mpmath.beta(1 + lambdas[0], 1 + lambdas[1]))
    assert_allclose(ndf.G2(wi, wo), expected, rtol=2e-13)


def test_uniform_numbers_lie_below_one() -> None:
    assert np.isnan(mf.GGX(alpha=0.3).sample([[1.0, 0.5], [0.5, 1.0], [-0.1, 0.5], [0.5, -0.1]])).all()
