"""Materials and what they are given: limits, hostile directions and numbers, and bad input to all."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from material_cases import ETAS, FAMILIES, directions, materials, stretched, towards

N = 400

each_family = pytest.mark.parametrize("family", FAMILIES)
each_dtype = pytest.mark.parametrize("dtype", [np.float64, np.float32])


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
        "Diffuse: ndf must be a distribution, got 0.3",
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
