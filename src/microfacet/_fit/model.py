"""The likelihood of slopes under one family, as a smooth function of unconstrained variables.

No density is written here: ``P22`` of the family's kernels is evaluated in standard space, and stretched.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from microfacet._family import Family
from microfacet._fit.slopes import Slopes

__all__ = ["Model", "model_of"]

Vector = NDArray[np.float64]
# A shape parameter is searched in [lower + 0.01, lower + 150]: beyond, every family is at its limit for
# practical purposes (Beckmann for large gamma and a).
_SHAPE_RANGE = (math.log(0.01), math.log(150.0))
_MEDIAN_RANGE = (-20.0, 20.0)
_STRETCH_RANGE = (-4.0, 4.0)
_LOG_ALPHA_RANGE = (-20.0, 20.0)
_SMALLEST = 1e-280  # below, the density is about to underflow
# Step of central differences in logarithmic variables: truncation about 1e-8, the kernels' rounding less.
_STEP = 1e-4


def model_of(family: Family, slopes: Slopes) -> Model:
    return Stretched(family, slopes) if family.anisotropic else Isotropic(family, slopes)


class Model(ABC):
    """One family and one sample of slopes.

    The first variable is not the logarithm of alpha but that of the median slope (relative to the sample's),
    which the data fix whatever the shape parameter is; the last is log(shape - lower) if there is a shape.
    """

    def __init__(self, family: Family, slopes: Slopes) -> None:
        self._family, self._slopes = family, slopes

    @property
    @abstractmethod
    def bounds(self) -> list[tuple[float, float]]:
        """Of the variables: wide, they only keep a search from running away."""

    @abstractmethod
    def mean_log_density(self, variables: Vector) -> float:
        """The log-likelihood per slope."""

    @abstractmethod
    def gradient(self, variables: Vector) -> Vector:
        """Its derivatives by the variables."""

    @abstractmethod
    def parameters(self, variables: Vector) -> dict[str, float]:
        """The parameters of the frozen distribution."""

    def start(self, shape: float | None) -> Vector:
        """Variables that give the slopes their median and anisotropy, for a given shape parameter."""
        variables = np.zeros(len(self.bounds))
        if shape is not None:
            variables[-1] = math.log(shape - self._family.parameters[1].lower)
        return variables

    def _shape_bounds(self) -> list[tuple[float, float]]:
        return [_SHAPE_RANGE for _ in self._family.parameters[1:]]

    def _shape(self, variables: Vector) -> tuple[float, ...]:
        return tuple(parameter.lower + math.exp(variables[-1]) for parameter in self._family.parameters[1:])

    def _named_shape(self, variables: Vector) -> dict[str, float]:
        names = (parameter.name for parameter in self._family.parameters[1:])
        return dict(zip(names, self._shape(variables), strict=True))

    def _difference(self, variables: Vector, index: int) -> float:
        """The derivative by one variable, as a central difference."""
        step = np.zeros(len(variables))
        step[index] = _STEP
        return (self.mean_log_density(variables + step) - self.mean_log_density(variables - step)) / (
            2 * _STEP
        )


class Stretched(Model):
    """Families that a linear map stretches: P22(p, q) = P22_standard(A^-1 (p, q)) / det A.

    On whitened slopes A is close to the unit matrix. It is symmetric and positive, and its logarithm
    ((s + d, e), (e, s - d)) is unconstrained and, unlike an angle, smooth where the roughness is isotropic.
    Variables: (log median, d, e[, log(shape - lower)]).
    """

    @property
    def bounds(self) -> list[tuple[float, float]]:
        return [_MEDIAN_RANGE, _STRETCH_RANGE, _STRETCH_RANGE, *self._shape_bounds()]

    def mean_log_density(self, variables: Vector) -> float:
        mean = float(np.mean(self._log_density(variables, self._radius(variables))))
        return mean - 2 * self._scale(variables) - math.log(abs(np.linalg.det(self._slopes.stretch)))

    def gradient(self, variables: Vector) -> Vector:
        radius = self._radius(variables)
        forward = self._log_density(variables, radius * math.exp(_STEP))
        steepness = (forward - self._log_density(variables, radius * math.exp(-_STEP))) / (2 * _STEP)
        gradient = [-float(np.mean(steepness)) - 2]  # the radius is proportional to exp(-s)
        gradient += [float(np.mean(steepness * change)) for change in self._log_radius_changes(variables)]
        gradient += [self._difference(variables, 3) for _ in self._family.parameters[1:]]
        return np.array(gradient)

    def parameters(self, variables: Vector) -> dict[str, float]:
        even, odd, _ = _hyperbolic(variables)
        _, d, e = variables[:3]
        remaining = np.array([[even + odd * d, odd * e], [odd * e, even - odd * d]])
        # The density depends on A A^T alone: exp(2s) W exp(2 log A) W, with the whitening W.
        squares, axes = np.linalg.eigh(self._slopes.stretch @ remaining @ self._slopes.stretch)
        alphas = math.exp(self._scale(variables)) * np.sqrt(squares)
        # Of the two ways to name the axes, the one that leaves alpha_x nearest to the x axis.
        x = int(abs(axes[0, 1]) > abs(axes[0, 0]))
        rotation = math.atan(axes[1, x] / axes[0, x])
        named = {"alpha_x": float(alphas[x]), "alpha_y": float(alphas[1 - x]), "rotation": rotation}
        return named | self._named_shape(variables)

    def _scale(self, variables: Vector) -> float:
        """s: the logarithm of the wanted median over that of the standard density."""
        median = self._family.kernels.sample_slope(0.5, 1.0, *self._shape(variables))
        return float(variables[0]) - math.log(float(median))

    def _log_density(self, variables: Vector, radius: Vector) -> Vector:
        kernels, shape = self._family.kernels, self._shape(variables)
        return _log(lambda r: kernels.P22(r, 0.0, 1.0, *shape), radius)

    def _radius(self, variables: Vector) -> Vector:
        """Lengths of A^-1 (p, q), from A^-2 = exp(-2s) (cosh(2m) I - sinh(2m)/m ((d, e), (e, -d)))."""
        radius = math.exp(-self._scale(variables)) * np.sqrt(self._unscaled(variables))
        return np.maximum(radius, 1e-12)  # positive but for rounding: slopes.py leaves no slope at zero

    def _unscaled(self, variables: Vector) -> Vector:
        even, odd, _ = _hyperbolic(variables)
        _, d, e = variables[:3]
        data = self._slopes
        unscaled: Vector = even * data.sum_ - odd * (d * data.difference + e * data.product)
        return np.maximum(unscaled, 1e-30)

    def _log_radius_changes(self, variables: Vector) -> tuple[Vector, Vector]:
        """Derivatives of log(radius) by d and e."""
        _, odd, odd_change = _hyperbolic(variables)
        _, d, e = variables[:3]
        data, twice = self._slopes, 2 * self._unscaled(variables)
        common = 2 * odd * data.sum_ - odd_change * (d * data.difference + e * data.product)
        return (d * common - odd * data.difference) / twice, (e * common - odd * data.product) / twice


class Isotropic(Model):
    """Families in which alpha is no stretch (GTR). Variables: (log median[, log(shape - lower)])."""

    @property
    def bounds(self) -> list[tuple[float, float]]:
        return [_MEDIAN_RANGE, *self._shape_bounds()]

    def mean_log_density(self, variables: Vector) -> float:
        alpha, shape, kernels = self._alpha(variables), self._shape(variables), self._family.kernels
        return float(np.mean(_log(lambda r: kernels.P22(r, 0.0, alpha, *shape), self._slopes.radius)))

    def gradient(self, variables: Vector) -> Vector:
        return np.array([self._difference(variables, index) for index in range(len(variables))])

    def parameters(self, variables: Vector) -> dict[str, float]:
        return {"alpha": self._alpha(variables)} | self._named_shape(variables)

    def _alpha(self, variables: Vector) -> float:
        """alpha from the median slope, which grows with it."""
        shape = self._shape(variables)
        median = float(variables[0]) + math.log(float(np.median(self._slopes.radius)))

        def excess(log_alpha: float) -> float:
            slope = float(self._family.kernels.sample_slope(0.5, math.exp(log_alpha), *shape))
            return math.log(min(max(slope, 1e-300), 1e300)) - median

        low = high = median
        while excess(low) > 0 and low > _LOG_ALPHA_RANGE[0]:
            low -= 1.0
        while excess(high) < 0 and high < _LOG_ALPHA_RANGE[1]:
            high += 1.0
        if not excess(low) <= 0 <= excess(high):  # GTR for gamma < 1: no alpha has so small a median
            return math.exp(low)
        return math.exp(brentq(excess, low, high, xtol=1e-14))


def _hyperbolic(variables: Vector) -> tuple[float, float, float]:
    """cosh(2m), sinh(2m)/m and, with its derivative by m, (2 cosh(2m) - sinh(2m)/m)/m^2, m = hypot(d, e)."""
    m = math.hypot(variables[1], variables[2])
    even = math.cosh(2 * m)
    odd = math.sinh(2 * m) / m if m > 0 else 2.0
    # The difference cancels for small m, where its series begins 8/3 + 16/15 m^2.
    return even, odd, (2 * even - odd) / m**2 if m > 0.01 else 8 / 3 + 16 / 15 * m**2


def _log(density: Callable[[Vector], Vector], radius: Vector) -> Vector:
    """log density(radius), also where the density underflows (outliers under a family with light tails).

    There, the logarithm is continued by the parabola through three points short of the underflow. That is
    exact for Beckmann (-r^2) and close for exponential tails; power laws do not fall so far.
    """
    values = density(radius)
    if values.min() > _SMALLEST:
        return np.log(values)
    low, high = math.log(radius.min()), math.log(radius.max())
    for _ in range(60):
        middle = (low + high) / 2
        fine = density(np.array([math.exp(middle)]))[0] > _SMALLEST
        low, high = (middle, high) if fine else (low, middle)
    edge = math.exp(low)
    nodes = density(edge * np.array([0.5, 0.75, 1.0]))
    if not nodes.min() > 0:  # nothing of the sample lies where this density does
        return np.full_like(radius, -1e9)
    y0, y1, y2 = np.log(nodes)
    curvature = min(y2 - 2 * y1 + y0, 0.0)
    steps = (radius - edge) / (edge / 4)
    continued = y2 + steps * (y2 - y1) + curvature * steps * (steps + 1) / 2
    with np.errstate(divide="ignore"):
        return np.where(radius <= edge, np.log(values), continued)
