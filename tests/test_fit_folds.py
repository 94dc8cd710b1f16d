"""The maximum without one fold is that of a fit without it, wherever the shape is: a general optimiser, which
knows no derivatives, finds no better one.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

import microfacet as mf
from microfacet._fit import blocks
from microfacet._fit.model import Model, State, symmetries
from microfacet._fit.newton import Maximum, fold_state, maximise
from microfacet._fit.slopes import prepare

CASES = Path(__file__).parents[2] / "shared" / "cases" / "surfaces"
FAMILIES = {family.name: family for family in mf.families() if not family.singular}


def of_radius(radius: np.ndarray, seed: int) -> np.ndarray:
    azimuth = 2 * np.pi * np.random.default_rng(seed).random(len(radius))
    return radius[:, np.newaxis] * np.column_stack((np.cos(azimuth), 0.7 * np.sin(azimuth)))


def heavy(_: Any, seed: int) -> np.ndarray:
    """Slopes over many orders of magnitude: tails heavier than those of any family."""
    return of_radius(0.2 * np.exp(4.0 * np.random.default_rng(seed).normal(size=600)), seed)


def inside(family: Any, seed: int) -> np.ndarray:
    """Of the family, at the shape that its pictures have."""
    shape = [own.pictured for own in family.parameters[1:]]
    return of_radius(family.kernels.sample_slope(np.random.default_rng(seed).random(600), 0.2, *shape), seed)


def near_gauss(_: Any, seed: int) -> np.ndarray:
    """Normal slopes that are small: the limit of many families, near which the likelihood is flat."""
    return np.random.default_rng(seed).normal(size=(600, 2)) * 0.01


def light(_: Any, seed: int) -> np.ndarray:
    """On a disc: tails lighter than those of any family."""
    return of_radius(0.1 * np.sqrt(np.random.default_rng(seed).random(600)), seed)


def kept(model: Model, state: State, fold: int) -> float:
    return float(np.sum(model.value(state)[model.slopes.folds != fold]))


def refitted(model: Model, found: Maximum, start: State, fold: int) -> State:
    """By the simplex method, from where the fold's own search ended and from the maximum of all slopes."""
    ends = []
    for begin in (start, found.state):
        best = minimize(
            lambda step, begin=begin: -kept(model, model.moved(begin, step), fold),
            np.zeros(model.size),
            method="Nelder-Mead",
            options={"xatol": 1e-5, "fatol": 1e-6, "initial_simplex": 0.02 * np.eye(model.size + 1)[:, :-1]},
        )
        ends.append((-best.fun, model.moved(begin, best.x)))
    return max(ends, key=lambda end: end[0])[1]


#: Where the shape is low or at the lower end, inside, far out, and at the upper end of its range.
KINDS = {"heavy": heavy, "inside": inside, "near_gauss": near_gauss, "light": light}
MODELS = [
    (name, symmetry, kind)
    for name, family in FAMILIES.items()
    for symmetry in symmetries(family)
    for kind in (KINDS if family.parameters[1:] else ["inside"])
]


def assert_folds_are_refits(family: Any, slopes: np.ndarray, symmetry: str) -> tuple[Model, Maximum]:
    model, found = maximise(family, prepare(slopes, None), symmetry)
    for fold in range(blocks.FOLDS):
        ours = fold_state(model, found, fold)
        theirs = refitted(model, found, ours, fold)
        assert kept(model, ours, fold) > kept(model, theirs, fold) - 1e-3
        held_out = (float(np.sum(model.value(state, only=fold))) for state in (ours, theirs))
        assert next(held_out) == pytest.approx(next(held_out), abs=0.05)
    return model, found


@pytest.mark.parametrize(("name", "symmetry", "kind"), MODELS)
def test_every_fold_is_as_good_as_a_refit(name: str, symmetry: str, kind: str) -> None:
    family = FAMILIES[name]
    assert_folds_are_refits(family, KINDS[kind](family, 3), symmetry)


@pytest.mark.parametrize("end", [0, 1])
@pytest.mark.parametrize(("name", "symmetry"), [own[:2] for own in MODELS if own[2] == "light"])
def test_folds_at_an_end_of_the_range(name: str, symmetry: str, end: int) -> None:
    """The range ends a little short of where the maximum would be: some folds stay there, others come off."""
    family = FAMILIES[name]
    alpha, own = family.parameters
    slopes = inside(family, 3)
    model, found = maximise(family, prepare(slopes, None), symmetry)
    search, at = model.searches[0], found.state.shapes[0]
    fitted = tuple(search.shape(at + by) for by in ((0.01, 2.0) if end == 0 else (-2.0, -0.01)))
    narrow = replace(family, parameters=(alpha, replace(own, fitted=fitted)))
    model, found = assert_folds_are_refits(narrow, slopes, symmetry)
    assert model.shape(found.state)[0] == pytest.approx(fitted[end])
    shapes = [model.shape(fold_state(model, found, fold))[0] for fold in range(blocks.FOLDS)]
    assert any(shape != pytest.approx(fitted[end]) for shape in shapes)


@pytest.mark.parametrize("seed", range(6))
def test_small_beckmann_slopes_and_the_limit_of_gtr(seed: int) -> None:
    """gtr is Beckmann in the limit of large gamma, with alpha growing as its root; held out it may not be
    worse by more than a few nats.
    """
    slopes = np.random.default_rng(seed).normal(size=(4000, 2)) * 0.01 / np.sqrt(2)
    beckmann, gtr = sorted(
        mf.fit(slopes, ["beckmann", "gtr"], symmetry="isotropic"), key=lambda one: one.family
    )
    assert gtr.held_out == pytest.approx(beckmann.held_out, abs=10 / 4000)
    assert gtr.held_out < gtr.log_likelihood_per_sample + 5 / 4000


def test_the_folds_of_a_sample_that_went_astray() -> None:
    path = CASES / "beckmann001_slopes.npz"
    if not path.exists():
        pytest.skip("../shared/cases/surfaces/beckmann001_slopes.npz is not there")
    with np.load(path) as file:
        slopes = file["slopes"]
    assert_folds_are_refits(FAMILIES["gtr"], slopes, "isotropic")
