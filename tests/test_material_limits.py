"""Materials at the ends of their domains: equal indices, huge and tiny ones, peaks, grazing light."""

from __future__ import annotations

from typing import Any

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import microfacet as mf
from material_cases import FAMILIES, SHAPES, Array, of_family, stretched, towards

each_dtype = pytest.mark.parametrize("dtype", [np.float64, np.float32])
each_family = pytest.mark.parametrize("family", FAMILIES)

HALF = {np.float64: 2.0**-53, np.float32: 2.0**-24}
INDICES = (1e-12, 3e-7, 0.02, 0.6, 1 / 1.001, 1 - 1e-7, 1 - 2**-53, 1 + 2**-52, 1 + 3e-10, 1 + 2**-23)
INDICES += (1.0002, 1.003, 1.04, 1.5, 7.0, 400.0, 2e6, 1e12)
HEIGHTS = (0.0, 1e-12, 1e-7, 1e-3, 0.07, 0.4, 0.9, 1.0)
# A density that is infinite at the macroscopic normal.
PEAKED = {
    "k0": mf.K0(alpha=0.01),
    "bessel_k": mf.BesselK(alpha=0.02, a=0.3),
    "sharp bessel_k": mf.BesselK(alpha=0.3, a=0.06),
}


def hostile(rng: np.random.Generator, n: int, dtype: Any) -> Array:
    """Directions that graze, lie along the surface, or along its normal, from both sides."""
    z = rng.choice(HEIGHTS, n)
    phi, s = rng.uniform(0, 2 * np.pi, n), np.sqrt(1 - z * z)
    w = np.stack([s * np.cos(phi), s * np.sin(phi), z * rng.choice([1, -1], n)], -1)
    return np.asarray(w, dtype)


def agree(material: Any, wi: Array, xi: Array) -> None:
    """Samples are numbers and directions, and what `eval` and `pdf` say of them is what came with them."""
    wo, weight, pdf = material.sample(wi, xi)
    single = wi.dtype == np.float32
    value, density = material.eval(wi, wo), material.pdf(wi, wo)
    for numbers in (wo, weight, pdf, value, density):
        assert np.all(np.isfinite(numbers))
    assert np.all((weight >= 0) & (pdf >= 0))
    length = np.linalg.norm(wo.astype(float), axis=-1)
    np.testing.assert_allclose(length, 1, atol=1e-6 if single else 2e-15)
    np.testing.assert_array_equal(density, pdf)
    product = weight.astype(float) * pdf
    least = (1e-30 if single else 1e-290) * np.maximum(1.0, weight)  # of what is flushed to zero
    assert np.all(np.abs(product - value) <= (1e-5 if single else 1e-13) * value + least)


@each_family
@each_dtype
@given(
    eta=st.one_of(st.sampled_from(INDICES), st.floats(np.log(1e-12), np.log(1e12)).map(np.exp)),
    alpha=st.floats(np.log(1e-3), np.log(3.0)).map(lambda x: float(np.exp(x))),
    mode=st.sampled_from(["radiance", "importance"]),
    correlated=st.booleans(),
    seed=st.integers(0, 2**32 - 1),
)
def test_glass_agrees_with_its_samples(
    family: str, dtype: Any, eta: float, alpha: float, mode: str, correlated: bool, seed: int
) -> None:
    if dtype(eta) == 1:
        eta = 1.0 + 2 * HALF[dtype]
    rng = np.random.default_rng(seed)
    ndf = stretched(family, alpha, 2 * alpha)
    glass = mf.Dielectric(ndf, eta, mode=mode, correlated=correlated)
    agree(
        glass, hostile(rng, 60, dtype), rng.random((60, glass.sample_dims)).astype(dtype) * (1 - HALF[dtype])
    )


@each_family
@each_dtype
@given(
    eta=st.floats(-300, 300).map(lambda x: 10.0**x),
    k=st.one_of(st.just(0.0), st.floats(-300, 300).map(lambda x: 10.0**x)),
    alpha=st.floats(np.log(1e-3), np.log(3.0)).map(lambda x: float(np.exp(x))),
    seed=st.integers(0, 2**32 - 1),
)
def test_metals_agree_with_their_samples(
    family: str, dtype: Any, eta: float, k: float, alpha: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    metal = mf.Conductor(stretched(family, alpha, 2 * alpha), eta, k)
    agree(
        metal, hostile(rng, 60, dtype), rng.random((60, metal.sample_dims)).astype(dtype) * (1 - HALF[dtype])
    )


# Indices that hardly differ


@each_family
@each_dtype
@pytest.mark.parametrize("distance", [1e-3, 1e-5, -1e-4])
def test_weights_tend_to_those_of_facets(family: str, dtype: Any, distance: float) -> None:
    """Nearly all passes, and what passes goes nearly straight on: the weight is that of masking."""
    ndf, n = stretched(family, 0.3, 0.3), 2000
    rng = np.random.default_rng(5)
    glass = mf.Dielectric(ndf, 1 + distance, mode="importance")
    wi = np.broadcast_to(towards(40.0).astype(dtype), (n, 3))
    wo, weight, pdf = glass.sample(wi, rng.random((n, glass.sample_dims)))
    passed = wo[:, 2] < 0
    assert np.mean(passed) > 0.99
    assert np.all(pdf[passed] > 0)
    np.testing.assert_allclose(wo[passed], -wi[passed], atol=300 * abs(distance))
    error = np.abs(weight / (ndf.G2(wi, wo) / ndf.G1(wi)) - 1)[passed]
    assert np.quantile(error, 0.99) < 1e-3  # but for the steepest facets
    assert np.mean(weight) == pytest.approx(float(glass.albedo(wi[0])), abs=1e-3)


def test_densities_near_one_are_those_of_many_digits() -> None:
    """Walter et al. 2007, equations 16 and 17, with the facet of the two directions, in 60 digits."""
    ndf = mf.GGX(alpha=0.4)
    wi, rng = towards(50.0, 20.0), np.random.default_rng(6)
    for eta in (1 + 1e-3, 1 + 1e-6, 1 - 1e-8, 1 / 3.0, 1e4):
        glass = mf.Dielectric(ndf, eta, mode="importance")
        wo, _, _ = glass.sample(np.broadcast_to(wi, (60, 3)), rng.random((60, glass.sample_dims)))
        wo = wo[wo[:, 2] < 0]
        assert len(wo) > 0
        leaving = ndf.G2(wi, wo) / ndf.G1(wi)
        for w, value, part in zip(wo, glass.eval(wi, wo), leaving, strict=True):
            # Directions near -wi know the facet to their rounding over the difference of indices.
            tolerance = 1e-12 + 1e-14 / min(abs(eta - 1), 1.0)
            assert value == pytest.approx(refracted(wi, w, eta, 0.4) * part, rel=tolerance)


def refracted(wi: Array, wo: Array, eta: float, alpha: float) -> float:
    with mp.workdps(60):
        i, o = ([mp.mpf(float(x)) for x in w] for w in (wi, wo))
        n, a = mp.mpf(eta), mp.mpf(alpha)
        h = [x + n * y for x, y in zip(i, o, strict=True)]
        length = mp.sqrt(sum(x * x for x in h)) * (1 if h[2] > 0 else -1)
        m = [x / length for x in h]
        ci, co = (sum(x * y for x, y in zip(w, m, strict=True)) for w in (i, o))
        if not (ci > 0 > co):
            return 0.0  # mirrored downwards
        density = a**2 / (mp.pi * (m[0] ** 2 + m[1] ** 2 + (a * m[2]) ** 2) ** 2)
        sigma = (i[2] + mp.sqrt(i[2] ** 2 + a**2 * (i[0] ** 2 + i[1] ** 2))) / 2
        passed = 4 * n * ci * abs(co)
        transmitted = passed / (ci + n * abs(co)) ** 2 + passed / (n * ci + abs(co)) ** 2
        return float(transmitted / 2 * ci * density / sigma * n**2 * abs(co) / (ci + n * co) ** 2)


@each_family
@each_dtype
def test_equal_indices_are_no_surface(family: str, dtype: Any) -> None:
    """All goes straight on: the density is infinite there, and 0 elsewhere."""
    rng = np.random.default_rng(7)
    wi = hostile(rng, 200, dtype)
    wi = wi[wi[:, 2] != 0] * dtype(3)  # of any length
    for glass in (mf.Dielectric(of_family(family, 0.3), 1.0, mode=m) for m in ("radiance", "importance")):
        wo, weight, pdf = glass.sample(wi, rng.random((len(wi), glass.sample_dims)))
        assert np.all(weight == 1)
        np.testing.assert_allclose(wo, -wi / 3, rtol=1e-6)
        assert np.all(pdf == np.inf)
        assert np.all(glass.pdf(wi, wo) == np.inf)
        assert np.all(glass.eval(wi, wo) == np.inf)
        beside = wo + dtype(0.01)
        assert np.all(glass.pdf(wi, beside) == 0)
        assert np.all(glass.eval(wi, beside) == 0)
        assert np.all(glass.albedo(wi) == 1)


# Huge and tiny indices


@each_dtype
@pytest.mark.parametrize("eta", [0.3, 1.5, 1e-45, 1e-300, 1e25, 1e78, 1e300])
@pytest.mark.parametrize("k", [0.0, 2.0, 1e10, 1e25, 1e78, 1e300])
def test_metals_of_huge_indices_are_mirrors(dtype: Any, eta: float, k: float) -> None:
    ndf, rng = mf.K0(alpha=0.4), np.random.default_rng(8)
    wi = np.broadcast_to(towards(60.0).astype(dtype), (50, 3))
    xi = rng.random((50, 2 if ndf.visible_dims == 2 else 3))
    mirror, metal = mf.Conductor(ndf).sample(wi, xi), mf.Conductor(ndf, eta, k).sample(wi, xi)
    np.testing.assert_array_equal(metal[0], mirror[0])
    np.testing.assert_array_equal(metal[2], mirror[2])
    assert np.all(metal[1] <= mirror[1])
    if max(eta, k) > 1e20 or eta < 1e-40:
        np.testing.assert_allclose(metal[1], mirror[1], rtol=1e-6 if dtype == np.float32 else 1e-15)


@each_dtype
def test_fresnel_of_huge_and_tiny_indices(dtype: Any) -> None:
    """Against many digits: the limits, and what leads to them."""
    rng, n, top = np.random.default_rng(9), 400, (300 if dtype == np.float64 else 36)
    eta, k = (np.asarray(10.0 ** rng.uniform(-top, top, n), dtype) for _ in range(2))
    k[::4] = 0
    cosine = np.where(rng.random(n) < 0.3, 1.0, 10.0 ** -rng.uniform(0, 12, n)).astype(dtype)
    limit = 9e-16 if dtype == np.float64 else 5e-7
    metals, glasses = mf.fresnel_conductor(cosine, eta, k), mf.fresnel_dielectric(cosine, eta)
    with mp.workdps(900):
        for c, e, kappa, metal, glass in zip(cosine, eta, k, metals, glasses, strict=True):
            for value, index in ((metal, mp.mpc(float(e), -float(kappa))), (glass, mp.mpf(float(e)))):
                n2, c_ = index**2, mp.mpf(float(c))
                root = mp.sqrt(n2 - 1 + c_**2)
                s, p = (c_ - root) / (c_ + root), (n2 * c_ - root) / (n2 * c_ + root)
                exact = (abs(s) ** 2 + abs(p) ** 2) / 2
                assert abs(mp.mpf(float(value)) / exact - 1) < limit, (c, e, kappa, value)


# Infinite peaks


@each_dtype
@pytest.mark.parametrize("name", PEAKED)
def test_no_sample_lies_on_an_infinite_peak(name: str, dtype: Any) -> None:
    """f and the density are infinite in the mirror direction; no drawn direction is that one."""
    ndf, rng, n = PEAKED[name], np.random.default_rng(10), 4000
    wi = np.concatenate([hostile(rng, n, dtype), np.broadcast_to(towards(0.0), (50, 3))]).astype(dtype)
    for material in (mf.Conductor(ndf, 0.2, 3.9), mf.Dielectric(ndf, 1.5), mf.Dielectric(ndf, 1.0003)):
        xi = rng.random((len(wi), material.sample_dims))
        xi[::3, 0] = 0.5 if ndf.visible_dims > 2 else 0.0
        xi[::5] = 0.0
        agree(material, wi, xi)
        up = wi[wi[:, 2] > 1e-3]
        mirrored = up * np.array([-1, -1, 1], dtype)
        assert np.all(material.eval(up, mirrored) == np.inf)
        assert np.all(material.pdf(up, mirrored) == np.inf)


def test_peaks_are_everyday_for_sharp_densities() -> None:
    """Of so sharp a density facets that differ mirror into one direction of float32, the mirror direction."""
    assert SHAPES["bessel_k"]["a"] < 1
    ndf, n = mf.BesselK(alpha=0.01, a=0.06), 5000
    metal = mf.Conductor(ndf)
    wi = np.broadcast_to(towards(30.0).astype(np.float32), (n, 3))
    xi = np.random.default_rng(11).random((n, metal.sample_dims))
    facets = ndf.sample_visible(wi, xi)
    wo = 2 * np.sum(wi * facets, -1, keepdims=True) * facets - wi
    assert np.mean(metal.pdf(wi, wo.astype(np.float32)) == np.inf) > 1e-3
    agree(metal, wi, xi)
