"""Scattering of all orders: nothing is lost, evaluation and samples are one measure, and it is reciprocal.

All comparisons of means are within 4 of their standard errors, with seeds that stay.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import furnace_cases
import microfacet as mf
from furnace_cases import Furnace
from material_cases import (
    FAMILIES,
    Array,
    absorbing,
    agree,
    directions,
    mean,
    of_family,
    stretched,
    towards,
)
from microfacet.testing._cells import DOMAINS, Cells
from microfacet.testing._quadrature import integrate

EVALUATIONS = 40_000
ALL = (1, 2**31)

each_family = pytest.mark.parametrize("family", FAMILIES)
each_dtype = pytest.mark.parametrize("dtype", [np.float64, np.float32])


# --- energy ---


@pytest.mark.parametrize("case", furnace_cases.selection(), ids=str)
def test_white_furnace(case: Furnace) -> None:
    """Through `eval`; `make docs-furnace` measures the full grid with more evaluations."""
    light, error = mean(case.light(EVALUATIONS))
    assert error < 0.03, "so that a loss would show"
    assert abs(light - 1.0) < 4.0 * error


def test_the_selection_meets_every_value_of_the_grid() -> None:
    every, some = list(furnace_cases.cases()), furnace_cases.selection()
    for name in ("material", "family", "alpha", "degrees"):
        assert {getattr(case, name) for case in some} == {getattr(case, name) for case in every}


def test_a_furnace_sees_what_is_missing() -> None:
    """Without the third order and those after it a few percent of the light are gone."""
    case = Furnace("metal", "ggx", 1.0, 45.0)
    wo, density = case.propose(EVALUATIONS, np.random.default_rng(1))
    light, error = mean(case.make("multiple").eval(case.wi, wo, rng=1, orders=(1, 2)) / density)
    assert light < 1.0 - 10.0 * error


@each_family
def test_what_absorbs_sends_less(family: str) -> None:
    ndf = of_family(family, 0.8)
    for degrees in (10.0, 75.0):
        wi = np.broadcast_to(towards(degrees), (4000, 3))
        for name, material in absorbing(ndf).items():
            if name.startswith("glass"):
                continue
            _, weight, facets = material.walk(wi, rng=3)
            total, error = mean(weight)
            assert total + 4.0 * error < 1.0
            assert np.all(facets >= 1)
            assert np.all(weight[facets <= 4] <= 1.0 + 1e-12), "before roulette"


@each_family
def test_lossless_walks_keep_their_weight(family: str) -> None:
    wi = np.concatenate([directions(600, 5), [towards(0.0), towards(89.999), towards(180.0)]])
    ndf = stretched(family)
    glass = mf.Dielectric(ndf, 0.6, scattering="multiple", mode="importance")
    for material in (mf.Conductor(ndf, scattering="multiple"), mf.Diffuse(ndf, 1.0), glass):
        wo, weight, facets = material.walk(wi, rng=4)
        lit = np.full(len(wi), True) if material is glass else wi[:, 2] > 0.0
        assert np.all(weight[lit] == 1.0)
        assert np.all(weight[~lit] == 0.0)
        assert np.all(facets[lit] >= 1)
        np.testing.assert_allclose(np.linalg.norm(wo[lit], axis=-1), 1.0, rtol=1e-9)
        if material is not glass:
            assert np.all(wo[lit][:, 2] > 0.0)


# --- one measure ---

FUNCTIONS: tuple[Callable[[Array], Array], ...] = (
    lambda wo: np.ones(len(wo)),
    lambda wo: wo[:, 2] ** 2,
    lambda wo: np.exp(-4.0 * np.sum((wo - [-0.6, 0.3, 0.7]) ** 2, axis=-1)) * (wo[:, 0] < 0.0),
)
ORDERS = ((1, 1), (2, 2), (3, 2**31), ALL)


@each_family
@pytest.mark.parametrize("name", absorbing(mf.GGX(alpha=1.0)))
def test_samples_and_values_are_one_measure(family: str, name: str) -> None:
    """E[weight g(wo)] of walks and the integral of eval g, for three functions g, and of every order."""
    kind = "diffuse" if name == "diffuse" else "glass" if name.startswith("glass") else "metal"
    case = Furnace(kind, family, 0.7, 55.0)
    material = absorbing(case.ndf)[name]
    walked, weight, facets = material.walk(np.broadcast_to(case.wi, (EVALUATIONS // 2, 3)), rng=5)
    wo, density = case.propose(EVALUATIONS // 3, np.random.default_rng(6))
    for first, last in ORDERS:
        counted = (facets >= first) & (facets <= last)
        value = material.eval(case.wi, wo, rng=first, orders=(first, last)) / density
        for g in FUNCTIONS:
            agree(mean(weight * counted * g(walked)), mean(value * g(wo)))


@each_family
def test_wavelengths_of_a_walk_have_their_own_light(family: str) -> None:
    """Roulette stops some of them sooner; their directions are common."""
    case = Furnace("metal", family, 1.2, 55.0)
    eta, k = [0.2, 1.4, np.inf], [3.9, 0.3, 0.0]
    metal = mf.Conductor(case.ndf, eta, k, scattering="multiple")
    walked, weight, facets = metal.walk(np.broadcast_to(case.wi, (EVALUATIONS // 2, 3)), rng=40)
    assert weight.shape == (EVALUATIONS // 2, 3)
    assert facets.shape == (EVALUATIONS // 2,)
    assert np.all(weight[:, 2] == 1.0)
    assert np.all(walked[:, 2] > 0.0)
    wo, density = case.propose(EVALUATIONS // 3, np.random.default_rng(41))
    value = metal.eval(case.wi, wo, rng=42) / density[:, None]
    for g in FUNCTIONS:
        agree(mean(weight * g(walked)[:, None]), mean(value * g(wo)[:, None]))


@each_family
def test_diffuse_facets_of_one_order(family: str) -> None:
    case = Furnace("diffuse", family, 0.8, 40.0)
    one, every = (mf.Diffuse(case.ndf, 0.9, scattering=s) for s in ("single", "multiple"))
    wi = np.broadcast_to(case.wi, (EVALUATIONS // 2, 3))
    walked, weight, density = one.sample(wi, rng=43)
    _, _, facets = every.walk(wi, rng=43)
    np.testing.assert_array_equal(weight, np.where(facets == 1, 0.9, 0.0))
    np.testing.assert_allclose(density, np.maximum(walked[:, 2], 0.0) / np.pi, rtol=1e-14)
    wo, density = case.propose(EVALUATIONS // 3, np.random.default_rng(44))
    value = one.eval(case.wi, wo, rng=45)
    np.testing.assert_array_equal(value, every.eval(case.wi, wo, rng=45, orders=(1, 1)))
    for g in FUNCTIONS:
        agree(mean(weight * g(walked)), mean(value / density * g(wo)))


@each_family
def test_orders_add_up(family: str) -> None:
    """The same seed means the same walks."""
    wi, wo = directions(300, 7), directions(300, 8)
    for material in absorbing(stretched(family)).values():
        parts = [material.eval(wi, wo, rng=9, orders=(k, k)) for k in range(1, 6)]
        parts.append(material.eval(wi, wo, rng=9, orders=(6, 2**31)))
        np.testing.assert_allclose(sum(parts), material.eval(wi, wo, rng=9), rtol=1e-12, atol=1e-300)
        assert np.all(material.eval(wi, wo, rng=9, orders=(3, 2)) == 0.0)


@each_family
def test_the_first_order_has_the_closed_form(family: str) -> None:
    wi, wo = directions(12, 10), directions(12, 11)
    wi[:, 2] = np.abs(wi[:, 2])
    n = 8000
    for name, material in absorbing(stretched(family)).items():
        if name == "diffuse":
            continue
        expected = type(material)(
            material.ndf,
            *((material.eta,) if name.startswith("glass") else (material.eta, material.k)),
            **({"mode": material.mode} if name.startswith("glass") else {}),
        ).eval(wi, wo)
        walks = material.eval(*(np.broadcast_to(w, (n, 12, 3)) for w in (wi, wo)), rng=12, orders=(1, 1))
        value, error = mean(walks)
        assert np.all(np.abs(value - expected) <= 4.0 * error + 1e-12 * expected)
        assert np.median(error[expected > 0.0] / expected[expected > 0.0]) < 0.02


@each_family
@pytest.mark.parametrize("degrees", [20.0, 80.0])
def test_how_many_facets_a_walk_meets(family: str, degrees: float) -> None:
    """One, as often as quadrature of the closed form says."""
    ndf, wi = stretched(family), towards(degrees, 70.0)
    mirror = mf.Conductor(ndf)
    wo = mirror.sample(wi, np.random.default_rng(13).random((20_000, mirror.sample_dims)))[0]
    cells = Cells.around(wo, DOMAINS["sphere"], 16, 16)
    albedo = float(integrate(lambda w: mirror.eval(wi, w), cells, 1e-6).sum())
    _, _, facets = mf.Conductor(ndf, scattering="multiple").walk(np.broadcast_to(wi, (40_000, 3)), rng=14)
    once, error = mean(facets == 1)
    assert abs(once - albedo) < 4.0 * error + 1e-4


@each_family
def test_n_walks_are_a_mean(family: str) -> None:
    """Of estimates as good as one another: the variance falls like 1/n."""
    wi, wo = np.broadcast_to(towards(50.0), (40_000, 3)), towards(40.0, 150.0)
    metal = mf.Conductor(of_family(family, 0.8), scattering="multiple")
    one, many = metal.eval(wi, wo, rng=15), metal.eval(wi, wo, n=16, rng=16)
    agree(mean(one), mean(many))
    assert 0.8 < one.var() / many.var() / 16.0 < 1.25


# --- symmetry ---


PAIRS = np.array(
    [
        [towards(20, 10), towards(45, 120)],
        [towards(50, 80), towards(30, 10)],
        [towards(65, 200), towards(60, 330)],
        [towards(40, 300), towards(10, 50)],
    ]
)


@each_family
def test_reciprocity(family: str) -> None:
    """f of opaque surfaces; of glass f in radiance is f in importance of the way back."""
    n = 40_000
    wi, wo = (np.broadcast_to(PAIRS[:, k], (n, len(PAIRS), 3)) for k in (0, 1))
    ndf = stretched(
        family, 1.0, 1.6
    )  # rough: most light is of higher orders, and no estimate is rare and large
    radiance, importance = (
        mf.Dielectric(ndf, 1.5, scattering="multiple", mode=mode) for mode in ("radiance", "importance")
    )
    metal, clay = mf.Conductor(ndf, 0.2, 3.9, scattering="multiple"), mf.Diffuse(ndf, 0.8)
    ways = [(metal, metal, +1, +1), (clay, clay, +1, +1)]
    ways += [(radiance, importance, i, o) for i in (+1, -1) for o in (+1, -1)]
    for there, back, i, o in ways:
        orders = (2, 2**31) if there is back else ALL
        forth = mean(there.eval(i * wi, o * wo, rng=19, orders=orders), 1.0 / wo[..., 2])
        again = mean(back.eval(o * wo, i * wi, rng=20, orders=orders), 1.0 / wi[..., 2])
        # Of light that comes back seldom the error is not known either.
        known = (forth[1] < 0.25 * forth[0]) & (again[1] < 0.25 * again[0])
        assert known.sum() >= 3
        agree((forth[0][known], forth[1][known]), (again[0][known], again[1][known]))
        assert np.median(forth[1] / forth[0]) < 0.15


@each_family
def test_below_is_above_turned_over(family: str) -> None:
    ndf, (wi, wo) = stretched(family), (directions(200, 21, -1), directions(200, 22))
    for mode in ("radiance", "importance"):
        glass, bubble = (mf.Dielectric(ndf, e, scattering="multiple", mode=mode) for e in (1.6, 1.0 / 1.6))
        np.testing.assert_allclose(glass.eval(wi, wo, rng=1), bubble.eval(-wi, -wo, rng=1), rtol=1e-9)


# --- proposals for multiple importance sampling ---


@each_family
@pytest.mark.parametrize("degrees", [30.0, 85.0, 140.0])
def test_the_proposal_is_a_density(family: str, degrees: float) -> None:
    wi = towards(degrees, 20.0)
    for name, material in absorbing(stretched(family)).items():
        if degrees > 90.0 and not name.startswith("glass"):
            assert material.pdf(wi, towards(20.0)) == 0.0
            continue
        wo, _, density = material.sample(np.broadcast_to(wi, (4000, 3)), rng=34)
        np.testing.assert_array_equal(density, material.pdf(wi, wo))
        cells = Cells.around(np.concatenate([wo, directions(4000, 35)]), DOMAINS["sphere"], 16, 16)
        mass = float(integrate(lambda w, m=material: m.pdf(wi, w), cells, 1e-6).sum())
        assert mass == pytest.approx(1.0, abs=2e-4)
