"""Generalised Trowbridge-Reitz: exponent gamma, GGX at 2; isotropic, since alpha is no stretch.

Nothing is computed here. Formulas, domain and sources live in
``include/microfacet/family/gtr.hpp``; this module gives them Python names,
documentation and a frozen distribution.
"""

from __future__ import annotations

from microfacet._core import gtr as _kernels
from microfacet._docs import FamilyText, documented
from microfacet._frozen import IsotropicDistribution

__all__ = [
    "G1",
    "GTR",
    "P2",
    "P22",
    "D",
    "Lambda",
    "sample_slope",
    "sample_u",
    "sigma",
    "slope_cdf",
    "survival",
]

TEXT = FamilyText(
    name="gtr",
    title="GTR",
    parameters={
        "gamma": "Exponent (dimensionless), in (0, 1e100); 2 is GGX. gamma = 1, alpha = 1 are exact.",
    },
    formulas={
        "D": (
            "D(u) = C (1 + u^2 (alpha^2 - 1))^-gamma,  C = (gamma-1) (alpha^2-1)/(pi (1 - alpha^(2-2 gamma)))"
        ),
        "P22": "P22(p, q) = C (1 + r^2)^(gamma-2) (r^2 + alpha^2)^-gamma,  r^2 = p^2 + q^2",
        "P2": "P2(p) = integral of P22(p, q) over q",
        "slope_cdf": "F(-p) = (1/pi) integral over t > 0 of T(p cosh t)/cosh t,  T = survival",
        "sigma": "sigma(u) = max(u, 0) + abs(u) Lambda(abs(u))",
        "Lambda": (
            "Lambda(u) = (1/pi) integral over t > 0 of T(cot(theta) cosh t) sinh^2(t)/cosh(t),  T = survival"
        ),
        "G1": "G1(u) = u/sigma(u) = 1/(1 + Lambda(u)) for u > 0",
        "survival": "T(r) = (w^(gamma-1) - 1)/(alpha^(2-2 gamma) - 1),  w = (1 + r^2)/(alpha^2 + r^2)",
        "sample_slope": (
            "u^2 = (1 - v^(1/(1-gamma)))/(1 - alpha^2),  v = 1 + (1 - xi) (alpha^(2-2 gamma) - 1)"
        ),
        "sample_u": "u = 1/sqrt(1 + sample_slope(xi)^2)",
    },
    arguments="0.3, 1.5",
    examples={
        "D": 0.460467,
        "P22": 1.15637,
        "P2": 1.16293,
        "slope_cdf": 0.374536,
        "sigma": 0.129402,
        "Lambda": 0.647012,
        "G1": 0.60716,
        "survival": 0.783612,
        "sample_slope": 0.395368,
        "sample_u": 0.929955,
    },
    sources=(
        "B. Burley, Physically Based Shading at Disney, SIGGRAPH 2012 course",
        "E. d'Eon, notebooks to A Hitchhiker's Guide to Multiple Scattering, 2020 (GTR NDF)",
    ),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(_kernels, TEXT)


class GTR(IsotropicDistribution):
    """Generalised Trowbridge-Reitz: exponent gamma, GGX at 2; isotropic, since alpha is no stretch.

    Parameters
    ----------
    alpha : float
        Roughness, in (1e-101, 1e101); 1 is the sphere.
    gamma : float
        Exponent, in (0, 1e100); 2 is GGX.

    Raises
    ------
    ValueError
        If a parameter is no number or lies outside its interval; the message names all three.

    Examples
    --------
    >>> import microfacet as mf
    >>> ndf = mf.GTR(alpha=0.3, gamma=1.5)
    >>> print(f"{ndf.P22(0.1, 0.2):.6g}")
    1.15637
    """

    __slots__ = ()
    family = "gtr"
    kernels = _kernels

    def __init__(self, alpha: float, gamma: float) -> None:
        self._set(alpha, gamma=gamma)


DISTRIBUTION = GTR
