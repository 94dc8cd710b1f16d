"""The quantities of every family: what each one means, takes and gives."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["QUANTITIES", "Argument"]


@dataclass(frozen=True)
class Argument:
    """An argument of a quantity: what it is, and the numbers that it may be."""

    name: str
    meaning: str
    domain: str
    lower: float = -math.inf
    upper: float = math.inf
    note: str = ""  # a further sentence


@dataclass(frozen=True)
class _Quantity:
    summary: str
    arguments: tuple[Argument, ...]
    returns: str
    outside: str
    example: str  # the arguments before the parameters


_COSINE = Argument(
    "u",
    "cosine of the angle to the macroscopic normal",
    "in [-1, 1]",
    -1.0,
    1.0,
    "Up to 8 ulp beyond, as rounding makes it, it counts as 1 or -1.",
)
_SLOPE = Argument("p", "slope along x", "any real number")
_RADIUS = Argument("r", "slope tan(theta)", "in [0, inf)", 0.0)
_XI = Argument(
    "xi",
    "uniform random number",
    "in [0, 1)",
    0.0,
    1.0,
    "NumPy rounds it where `dtype` asks for float32 of float64: what lies above 1 - 2**-25 becomes 1.",
)
_NAN = "nan where any argument is nan or a parameter lies outside its domain"

QUANTITIES: Mapping[str, _Quantity] = {
    "D": _Quantity(
        "Density of microfacet normals, per steradian.",
        (_COSINE,),
        "Area of microfacets per unit area of surface and steradian; D cos(theta) integrates to 1.",
        f"0 for u <= 0; {_NAN}, or abs(u) exceeds 1 by more.",
        "0.9",
    ),
    "P22": _Quantity(
        "Joint density of the slopes (p, q).",
        (_SLOPE, Argument("q", "slope along y", "any real number")),
        "Probability per unit area of slopes; integrates to 1 over the plane.",
        f"{_NAN}.",
        "0.1, 0.2",
    ),
    "P2": _Quantity(
        "Density of the slope along one axis, the marginal of P22.",
        (_SLOPE,),
        "Probability per unit slope; integrates to 1 over the line.",
        f"{_NAN}.",
        "0.1",
    ),
    "slope_cdf": _Quantity(
        "Probability that the slope along one axis is at most p.",
        (_SLOPE,),
        "Probability, with full relative accuracy in the lower tail.",
        f"{_NAN}.",
        "-0.1",
    ),
    "sigma": _Quantity(
        "Projected area of the microfacets towards a direction, on the whole sphere.",
        (_COSINE,),
        "Area per unit area of surface: 1 at u = 1, 0 at u = -1; sigma(u) - sigma(-u) = u.",
        f"{_NAN}, or abs(u) exceeds 1 by more.",
        "-0.2",
    ),
    "Lambda": _Quantity(
        "Smith's auxiliary function: sigma(u) = u (1 + Lambda(u)).",
        (_COSINE,),
        "Masked over visible area (dimensionless); Lambda(-u) = -1 - Lambda(u).",
        f"inf at u = 0; {_NAN}, or abs(u) exceeds 1 by more.",
        "0.2",
    ),
    "G1": _Quantity(
        "Smith's masking function: the visible fraction of microfacets that face a direction.",
        (_COSINE,),
        "u/sigma(u) = 1/(1 + Lambda(u)), in [0, 1].",
        f"0 for u <= 0; {_NAN}, or abs(u) exceeds 1 by more.",
        "0.2",
    ),
    "survival": _Quantity(
        "Probability that the slope of a normal drawn from D cos(theta) exceeds r.",
        (_RADIUS,),
        "Probability: 1 at r = 0, falling to 0.",
        f"{_NAN} or r < 0.",
        "0.2",
    ),
    "sample_slope": _Quantity(
        "Slope tan(theta) of a normal drawn from D cos(theta), by inversion.",
        (_XI,),
        "The r with survival(r) = 1 - xi: 0 at xi = 0, increasing.",
        f"{_NAN} or xi outside [0, 1).",
        "0.5",
    ),
    "sample_u": _Quantity(
        "Cosine of the angle of a normal drawn from D cos(theta), by inversion.",
        (_XI,),
        "1/sqrt(1 + sample_slope(xi)^2): 1 at xi = 0, decreasing.",
        f"{_NAN} or xi outside [0, 1).",
        "0.5",
    ),
}
