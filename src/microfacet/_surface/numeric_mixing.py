"""The law of the squared roughness of a density that states none, by expectation and maximisation.

Slopes are a mixture of Beckmann's over their squared roughness m where P22 is; the probabilities of rings
then are those of the mixture, which the iteration approaches from a broad law, so that what it finds is
smooth. W. H. Richardson, Bayesian-based iterative method of image restoration, 1972; L. B. Lucy, An iterative
technique for the rectification of observed distributions, 1974.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from microfacet._densities.standard import Standard
from microfacet._surface.checks import SurfaceError

__all__ = ["numeric_quantile"]

Vector = NDArray[np.float64]

_RINGS, _LAWS, _STEPS = 240, 160, 3000
_CLOSE = 3e-3  # largest difference of probabilities that is taken


def numeric_quantile(ndf: Any) -> Callable[[Vector], Vector]:
    """The quantile function of m; `SurfaceError` where no mixture is near the density."""
    axes = {"alpha_x": 1.0, "alpha_y": 1.0, "rotation": 0.0}
    shape = {name: value for name, value in ndf.parameters.items() if name not in axes}
    unit = ndf.with_roughness(1.0) if hasattr(ndf, "with_roughness") else type(ndf)(1.0, **shape)
    standard = Standard(lambda r: unit.P22(r, 0.0))
    ends = [float(end) for end in standard.quantile(np.array([1e-5, 1.0 - 1e-6]))]
    r = np.concatenate(([0.0], np.geomspace(ends[0], ends[1], _RINGS)))
    survival = np.append(np.concatenate(([1.0], standard.survival(r[1:]))), 0.0)
    observed = -np.diff(survival)
    m = np.square(np.geomspace(ends[0], ends[1], _LAWS))
    beyond = np.vstack((np.exp(-np.square(r)[:, np.newaxis] / m), np.zeros((1, _LAWS))))
    kernel = -np.diff(beyond, axis=0)
    law = np.full(_LAWS, 1.0 / _LAWS)
    for _ in range(_STEPS):
        law *= kernel.T @ (observed / np.maximum(kernel @ law, 1e-300))
    law /= law.sum()
    away = float(np.max(np.abs(beyond[:-1] @ law - survival[:-1])))
    if away > _CLOSE:
        raise SurfaceError(
            f"the density is no mixture of Beckmann surfaces, of which such maps are made: the nearest one "
            f"differs by {away:.2g} in probability"
        )
    share = np.cumsum(law) - 0.5 * law
    rising = np.concatenate(([True], np.diff(share) > 1e-12))
    curve = PchipInterpolator(share[rising], np.log(m[rising]))
    first, last = share[rising][0], share[rising][-1]
    return lambda u: np.asarray(np.exp(curve(np.clip(u, first, last))))
