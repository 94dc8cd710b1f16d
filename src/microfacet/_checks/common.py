"""Checks that need nothing but the density itself: of a family that has no statements of its own."""

from __future__ import annotations

from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np

from microfacet._checks import integrals
from microfacet._checks.check import Check
from microfacet._checks.routes import Array
from microfacet._family import Family

__all__ = ["table"]

_ALPHAS = (1e-2, 0.1, 0.5, 1.0, 3.0)


def table(family: Family) -> Any:
    """What a module of checks of this family would hold: CHECKS and GRID."""
    names = [parameter.name for parameter in family.parameters]
    points = ((alpha, *shape) for alpha, shape in product(_ALPHAS, family.shapes))
    grid = tuple(dict(zip(names, point, strict=True)) for point in points)
    return SimpleNamespace(FAMILY=family.name, GRID=grid, CHECKS=() if family.singular else _checks(family))


def _checks(family: Family) -> tuple[Check, ...]:
    names = [parameter.name for parameter in family.parameters]

    def peak(*parameters: float) -> str:
        finite = np.isfinite(family.kernels.P22(0.0, 0.0, *parameters))
        return "" if finite else "the density is infinite at the normal, and cosines do not resolve that"

    def draw(rng: np.random.Generator, n: int, *parameters: float) -> Array:
        return np.asarray(1 / np.hypot(1.0, family.kernels.sample_slope(rng.random(n), *parameters)))

    entry: dict[str, Any] = {
        "parameters": dict(zip(names, family.figures[0], strict=True)),
        "source": "definition",
        "notebook": False,
    }
    seen = entry | {"unless": peak}
    drawn = r"u = \frac{1}{\sqrt{1 + r^2}}, \quad \Pr(\tan\theta > r) = 1 - \xi"
    return (
        integrals.normalization(**seen),
        integrals.slopes_normalized(**entry),
        integrals.lambda_from_marginal(**entry),
        integrals.sigma_delta(**seen),
        integrals.sampling(draw, drawn, **seen),
    )
