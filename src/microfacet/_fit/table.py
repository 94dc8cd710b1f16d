"""Fits to tables: histograms of slopes, densities against the angle, mean square slopes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize

from microfacet._family import Family
from microfacet._fit.estimate import Candidates, chosen_families
from microfacet._fit.moments import from_moments
from microfacet._fit.result import TableFit
from microfacet._fit.search import searches
from microfacet._fit.table_input import checked_density, checked_histogram

__all__ = ["fit_table"]

_SHAPE_STARTS = (0.355, 0.52, 0.695)  # shares of the range that is searched
_STEP = 1e-3  # of the second differences that give the standard errors

Vector = NDArray[np.float64]


def fit_table(
    *,
    histogram: tuple[ArrayLike, ArrayLike] | None = None,
    density: tuple[ArrayLike, ArrayLike] | None = None,
    mean_square_slopes: tuple[float, float] | float | None = None,
    families: Candidates = None,
    **shape: float,
) -> list[TableFit]:
    """Fit families to tabulated data, best first. Give exactly one of the three tables.

    Parameters
    ----------
    histogram : (edges, counts)
        Slopes along one axis: n + 1 ascending edges (the outer ones may be infinite), n counts. Maximum of
        the multinomial likelihood, with the family's probabilities of the bins; counts outside the edges are
        unknown.
    density : (theta, D)
        Angles from the macronormal in radians, in [0, pi/2), and D there, of any unit: the scale is free.
        Least squares of log D.
    mean_square_slopes : float or (float, float)
        Mean square slope along one axis, or along two (Cox and Munk 1954: upwind, crosswind). It fixes alpha
        alone: families with a shape parameter need its value. ggx, gtr, and student_t with gamma <= 2 have no
        finite one.
    families : str, UserFamily, RadialNDF or iterable of them, optional
        As in `fit`. By default all, for mean square slopes all that have one and whose shape is given.
    **shape : float, optional
        Shape parameters by their names for `mean_square_slopes`, such as ``gamma=3.0``.

    Returns
    -------
    list of TableFit

    Raises
    ------
    ValueError
        If there is not exactly one table, a table is malformed, or a family has no finite mean square slope.

    References
    ----------
    C. Cox & W. Munk, Measurement of the roughness of the sea surface from photographs of the sun's glitter,
    JOSA 44, 1954.

    Examples
    --------
    >>> import numpy as np
    >>> import microfacet as mf
    >>> theta = np.radians(np.arange(0, 80, 5))
    >>> table = theta, 7 * mf.ggx.D(np.cos(theta), 0.2)
    >>> best = mf.fit_table(density=table, families=["beckmann", "ggx"])[0]
    >>> best.family, round(best.params["alpha"], 4), round(best.params["scale"], 4)
    ('ggx', 0.2, 7.0)
    >>> wind = 10.0
    >>> upwind, crosswind = 0.00316 * wind, 0.003 + 0.00192 * wind
    >>> sea = mf.fit_table(mean_square_slopes=(upwind, crosswind), families="beckmann")[0]
    >>> f"{sea.params['alpha_x']:.3f}, {sea.params['alpha_y']:.3f}"
    '0.251, 0.211'
    """
    if sum(table is not None for table in (histogram, density, mean_square_slopes)) != 1:
        raise ValueError("give exactly one of histogram, density and mean_square_slopes")
    if mean_square_slopes is not None:
        return from_moments(mean_square_slopes, families, shape)
    if shape:
        raise ValueError(f"{next(iter(shape))} goes with mean_square_slopes; from other tables it is fitted")
    chosen = chosen_families(families)
    if histogram is not None:
        edges, counts = checked_histogram(*histogram)
        found = [_fit_histogram(family, edges, counts) for family in chosen]
    else:
        assert density is not None
        theta, values = checked_density(*density)
        found = [_fit_density(family, theta, values) for family in chosen]
    return sorted(found, key=lambda result: result.objective)


def _fit_histogram(family: Family, edges: Vector, counts: Vector) -> TableFit:
    total = float(counts.sum())
    inner = np.isfinite(edges)
    share = np.cumsum(np.concatenate(([0.0], counts))) / total
    middle = float(np.interp(0.5, share[inner], edges[inner]))
    low, high = np.interp([0.25, 0.75], share[inner], edges[inner])
    width = max(float(high - low) / 2, 1e-12 * (1 + abs(middle)))
    seen = counts > 0

    def loss(variables: Vector) -> float:
        alpha, shape = math.exp(variables[1]), _shape(family, variables[2:])
        below = family.kernels.slope_cdf(edges - width * variables[0] - middle, alpha, *shape)
        above = family.kernels.slope_cdf(middle + width * variables[0] - edges, alpha, *shape)
        # In the upper tail from the other side, where the difference keeps its digits.
        parts = np.where(below[1:] < 0.5, np.diff(below), -np.diff(above))[seen]
        within = below[-1] - below[0]
        if not (parts.min() > 0 and within > 0):
            return 1e3
        return float(-np.sum(counts[seen] * np.log(parts / within)) / total)

    best = _minimum(loss, family, [0.0, math.log(1.5 * width)])
    errors = _errors(loss, best.x, 1 / total)
    shape, shape_errors = _named_shape(family, best.x[2:], errors[2:])
    alpha = math.exp(best.x[1])
    params = {"alpha": alpha} | shape
    return TableFit(
        family.name,
        params | {"mean": middle + width * float(best.x[0])},
        {"alpha": alpha * errors[1]} | shape_errors | {"mean": width * errors[0]},
        float(best.fun),
        family.cls(**params),
    )


def _fit_density(family: Family, theta: Vector, values: Vector) -> TableFit:
    cosines, logs = np.cos(theta), np.log(values)

    def differences(variables: Vector) -> Vector:
        model = family.kernels.D(cosines, math.exp(variables[0]), *_shape(family, variables[1:]))
        with np.errstate(divide="ignore"):
            return np.asarray(logs - np.log(np.minimum(np.maximum(model, 1e-300), 1e300)))

    def loss(variables: Vector) -> float:
        return float(np.var(differences(variables)))

    starts = [math.log(max(float(np.tan(np.median(theta))), 1e-3)) + shift for shift in (-2.0, -1.0, 0.0)]
    found = [_minimum(loss, family, [start]) for start in starts]
    best = min(found, key=lambda one: float(one.fun))
    freedom = max(len(theta) - 1 - len(best.x), 1)
    errors = _errors(loss, best.x, 2 * float(best.fun) / freedom)
    shape, shape_errors = _named_shape(family, best.x[1:], errors[1:])
    alpha, scale = math.exp(best.x[0]), math.exp(float(np.mean(differences(best.x))))
    params = {"alpha": alpha} | shape
    return TableFit(
        family.name,
        params | {"scale": scale},
        {"alpha": alpha * errors[0]} | shape_errors,
        math.sqrt(float(best.fun)),
        family.cls(**params),
    )


def _minimum(loss: Callable[[Vector], float], family: Family, start: list[float]) -> Any:
    """The best of the minima from several shapes."""
    own = searches(family)
    shapes = [[one.at(share) for one in own] for share in (_SHAPE_STARTS if own else (0.5,))]
    found = [
        minimize(
            loss,
            np.array([*start, *shape]),
            method="Nelder-Mead",
            bounds=[(-60.0, 60.0)] * len(start) + [one.ends for one in own],
            options={"xatol": 1e-7, "fatol": 1e-14, "maxiter": 4000, "maxfev": 4000},
        )
        for shape in shapes
    ]
    return min(found, key=lambda one: float(one.fun))


def _errors(loss: Callable[[Vector], float], at: Vector, variance: float) -> list[float]:
    """Standard errors from second differences of the loss; nan where it is flat or at an end."""
    n, unit = len(at), _STEP * np.eye(len(at))
    hessian = np.empty((n, n))
    for i in range(n):
        for j in range(n):
            corners = [(s, t, loss(at + s * unit[i] + t * unit[j])) for s in (-1, 1) for t in (-1, 1)]
            hessian[i, j] = sum(s * t * value for s, t, value in corners) / (4 * _STEP**2)
    values, axes = np.linalg.eigh(hessian)
    if not values.min() > 0:
        return [math.nan] * n
    return [math.sqrt(variance * float(np.sum(axes[i] ** 2 / values))) for i in range(n)]


def _shape(family: Family, variables: Vector) -> tuple[float, ...]:
    pairs = zip(searches(family), variables.tolist(), strict=True)
    return tuple(one.shape(variable) for one, variable in pairs)


def _named_shape(
    family: Family, variables: Vector, errors: list[float]
) -> tuple[dict[str, float], dict[str, float]]:
    found = list(zip(searches(family), variables.tolist(), errors, strict=True))
    return (
        {one.parameter.name: one.shape(variable) for one, variable, _ in found},
        {one.parameter.name: one.slope(variable) * error for one, variable, error in found},
    )
