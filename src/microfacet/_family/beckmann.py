"""Beckmann: names and documentation. The mathematics is ``include/microfacet/family/beckmann.hpp``."""

from __future__ import annotations

from microfacet._core import beckmann as _kernels
from microfacet._family.text import QUANTITIES, FamilyText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [*QUANTITIES, "Beckmann"]


class Beckmann(StretchedDistribution):
    """Gaussian slopes."""

    __slots__ = ()
    kernels = _kernels


TEXT = FamilyText(
    cls=Beckmann,
    title="Beckmann",
    formulas={
        "D": "D(u) = exp(-tan^2(theta)/alpha^2)/(pi alpha^2 u^4)",
        "P22": "P22(p, q) = exp(-(p^2 + q^2)/alpha^2)/(pi alpha^2)",
        "P2": "P2(p) = exp(-p^2/alpha^2)/(sqrt(pi) alpha)",
        "slope_cdf": "F(p) = erfc(-p/alpha)/2",
        "sigma": (
            "sigma(u) = (u (1 + erf x) + alpha s exp(-x^2)/sqrt(pi))/2,  x = cot(theta)/alpha, s = sin(theta)"
        ),
        "Lambda": "Lambda(u) = ierfc(x)/(2 x),  x = cot(theta)/alpha",
        "survival": "T(r) = exp(-r^2/alpha^2)",
        "sample_slope": "r = alpha sqrt(-log(1 - xi))",
    },
    at=(0.3,),
    figures=((0.5,), (0.7,), (1.3,)),
    values=(
        0.397861,
        2.02924,
        1.68286,
        0.318676,
        0.0185979,
        0.0929895,
        0.914922,
        0.64118,
        0.249766,
        0.970196,
    ),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(TEXT)
