"""GGX (Trowbridge-Reitz) slopes: GTR and Student-T at gamma = 2.

Nothing is computed here. Formulas, domain and sources live in
``include/microfacet/family/ggx.hpp``; this module gives them Python names,
documentation and a frozen distribution.
"""

from __future__ import annotations

from microfacet._core import ggx as _kernels
from microfacet._docs import FamilyText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [
    "G1",
    "GGX",
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
    name="ggx",
    title="GGX",
    parameters={},
    formulas={
        "D": "D(u) = alpha^2/(pi (s^2 + alpha^2 u^2)^2),  s = sin(theta)",
        "P22": "P22(p, q) = alpha^2/(pi (alpha^2 + p^2 + q^2)^2)",
        "P2": "P2(p) = alpha^2/(2 (p^2 + alpha^2)^(3/2))",
        "slope_cdf": "F(p) = (1 + p/sqrt(p^2 + alpha^2))/2",
        "sigma": "sigma(u) = (u + sqrt(u^2 + alpha^2 s^2))/2,  s = sin(theta)",
        "Lambda": "Lambda(u) = 1/(2 x (x + sqrt(1 + x^2))),  x = cot(theta)/alpha",
        "G1": "G1(u) = u/sigma(u) = 1/(1 + Lambda(u)) for u > 0",
        "survival": "T(r) = alpha^2/(alpha^2 + r^2)",
        "sample_slope": "r = alpha sqrt(xi/(1 - xi))",
        "sample_u": "u = 1/sqrt(1 + sample_slope(xi)^2)",
    },
    arguments="0.3",
    examples={
        "D": 0.414488,
        "P22": 1.46163,
        "P2": 1.42302,
        "slope_cdf": 0.341886,
        "sigma": 0.0777639,
        "Lambda": 0.388819,
        "G1": 0.720036,
        "survival": 0.692308,
        "sample_slope": 0.3,
        "sample_u": 0.957826,
    },
    sources=(
        "T. S. Trowbridge and K. P. Reitz, Average Irregularity Representation of a Rough Surface, JOSA 1975",
        "B. Walter et al., Microfacet Models for Refraction through Rough Surfaces, EGSR 2007",
    ),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(_kernels, TEXT)


class GGX(StretchedDistribution):
    """GGX (Trowbridge-Reitz) slopes: GTR and Student-T at gamma = 2.

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
    >>> ndf = mf.GGX(alpha=0.3)
    >>> print(f"{ndf.P22(0.1, 0.2):.6g}")
    1.46163
    """

    __slots__ = ()
    family = "ggx"
    kernels = _kernels


DISTRIBUTION = GGX
