"""alpha from mean square slopes, for the families that have one."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from scipy.integrate import quad

from microfacet._family import Family
from microfacet._family import families as all_families
from microfacet._fit.estimate import Candidates, chosen_families
from microfacet._fit.result import TableFit

__all__ = ["from_moments"]


def from_moments(
    moments: tuple[float, float] | float, names: Candidates, given: Mapping[str, float]
) -> list[TableFit]:
    """The families that have these mean square slopes along one axis or two; E[p^2] = alpha^2 E[r^2]/2."""
    values = np.atleast_1d(np.asarray(moments, dtype=np.float64))
    if values.shape not in ((1,), (2,)) or not np.all((values > 0) & np.isfinite(values)):
        raise ValueError(f"mean_square_slopes must be one or two positive numbers, got {moments!r}")
    chosen, found = chosen_families(names), []
    for name in given:
        if not any(name == own.name for family in all_families() for own in family.parameters[1:]):
            raise ValueError(f"{name} is a shape parameter of no family")
    for family in chosen:
        own = [parameter.name for parameter in family.parameters[1:]]
        missing = [name for name in own if given.get(name) is None]
        shape = {name: given[name] for name in own if name not in missing}
        square = math.inf if missing else _mean_square(family, tuple(shape.values()))
        if math.isfinite(square):
            alphas = [math.sqrt(2 * value / square) for value in values]
            params = dict(
                zip(("alpha_x", "alpha_y") if len(alphas) == 2 else ("alpha",), alphas, strict=True)
            )
            found.append(TableFit(family.name, params | shape, {}, 0.0, family.cls(**params, **shape)))
        elif names is not None:
            raise ValueError(
                f"{family.name}: give {missing[0]}, which a mean square slope does not tell"
                if missing
                else f"{family.name}: its mean square slope is infinite at every alpha"
            )
    return found


def _mean_square(family: Family, shape: tuple[float, ...]) -> float:
    """E[r^2] of the standard density, the integral of 2 r survival(r); inf where its tail is too heavy."""

    def survival(radius: float) -> float:
        value = float(family.kernels.survival(radius, 1.0, *shape))
        if math.isnan(value):
            raise ValueError(f"{family.name}: its shape parameter is outside its interval, got {shape[0]:g}")
        return value

    edge, far = 1e6, 1e40
    tail = 0.0
    if survival(far) > 0:
        index = math.log(survival(edge) / survival(far)) / math.log(far / edge)
        if index < 2 + 1e-6:
            return math.inf
        tail = 2 * edge**2 * survival(edge) / (index - 2)
    body = quad(lambda t: 2 * math.exp(2 * t) * survival(math.exp(t)), -25.0, math.log(edge), limit=200)[0]
    return float(body + tail)
