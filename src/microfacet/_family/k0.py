"""K0 slopes: Beckmann over exponentially distributed squared roughness; Bessel K at a = 1.

Nothing is computed here. Formulas, domain and sources live in
``include/microfacet/family/k0.hpp``; this module gives them Python names,
documentation and a frozen distribution.
"""

from __future__ import annotations

from microfacet._core import k0 as _kernels
from microfacet._docs import FamilyText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [
    "G1",
    "K0",
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
    name="k0",
    title="K0",
    parameters={},
    formulas={
        "D": "D(u) = 2 K_0(2 tan(theta)/alpha)/(pi alpha^2 u^4), inf at u = 1",
        "P22": "P22(p, q) = 2 K_0(2 r/alpha)/(pi alpha^2),  r^2 = p^2 + q^2, inf at 0",
        "P2": "P2(p) = exp(-2 abs(p)/alpha)/alpha",
        "slope_cdf": "F(-p) = exp(-2 p/alpha)/2 for p > 0",
        "sigma": "sigma(u) = max(u, 0) + (alpha s/4) exp(-2 abs(u)/(alpha s)),  s = sin(theta)",
        "Lambda": "Lambda(u) = exp(-2 x)/(4 x),  x = cot(theta)/alpha",
        "G1": "G1(u) = u/sigma(u) = 1/(1 + Lambda(u)) for u > 0",
        "survival": "T(r) = 2 y K_1(2 y),  y = r/alpha",
        "sample_slope": "the root of T(r) = 1 - xi",
        "sample_u": "u = 1/sqrt(1 + sample_slope(xi)^2)",
    },
    arguments="0.3",
    examples={
        "D": 0.287843,
        "P22": 1.53071,
        "P2": 1.71139,
        "slope_cdf": 0.256709,
        "sigma": 0.018845,
        "Lambda": 0.0942252,
        "G1": 0.913889,
        "survival": 0.472369,
        "sample_slope": 0.188573,
        "sample_u": 0.982681,
    },
    sources=("E. d'Eon, notebooks to A Hitchhiker's Guide to Multiple Scattering, 2020 (K0 NDF)",),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(_kernels, TEXT)


class K0(StretchedDistribution):
    """K0 slopes: Beckmann over exponentially distributed squared roughness; Bessel K at a = 1.

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
    >>> ndf = mf.K0(alpha=0.3)
    >>> print(f"{ndf.P22(0.1, 0.2):.6g}")
    1.53071
    """

    __slots__ = ()
    family = "k0"
    kernels = _kernels


DISTRIBUTION = K0
