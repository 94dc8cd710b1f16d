"""Albedos: the quadrature over facets against other integrals and samples; walks; bounds."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from scipy import integrate

import microfacet as mf
from microfacet._bsdf import quadrature

NDFS = [
    mf.Beckmann(alpha=0.3),
    mf.GGX(alpha_x=0.1, alpha_y=0.6, rotation=0.7),
    mf.GTR(alpha=0.2, gamma=1.3),
    mf.StudentT(alpha=0.5, gamma=1.7),
    mf.K0(alpha=1.0),
    mf.BesselK(alpha=0.4, a=0.3),
]
MATERIALS = {
    "white": lambda ndf: mf.Conductor(ndf),
    "gold": lambda ndf: mf.Conductor(ndf, [0.18, 1.37], [3.42, 1.77], correlated=False),
    "glass": lambda ndf: mf.Dielectric(ndf, 1.5, mode="importance"),
    "out of glass": lambda ndf: mf.Dielectric(ndf, 1 / 1.5, mode="importance"),
}
each_ndf = pytest.mark.parametrize("ndf", NDFS, ids=lambda ndf: ndf.family)
each_material = pytest.mark.parametrize("kind", MATERIALS)


def directions(*degrees: float, azimuth: float = 0.4) -> Any:
    theta = np.radians(degrees)
    return np.stack(
        (np.sin(theta) * np.cos(azimuth), np.sin(theta) * np.sin(azimuth), np.cos(theta)), axis=-1
    )


@each_ndf
@each_material
def test_quadrature_agrees_with_samples(ndf: Any, kind: str) -> None:
    material = MATERIALS[kind](ndf)
    wi = directions(0, 50, 88)
    n = 20_000
    xi = np.random.default_rng(3).random((n, 1, material.sample_dims))
    wo, weight, _ = material.sample(wi, xi)
    for part, sign in (("reflected", 1), ("transmitted", -1)):
        side = sign * wo[..., 2] > 0
        kept = np.where(side.reshape(side.shape + (1,) * (weight.ndim - 2)), weight, 0)
        error = kept.std(axis=0) / np.sqrt(n) + 1e-6
        assert np.all(np.abs(material.albedo(wi, part=part) - kept.mean(axis=0)) < 4.5 * error), part


@each_ndf
@each_material
def test_refinement_changes_nothing(ndf: Any, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A level beyond the one that is used agrees within what is promised, 1e-6, and within what is said."""
    material = MATERIALS[kind](ndf)
    wi = directions(30, 70, 89)
    value, error = material.albedo(wi, with_error=True)
    assert np.all(error < 1e-6)
    level = 4
    finer = quadrature._level(material, wi, level, int(np.prod(material._channels))).sum(axis=1)
    assert np.all(np.abs(finer.reshape(value.shape) - value) < 1e-7 + error)


@pytest.mark.parametrize("alpha", [0.3, 1.0])
def test_directions_integrate_to_the_same(alpha: float) -> None:
    """SciPy's integral of f |cos| over directions knows nothing of facets."""
    white, theta = mf.Conductor(mf.GGX(alpha=alpha)), 0.5
    wi = np.array([np.sin(theta), 0.0, np.cos(theta)])

    def of(phi: float, cosine: float) -> float:
        sine = np.sqrt(1 - cosine**2)
        return float(white.eval(wi, [-sine * np.cos(phi), sine * np.sin(phi), cosine]))

    value, error = integrate.dblquad(of, 0, 1, 0, np.pi, epsabs=1e-7, epsrel=1e-7)
    assert abs(2 * value - white.albedo(wi)) < 1e-6 + 2 * error


def test_quadrature_gives_the_same_in_any_company() -> None:
    cosine = (np.arange(70) + 0.5) / 70
    wi = np.stack((np.sqrt(1 - cosine**2), 0 * cosine, cosine), -1)
    glass = mf.Dielectric(mf.StudentT(alpha=0.3, gamma=2.5), 1.5)
    together = glass.albedo(wi, part="reflected")
    assert [glass.albedo(w, part="reflected") for w in wi[::9]] == together[::9].tolist()


def test_known_values() -> None:
    # D = 1/pi and G2 = 2 c/(1 + c): the integral of c/(1 + c) over directions of mirrored light.
    assert mf.Conductor(mf.GGX(alpha=1.0)).albedo([0, 0, 1]) == pytest.approx(1 - np.log(2), abs=1e-9)
    smooth = mf.Dielectric(mf.Beckmann(alpha=1e-4), 1.5, mode="importance")
    assert smooth.albedo([0.6, 0, 0.8], part="reflected") == pytest.approx(
        mf.fresnel_dielectric(0.8, 1.5), rel=1e-6
    )
    # GTR with gamma = 2 is GGX, by other routes.
    wi = directions(10, 85)
    np.testing.assert_allclose(
        mf.Conductor(mf.GTR(alpha=0.3, gamma=2.0)).albedo(wi),
        mf.Conductor(mf.GGX(alpha=0.3)).albedo(wi),
        atol=1e-9,
    )


@each_ndf
def test_walks_know_the_first_order(ndf: Any) -> None:
    """Of walks through metal that end after one facet the mean is single scattering; all lose nothing."""
    wi = directions(20, 75)
    multiple = mf.Conductor(ndf, scattering="multiple")
    value, error = multiple.albedo(wi, n=2000, rng=1, with_error=True)
    assert np.all(value == 1)
    assert np.all(error == 0)
    _, weight, facets = multiple.walk(np.broadcast_to(wi, (20_000, 2, 3)), rng=2)
    once = np.where(facets == 1, weight, 0)
    expected = mf.Conductor(ndf).albedo(wi)
    assert np.all(np.abs(once.mean(axis=0) - expected) < 4.5 * once.std(axis=0) / np.sqrt(20_000) + 1e-6)


def test_walks_lose_nothing_of_importance_and_more_orders_reflect_more() -> None:
    glass = mf.Dielectric(mf.K0(alpha=0.6), 1.5, mode="importance", scattering="multiple")
    wi = directions(30, 85)
    reflected, transmitted = (
        glass.albedo(wi, n=5000, rng=4, part=part) for part in ("reflected", "transmitted")
    )
    np.testing.assert_allclose(reflected + transmitted, 1, rtol=1e-12)
    gold = [mf.Conductor(mf.K0(alpha=0.6), 0.18, 3.42, scattering=s) for s in ("single", "multiple")]
    single, multiple = gold[0].albedo(wi), gold[1].albedo(wi, n=20_000, rng=5)
    assert np.all((single < multiple) & (multiple < 1))


def test_walks_are_reproducible_in_any_company() -> None:
    clay = mf.Diffuse(mf.GGX(alpha=0.5), [0.3, 0.9])
    wi = directions(0, 40, 70)
    value = clay.albedo(wi, n=300, rng=7)
    assert value.shape == (3, 2)
    np.testing.assert_array_equal(clay.albedo(wi[:2], n=300, rng=7), value[:2])
    assert np.any(clay.albedo(wi, n=300, rng=8) != value)


@each_ndf
def test_no_more_leaves_than_came(ndf: Any) -> None:
    wi = np.concatenate([directions(0, 80), -directions(45, 89)])
    for kind in ("white", "glass"):
        value = MATERIALS[kind](ndf).albedo(wi)
        assert np.all((value >= 0) & (value <= 1 + 1e-7))
    assert np.all(mf.Conductor(ndf).albedo(wi[2:]) == 0)  # there is no light below a metal


def test_radiance_is_scaled_where_it_passes() -> None:
    wi = np.concatenate([directions(40), -directions(20)])
    for part, scale in (("reflected", 1.0), ("transmitted", np.array([1.5**-2, 1.5**2]))):
        radiance, importance = (
            mf.Dielectric(mf.GGX(alpha=0.3), 1.5, mode=mode).albedo(wi, part=part)
            for mode in ("radiance", "importance")
        )
        np.testing.assert_allclose(radiance, importance * scale, rtol=1e-14)


def test_average_albedo() -> None:
    white = mf.Conductor(mf.GGX(alpha=0.7))
    value, error = white.average_albedo(with_error=True)
    expected, _ = integrate.quad(
        lambda c: 2 * c * float(white.albedo([np.sqrt(1 - c * c), 0, c])), 0, 1, epsabs=1e-6, epsrel=1e-6
    )
    assert error < 1e-6
    assert value == pytest.approx(expected, abs=2e-6)
    clay = mf.Diffuse(mf.GGX(alpha=0.7), 0.5)
    mean, error = clay.average_albedo(n=20_000, rng=1, with_error=True)
    nodes, weights = np.polynomial.legendre.leggauss(8)
    cosine = (nodes + 1) / 2
    wi = np.stack((np.sqrt(1 - cosine**2), 0 * cosine, cosine), -1)
    values, errors = clay.albedo(wi, n=20_000, rng=2, with_error=True)
    spread = np.hypot(error, np.hypot.reduce(weights * cosine * errors))
    assert abs(mean - (weights * cosine) @ values) < 4.5 * spread + 1e-4


def test_without_interface_all_goes_on() -> None:
    nothing = mf.Dielectric(mf.GGX(alpha=0.3), 1.0)
    assert nothing.albedo([0.6, 0, 0.8]) == 1
    assert nothing.albedo([0.6, 0, 0.8], part="reflected") == 0


def test_shapes_and_hostile_directions() -> None:
    gold = mf.Conductor(mf.GGX(alpha=0.3), [0.2, 0.4, 1.3], [3.4, 2.3, 1.7])
    assert gold.albedo(np.zeros((2, 0, 3))).shape == (2, 0, 3)
    assert gold.albedo([0.6, 0, 0.8]).shape == (3,)
    value = gold.albedo([[np.nan, 0, 1], [1, 0, 0], [0, 0, -1]])
    assert np.isnan(value[0]).all()
    assert np.all(value[1:] == 0)
    with pytest.raises(ValueError, match="part must be one of"):
        gold.albedo([0, 0, 1], part="both")
    with pytest.raises(ValueError, match="n must be a whole number"):
        mf.Diffuse(mf.GGX(alpha=0.3), 0.5).albedo([0, 0, 1], n=0)
    with pytest.raises(ValueError, match="side must be"):
        gold.average_albedo(side="left")
    again = pickle.loads(pickle.dumps(gold.ndf))
    assert (
        mf.Conductor(again, gold.eta, gold.k).albedo([0.6, 0, 0.8]).tolist()
        == gold.albedo([0.6, 0, 0.8]).tolist()
    )
