"""Uniform numbers below 1 stay below 1, whatever type the directions beside them have."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import microfacet as mf
from material_cases import FAMILIES, SHAPES, directions, of_family

# Below 1 in float64; most are 1 in float32.
CLOSE = np.array([1 - 2.0**-53, 1 - 2.0**-40, 1 - 2.0**-26, 1 - 2.0**-25, 1 - 2.0**-24, 1 - 2.0**-23])
each_family = pytest.mark.parametrize("family", FAMILIES)


def close(dims: int, n: int = 300) -> Any:
    """Each of them in some place."""
    rng = np.random.default_rng(1)
    xi = rng.random((n, dims))
    xi[rng.random(xi.shape) < 0.6] = 0.0
    where = rng.random(xi.shape) < 0.6
    xi[where] = rng.choice(CLOSE, where.sum())
    return xi


def materials(family: str) -> list[Any]:
    ndf = of_family(family, 0.4)
    return [mf.Conductor(ndf, [0.2, 1.0], 3.9), mf.Dielectric(ndf, 1.5), mf.Dielectric(ndf, 0.7)]


@each_family
def test_materials_draw_from_float64_in_float32(family: str) -> None:
    for material in materials(family):
        xi = close(material.sample_dims)
        for side in (1, -1) if isinstance(material, mf.Dielectric) else (1,):
            wi = directions(len(xi), 2, side)
            exact, narrow = material.sample(wi, xi), material.sample(wi.astype(np.float32), xi)
            singular = family == "dirac"  # whose density on the ring is infinite
            for number, (numbers, others) in enumerate(zip(narrow, exact, strict=True)):
                assert numbers.dtype == np.float32
                assert np.isfinite(numbers).all() or (singular and number == 2)
                assert numbers.shape == others.shape
        ones = np.ones((1, material.sample_dims))
        if family != "ggx":  # its closed form may stand at 1
            assert np.isnan(material.sample(directions(1, 2, 1).astype(np.float32), ones)[0]).all()


@each_family
def test_longer_types_too(family: str) -> None:
    xi = np.full((5, 4), np.nextafter(np.longdouble(1), 0))
    for material in materials(family):
        for numbers in material.sample(directions(5, 3, 1), xi)[: 2 if family == "dirac" else 3]:
            assert np.isfinite(numbers).all()


@each_family
@pytest.mark.parametrize("scheme", ["continuous", "mixture"])
def test_normals_of_mixed_types(family: str, scheme: str) -> None:
    """float32 directions beside float64 numbers are computed in float64: nothing is rounded."""
    ndf = of_family(family, 0.4)
    xi = close(ndf.mixture_dims if scheme == "mixture" else ndf.visible_dims)
    w = directions(len(xi), 4).astype(np.float32)
    m = ndf.sample_visible(w, xi, scheme=scheme)
    assert m.dtype == np.float64
    assert np.isfinite(m).all()
    np.testing.assert_array_equal(m, ndf.sample_visible(w.astype(float), xi, scheme=scheme))
    out = np.empty(m.shape, np.float32)
    assert np.isfinite(ndf.sample_visible(w, xi, scheme=scheme, out=out)).all()
    assert np.isfinite(ndf.sample(xi[:, :2], out=out)).all()
    assert (out[:, 2] >= 0).all()


@each_family
def test_elementwise_samplers_take_each_type_as_it_is(family: str) -> None:
    kernels = getattr(mf, family)
    parameters = SHAPES[family].values()
    for sampler in (kernels.sample_slope, kernels.sample_u):
        assert np.isfinite(sampler(CLOSE, np.float32(0.4), *parameters)).all()
        assert np.isfinite(sampler(CLOSE[-2:].astype(np.float32), 0.4, *parameters)).all()
        assert np.isnan(sampler(1.0, 0.4, *parameters))
        assert "dtype" in (sampler.__doc__ or "")


def test_narrowing_keeps_what_is_invalid() -> None:
    from microfacet._bsdf.arguments import narrowed

    xi = np.array([0.0, 0.25, 1 - 2.0**-53, 1.0, 1 + 2.0**-30, -1e-9, np.nan, np.inf])
    found = narrowed(xi, np.float32)
    below = np.float32(1 - 2.0**-24)
    np.testing.assert_array_equal(found, np.float32([0, 0.25, below, 1, 1, -1e-9, np.nan, np.inf]))
    assert narrowed(found, np.float32) is found
