"""Samples of materials with scattering of one order: their density, their weights, and the sum of both."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from material_cases import FAMILIES, stretched, towards, unit
from microfacet.testing import chi2
from microfacet.testing._cells import DOMAINS, Cells
from microfacet.testing._quadrature import integrate

N = 400
SAMPLES = 60_000

each_family = pytest.mark.parametrize("family", FAMILIES)
each_dtype = pytest.mark.parametrize("dtype", [np.float64, np.float32])


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
