"""Whether slopes that were left out tell two fits apart, and what one family holds of another.

The difference of two held-out log-likelihoods is a sum over slopes, and its standard error follows from how
parts of the map differ. That is worth something where many slopes make the sum. It is not where two fits are
nearly the same density, so that the chance of their parameters is all there is, nor where a few slopes in the
tail make nearly all of it, so that the error is as large as the difference however large that is. Q. H.
Vuong, Likelihood ratio tests for model selection and non-nested hypotheses, Econometrica 57, 1989, has the
first case; the second is met with a bound.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._fit import blocks
from microfacet._fit.model import Model, State
from microfacet._fit.newton import Maximum, fold_state

__all__ = ["Validation", "are_tied", "difference_error", "validation"]

_ERRORS = 2  # standard errors within which fits are tied
_TAIL = 30  # independent slopes that share the largest differences: enough for a sum to be nearly normal

Vector = NDArray[np.float64]


class Validation(NamedTuple):
    """A model, its maximum without each fold, and the log-likelihood of each group under that without its
    fold.
    """

    model: Model
    states: tuple[State, ...]
    groups: Vector


def validation(model: Model, found: Maximum) -> Validation:
    """The maxima without each fold, and what the slopes of that fold say of them."""
    states = tuple(fold_state(model, found, fold) for fold in range(blocks.FOLDS))
    values = [model.value(state, only=fold) for fold, state in enumerate(states)]
    return Validation(model, states, np.sum(values, axis=0))


def difference_error(one: Validation, other: Validation, share: float) -> float:
    """Standard error of the difference of two held-out log-likelihoods per slope, of which a share of the
    slopes is independent.

    A log-likelihood varies by chance at its maximum alone: twice that is chi-square with as many degrees of
    freedom as there are parameters, whose variance is what the error has at least.
    """
    if one is other:
        return 0.0
    slopes = one.model.slopes
    among_parameters = (one.model.size + other.model.size) / 2 / share**2
    return math.sqrt(_variance(one.model, one.groups - other.groups) + among_parameters) / slopes.n


def are_tied(best: Validation, other: Validation, share: float) -> bool:
    """Whether the slopes leave open which of the two is better.

    They do if the difference is within two of its standard errors; but where that error is large because of a
    few slopes, only if it still is when the largest contributions are cut down to the size of one that many
    have. Cutting them favours the one that is behind.
    """
    n = best.model.slopes.n
    behind = float(np.sum(best.groups - other.groups))
    if behind > _ERRORS * n * difference_error(best, other, share):
        return False
    chance = math.sqrt((best.model.size + other.model.size) / 2) / share
    if behind <= _ERRORS * chance:
        return True
    each = best.model.each(best.states) - other.model.each(other.states)
    tail = min(math.ceil(_TAIL / share), n // 2)
    cut = np.minimum(each, np.partition(each, n - tail)[n - tail])
    groups = best.model.slopes.totals(cut)
    return float(np.sum(groups)) <= _ERRORS * math.sqrt(_variance(best.model, groups) + chance**2)


def _variance(model: Model, difference: Vector) -> float:
    """Of the sum over groups, from how they differ."""
    slopes = model.slopes
    rest = difference - difference.sum() / slopes.n * slopes.sizes
    return blocks.variances(rest, slopes.on_map, slopes.shape)[0].error ** 2
