"""Derivatives that are recorded with a function, against differences of the function, on NumPy in float64."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import microfacet as mf
from array_cases import CASES, METALS, Case, inputs, shape_of
from microfacet._export.derivatives import graph_of
from microfacet._export.evaluate import Evaluator
from microfacet._export.libraries import library_of
from microfacet._graphs import shorter_from_tables

FAMILIES = [family for family in mf.families() if not shorter_from_tables[family.name]]
COUNT = 400
# The central difference of the sixth order.
WEIGHTS = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))


def arguments(names: tuple[str, ...], case: Case, shape: dict[str, float]) -> list[Any]:
    """Random inputs of a graph, by name; parameters vary around the usual ones."""
    rng = np.random.default_rng(4)
    given = inputs(COUNT, "float64", shape["alpha"], seed=5)
    found = []
    for name in names:
        vector, _, component = name.partition(".")
        if name == "choice" or vector == "xi":
            found.append(rng.uniform(0.05, 0.95, COUNT))
        elif component:
            found.append(given[vector][:, "xyz".index(component)])
        elif name in given:
            found.append(given[name])
        else:
            middle = {**shape, **METALS.get(case.material, {})}[name]
            found.append(middle * rng.uniform(0.8, 1.25, COUNT))
    return found


def difference(evaluate: Evaluator, at: list[Any], place: int, step: Any) -> Any:
    """Of every result by one input."""
    total = 0.0
    for steps, weight in WEIGHTS:
        for sign in (1, -1):
            moved = list(at)
            moved[place] = at[place] + sign * steps * step
            with np.errstate(invalid="ignore"):  # the density of a ring is infinite
                total = total + sign * weight * np.array(evaluate(moved))
    return total / step


@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")  # of a ring's density, which is infinite
@pytest.mark.parametrize("case", CASES, ids=str)
@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_derivatives_are_differences(family: Any, case: Case) -> None:
    """By every input, of every result, wherever differences say what they are."""
    shape = shape_of(family)
    parameters = dict.fromkeys([*shape, *METALS.get(case.material, {})])
    functions = mf.array_functions(family.name)
    quantity = f"{case.material}_{case.name}" if case.material else case.name
    recipe = functions._recipe(quantity, parameters, "float64", False)
    names, library = graph_of(recipe).inputs, library_of("numpy")
    evaluate, both = Evaluator(graph_of(recipe), library), Evaluator(graph_of(recipe, names), library)
    at = arguments(names, case, shape)
    values = np.array(evaluate(at))
    recorded = dict(zip((name for name, _ in both.graph.results), both(at), strict=True))
    checked = 0
    for place, by in enumerate(names):
        step = np.maximum(np.abs(at[place]), 0.05) * 1e-3
        coarse, fine = difference(evaluate, at, place, step), difference(evaluate, at, place, step / 2)
        for (name, _), value, a, b in zip(evaluate.graph.results, values, coarse, fine, strict=True):
            got = recorded[f"{name}/{by}"]
            scale = np.abs(b) + 1e-3 * np.abs(value) + 1e-280
            with np.errstate(invalid="ignore"):
                change = np.abs(a - b)
            certain = change + 1e-13 * np.abs(value) / step < 1e-8 * scale
            off = np.abs(got - b)[certain] / scale[certain]
            assert off.max(initial=0) < 2e-8, f"{name} by {by}: {off.max()}"
            checked += int(certain.sum())
    assert checked > 0.4 * len(names) * np.isfinite(values).sum()
