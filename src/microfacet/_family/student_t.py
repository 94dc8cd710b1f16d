"""Student-T: names and documentation. The mathematics is ``include/microfacet/family/student_t.hpp``."""

from __future__ import annotations

from microfacet._core import student_t as _kernels
from microfacet._family.text import QUANTITIES, FamilyText, ShapeText, documented
from microfacet._frozen import StretchedDistribution

__all__ = [*QUANTITIES, "StudentT"]


class StudentT(StretchedDistribution):
    """Student-T slopes: power-law tails set by gamma, through GGX (2) to Beckmann (infinity)."""

    __slots__ = ()
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


TEXT = FamilyText(
    cls=StudentT,
    title="Student-T",
    parameters={"gamma": ShapeText("Tail index", "2 is GGX.", (1.7, 2.0, 5.0), pictured=3.0)},
    figures=((0.5, 3.0), (0.7, 3.0), (1.2, 2.3)),
    formulas={
        "D": "D(u) = (1 + tan^2(theta)/(alpha^2 k))^-gamma/(pi alpha^2 u^4),  k = gamma - 1",
        "P22": "P22(p, q) = (1 + (p^2 + q^2)/(alpha^2 k))^-gamma/(pi alpha^2),  k = gamma - 1",
        "P2": "P2(p) = N/alpha (1 + p^2/(alpha^2 k))^(1/2-gamma),  N = Gamma(k + 1/2)/(sqrt(pi k) Gamma(k))",
        "slope_cdf": "F(-p) = I_z(k, 1/2)/2 for p > 0,  z = k/(k + (p/alpha)^2), k = gamma - 1",
        "Lambda": (
            "Lambda(u) = z^k sqrt(1 + k/x^2) B(3/2, gamma-3/2)/(2 pi) 2F1(1, gamma-3/2; gamma; z),\n"
            "x = cot(theta)/alpha, k = gamma - 1, z = k/(k + x^2)"
        ),
        "survival": "T(r) = (1 + r^2/(alpha^2 k))^-k,  k = gamma - 1",
        "sample_slope": "r = alpha sqrt(k ((1 - xi)^(-1/k) - 1)),  k = gamma - 1",
    },
    at=(0.3, 2.5),
    values=(
        0.434747,
        1.60884,
        1.50191,
        0.334758,
        0.0468745,
        0.234372,
        0.810128,
        0.677553,
        0.281601,
        0.962563,
    ),
)

D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope, sample_u = documented(TEXT)
