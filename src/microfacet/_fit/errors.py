"""Parameters of the frozen distribution, their standard errors, and how much the slopes know."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._fit import blocks
from microfacet._fit.model import Model, State
from microfacet._fit.newton import Maximum

__all__ = ["Uncertainty", "azimuth_of_x", "parameters", "uncertainty"]

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
    if not model.stretched:
        return {"alpha": math.exp(state.log_alpha)} | shape
    squares, axes = _axes(model, state)
    rotation = math.atan(axes[1, 0] / axes[0, 0])
    alpha_x, alpha_y = (float(value) for value in np.sqrt(squares))
    return {"alpha_x": alpha_x, "alpha_y": alpha_y, "rotation": rotation} | shape


def uncertainty(model: Model, found: Maximum) -> Uncertainty:
    """H^-1 J H^-1 in tangent coordinates, taken to the parameters (P. J. Huber, The behavior of maximum
    likelihood estimates under nonstandard conditions, 1967; J by `blocks.scatter` where the slopes depend on
    each other).
    """
    names = list(parameters(model, found.state))
    free = found.free
    inner = np.ix_(free, free)
    information = -found.sums.hessian.sum(axis=0)[inner]
    alone = found.sums.squares[inner]
    try:
        inverse = np.linalg.inv(information)
    except np.linalg.LinAlgError:
        return Uncertainty(
            dict.fromkeys(names, math.nan), 1.0, ("the likelihood is flat: no standard errors",)
        )
    together, share, notes = alone, 1.0, tuple[str, ...]()
    if model.slopes.on_map:
        sums = found.sums.gradient[:, free]
        together = blocks.scatter(sums, True)
        share = float(np.trace(inverse @ alone) / max(np.trace(inverse @ together), 1e-300))
        # Fewer slopes than there are cells, or luck: dependence of neighbours never adds information.
        share, together = (1.0, alone) if share > 1 else (share, together)
        if blocks.neighbouring_tiles(sums) > 0.5:
            notes = ("slopes depend on each other over more than a tenth of the map: errors are too small",)
    covariance = np.zeros((model.size, model.size))
    covariance[inner] = inverse @ together @ inverse
    jacobian = _jacobian(model, found.state)
    with np.errstate(invalid="ignore"):
        errors = np.sqrt(np.einsum("ij,jk,ik->i", jacobian, covariance, jacobian))
    first = model.size - len(model.searches)
    errors[first:][~free[first:]] = math.nan
    return Uncertainty(dict(zip(names, map(float, errors), strict=True)), share, notes)


def azimuth_of_x(model: Model, state: State) -> float:
    """Twice the azimuth, in standard space, of slopes along the axis of alpha_x."""
    if not model.stretched:
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


def _jacobian(model: Model, state: State) -> Vector:
    """Derivatives of the parameters by the tangent coordinates; of eigenvalues and axes by perturbation
    theory.
    """
    result = np.zeros((model.size, model.size))
    first = model.size - len(model.searches)
    for number, (search, variable) in enumerate(zip(model.searches, state.shapes, strict=True), first):
        result[number, number] = search.slope(variable)
    if not model.stretched:
        result[0, 0] = math.exp(state.log_alpha)
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
