"""Compensation lobes: energy, sampling against density, reciprocity, and where they are meant to differ."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import microfacet as mf

NDFS = [mf.GGX(alpha=0.8), mf.StudentT(alpha=0.4, gamma=2.2), mf.BesselK(alpha=0.5, a=1.5)]
LOBES = [mf.KullaConty, mf.Turquin]
GOLD = ([0.18, 0.42, 1.37], [3.42, 2.35, 1.77])
each_ndf = pytest.mark.parametrize("ndf", NDFS, ids=lambda ndf: ndf.family)
each_lobe = pytest.mark.parametrize("lobe", LOBES)


def directions(*degrees: float) -> Any:
    theta = np.radians(degrees)
    return np.stack((np.sin(theta), np.zeros_like(theta), np.cos(theta)), axis=-1)


def hemisphere(count: int) -> tuple[Any, Any]:
    """Gauss nodes in the cosine, even ones in azimuth; weights of solid angle."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    cosine, phi = (nodes + 1) / 2, (np.arange(2 * count) + 0.5) * np.pi / count
    sine = np.sqrt(1 - cosine**2)[:, None]
    wo = np.stack(np.broadcast_arrays(sine * np.cos(phi), sine * np.sin(phi), cosine[:, None]), -1)
    return wo.reshape(-1, 3), np.repeat(weights / 2 * np.pi / count, 2 * count)


@each_ndf
@each_lobe
def test_white_metal_loses_nothing(ndf: Any, lobe: Any) -> None:
    white = lobe(mf.Conductor(ndf))
    np.testing.assert_allclose(white.albedo(directions(0, 40, 88)), 1, atol=2e-4)
    wo, weights = hemisphere(64)
    total = weights @ white.eval(directions(20, 50)[:, None], wo).T
    np.testing.assert_allclose(total, 1, atol=2e-3)


@each_ndf
@each_lobe
def test_gold_lies_between_its_first_order_and_all(ndf: Any, lobe: Any) -> None:
    wi = directions(0, 60)
    single = mf.Conductor(ndf, *GOLD)
    walk = mf.Conductor(ndf, *GOLD, scattering="multiple").albedo(wi, n=20_000, rng=1)
    value = lobe(single).albedo(wi)
    assert value.shape == (2, 3)
    assert np.all(value > single.albedo(wi))
    assert np.all(np.abs(value - walk) < 0.06)


@each_ndf
@each_lobe
def test_sampling_and_evaluation_are_one_measure(ndf: Any, lobe: Any) -> None:
    gold, n = lobe(mf.Conductor(ndf, *GOLD)), 100_000
    wi = directions(55)
    wo, weight, density = gold.sample(wi, np.random.default_rng(2).random((n, gold.sample_dims)))
    np.testing.assert_allclose(density, gold.pdf(wi, wo), rtol=1e-9)
    seen = (density > 0) & (wo[:, 2] > 0)
    np.testing.assert_allclose(
        weight[seen] * density[seen, None], gold.eval(wi, wo[seen]), rtol=1e-8, atol=1e-12
    )
    error = weight.std(axis=0) / np.sqrt(n)
    assert np.all(np.abs(weight.mean(axis=0) - gold.albedo(wi)[0]) < 4.5 * error + 2e-4)


def test_reciprocity() -> None:
    """f of Kulla and Conty's lobe is symmetric; Turquin's scale belongs to one direction."""
    a, b = directions(20, 75)
    for lobe, symmetric in ((mf.KullaConty, True), (mf.Turquin, False)):
        gold = lobe(mf.Conductor(NDFS[0], *GOLD))
        f, back = gold.eval(a, b) / b[2], gold.eval(b, a) / a[2]
        assert np.allclose(f, back, rtol=1e-12) == symmetric


@each_lobe
def test_nothing_below_the_surface(lobe: Any) -> None:
    white = lobe(mf.Conductor(NDFS[0]))
    up, down = directions(30), -directions(30)
    assert white.eval(up, down) == white.eval(down, up) == white.albedo(down) == 0


@each_lobe
def test_bad_input(lobe: Any) -> None:
    for material in (
        mf.Conductor(NDFS[0], scattering="multiple"),
        mf.Dielectric(NDFS[0], 1.5),
        mf.Conductor(mf.GGX(alpha_x=0.1, alpha_y=0.2)),
    ):
        with pytest.raises(ValueError, match=f"^{lobe.__name__}: "):
            lobe(material)
