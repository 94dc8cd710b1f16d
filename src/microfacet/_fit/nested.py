"""Whether one family contains another: has the same density at some value of its shape parameters."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from microfacet._family import Family
from microfacet._fit.density import log_density
from microfacet._fit.model import ANISOTROPIC
from microfacet._fit.result import FitResult
from microfacet._fit.search import searches

__all__ = ["contained", "containment"]

_SAME = 1e-6  # largest difference of the logarithms of two densities that are one
_PROBABILITIES = np.concatenate((np.linspace(0.01, 0.99, 50), 1 - np.geomspace(1e-5, 5e-3, 10)))

Vector = NDArray[np.float64]


def containment(wide: FitResult, own: Family, narrow: FitResult, other: Family) -> tuple[str, ...]:
    """What is to be said of two fits that describe the same slopes equally well: that one of them, which has
    more shape parameters and at least the same axes, contains the other.
    """
    if len(own.parameters) <= len(other.parameters) or wide.symmetry not in (narrow.symmetry, ANISOTROPIC):
        return ()
    (start, at), names = (_of(wide, own), _of(narrow, other)), [one.name for one in own.parameters[1:]]
    shape = contained(own, start, other, at)
    if shape is None:
        return ()
    values = ", ".join(f"{name} {value:.4g}" for name, value in zip(names, shape, strict=True))
    return (f"contains {other.name}: at {values} it is the same density",)


def _of(result: FitResult, family: Family) -> tuple[float, ...]:
    """Mean roughness and shape."""
    own = (result.params[parameter.name] for parameter in family.parameters[1:])
    return (math.sqrt(math.prod(result.roughness)), *own)


def contained(
    wide: Family, start: tuple[float, ...], narrow: Family, of_narrow: tuple[float, ...]
) -> tuple[float, ...] | None:
    """The shape at which one family is another with these parameters (alpha, then the shape), or None.

    `start` are parameters of the wider family that are near, as those that were fitted to the same slopes.
    """
    radius = np.asarray(narrow.kernels.sample_slope(_PROBABILITIES, *of_narrow), dtype=np.float64)
    if not (np.isfinite(radius).all() and radius.min() > 0):
        return None
    expected = log_density(lambda r: narrow.kernels.P22(r, 0.0, *of_narrow), radius)
    own = searches(wide)
    variables = [search.variable(value) for search, value in zip(own, start[1:], strict=True)]

    def shape(at: Vector) -> tuple[float, ...]:
        return tuple(search.shape(variable) for search, variable in zip(own, at[1:].tolist(), strict=True))

    def differences(at: Vector) -> Vector:
        alpha = math.exp(at[0])
        return log_density(lambda r: wide.kernels.P22(r, 0.0, alpha, *shape(at)), radius) - expected

    ends = [(-230.0, 230.0), *(search.ends for search in own)]
    begin = np.array([math.log(start[0]), *variables])
    lower, upper = np.array(ends).T
    room = 1e-9 * (upper - lower)
    found = least_squares(
        differences, np.clip(begin, lower + room, upper - room), bounds=(lower, upper), xtol=1e-15, ftol=1e-15
    )
    return shape(found.x) if float(np.abs(found.fun).max()) < _SAME else None
