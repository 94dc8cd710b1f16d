"""Erfc: names and documentation. The mathematics is ``include/microfacet/family/erfc.hpp``."""

from __future__ import annotations

from microfacet._core import erfc as _kernels
from microfacet._family.text import QUANTITIES, FamilyText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [*QUANTITIES, "Erfc"]


class Erfc(StretchedDistribution):
    """Erfc slopes: Beckmann over uniformly distributed roughness, up to alpha."""

    __slots__ = ()
    kernels = _kernels


TEXT = FamilyText(
    cls=Erfc,
    title="Erfc",
    formulas={
        "D": "D(u) = erfc(y)/(2 sqrt(pi) alpha^2 u^4 y),  y = tan(theta)/alpha, inf at u = 1",
        "P22": "P22(p, q) = erfc(r/alpha)/(2 sqrt(pi) alpha r),  r^2 = p^2 + q^2, inf at 0",
        "P2": "P2(p) = E_1((p/alpha)^2)/(2 sqrt(pi) alpha), inf at 0",
        "slope_cdf": "F(-p) = (erfc(x) - x E_1(x^2)/sqrt(pi))/2,  x = p/alpha > 0",
        "Lambda": (
            "Lambda(u) = (-2 erfc(x) + (exp(-x^2) + x^2 E_1(x^2))/(sqrt(pi) x))/4,  x = cot(theta)/alpha"
        ),
        "survival": "T(r) = sqrt(pi) ierfc(y) = exp(-y^2) - sqrt(pi) y erfc(y),  y = r/alpha",
    },
    at=(0.3,),
    values=(
        0.0663549,
        1.22725,
        1.62497,
        0.156179,
        0.00416011,
        0.0208005,
        0.979623,
        0.232596,
        0.104918,
        0.994541,
    ),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(TEXT)
