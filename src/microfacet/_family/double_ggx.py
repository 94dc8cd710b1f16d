"""Double GGX: names and documentation. The mathematics is ``include/microfacet/family/double_ggx.hpp``."""

from __future__ import annotations

from microfacet._core import double_ggx as _kernels
from microfacet._family.text import QUANTITIES, FamilyText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [*QUANTITIES, "DoubleGGX"]


class DoubleGGX(StretchedDistribution):
    """Double GGX slopes: GGX over exponentially distributed inverse squared roughness."""

    __slots__ = ()
    kernels = _kernels


_BESSEL = "z = (m/alpha)^-2/2 and modified Bessel functions K at z"

TEXT = FamilyText(
    cls=DoubleGGX,
    title="Double GGX",
    formulas={
        "D": "D(u) = P22(tan(theta), 0)/u^4",
        "P22": (
            "P22(p, q) = w^2 ((1 + w) exp(w) E_1(w) - 1)/(pi alpha^2),  w = alpha^2/(p^2 + q^2), "
            "1/(pi alpha^2) at 0"
        ),
        "P2": f"P2(p) = (z/p) exp(z) ((1 + 2 z) K_0 - 2 z K_1),  m = p, {_BESSEL}",
        "slope_cdf": f"F(-p) = (1 - z exp(z) (K_1 - K_0))/2,  m = p > 0, {_BESSEL}",
        "Lambda": f"Lambda(u) = (z exp(z) (K_0 + K_1) - 1)/2,  m = cot(theta), {_BESSEL}",
        "survival": "T(r) = w exp(w) E_1(w),  w = (alpha/r)^2",
    },
    at=(0.3,),
    values=(0.383737, 1.1021, 1.19789, 0.362631, 0.187065, 0.935327, 0.516709, 0.74208, 0.384092, 0.933509),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(TEXT)
