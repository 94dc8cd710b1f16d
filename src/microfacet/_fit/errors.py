"""Parameters of the frozen distribution, their standard errors, and how much the slopes know."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._fit import blocks
from microfacet._fit.model import ANISOTROPIC, Model, State
from microfacet._fit.newton import Maximum

__all__ = ["Uncertainty", "azimuth_of_x", "jacobian", "parameters", "uncertainty"]

Vector = NDArray[np.float64]


class Uncertainty(NamedTuple):
    """Standard errors by parameter, the share of the slopes that is effectively independent, remarks."""

    errors: dict[str, float]
    independent_share: float
    notes: tuple[str, ...]


def parameters(model: Model, state: State) -> dict[str, float]:
    """The parameters of the frozen distribution."""
    names = [parameter.name for parameter in model.family.parameters[1:]]
    shape = dict(zip(names, model.shape(state), strict=True))
    if model.symmetry != ANISOTROPIC:
        return {"alpha": _alpha(model, state)} | shape
    squares, axes = _axes(model, state)
    rotation = math.atan(axes[1, 0] / axes[0, 0])
    alpha_x, alpha_y = (float(value) for value in np.sqrt(squares))
    return {"alpha_x": alpha_x, "alpha_y": alpha_y, "rotation": rotation} | shape


def uncertainty(model: Model, found: Maximum) -> Uncertainty:
    """H^-1 J H^-1 taken to the parameters, with the observed information H and the covariance J of the score:
    of its total over the map where the slopes depend on each other (`blocks.variances`). P. J. Huber, The
    behavior of maximum likelihood estimates under nonstandard conditions, 1967.
    """
    names = list(parameters(model, found.state))
    free = found.free
    inner = np.ix_(free, free)
    information = -found.sums.hessian.sum(axis=0)[inner]
    try:
        inverse = np.linalg.inv(information)
    except np.linalg.LinAlgError:
        return Uncertainty(
            dict.fromkeys(names, math.nan), 1.0, ("the likelihood is flat: no standard errors",)
        )
    ways = jacobian(model, found.state)
    alone = np.zeros((model.size, model.size))
    alone[inner] = inverse @ found.sums.squares[inner] @ inverse
    with np.errstate(invalid="ignore"):
        errors = np.sqrt(np.einsum("ij,jk,ik->i", ways, alone, ways))
    share = 1.0
    if model.slopes.on_map:
        score = found.sums.gradient[:, free]
        influence = blocks.variances(score @ (ways[:, free] @ inverse).T, True, model.slopes.shape)
        # Dependence of neighbours never adds information: less than without it is luck, or there are fewer
        # slopes than cells.
        errors = np.maximum(errors, [one.error for one in influence])
        values, axes = np.linalg.eigh(inverse)
        together = blocks.variances(score @ axes, True, model.slopes.shape)
        total = sum(value * one.variance for value, one in zip(values, together, strict=True))
        share = min(float(np.trace(inverse @ found.sums.squares[inner]) / max(total, 1e-300)), 1.0)
    first = model.first_shape
    errors[first:][~free[first:]] = math.nan
    return Uncertainty(dict(zip(names, map(float, errors), strict=True)), share, ())


def _alpha(model: Model, state: State) -> float:
    """The one roughness of an isotropic density, of which slopes are stretched or alpha is free."""
    stretch = math.sqrt(abs(np.linalg.det(model.slopes.stretch @ np.linalg.inv(state.inverse))))
    return stretch if model.stretched else math.exp(state.log_alpha)


def azimuth_of_x(model: Model, state: State) -> float:
    """Twice the azimuth, in standard space, of slopes along the axis of alpha_x."""
    if model.symmetry != ANISOTROPIC:
        return 0.0
    x, y = state.inverse @ np.linalg.solve(model.slopes.stretch, _axes(model, state)[1][:, 0])
    return 2 * math.atan2(y, x)


def _axes(model: Model, state: State) -> tuple[Vector, Vector]:
    """Squares of alpha_x and alpha_y and, as columns, their axes: the density depends on A A^T alone."""
    a = model.slopes.stretch @ np.linalg.inv(state.inverse)
    squares, axes = np.linalg.eigh(a @ a.T)
    # Of the two ways to name the axes, the one that leaves alpha_x nearest to the x axis.
    order = [1, 0] if abs(axes[0, 1]) > abs(axes[0, 0]) else [0, 1]
    return squares[order], axes[:, order]


def jacobian(model: Model, state: State) -> Vector:
    """Derivatives of the parameters by the tangent coordinates; of eigenvalues and axes by perturbation
    theory.
    """
    result = np.zeros((model.size, model.size))
    shapes = zip(model.searches, state.shapes, strict=True)
    for number, (search, variable) in enumerate(shapes, model.first_shape):
        result[number, number] = search.slope(variable)
    if model.symmetry != ANISOTROPIC:
        result[0, 0] = _alpha(model, state)
        return result
    squares, axes = _axes(model, state)
    a = model.slopes.stretch @ np.linalg.inv(state.inverse)
    changes = np.array([[[1, 0], [0, 1]], [[1, 0], [0, -1]], [[0, 1], [1, 0]]], dtype=np.float64)
    for column, change in enumerate(changes):
        turned = axes.T @ (2 * a @ change @ a.T) @ axes
        for row in range(2):
            result[row, column] = turned[row, row] / (2 * math.sqrt(squares[row]))
        gap = squares[0] - squares[1]
        # The axes of a round density are anywhere: a large number, which `rotation` then has as its error.
        result[2, column] = turned[0, 1] / (gap if abs(gap) > 1e-12 * squares[0] else 1e-12 * squares[0])
    return result
