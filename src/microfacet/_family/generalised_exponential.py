"""Generalised exponential: names and documentation.

The mathematics is ``include/microfacet/family/generalised_exponential.hpp``.
"""

from __future__ import annotations

from microfacet._core import generalised_exponential as _kernels
from microfacet._family.text import QUANTITIES, FamilyText, ShapeText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [*QUANTITIES, "GeneralisedExponential"]


class GeneralisedExponential(StretchedDistribution):
    """Generalised exponential slopes: exp(-(slope/alpha)^g), through Beckmann (g = 2) to a blunt top."""

    __slots__ = ()
    kernels = _kernels

    def __init__(
        self,
        alpha: float | None = None,
        g: float | None = None,
        *,
        alpha_x: float | None = None,
        alpha_y: float | None = None,
        rotation: float = 0.0,
    ) -> None:
        self._set(alpha, alpha_x, alpha_y, rotation, g=g)


TEXT = FamilyText(
    cls=GeneralisedExponential,
    title="Generalised exponential",
    parameters={
        "g": ShapeText(
            "Power of the slope in the exponent",
            "1 is Exponential at twice the alpha, 2 is Beckmann.",
            (0.6, 1.5, 4.0),
        )
    },
    figures=((0.5, 1.5), (0.7, 0.8), (1.2, 4.0)),
    formulas={
        "D": "D(u) = exp(-y^g)/(pi alpha^2 Gamma(1 + 2/g) u^4),  y = tan(theta)/alpha",
        "P22": "P22(p, q) = exp(-y^g)/(pi alpha^2 Gamma(1 + 2/g)),  y^2 = (p^2 + q^2)/alpha^2",
        "survival": "T(r) = Q(2/g, (r/alpha)^g),  the regularised upper incomplete Gamma function",
        "sample_slope": "alpha z^(1/g), z the root of Q(2/g, z) = 1 - xi",
    },
    at=(0.3, 1.5),
    values=(0.582115, 1.56085, 1.43325, 0.345434, 0.0352666, 0.176333, 0.850099, 0.72348, 0.30374, 0.956836),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(TEXT)
