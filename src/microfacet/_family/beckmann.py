"""Gaussian slopes.

Nothing is computed here. Formulas, domain and sources live in
``include/microfacet/family/beckmann.hpp``; this module gives them Python names,
documentation and a frozen distribution.
"""

from __future__ import annotations

from microfacet._core import beckmann as _kernels
from microfacet._docs import FamilyText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [
    "G1",
    "P2",
    "P22",
    "Beckmann",
    "D",
    "Lambda",
    "sample_slope",
    "sample_u",
    "sigma",
    "slope_cdf",
    "survival",
]

TEXT = FamilyText(
    name="beckmann",
    title="Beckmann",
    parameters={},
    formulas={
        "D": "D(u) = exp(-tan^2(theta)/alpha^2)/(pi alpha^2 u^4)",
        "P22": "P22(p, q) = exp(-(p^2 + q^2)/alpha^2)/(pi alpha^2)",
        "P2": "P2(p) = exp(-p^2/alpha^2)/(sqrt(pi) alpha)",
        "slope_cdf": "F(p) = erfc(-p/alpha)/2",
        "sigma": (
            "sigma(u) = (u (1 + erf x) + alpha s exp(-x^2)/sqrt(pi))/2,  x = cot(theta)/alpha, s = sin(theta)"
        ),
        "Lambda": "Lambda(u) = ierfc(x)/(2 x),  x = cot(theta)/alpha",
        "G1": "G1(u) = u/sigma(u) = 1/(1 + Lambda(u)) for u > 0",
        "survival": "T(r) = exp(-r^2/alpha^2)",
        "sample_slope": "r = alpha sqrt(-log(1 - xi))",
        "sample_u": "u = 1/sqrt(1 + sample_slope(xi)^2)",
    },
    arguments="0.3",
    examples={
        "D": 0.397861,
        "P22": 2.02924,
        "P2": 1.68286,
        "slope_cdf": 0.318676,
        "sigma": 0.0185979,
        "Lambda": 0.0929895,
        "G1": 0.914922,
        "survival": 0.64118,
        "sample_slope": 0.249766,
        "sample_u": 0.970196,
    },
    sources=(
        "P. Beckmann and A. Spizzichino, The Scattering of Electromagnetic Waves from Rough Surfaces, 1963",
        "B. Walter et al., Microfacet Models for Refraction through Rough Surfaces, EGSR 2007",
        "E. d'Eon, notebooks to A Hitchhiker's Guide to Multiple Scattering, 2020 (Beckmann NDF)",
    ),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(_kernels, TEXT)


class Beckmann(StretchedDistribution):
    """Gaussian slopes.

    Parameters
    ----------
    alpha : float
        Isotropic roughness, in (1e-101, 1e101); or give both of
    alpha_x, alpha_y : float
        Roughness along the two axes, in (1e-101, 1e101).
    rotation : float
        Angle of the first axis from +x (radians, counter-clockwise).

    Raises
    ------
    ValueError
        If a parameter is no number or lies outside its interval; the message names all three.

    Examples
    --------
    >>> import microfacet as mf
    >>> ndf = mf.Beckmann(alpha=0.3)
    >>> print(f"{ndf.P22(0.1, 0.2):.6g}")
    2.02924
    """

    __slots__ = ()
    family = "beckmann"
    kernels = _kernels


DISTRIBUTION = Beckmann
