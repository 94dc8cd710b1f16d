"""Ei: names and documentation. The mathematics is ``include/microfacet/family/ei.hpp``."""

from __future__ import annotations

from microfacet._core import ei as _kernels
from microfacet._family.text import QUANTITIES, FamilyText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [*QUANTITIES, "Ei"]


class Ei(StretchedDistribution):
    """Ei slopes: Beckmann over uniformly distributed squared roughness, up to alpha^2."""

    __slots__ = ()
    kernels = _kernels


TEXT = FamilyText(
    cls=Ei,
    title="Ei",
    formulas={
        "D": "D(u) = E_1((tan(theta)/alpha)^2)/(pi alpha^2 u^4), inf at u = 1",
        "P22": "P22(p, q) = E_1((p^2 + q^2)/alpha^2)/(pi alpha^2), inf at 0",
        "P2": "P2(p) = 2 ierfc(abs(p)/alpha)/alpha,  ierfc(x) = exp(-x^2)/sqrt(pi) - x erfc(x)",
        "slope_cdf": "F(-p) = (1/2 + x^2) erfc(x) - x exp(-x^2)/sqrt(pi),  x = p/alpha > 0",
        "Lambda": (
            "Lambda(u) = exp(-x^2) (1 + x^2)/(3 sqrt(pi) x) - (3 + 2 x^2) erfc(x)/6,  x = cot(theta)/alpha"
        ),
        "survival": "T(r) = E_2(y^2) = exp(-y^2) - y^2 E_1(y^2),  y = r/alpha",
    },
    at=(0.3,),
    values=(
        0.116818,
        1.75983,
        1.94939,
        0.221206,
        0.00694124,
        0.0347062,
        0.966458,
        0.359725,
        0.155137,
        0.988179,
    ),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(TEXT)
