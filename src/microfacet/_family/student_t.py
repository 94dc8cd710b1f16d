"""Student-T slopes: power-law tails set by gamma, through GGX (2) to Beckmann (infinity).

Nothing is computed here. Formulas, domain and sources live in
``include/microfacet/family/student_t.hpp``; this module gives them Python names,
documentation and a frozen distribution.
"""

from __future__ import annotations

from microfacet._core import student_t as _kernels
from microfacet._docs import FamilyText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [
    "G1",
    "P2",
    "P22",
    "D",
    "Lambda",
    "StudentT",
    "sample_slope",
    "sample_u",
    "sigma",
    "slope_cdf",
    "survival",
]

TEXT = FamilyText(
    name="student_t",
    title="Student-T",
    parameters={
        "gamma": "Tail index (dimensionless), in (3/2, inf); 2 is GGX. Densities need gamma > 1.",
    },
    formulas={
        "D": "D(u) = (1 + tan^2(theta)/(alpha^2 k))^-gamma/(pi alpha^2 u^4),  k = gamma - 1",
        "P22": "P22(p, q) = (1 + (p^2 + q^2)/(alpha^2 k))^-gamma/(pi alpha^2),  k = gamma - 1",
        "P2": "P2(p) = N/alpha (1 + p^2/(alpha^2 k))^(1/2-gamma),  N = Gamma(k + 1/2)/(sqrt(pi k) Gamma(k))",
        "slope_cdf": "F(-p) = I_z(k, 1/2)/2 for p > 0,  z = k/(k + (p/alpha)^2), k = gamma - 1",
        "sigma": "sigma(u) = max(u, 0) + abs(u) Lambda(abs(u))",
        "Lambda": (
            "Lambda(u) = z^k sqrt(1 + k/x^2) B(3/2, gamma-3/2)/(2 pi) 2F1(1, gamma-3/2; gamma; z),\n"
            "x = cot(theta)/alpha, k = gamma - 1, z = k/(k + x^2)"
        ),
        "G1": "G1(u) = u/sigma(u) = 1/(1 + Lambda(u)) for u > 0",
        "survival": "T(r) = (1 + r^2/(alpha^2 k))^-k,  k = gamma - 1",
        "sample_slope": "r = alpha sqrt(k ((1 - xi)^(-1/k) - 1)),  k = gamma - 1",
        "sample_u": "u = 1/sqrt(1 + sample_slope(xi)^2)",
    },
    arguments="0.3, 2.5",
    examples={
        "D": 0.434747,
        "P22": 1.60884,
        "P2": 1.50191,
        "slope_cdf": 0.334758,
        "sigma": 0.0468745,
        "Lambda": 0.234372,
        "G1": 0.810128,
        "survival": 0.677553,
        "sample_slope": 0.281601,
        "sample_u": 0.962563,
    },
    sources=(
        "M. Ribardiere et al., Student's t-Distribution of Slopes for Microfacet Based BSDFs, CGF 36, 2017",
        "E. d'Eon, notebooks to A Hitchhiker's Guide to Multiple Scattering, 2020 (Student-T NDF)",
    ),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(_kernels, TEXT)


class StudentT(StretchedDistribution):
    """Student-T slopes: power-law tails set by gamma, through GGX (2) to Beckmann (infinity).

    Parameters
    ----------
    alpha : float
        Isotropic roughness, in (1e-101, 1e101); or give both of
    alpha_x, alpha_y : float
        Roughness along the two axes, in (1e-101, 1e101).
    rotation : float
        Angle of the first axis from +x (radians, counter-clockwise).
    gamma : float
        Tail index, in (3/2, inf); 2 is GGX.

    Raises
    ------
    ValueError
        If a parameter is no number or lies outside its interval; the message names all three.

    Examples
    --------
    >>> import microfacet as mf
    >>> ndf = mf.StudentT(alpha=0.3, gamma=2.5)
    >>> print(f"{ndf.P22(0.1, 0.2):.6g}")
    1.60884
    """

    __slots__ = ()
    family = "student_t"
    kernels = _kernels

    def __init__(
        self,
        alpha: float | None = None,
        gamma: float | None = None,
        *,
        alpha_x: float | None = None,
        alpha_y: float | None = None,
        rotation: float = 0.0,
    ) -> None:
        self._set(alpha, alpha_x, alpha_y, rotation, gamma=gamma)

    @property
    def visible_dims(self) -> int:
        """How many uniforms `sample_visible` takes: 2 for gamma = 3, which has a closed sampler, else 3."""
        return 2 if self.gamma == 3.0 else 3


DISTRIBUTION = StudentT
