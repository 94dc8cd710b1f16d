"""The ABg model fitted to a predicted BRDF."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

if TYPE_CHECKING:
    from microfacet._optics.brdf import BrdfTable

__all__ = ["AbgFit", "fit_abg", "fit_table"]

Array = NDArray[np.float64]
_LEAST_B = 1e-12  # the least that optics programs take
_LEAST = 1e-8  # of the largest value: below it walks say little
_STARTS = ((1e-4, 2.0), (1e-2, 2.0), (1e-2, 4.0), (1e-1, 3.0))


class AbgFit(NamedTuple):
    """BSDF = A/(B + x^g), x the distance of scattered from specular light in direction cosines.

    `residual` is the root mean square of log10(model/BRDF), in decades, over the directions of the table:
    0.05 is 12 %. The model knows no Fresnel reflectance, no shadowing and no off-specular peak, so a
    residual above some tenths says that the table should be used in its place.
    """

    wavelength: float
    theta_i: float
    phi_i: float
    A: float
    B: float
    g: float
    residual: float


def fit_table(table: BrdfTable) -> list[AbgFit]:
    """One fit for every wavelength and direction of light."""
    wi, wo = table.directions()
    found = []
    for k, wavelength in enumerate(table.wavelengths):
        for i, theta in enumerate(table.theta_i):
            for j, phi in enumerate(table.phi_i):
                distance = np.hypot(*np.moveaxis(wo[i, j, ..., :2] + wi[i, j, :2], -1, 0))
                fitted = fit_abg(distance.ravel(), table.values[k, i, j].ravel())
                found.append(AbgFit(float(wavelength), float(theta), float(phi), *fitted))
    return found


def fit_abg(distance: Array, values: Array) -> tuple[float, float, float, float]:
    """A, B, g and the residual, by least squares of the logarithm, in which all directions count alike.

    J. E. Harvey, Light-scattering characteristics of optical surfaces, 1976, had the form; R. N. Pfisterer,
    Approximated scatter models for stray light analysis, Optics & Photonics News 22, 2011, gives it its name
    and typical values.
    """
    seen = values > _LEAST * values.max(initial=0.0)
    x, logs = distance[seen], np.log(values[seen])
    if x.size < 4:
        return math.nan, math.nan, math.nan, math.nan
    log_x = np.log(np.maximum(x, 1e-12))

    def differences(parameters: Array) -> Array:
        log_a, log_b, g = parameters
        return np.asarray(log_a - np.logaddexp(log_b, g * log_x) - logs)

    low, high = np.array([-200.0, math.log(_LEAST_B), 0.0]), np.array([200.0, 50.0, 30.0])
    best = None
    for b, g in _STARTS:
        start = np.array([float(logs.max()) + math.log(b), math.log(b), g])
        one = least_squares(differences, start, bounds=(low, high), x_scale="jac")
        best = one if best is None or one.cost < best.cost else best
    assert best is not None
    log_a, log_b, g = best.x
    residual = math.sqrt(float(np.mean(np.square(best.fun)))) / math.log(10)
    return math.exp(log_a), math.exp(log_b), float(g), residual
