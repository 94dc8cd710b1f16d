"""Materials with scattering of one order: the formula, its symmetries, and the shapes of results."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import microfacet as mf
from material_cases import COPPER, ETAS, FAMILIES, Array, directions, materials, stretched, unit

N = 400

each_family = pytest.mark.parametrize("family", FAMILIES)
each_dtype = pytest.mark.parametrize("dtype", [np.float64, np.float32])


def dot(a: Array, b: Array) -> Array:
    return np.asarray(np.sum(a * b, axis=-1))


def refracting(wi: Array, wo: Array, eta: float) -> tuple[Array, Array, Array]:
    """The facet that refracts wi, above, into wo, below, and the cosines to it."""
    h = wi + eta * wo
    m = unit(h) * np.sign(h[..., 2:])
    return m, dot(wi, m), dot(wo, m)


def agree(value: Array, expected: Array, wi: Array, wo: Array, eta: float) -> None:
    """To rounding: the cosine behind a facet is the root of a difference, and zero at the critical angle."""
    _, i, o = refracting(wi, wo, eta)
    tolerance = 1e-12 + 2e-15 / np.minimum(np.abs(i), np.abs(o)) ** 2
    np.testing.assert_array_less(np.abs(value - expected), expected * tolerance + 1e-100)


def transmitted(ndf: Any, wi: Array, wo: Array, eta: float) -> Array:
    """Walter et al. 2007, equation 21, times |cos wo|, for wi above and wo below; eta below over above."""
    m, i, o = refracting(wi, wo, eta)
    passed = 1.0 - mf.fresnel_dielectric(i, eta)
    value = passed * ndf.D(m) * ndf.G2(wi, wo) * np.abs(i * o) * eta**2 / (wi[..., 2] * (i + eta * o) ** 2)
    return np.where((i > 0.0) & (o < 0.0), value, 0.0)


# --- the value ---


@each_family
@pytest.mark.parametrize("correlated", [True, False])
def test_a_metal_is_its_formula(family: str, correlated: bool) -> None:
    ndf, (eta, k) = stretched(family), COPPER
    wi, wo = directions(N, 1, +1), directions(N, 2, +1)
    m = unit(wi + wo)
    fresnel = mf.fresnel_conductor(dot(wi, m)[:, None], eta, k)
    g2 = ndf.G2(wi, wo) if correlated else ndf.G1(wi) * ndf.G1(wo)
    expected = fresnel * (ndf.D(m) * g2 / (4.0 * wi[:, 2]))[:, None]
    value = mf.Conductor(ndf, eta, k, correlated=correlated).eval(wi, wo)
    assert value.shape == (N, 3)
    np.testing.assert_allclose(value, expected, rtol=1e-12, atol=1e-300)


@each_family
@pytest.mark.parametrize("eta", ETAS)
@pytest.mark.parametrize("side", [+1, -1])
def test_glass_is_its_formula(family: str, eta: float, side: int) -> None:
    """From below it is the glass of 1/eta, with all directions turned over."""
    ndf, relative = stretched(family), eta**side
    glass = mf.Dielectric(ndf, eta, mode="importance")
    wi, wo = directions(N, 3, +1), directions(N, 4, +1)
    m = unit(wi + wo)
    reflected = mf.fresnel_dielectric(dot(wi, m), relative) * ndf.D(m) * ndf.G2(wi, wo) / (4.0 * wi[:, 2])
    np.testing.assert_allclose(glass.eval(side * wi, side * wo), reflected, rtol=1e-12, atol=1e-300)
    through = transmitted(ndf, wi, -wo, relative)
    assert np.mean(through > 0.0) > 0.1
    agree(glass.eval(side * wi, -side * wo), through, wi, -wo, relative)
    radiance = mf.Dielectric(ndf, eta).eval(side * wi, -side * wo)
    agree(radiance, through / relative**2, wi, -wo, relative)


@each_family
def test_float32_values_are_those_of_float64(family: str) -> None:
    ndf = stretched(family)
    wi, wo = directions(N, 5, +1).astype(np.float32), directions(N, 6).astype(np.float32)
    for material in (mf.Conductor(ndf, 0.2, 3.9), mf.Dielectric(ndf, 1.5)):
        single, double = material.eval(wi, wo), material.eval(wi.astype(float), wo.astype(float))
        assert single.dtype == np.float32
        seen = double > 1e-6
        np.testing.assert_allclose(single[seen], double[seen], rtol=2e-4)
        assert np.median(np.abs(single[seen] / double[seen] - 1.0)) < 1e-6


# --- symmetry ---


@each_family
@pytest.mark.parametrize("correlated", [True, False])
def test_reciprocity(family: str, correlated: bool) -> None:
    """f of metals and of reflection; of transmission f in radiance is f in importance of the way back."""
    ndf = stretched(family)
    wi, wo = directions(N, 7), directions(N, 8)

    def f(material: Any, i: Array, o: Array) -> Array:
        return np.asarray(material.eval(i, o) / np.abs(o[:, 2]))

    metal = mf.Conductor(ndf, 0.2, 3.9, correlated=correlated)
    np.testing.assert_allclose(f(metal, wi, wo), f(metal, wo, wi), rtol=1e-13, atol=1e-300)
    for eta in ETAS:
        radiance, importance = (
            mf.Dielectric(ndf, eta, mode=mode, correlated=correlated) for mode in ("radiance", "importance")
        )
        for glass in (radiance, importance):
            same = wi * np.sign(wi[:, 2:] * wo[:, 2:])
            np.testing.assert_allclose(f(glass, same, wo), f(glass, wo, same), rtol=1e-13, atol=1e-300)
        above, below = wi * np.sign(wi[:, 2:]), -wo * np.sign(wo[:, 2:])
        there, back = f(radiance, above, below), f(importance, below, above)
        assert np.mean(there > 0.0) > 0.1
        agree(back, there, above, below, eta)
        agree(f(radiance, below, above), f(importance, above, below), above, below, eta)
        np.testing.assert_allclose(there * eta**2, f(importance, above, below), rtol=1e-14)
        np.testing.assert_allclose(f(radiance, below, above), back * eta**2, rtol=1e-14)


@each_family
def test_an_opaque_surface_has_one_side(family: str) -> None:
    metal = mf.Conductor(stretched(family))
    above, below = directions(50, 1, +1), directions(50, 2, -1)
    for wi, wo in ((above, below), (below, above), (below, -above)):
        assert np.all(metal.eval(wi, wo) == 0.0)
    assert np.all(metal.pdf(below, above) == 0.0)
    assert np.all(metal.sample(below, np.full((50, 3), 0.4))[1] == 0.0)


# --- shapes ---


def test_wavelengths_come_last() -> None:
    metal = mf.Conductor(mf.GGX(alpha=0.3), *COPPER)
    wi, wo = directions(6, 1, +1).reshape(2, 3, 3), directions(3, 2, +1)
    value = metal.eval(wi, wo)
    assert value.shape == (2, 3, 3)
    for channel in range(3):
        one = mf.Conductor(mf.GGX(alpha=0.3), COPPER[0][channel], COPPER[1][channel])
        np.testing.assert_array_equal(value[..., channel], one.eval(wi, wo))
    wo, weight, pdf = metal.sample(wi, np.full(2, 0.3))
    assert (wo.shape, weight.shape, pdf.shape) == ((2, 3, 3), (2, 3, 3), (2, 3))
    np.testing.assert_allclose(weight * pdf[..., None], metal.eval(wi, wo), rtol=1e-9)
    table = mf.Conductor(mf.GGX(alpha=0.3), [[1.0], [2.0]], [1.0, 2.0, 3.0])
    assert table.eval(wi, wo).shape == (2, 3, 2, 3)
    multiple = mf.Conductor(mf.GGX(alpha=0.3), *COPPER, scattering="multiple")
    assert multiple.eval(wi, wo, rng=1).shape == (2, 3, 3)
    wo, weight, pdf = multiple.sample(wi, rng=1)
    assert (wo.shape, weight.shape, pdf.shape) == ((2, 3, 3), (2, 3, 3), (2, 3))


@pytest.mark.parametrize("material", [*materials("k0"), *materials("k0", "multiple")], ids=repr)
def test_one_direction_and_none(material: Any) -> None:
    multiple = material.scattering == "multiple"
    options: dict[str, Any] = {"rng": 1} if multiple else {}
    assert np.ndim(material.eval([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], **options)) == 0
    assert material.eval(np.empty((0, 3)), [0.0, 0.0, 1.0], **options).shape == (0,)
    wo, weight, pdf = (
        material.sample([0.6, 0.0, 0.8], **options)
        if multiple
        else material.sample([0.6, 0.0, 0.8], np.full(material.sample_dims, 0.5))
    )
    assert (wo.shape, np.shape(weight), np.shape(pdf)) == ((3,), (), ())


@each_family
@each_dtype
def test_lanes_do_not_depend_on_their_neighbours(family: str, dtype: type) -> None:
    wi, wo = directions(700, 11).astype(dtype), directions(700, 12).astype(dtype)
    for material in materials(family):
        whole = material.eval(wi, wo)
        xi = np.random.default_rng(8).random((700, material.sample_dims), dtype)
        drawn = material.sample(wi, xi)
        for part in (slice(0, 1), slice(5, 9), slice(250, 527), slice(None, None, 3)):
            np.testing.assert_array_equal(material.eval(wi[part], wo[part]), whole[part])
            for piece, every in zip(material.sample(wi[part], xi[part]), drawn, strict=True):
                np.testing.assert_array_equal(piece, every[part])
