"""GGX: names and documentation. The mathematics is ``include/microfacet/family/ggx.hpp``."""

from __future__ import annotations

from microfacet._core import ggx as _kernels
from microfacet._family.text import QUANTITIES, FamilyText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [*QUANTITIES, "GGX"]


class GGX(StretchedDistribution):
    """GGX (Trowbridge-Reitz) slopes: GTR and Student-T at gamma = 2."""

    __slots__ = ()
    kernels = _kernels


TEXT = FamilyText(
    cls=GGX,
    title="GGX",
    formulas={
        "D": "D(u) = alpha^2/(pi (s^2 + alpha^2 u^2)^2),  s = sin(theta)",
        "P22": "P22(p, q) = alpha^2/(pi (alpha^2 + p^2 + q^2)^2)",
        "P2": "P2(p) = alpha^2/(2 (p^2 + alpha^2)^(3/2))",
        "slope_cdf": "F(p) = (1 + p/sqrt(p^2 + alpha^2))/2",
        "sigma": "sigma(u) = (u + sqrt(u^2 + alpha^2 s^2))/2,  s = sin(theta)",
        "Lambda": "Lambda(u) = 1/(2 x (x + sqrt(1 + x^2))),  x = cot(theta)/alpha",
        "survival": "T(r) = alpha^2/(alpha^2 + r^2)",
        "sample_slope": "r = alpha sqrt(xi/(1 - xi))",
    },
    at=(0.3,),
    figures=((0.5,), (0.2,), (0.6,)),
    values=(0.414488, 1.46163, 1.42302, 0.341886, 0.0777639, 0.388819, 0.720036, 0.692308, 0.3, 0.957826),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(TEXT)
