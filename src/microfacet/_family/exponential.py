"""Exponential: names and documentation. The mathematics is ``include/microfacet/family/exponential.hpp``."""

from __future__ import annotations

from microfacet._core import exponential as _kernels
from microfacet._family.text import QUANTITIES, FamilyText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [*QUANTITIES, "Exponential"]


class Exponential(StretchedDistribution):
    """Exponential slopes: a density that falls as exp(-2 slope/alpha); Bessel K at a = 3/2."""

    __slots__ = ()
    kernels = _kernels


TEXT = FamilyText(
    cls=Exponential,
    title="Exponential",
    formulas={
        "D": "D(u) = 2 exp(-2 tan(theta)/alpha)/(pi alpha^2 u^4)",
        "P22": "P22(p, q) = 2 exp(-2 r/alpha)/(pi alpha^2),  r^2 = p^2 + q^2",
        "P2": "P2(p) = 4 t K_1(2 t)/(pi alpha),  t = abs(p)/alpha",
        "slope_cdf": "F(p) of Bessel K at a = 3/2",
        "Lambda": "Lambda(u) of Bessel K at a = 3/2",
        "survival": "T(r) = (1 + 2 y) exp(-2 y),  y = r/alpha",
        "sample_slope": "alpha y, y the root of (1 + 2 y) exp(-2 y) = 1 - xi",
    },
    at=(0.3,),
    figures=((0.8,), (2.1,), (2.3,)),
    values=(0.426984, 1.59305, 1.59293, 0.310138, 0.0299954, 0.149977, 0.869582, 0.61506, 0.251752, 0.969741),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(TEXT)
