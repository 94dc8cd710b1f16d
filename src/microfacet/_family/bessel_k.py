"""Bessel K slopes: Beckmann over Gamma(a, 1) distributed squared roughness; exponential tails.

Nothing is computed here. Formulas, domain and sources live in
``include/microfacet/family/bessel_k.hpp``; this module gives them Python names,
documentation and a frozen distribution.
"""

from __future__ import annotations

from microfacet._core import bessel_k as _kernels
from microfacet._docs import FamilyText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [
    "G1",
    "P2",
    "P22",
    "BesselK",
    "D",
    "Lambda",
    "sample_slope",
    "sample_u",
    "sigma",
    "slope_cdf",
    "survival",
]

TEXT = FamilyText(
    name="bessel_k",
    title="Bessel K",
    parameters={
        "a": "Shape of the mixing distribution (dimensionless), in (0, 1e100); 1 is K0, and below 1e-300 it "
        "counts as 1e-300.",
    },
    formulas={
        "D": (
            "D(u) = 2 y^(a-1) K_{a-1}(2 y)/(pi alpha^2 Gamma(a) u^4),  y = tan(theta)/alpha, "
            "inf at u = 1 for a <= 1"
        ),
        "P22": (
            "P22(p, q) = 2 y^(a-1) K_{a-1}(2 y)/(pi alpha^2 Gamma(a)),  y^2 = (p^2 + "
            "q^2)/alpha^2, inf at 0 for a <= 1"
        ),
        "P2": (
            "P2(p) = 2 t^(a-1/2) K_{a-1/2}(2 t)/(sqrt(pi) alpha Gamma(a)),  t = abs(p)/alpha, "
            "inf at 0 for a <= 1/2"
        ),
        "slope_cdf": (
            "F(-p) = integral of P2 above p: Struve functions near 0, an average of Beckmann's elsewhere"
        ),
        "sigma": "sigma(u) = max(u, 0) + abs(u) Lambda(abs(u))",
        "Lambda": (
            "Lambda(u) = average of Beckmann's Lambda(x/sqrt(b)) over b ~ Gamma(a, 1),  x = cot(theta)/alpha"
        ),
        "G1": "G1(u) = u/sigma(u) = 1/(1 + Lambda(u)) for u > 0",
        "survival": "T(r) = 2 y^a K_a(2 y)/Gamma(a),  y = r/alpha",
        "sample_slope": "the root of T(r) = 1 - xi",
        "sample_u": "u = 1/sqrt(1 + sample_slope(xi)^2)",
    },
    arguments="0.3, 1.5",
    examples={
        "D": 0.426984,
        "P22": 1.59305,
        "P2": 1.59293,
        "slope_cdf": 0.310138,
        "sigma": 0.0299954,
        "Lambda": 0.149977,
        "G1": 0.869582,
        "survival": 0.61506,
        "sample_slope": 0.251752,
        "sample_u": 0.969741,
    },
    sources=("E. d'Eon, notebooks to A Hitchhiker's Guide to Multiple Scattering, 2020 (Bessel K NDF)",),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(_kernels, TEXT)


class BesselK(StretchedDistribution):
    """Bessel K slopes: Beckmann over Gamma(a, 1) distributed squared roughness; exponential tails.

    Parameters
    ----------
    alpha : float
        Isotropic roughness, in (1e-101, 1e101); or give both of
    alpha_x, alpha_y : float
        Roughness along the two axes, in (1e-101, 1e101).
    rotation : float
        Angle of the first axis from +x (radians, counter-clockwise).
    a : float
        Shape of the mixing distribution, in (0, 1e100); 1 is K0.

    Raises
    ------
    ValueError
        If a parameter is no number or lies outside its interval; the message names all three.

    Examples
    --------
    >>> import microfacet as mf
    >>> ndf = mf.BesselK(alpha=0.3, a=1.5)
    >>> print(f"{ndf.P22(0.1, 0.2):.6g}")
    1.59305
    """

    __slots__ = ()
    family = "bessel_k"
    kernels = _kernels

    def __init__(
        self,
        alpha: float | None = None,
        a: float | None = None,
        *,
        alpha_x: float | None = None,
        alpha_y: float | None = None,
        rotation: float = 0.0,
    ) -> None:
        self._set(alpha, alpha_x, alpha_y, rotation, a=a)


DISTRIBUTION = BesselK
