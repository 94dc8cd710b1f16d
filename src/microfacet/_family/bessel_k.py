"""Bessel K: names and documentation. The mathematics is ``include/microfacet/family/bessel_k.hpp``."""

from __future__ import annotations

from microfacet._core import bessel_k as _kernels
from microfacet._family.text import QUANTITIES, FamilyText, ShapeText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [*QUANTITIES, "BesselK"]


class BesselK(StretchedDistribution):
    """Bessel K slopes: Beckmann over Gamma(a, 1) distributed squared roughness; exponential tails."""

    __slots__ = ()
    kernels = _kernels

    def __init__(
        self,
        alpha: float | None = None,
        a: float | None = None,
        *,
        alpha_x: float | None = None,
        alpha_y: float | None = None,
        rotation: float = 0.0,
    ) -> None:
        self._set(alpha, alpha_x, alpha_y, rotation, a=a)


TEXT = FamilyText(
    cls=BesselK,
    title="Bessel K",
    parameters={
        "a": ShapeText(
            "Shape of the mixing distribution",
            "1 is K0. Below 1e-300 it counts as 1e-300.",
            (0.6, 1.0, 4.0),
            pictured=0.5,
        )
    },
    figures=((0.5, 1.6), (2.1, 1.5), (0.7, 1.3)),
    formulas={
        "D": (
            "D(u) = 2 y^(a-1) K_{a-1}(2 y)/(pi alpha^2 Gamma(a) u^4),  y = tan(theta)/alpha, inf at u "
            "= 1 for a <= 1"
        ),
        "P22": (
            "P22(p, q) = 2 y^(a-1) K_{a-1}(2 y)/(pi alpha^2 Gamma(a)),  y^2 = (p^2 + q^2)/alpha^2, inf "
            "at 0 for a <= 1"
        ),
        "P2": (
            "P2(p) = 2 t^(a-1/2) K_{a-1/2}(2 t)/(sqrt(pi) alpha Gamma(a)),  t = abs(p)/alpha, inf at 0 "
            "for a <= 1/2"
        ),
        "slope_cdf": "F(p) = average of Beckmann's F(p/sqrt(b)) over b ~ Gamma(a, 1)",
        "Lambda": (
            "Lambda(u) = average of Beckmann's Lambda(x/sqrt(b)) over b ~ Gamma(a, 1),  x = cot(theta)/alpha"
        ),
        "survival": "T(r) = 2 y^a K_a(2 y)/Gamma(a),  y = r/alpha",
    },
    at=(0.3, 1.5),
    values=(0.426984, 1.59305, 1.59293, 0.310138, 0.0299954, 0.149977, 0.869582, 0.61506, 0.251752, 0.969741),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(TEXT)
