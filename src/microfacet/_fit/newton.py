"""The maximum of the likelihood: Newton's method with a trust region, from the best of several starts."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._family import Family
from microfacet._fit.model import Model, State, Sums, make_state
from microfacet._fit.slopes import Slopes

__all__ = ["Maximum", "fold_state", "maximise", "newton_step"]

_SHAPE_STARTS = (0.24, 0.385, 0.48, 0.575, 0.665, 0.79)  # shares of the range that is searched
_MOST_STARTS = 81
_FIRST_SEARCH = 4000  # slopes for the search from several starts
_SECOND_SEARCH = 50_000  # slopes for the search from its result
_STEPS = 60
# Squared length of the remaining step in standard errors of independent slopes: what is aimed at, and what
# is good enough where rounding allows no better.
_TOLERANCE, _GOOD_ENOUGH = 1e-10, 1e-6
_SHORT = 1e-4  # of the last step in logarithmic units, whose square is nothing

Vector = NDArray[np.float64]


class Maximum(NamedTuple):
    """Where the search ended: the state, the sums there, which coordinates are free (not at an end of their
    range).
    """

    state: State
    sums: Sums
    free: NDArray[np.bool_]
    converged: bool


def maximise(family: Family, slopes: Slopes, symmetry: str) -> tuple[Model, Maximum]:
    """The maximum, by way of parts of the slopes, on which steps are cheap."""
    part = Model(family, slopes.part(_FIRST_SEARCH), symmetry)
    shares = _SHAPE_STARTS if len(part.searches) < 2 else _SHAPE_STARTS[::2]
    places = product(*([search.at(share) for share in shares] for search in part.searches))
    starts = [make_state(part, variables) for variables in _with_own(part, places)]
    starts.sort(key=lambda start: float(np.sum(part.value(start))), reverse=True)
    found = max((_search(part, start) for start in starts[:2]), key=lambda end: float(end.sums.value[0]))
    state = found.state
    if slopes.n > 4 * _SECOND_SEARCH:
        state = _search(Model(family, slopes.part(_SECOND_SEARCH), symmetry), state).state
    model = Model(family, slopes, symmetry)
    return model, _search(model, state)


def _with_own(model: Model, places: Iterable[tuple[float, ...]]) -> list[tuple[float, ...]]:
    """The places to start from; of several parameters also where they are pictured."""
    pictured = tuple(search.variable(search.parameter.pictured) for search in model.searches)
    return [*itertools.islice(places, _MOST_STARTS), *([pictured] if len(pictured) > 1 else [])]


def fold_state(model: Model, found: Maximum, fold: int) -> State:
    """The maximum without one fold, from that with it: a search like the first one, which is over after one
    step where the likelihood is a parabola as far as that.
    """
    kept = model.slopes.folds != fold
    value, gradient, hessian, squares = found.sums
    sums = Sums(
        value * kept, gradient * kept[:, np.newaxis], hessian * kept[:, np.newaxis, np.newaxis], squares
    )
    return _search(model, found.state, sums, fold, short=0.003).state


def newton_step(gradient: Vector, hessian: Vector, free: NDArray[np.bool_]) -> Vector:
    """Up the hill in the free coordinates; where the likelihood is convex, as if it were as concave."""
    step = np.zeros_like(gradient)
    if np.any(free) and np.all(np.isfinite(hessian)):
        values, axes = np.linalg.eigh(-hessian[np.ix_(free, free)])
        curvature = np.maximum(np.abs(values), 1e-9 * np.abs(values).max() + 1e-300)
        step[free] = axes @ ((axes.T @ gradient[free]) / curvature)
    return step


def _search(
    model: Model, state: State, sums: Sums | None = None, without: int | None = None, short: float = _SHORT
) -> Maximum:
    """Up the hill from a state, of all slopes or without those of one fold, until what is left is chance.

    A step shorter than `short` is the last one, and the sums are carried along it by their derivatives: what
    it misses is its square.
    """
    sums = model.sums(state, without) if sums is None else sums
    radius, left = 1.0, math.inf  # of the region where the parabola is trusted, in logarithmic units
    for _ in range(_STEPS):
        gradient, hessian = sums.gradient.sum(axis=0), sums.hessian.sum(axis=0)
        step, free = _step(model, state, gradient, hessian)
        left = float(gradient @ step)
        if left < _TOLERANCE:
            return Maximum(state, sums, free, True)
        if float(np.abs(step).max()) < short and _inside(model, state, step):
            return Maximum(model.moved(state, step), _carried(sums, step), free, True)
        step = _shortened(step, radius)
        trial = model.moved(state, step)
        new = model.sums(trial, without)
        gain = float(np.sum(new.value - sums.value))
        if not math.isfinite(gain) or gain < -1e-12 * abs(float(np.sum(sums.value))):
            radius = float(np.abs(step).max()) / 4
            if radius < 1e-12:
                break
            continue
        state, sums, radius = trial, new, min(2 * radius, 1.0)
    free = _free(model, state, sums.gradient.sum(axis=0))
    return Maximum(state, sums, free, left < _GOOD_ENOUGH)


def _step(model: Model, state: State, gradient: Vector, hessian: Vector) -> tuple[Vector, NDArray[np.bool_]]:
    """Newton's step within the ranges of the shapes, and what is free: also a shape at an end that comes off
    it once the others have moved, as gtr's does, whose alpha grows with the root of gamma.
    """
    free = _free(model, state, gradient)
    step = newton_step(gradient, hessian, free)
    drawn = free | _free(model, state, gradient + hessian @ step)
    if np.array_equal(drawn, free):
        return step, free
    wider = newton_step(gradient, hessian, drawn)
    inwards = _free(model, state, wider)[drawn & ~free].all()
    return (wider, drawn) if inwards else (step, free)


def _inside(model: Model, state: State, step: Vector) -> bool:
    """Whether a step leaves every shape within its range."""
    shapes = zip(model.searches, state.shapes, step[model.first_shape :].tolist(), strict=True)
    return all(search.ends[0] < variable + by < search.ends[1] for search, variable, by in shapes if by)


def _carried(sums: Sums, step: Vector) -> Sums:
    """The sums after a short step."""
    value, gradient, hessian, squares = sums
    change = hessian @ step
    return Sums(value + (gradient + change / 2) @ step, gradient + change, hessian, squares)


def _free(model: Model, state: State, gradient: Vector) -> NDArray[np.bool_]:
    """Which coordinates may move: a shape not beyond an end of its range."""
    free = np.ones(model.size, dtype=np.bool_)
    shapes = zip(model.searches, state.shapes, strict=True)
    for number, (search, variable) in enumerate(shapes, model.first_shape):
        low, high = search.ends
        at_low, at_high = variable <= low, variable >= high
        free[number] = not ((at_low and gradient[number] < 0) or (at_high and gradient[number] > 0))
    return free


def _shortened(step: Vector, longest: float = 1.0) -> Vector:
    size = float(np.abs(step).max())
    return step if size <= longest else step * (longest / size)
