"""GTR: names and documentation. The mathematics is ``include/microfacet/family/gtr.hpp``."""

from __future__ import annotations

from microfacet._core import gtr as _kernels
from microfacet._family.text import QUANTITIES, FamilyText, ShapeText, documented
from microfacet._frozen import IsotropicDistribution

__all__ = [*QUANTITIES, "GTR"]


class GTR(IsotropicDistribution):
    """Generalised Trowbridge-Reitz: exponent gamma, GGX at 2; isotropic, since alpha is no stretch."""

    __slots__ = ()
    kernels = _kernels

    def __init__(self, alpha: float, gamma: float) -> None:
        self._set(alpha, gamma=gamma)


TEXT = FamilyText(
    cls=GTR,
    title="GTR",
    parameters={
        "gamma": ShapeText(
            "Exponent", "2 is GGX. gamma = 1 and alpha = 1, the sphere, are exact.", (1.0, 1.5, 3.0)
        )
    },
    figures=((0.5, 1.5), (0.1, 1.0), (0.2, 1.0)),
    formulas={
        "D": (
            "D(u) = C (1 + u^2 (alpha^2 - 1))^-gamma,  C = (gamma-1) (alpha^2-1)/(pi (1 - alpha^(2-2 gamma)))"
        ),
        "P22": "P22(p, q) = C (1 + r^2)^(gamma-2) (r^2 + alpha^2)^-gamma,  r^2 = p^2 + q^2",
        "survival": "T(r) = (w^(gamma-1) - 1)/(alpha^(2-2 gamma) - 1),  w = (1 + r^2)/(alpha^2 + r^2)",
        "sample_slope": (
            "u^2 = (1 - v^(1/(1-gamma)))/(1 - alpha^2),  v = 1 + (1 - xi) (alpha^(2-2 gamma) - 1)"
        ),
    },
    at=(0.3, 1.5),
    values=(0.460467, 1.15637, 1.16293, 0.374536, 0.129402, 0.647012, 0.60716, 0.783612, 0.395368, 0.929955),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(TEXT)
