"""Dirac: names and documentation. The mathematics is ``include/microfacet/family/dirac.hpp``."""

from __future__ import annotations

from microfacet._core import dirac as _kernels
from microfacet._family.text import QUANTITIES, FamilyText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [*QUANTITIES, "Dirac"]


class Dirac(StretchedDistribution):
    """A ring: all facets have the slope alpha, so that D is infinite there and 0 elsewhere."""

    __slots__ = ()
    kernels = _kernels


TEXT = FamilyText(
    cls=Dirac,
    title="Dirac",
    formulas={
        "D": "D(u) = delta(tan(theta) - alpha)/(2 pi alpha u^4): inf on the ring, else 0",
        "P22": "P22(p, q) = delta(r - alpha)/(2 pi alpha),  r^2 = p^2 + q^2: inf on the ring, else 0",
        "P2": "P2(p) = 1/(pi sqrt(alpha^2 - p^2)) for abs(p) < alpha, else 0",
        "slope_cdf": "F(-p) = acos(p/alpha)/pi for 0 <= p <= alpha, else 0",
        "Lambda": "Lambda(u) = (sqrt(1 - x^2)/x - acos(x))/pi,  x = cot(theta)/alpha < 1, else 0",
        "survival": "T(r) = 1 for r < alpha, else 0",
        "sample_slope": "alpha",
        "sample_u": "u = 1/sqrt(1 + alpha^2)",
    },
    at=(0.3,),
    figures=((0.5,), (0.6,), (1.2,)),
    values=(0.0, 0.0, 1.1254, 0.391827, 0.016206, 0.0810302, 0.925044, 1.0, 0.3, 0.957826),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(TEXT)
