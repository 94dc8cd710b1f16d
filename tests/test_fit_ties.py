"""When two fits are tied, and when one family is said to contain another."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

import microfacet as mf
from microfacet._fit import blocks
from microfacet._fit.nested import contained
from microfacet._fit.newton import maximise
from microfacet._fit.slopes import prepare
from microfacet._fit.ties import are_tied, difference_error, validation

CASES = Path(__file__).parents[2] / "shared" / "cases" / "surfaces"
FAMILIES = {family.name: family for family in mf.families() if not family.singular}


def draw(name: str, shape: tuple[float, ...], n: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    radius = FAMILIES[name].kernels.sample_slope(rng.random(n), 0.3, *shape)
    azimuth = 2 * np.pi * rng.random(n)
    return radius[:, np.newaxis] * np.column_stack((np.cos(azimuth), np.sin(azimuth)))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(("name", "shape"), [("ggx", ()), ("gtr", (1.5,)), ("double_ggx", ())])
def test_a_few_slopes_in_the_tail_make_no_tie(name: str, shape: tuple[float, ...], seed: int) -> None:
    """Light tails against heavy ones: the largest slopes cost as much as all others, which is their error."""
    results = mf.fit(draw(name, shape, 2000, seed), ["beckmann", "erfc", "ei", name], symmetry="isotropic")
    assert [result.family for result in results if result.tied] == [name]


def test_their_error_is_as_large_as_the_difference() -> None:
    """Of 40 samples some have differences that are within two errors, so that these tests test."""
    within = 0
    for seed in range(40):
        first, *others = mf.fit(
            draw("double_ggx", (), 2000, seed), ["ei", "double_ggx"], symmetry="isotropic"
        )
        (second,) = others
        assert (first.family, second.tied) == ("double_ggx", False)
        within += first.held_out - second.held_out < 2 * second.held_out_error
    assert within > 0


def test_an_isotropic_family_is_first_and_what_contains_it_is_tied() -> None:
    """That one more parameter is worse by the chance of that parameter tells nothing apart."""
    first, tied = 0, 0
    for seed in range(20):
        results = mf.fit(draw("ggx", (), 2000, seed), ["ggx", "gtr", "student_t"])
        first += (results[0].family, results[0].symmetry) == ("ggx", "isotropic")
        tied += all(result.tied for result in results)
    # The criterion prefers a parameter by chance with probability P(chi2 > log n), four times at most.
    unlucky = stats.chi2.sf(math.log(2000), 1) * 2 + stats.chi2.sf(2 * math.log(2000), 2)
    assert stats.binom.sf(20 - first - 1, 20, unlucky) > 0.001
    assert tied >= 17


def test_ties_are_worked_out_from_the_slopes() -> None:
    slopes = prepare(draw("student_t", (2.5,), 3000, 1), None)
    one, other = (validation(*maximise(FAMILIES[name], slopes, "isotropic")) for name in ("student_t", "ggx"))
    for held_out in (one, other):
        each = held_out.model.each(held_out.states)
        assert held_out.groups == pytest.approx(slopes.totals(each), rel=1e-12)
    assert slopes.totals(np.ones(3000)) == pytest.approx(slopes.sizes)
    difference = one.groups - other.groups
    groups = difference - difference.mean()
    spread = np.sum(groups**2) * blocks.GROUPS / (blocks.GROUPS - 1)
    parameters = (2 + 1) / 2
    assert difference_error(one, other, 1.0) == pytest.approx(math.sqrt(spread + parameters) / 3000)
    assert difference_error(one, one, 1.0) == 0
    assert are_tied(one, one, 1.0)
    assert not are_tied(one, other, 1.0)
    assert are_tied(one, other, 1e-3), "as many as three independent slopes tell nothing"


INSIDE = {
    ("student_t", "ggx"): 2.0,
    ("gtr", "ggx"): 2.0,
    ("bessel_k", "k0"): 1.0,
    ("bessel_k", "exponential"): 1.5,
    ("generalised_exponential", "beckmann"): 2.0,
    ("generalised_exponential", "exponential"): 1.0,
}


@pytest.mark.parametrize("narrow", [name for name, family in FAMILIES.items() if not family.parameters[1:]])
@pytest.mark.parametrize("wide", [name for name, family in FAMILIES.items() if family.parameters[1:]])
def test_which_family_contains_which(wide: str, narrow: str) -> None:
    """Found from the densities alone, from near and from far."""
    family = FAMILIES[wide]
    for start in family.parameters[1].examples:
        found = contained(family, (0.3, start), FAMILIES[narrow], (0.2,))
        expected = INSIDE.get((wide, narrow))
        assert found == (None if expected is None else pytest.approx((expected,), rel=1e-6))


def test_the_result_says_so() -> None:
    results = mf.fit(draw("ggx", (), 5000, 3), ["ggx", "gtr", "student_t", "bessel_k"])
    said = "contains ggx: at gamma 2 it is the same density"
    assert {result.family for result in results if said in result.notes} == {"gtr", "student_t"}


def test_a_sample_of_ggx() -> None:
    path = CASES / "ggx03_iid_slopes.npz"
    if not path.exists():
        pytest.skip("../shared/cases/surfaces/ggx03_iid_slopes.npz is not there")
    with np.load(path) as file:
        results = mf.fit(file["slopes"])
    assert (results[0].family, results[0].symmetry) == ("ggx", "isotropic")
    assert {result.family for result in results if result.tied} == {"ggx", "gtr", "student_t"}
