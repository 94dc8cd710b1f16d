"""Directions of any length: materials normalise them, in one place, for every method."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from material_cases import FAMILIES, Array, directions, of_family, towards

each_dtype = pytest.mark.parametrize("dtype", [np.float64, np.float32])
LENGTHS = {np.float64: (1e-200, 0.3, 1 + 1e-9, 1e200), np.float32: (1e-30, 0.3, 1 + 1e-4, 1e30)}


def materials(family: str = "ggx") -> list[Any]:
    ndf = of_family(family, 0.4)
    metal = mf.Conductor(ndf, [0.2, 1.0], [3.9, 2.6])
    return [
        metal,
        mf.Conductor(ndf, 0.2, 3.9, correlated=False),
        mf.Conductor(ndf, 0.2, 3.9, scattering="multiple"),
        mf.Dielectric(ndf, 1.5),
        mf.Dielectric(ndf, 1.5, scattering="multiple", mode="importance"),
        mf.Diffuse(ndf, [0.3, 0.8]),
        mf.Diffuse(ndf, 0.8, scattering="single"),
        mf.KullaConty(metal),
        mf.Turquin(metal),
    ]


def methods(material: Any, xi: Array) -> dict[str, Callable[[Array, Array], Any]]:
    """Every method of directions, as a function of two."""
    walks = hasattr(material, "walk") and (
        material.scattering == "multiple" or isinstance(material, mf.Diffuse)
    )
    options: dict[str, Any] = {"n": 20, "rng": 1} if walks else {}
    draws: dict[str, Any] = {"rng": 1} if walks else {"xi": xi[..., : material.sample_dims]}
    found: dict[str, Callable[[Array, Array], Any]] = {
        "eval": lambda i, o: material.eval(i, o, **options),
        "pdf": material.pdf,
        "sample": lambda i, _: material.sample(i, **draws),
        "albedo": lambda i, _: material.albedo(i, **options),
    }
    if hasattr(material, "walk"):
        found["walk"] = lambda i, _: material.walk(i, rng=1)
    return found


def results(result: Any) -> list[Array]:
    return [np.asarray(part) for part in (result if isinstance(result, tuple) else (result,))]


@pytest.mark.parametrize("family", FAMILIES)
@each_dtype
def test_lengths_do_not_matter(family: str, dtype: Any) -> None:
    rng = np.random.default_rng(1)
    wi, wo = (directions(12, seed, side=1).astype(dtype) for seed in (2, 3))
    xi = rng.random((12, 4)).astype(dtype)
    for material in materials(family):
        if isinstance(material, mf.KullaConty | mf.Turquin) and family != "ggx":
            continue  # one distribution tells as much
        for name, method in methods(material, xi).items():
            if name == "albedo" and family != "ggx":
                continue
            expected = results(method(wi, wo))
            for i, o in zip(LENGTHS[dtype], reversed(LENGTHS[dtype]), strict=True):
                for value, exact in zip(results(method(wi * dtype(i), wo * dtype(o))), expected, strict=True):
                    assert value.dtype == exact.dtype
                    # Walks are chains of decisions, of which a rounding may turn one.
                    near = np.isclose(value, exact, rtol=1e-9 if dtype == np.float64 else 1e-3, atol=1e-30)
                    assert np.mean(near) > 0.8, f"{material!r}.{name} at {i:g}, {o:g}"
                    if not _walks(material):
                        assert near.all(), f"{material!r}.{name} at {i:g}, {o:g}"


def _walks(material: Any) -> bool:
    return getattr(material, "scattering", "single") == "multiple" or isinstance(material, mf.Diffuse)


@each_dtype
def test_unit_directions_are_left_alone(dtype: Any) -> None:
    """However they were normalised: a result would not come back from `sample` as it went."""
    material = mf.Conductor(mf.GGX(alpha=0.3))

    def unit(directions: Array) -> Array:
        return material._units(directions)[0]

    w = np.random.default_rng(4).normal(size=(100_000, 3)) * [1, 1, 1e-3]
    for normalised in (
        (w / np.linalg.norm(w, axis=-1, keepdims=True)).astype(dtype),
        w.astype(dtype) / np.sqrt(np.sum(w.astype(dtype) ** 2, axis=-1, keepdims=True)),
        w.astype(dtype) * (1 / np.sqrt(np.sum(w.astype(dtype) ** 2, axis=-1, keepdims=True))),
    ):
        np.testing.assert_array_equal(unit(normalised), normalised)
        again = unit(normalised * dtype(3.7))
        np.testing.assert_array_equal(unit(again), again)
        np.testing.assert_allclose(again, normalised, rtol=8 * np.finfo(dtype).eps)
    exact = unit(np.array([[3, 0, 4], [0, 0, -7]], dtype))
    np.testing.assert_allclose(
        exact, np.array([[0.6, 0, 0.8], [0, 0, -1]], dtype), rtol=2 * np.finfo(dtype).eps
    )


@each_dtype
def test_what_is_no_direction_gives_nan(dtype: Any) -> None:
    good = towards(30.0).astype(dtype)
    bad = [[0, 0, 0], [np.nan, 0, 1], [0, np.nan, 0.5], [0.1, 0.2, np.nan], [np.inf, 0, 0], [0, -np.inf, 1]]
    given = np.array([good, *bad], dtype)
    xi = np.full((len(given), 4), 0.4, dtype)
    for material in materials():
        for name, method in methods(material, xi).items():
            for pair in ((given, good), (good, given)) if name in ("eval", "pdf") else ((given, good),):
                for value in results(method(*pair)):
                    if value.dtype.kind != "f":
                        continue  # the number of facets
                    assert np.isfinite(value[0]).all(), f"{material!r}.{name}"
                    assert np.isnan(value[1:]).all(), f"{material!r}.{name}"


def test_docstrings_say_so() -> None:
    for cls in (mf.Conductor, mf.Dielectric, mf.Diffuse, mf.KullaConty, mf.Turquin):
        assert "any length" in (cls.__doc__ or ""), cls
