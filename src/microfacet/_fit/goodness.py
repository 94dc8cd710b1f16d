"""How far the sample's radial distribution is from the fitted one."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from microfacet._fit.misfit import Misfit
from microfacet._fit.model import Model, State
from microfacet._fit.result import Goodness

__all__ = ["goodness"]

_PROBABILITIES = (
    0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 0.995, 0.998, 0.999,
    0.9995, 0.9998, 0.9999,
)  # fmt: skip
_SECTORS = 8

Vector = NDArray[np.float64]


def goodness(model: Model, state: State, axis: float, independent_share: float, test: Misfit) -> Goodness:
    """Quantiles and A^2, scaled to the number of independent slopes; `axis` is twice the azimuth of alpha_x's
    axis in standard space.
    """
    radius, cosine, sine = model.radius(state)
    shape, alpha = model.shape(state), math.exp(state.log_alpha)
    beyond = model.law.beyond(radius, alpha, *shape)
    n = radius.size
    probabilities = tuple(p for p in _PROBABILITIES if 1 / n < p < 1 - 1 / n)
    observed = np.quantile(radius, probabilities)
    expected = [model.law.quantile(p, alpha, *shape) for p in probabilities]
    if model.stretched:
        turned = np.arctan2(sine, cosine) - axis
        sector = np.floor(turned * (_SECTORS / (2 * math.pi))).astype(np.int8) % _SECTORS
        sectors = [_anderson_darling(beyond[sector == k]) for k in range(_SECTORS)]
    else:
        sectors = []
    return Goodness(
        probabilities=probabilities,
        observed=tuple(map(float, observed)),
        expected=tuple(expected),
        anderson_darling=independent_share * _anderson_darling(beyond),
        sectors=tuple(independent_share * value for value in sectors),
        p_value=test.p_value,
        deviation=test.deviation,
    )


def _anderson_darling(beyond: Vector) -> float:
    """A^2 of a sample, from the probabilities to lie beyond each of its members.

    T. W. Anderson & D. A. Darling, A test of goodness of fit, JASA 49, 1954: A^2 = -n - sum (2 i - 1)/n
    (log F_i + log(1 - F_(n+1-i))).
    """
    n = beyond.size
    if n == 0:
        return math.nan
    tail = np.maximum(np.sort(beyond)[::-1], 1e-300)
    weight = (2 * np.arange(1, n + 1) - 1) / n
    with np.errstate(divide="ignore"):
        below = np.maximum(np.log1p(-np.minimum(tail, 1.0)), -690.0)
    return float(-n - np.sum(weight * (below + np.log(tail)[::-1])))
