"""Materials with scattering of one order: the formula, its symmetries, its samples; and bad input to all."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from material_cases import COPPER, ETAS, FAMILIES, Array, directions, stretched, towards, unit
from microfacet.testing import chi2
from microfacet.testing._cells import DOMAINS, Cells
from microfacet.testing._quadrature import integrate

N = 400
SAMPLES = 60_000

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


# --- samples ---


def single_materials(family: str) -> dict[str, tuple[Callable[..., Any], float, dict[str, Any]]]:
    """Materials of a distribution, angles of incidence in degrees, and options of sample and pdf."""
    found: dict[str, tuple[Callable[..., Any], float, dict[str, Any]]] = {
        "metal": (partial(mf.Conductor, eta=0.2, k=3.9), 70.0, {}),
        "glass from above": (partial(mf.Dielectric, eta=1.5), 50.0, {}),
        "glass from below": (partial(mf.Dielectric, eta=1.5), 115.0, {}),
        "bubble from above": (partial(mf.Dielectric, eta=0.7), 83.0, {}),
    }
    if family == "ggx":
        found["metal, bounded"] = (partial(mf.Conductor, eta=0.2, k=3.9), 70.0, {"bounded": True})
    return found


CASES = [(family, name) for family in FAMILIES for name in single_materials(family)]
each_case = pytest.mark.parametrize(("family", "name"), CASES)


@each_case
@each_dtype
def test_samples_follow_their_density(family: str, name: str, dtype: type) -> None:
    make, degrees, options = single_materials(family)[name]
    material = make(stretched(family))
    wi = unit(towards(degrees, 25.0).astype(dtype).astype(np.float64))
    result = chi2(
        lambda xi: material.sample(wi.astype(dtype), xi, **options)[0],
        lambda wo: material.pdf(wi, wo, **options),
        domain="sphere",
        n=SAMPLES,
        dims=material.sample_dims,
        dtype=dtype,
        resolution=(12, 12),
        tests=2 * len(CASES),
    )
    assert result, result


@each_case
def test_the_density_integrates_to_one(family: str, name: str) -> None:
    make, degrees, options = single_materials(family)[name]
    material, wi = make(stretched(family)), towards(degrees, 25.0)
    pilot = material.sample(wi, np.random.default_rng(4).random((20_000, material.sample_dims)), **options)[0]
    cells = Cells.around(pilot, DOMAINS["sphere"], 24, 24)
    mass = float(integrate(lambda wo: material.pdf(wi, wo, **options), cells, 1e-6).sum())
    assert mass == pytest.approx(1.0, abs=1e-4)


@each_case
def test_the_weight_is_the_value_over_the_density(family: str, name: str) -> None:
    make, degrees, options = single_materials(family)[name]
    for correlated in (True, False):
        material = make(stretched(family), correlated=correlated)
        wi = towards(degrees, 25.0)
        xi = np.random.default_rng(3).random((4000, material.sample_dims))
        wo, weight, pdf = material.sample(wi, xi, **options)
        np.testing.assert_allclose(np.linalg.norm(wo, axis=-1), 1.0, rtol=1e-12)
        np.testing.assert_allclose(pdf, material.pdf(wi, wo, **options), rtol=1e-6, atol=1e-12)
        np.testing.assert_allclose(weight * pdf, material.eval(wi, wo), rtol=1e-6, atol=1e-12)
        assert weight.min() >= 0.0
        assert weight.mean() > 0.1


@each_case
def test_the_mean_weight_is_the_integral_of_the_value(family: str, name: str) -> None:
    """Samples and quadrature; the quadrature's directions know nothing of the samples' weights."""
    make, degrees, options = single_materials(family)[name]
    material, wi = make(stretched(family)), towards(degrees, 25.0)
    xi = np.random.default_rng(5).random((60_000, material.sample_dims))
    wo, weight, _ = material.sample(wi, xi, **options)
    cells = Cells.around(wo[:20_000], DOMAINS["sphere"], 16, 16)
    albedo = float(integrate(lambda w: material.eval(wi, w), cells, 1e-6).sum())
    deviation = weight.std() / np.sqrt(len(weight))
    assert deviation < 3e-3, "so that a wrong weight would show"
    assert abs(weight.mean() - albedo) < 4.0 * deviation + 1e-4


# --- limits and hostile input ---


@each_family
@each_dtype
def test_equal_media_let_everything_pass(family: str, dtype: type) -> None:
    rng = np.random.default_rng(6)
    wi = directions(300, 9).astype(dtype)
    for mode in ("radiance", "importance"):
        glass = mf.Dielectric(stretched(family), 1.0, mode=mode)
        wo, weight, _ = glass.sample(wi, rng.random((300, glass.sample_dims), dtype))
        np.testing.assert_array_equal(wo, -wi)
        assert np.all(weight == 1.0)
        assert np.all(glass.eval(wi, directions(300, 10).astype(dtype)) == 0.0)


HOSTILE = {
    "vertical": [0.0, 0.0, 1.0],
    "grazing": [1.0, 0.0, 1e-12],
    "barely above": [1.0, 0.0, 1e-30],
    "horizontal": [0.6, 0.8, 0.0],
    "horizontal from below": [0.6, 0.8, -0.0],
    "barely below": [0.0, 1.0, -1e-30],
    "below": [0.6, 0.0, -0.8],
    "down": [0.0, 0.0, -1.0],
    "long": [30.0, 0.0, 40.0],
    "short": [3e-12, 0.0, 4e-12],
}


MOST = 100.0  # radiance from where the index is 10 into 1


def materials(family: str, scattering: str = "single") -> list[Any]:
    ndf = stretched(family)
    found = [
        mf.Conductor(ndf, 0.2, 3.9, scattering=scattering),
        mf.Dielectric(ndf, 1.5, mode="importance", scattering=scattering),
        mf.Dielectric(ndf, 0.1, scattering=scattering),
        mf.Dielectric(ndf, 1.0, scattering=scattering),
        mf.Diffuse(ndf, 0.9, scattering=scattering),
    ]
    return [
        material for material in found if scattering == "multiple" or not isinstance(material, mf.Diffuse)
    ]


@each_family
@each_dtype
@pytest.mark.parametrize("scattering", ["single", "multiple"])
def test_hostile_directions_give_no_nan_and_nothing_negative(
    family: str, dtype: type, scattering: str
) -> None:
    hostile = np.array(list(HOSTILE.values()), dtype)
    wi, wo = np.repeat(hostile, len(hostile), axis=0), np.tile(hostile, (len(hostile), 1))
    for material in materials(family, scattering):
        options: dict[str, Any] = {"rng": 1} if scattering == "multiple" else {}
        for quantity in (material.eval(wi, wo, **options), material.pdf(wi, wo)):
            assert quantity.dtype == dtype
            assert not np.any(np.isnan(quantity)), material
            assert np.all(quantity >= 0.0), material
        if scattering == "single":
            xi = np.random.default_rng(7).random((len(wi), material.sample_dims), dtype)
            drawn = material.sample(wi, xi)
        else:
            drawn = material.sample(wi, rng=2)
        assert not any(np.any(np.isnan(x)) for x in drawn), material
        assert np.all(drawn[1] >= 0.0)
        assert np.all(drawn[1] <= MOST * (1.0 + 1e-5))


@each_family
@pytest.mark.parametrize("scattering", ["single", "multiple"])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_no_direction_gives_nan(family: str, scattering: str, bad: float) -> None:
    good, wrong = np.array([0.6, 0.0, 0.8]), np.array([bad, 0.0, 0.8])
    for material in materials(family, scattering):
        options: dict[str, Any] = {"rng": 1} if scattering == "multiple" else {}
        assert np.isnan(material.eval(wrong, good, **options))
        assert np.isnan(material.eval(good, wrong, **options))
        neighbours = material.eval(np.array([good, wrong, good]), good, **options)
        np.testing.assert_array_equal(np.isnan(neighbours), [False, True, False])


@each_family
@each_dtype
def test_hostile_uniform_numbers(family: str, dtype: type) -> None:
    tiny, last = np.finfo(dtype).smallest_subnormal, np.nextafter(dtype(1), dtype(0))
    corners = np.array([0.0, tiny, 0.5, last], dtype)
    for material in materials(family):
        grid = np.meshgrid(*[corners] * material.sample_dims)
        xi = np.stack([x.ravel() for x in grid], axis=-1)
        for degrees in (0.0, 45.0, 89.99, 120.0):
            wo, weight, pdf = material.sample(towards(degrees, 10.0).astype(dtype), xi)
            assert not np.any(np.isnan(wo))
            assert np.all((weight >= 0.0) & (weight <= MOST * (1.0 + 1e-5)))
            assert np.all(pdf >= 0.0)
            np.testing.assert_allclose(np.linalg.norm(wo, axis=-1), 1.0, rtol=1e-5)


@each_family
def test_straight_from_below(family: str) -> None:
    metal = mf.Conductor(stretched(family))
    wo, weight, pdf = metal.sample([0.0, 0.0, -1.0], np.full(metal.sample_dims, 0.3))
    assert weight == 0.0
    assert pdf == 0.0
    assert np.linalg.norm(wo) == pytest.approx(1.0)


@pytest.mark.parametrize("ndf", [mf.K0(alpha=0.3), mf.BesselK(alpha=0.3, a=0.7)], ids=repr)
def test_where_the_density_is_infinite(ndf: Any) -> None:
    up = np.array([0.0, 0.0, 1.0])
    assert ndf.D(up) == np.inf
    assert mf.Conductor(ndf).eval(up, up) == np.inf
    assert mf.Dielectric(ndf, 1.5).eval(up, up) == np.inf
    nothing = mf.Dielectric(ndf, 1.0)
    assert nothing.eval(up, up) == 0.0
    assert nothing.pdf(up, up) == 0.0
    for dtype in (np.float32, np.float64):
        xi = np.array([[0.5, 0.0, 0.0, u] for u in (0.0, 0.02, 0.5)], dtype)[
            :, -mf.Dielectric(ndf, 1.5).sample_dims :
        ]
        for eta in ETAS:
            weight = mf.Dielectric(ndf, eta, mode="importance").sample(up.astype(dtype), xi)[1]
            np.testing.assert_allclose(weight, 1.0, rtol=1e-5)


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


# --- bad input ---

NDF = mf.GGX(alpha=0.3)
UP = [0.0, 0.0, 1.0]
BAD: dict[str, tuple[Callable[[], object], str]] = {
    "eta of a metal": (lambda: mf.Conductor(NDF, 0.0, 1.0), "Conductor: eta must lie in (0, inf], got 0"),
    "negative k": (lambda: mf.Conductor(NDF, 1.0, [1.0, -2.0]), "Conductor: k must lie in [0, inf), got -2"),
    "nan": (lambda: mf.Conductor(NDF, np.nan, 1.0), "Conductor: eta must lie in (0, inf], got nan"),
    "a word": (lambda: mf.Conductor(NDF, "gold"), "Conductor: eta must be a number in (0, inf], got 'gold'"),
    "a complex index": (
        lambda: mf.Conductor(NDF, 1 + 2j),
        "Conductor: eta must be a number in (0, inf], got",
    ),
    "shapes": (
        lambda: mf.Conductor(NDF, [1.0, 2.0], [1.0, 2.0, 3.0]),
        "Conductor: eta and k must have shapes that broadcast, got (2,) and (3,)",
    ),
    "eta of glass": (lambda: mf.Dielectric(NDF, -1.5), "Dielectric: eta must lie in (0, inf), got -1.5"),
    "infinite glass": (lambda: mf.Dielectric(NDF, np.inf), "Dielectric: eta must lie in (0, inf), got inf"),
    "glasses": (
        lambda: mf.Dielectric(NDF, [1.4, 1.5]),
        "Dielectric: eta must be one number, got an array of shape (2,)",
    ),
    "albedo": (lambda: mf.Diffuse(NDF, 1.1), "Diffuse: albedo must lie in [0, 1], got 1.1"),
    "scattering": (
        lambda: mf.Conductor(NDF, scattering="double"),
        'Conductor: scattering must be "single" or "multiple", got \'double\'',
    ),
    "mode": (
        lambda: mf.Dielectric(NDF, 1.5, mode="light"),
        'Dielectric: mode must be "radiance" or "importance", got \'light\'',
    ),
    "no distribution": (
        lambda: mf.Diffuse(0.3, 0.5),
        "Diffuse: ndf must be a distribution of one of the families, got 0.3",
    ),
    "a density of one's own": (
        lambda: mf.Conductor(mf.RadialNDF(lambda r2: np.exp(-r2) / np.pi, alpha=0.3)),
        "Conductor: ndf must be a distribution of one of the families, got <RadialNDF",
    ),
    "a pair": (
        lambda: mf.Conductor(NDF).eval([0.6, 0.8], UP),
        "Conductor.eval: wi must be real numbers of shape (..., 3), got float64 of shape (2,)",
    ),
    "a complex direction": (
        lambda: mf.Dielectric(NDF, 1.5).pdf(UP, [0.0, 0.0, 1j]),
        "Dielectric.pdf: wo must be real numbers of shape (..., 3), got complex128 of shape (3,)",
    ),
    "no xi": (lambda: mf.Conductor(NDF).sample(UP), "Conductor.sample: give xi, of shape (..., 2)"),
    "too few xi": (
        lambda: mf.Dielectric(NDF, 1.5).sample(UP, [0.5, 0.5]),
        "Dielectric.sample: xi must be real numbers of shape (..., 3), got float64 of shape (2,)",
    ),
    "bounded": (
        lambda: mf.Conductor(mf.K0(alpha=0.3)).sample(UP, [0.5] * 3, bounded=True),
        "Conductor.sample",
    ),
    "xi for a walk": (lambda: mf.Diffuse(NDF, 0.5).sample(UP, [0.5]), "Diffuse.sample: a walk takes rng"),
    "no walks": (
        lambda: mf.Diffuse(NDF, 0.5).eval(UP, UP, n=0),
        "Diffuse.eval: n must be a whole number in [1, inf), got 0",
    ),
    "half a walk": (
        lambda: mf.Conductor(NDF, scattering="multiple").eval(UP, UP, n=1.5),
        "Conductor.eval: n must be a whole number in [1, inf), got 1.5",
    ),
    "seed": (
        lambda: mf.Diffuse(NDF, 0.5).eval(UP, UP, rng=-1),
        "Diffuse: a seed must lie in [0, 2**53), got -1",
    ),
    "no generator": (
        lambda: mf.Diffuse(NDF, 0.5).walk(UP, rng="dice"),
        "Diffuse: rng must be a seed or a numpy.random.Generator, got 'dice'",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_sentence(name: str) -> None:
    call, words = BAD[name]
    with pytest.raises(ValueError, match="^" + re.escape(words)) as raised:
        call()
    assert "\n" not in str(raised.value)


def test_directions_that_do_not_broadcast() -> None:
    with pytest.raises(ValueError, match="broadcast"):
        mf.Conductor(NDF).eval(np.ones((2, 3)), np.ones((4, 3)))
    with pytest.raises(ValueError, match="broadcast"):
        mf.Diffuse(NDF, 0.5).eval(np.ones((2, 3)), np.ones((4, 3)))


@pytest.mark.parametrize("material", [*materials("k0"), *materials("k0", "multiple")], ids=repr)
def test_materials_are_frozen(material: Any) -> None:
    with pytest.raises(AttributeError, match="is frozen: scattering cannot be set"):
        material.scattering = "multiple"
