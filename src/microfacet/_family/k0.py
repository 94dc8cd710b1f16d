"""K0: names and documentation. The mathematics is ``include/microfacet/family/k0.hpp``."""

from __future__ import annotations

from microfacet._core import k0 as _kernels
from microfacet._family.text import QUANTITIES, FamilyText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [*QUANTITIES, "K0"]


class K0(StretchedDistribution):
    """K0 slopes: Beckmann over exponentially distributed squared roughness; Bessel K at a = 1."""

    __slots__ = ()
    kernels = _kernels


TEXT = FamilyText(
    cls=K0,
    title="K0",
    formulas={
        "D": "D(u) = 2 K_0(2 tan(theta)/alpha)/(pi alpha^2 u^4), inf at u = 1",
        "P22": "P22(p, q) = 2 K_0(2 r/alpha)/(pi alpha^2),  r^2 = p^2 + q^2, inf at 0",
        "P2": "P2(p) = exp(-2 abs(p)/alpha)/alpha",
        "slope_cdf": "F(-p) = exp(-2 p/alpha)/2 for p > 0",
        "sigma": "sigma(u) = max(u, 0) + (alpha s/4) exp(-2 abs(u)/(alpha s)),  s = sin(theta)",
        "Lambda": "Lambda(u) = exp(-2 x)/(4 x),  x = cot(theta)/alpha",
        "survival": "T(r) = 2 y K_1(2 y),  y = r/alpha",
    },
    at=(0.3,),
    figures=((0.5,), (0.8,), (1.7,)),
    values=(
        0.287843,
        1.53071,
        1.71139,
        0.256709,
        0.018845,
        0.0942252,
        0.913889,
        0.472369,
        0.188573,
        0.982681,
    ),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(TEXT)
