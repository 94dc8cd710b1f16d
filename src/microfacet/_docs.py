"""Docstrings of the ufuncs: what is the same for every family is written here once.

A family module states its formulas and its example values in a `FamilyText`; `document` joins them with the
meaning, domain and behaviour of the quantity and attaches the result to the ufunc.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from textwrap import fill, indent

import numpy as np

__all__ = ["QUANTITIES", "Argument", "FamilyText", "document", "documented"]


@dataclass(frozen=True)
class FamilyText:
    """What the docstrings of one family say that those of another do not.

    Attributes
    ----------
    name : str
        Name of the family, as in ``microfacet.<name>``.
    title : str
        How people write it.
    parameters : mapping of str to str
        Shape parameters after `alpha`: name and numpydoc description with the domain.
    formulas : mapping of str to str
        Plain-text formula of each quantity.
    arguments : str
        The parameters as the examples pass them, for instance ``"0.3, 2.5"``.
    examples : mapping of str to float
        Value of each quantity at the point of its example, to six significant digits.
    sources : tuple of str
        Where the formulas come from.
    """

    name: str
    title: str
    formulas: Mapping[str, str]
    arguments: str
    examples: Mapping[str, float]
    sources: tuple[str, ...]
    parameters: Mapping[str, str] = field(default_factory=dict)


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

_ALPHA = (
    "Roughness, the scale of the slopes (dimensionless), in (1e-101, 1e101): in float32 any normal number."
)


def _wrap(text: str, prefix: str = "") -> str:
    return fill(text, 88, initial_indent=prefix, subsequent_indent=prefix)


def _entries(pairs: list[tuple[str, str]]) -> str:
    return "\n".join(f"{name} : array_like\n{_wrap(text, '    ')}" for name, text in pairs)


def _text(quantity: str, family: FamilyText) -> str:
    about = QUANTITIES[quantity]
    arguments = [
        (x.name, f"{x.meaning.capitalize()} (dimensionless), {x.domain}. {x.note}".rstrip())
        for x in about.arguments
    ]
    parameters = [*arguments, ("alpha", _ALPHA), *family.parameters.items()]
    call = f"mf.{family.name}.{quantity}({about.example}, {family.arguments})"
    value = f"{family.examples[quantity]:.6g}"
    return f"""{about.summary} {family.title} family.

{indent(family.formulas[quantity], "    ")}

Parameters
----------
{_entries(parameters)}
out, where, casting, order, dtype, subok
    As of any `numpy.ufunc`.

Returns
-------
ndarray or scalar
{_wrap(about.returns, "    ")}
    The shape is that of all arguments broadcast together; float32 if all arguments
    are float32 or narrower, else float64.

Notes
-----
{_wrap(f"Outside the domain: {about.outside} No warning is raised. Inside, every result is a number.")}
{_wrap("Numbers below the normal ones of the precision count as 0, as arguments and as results.")}

References
----------
{chr(10).join(f".. [{i}] {source}" for i, source in enumerate(family.sources, 1))}

Examples
--------
>>> import microfacet as mf
>>> print(f"{{{call}:.6g}}")
{value}
"""


def document(kernel: np.ufunc, quantity: str, family: FamilyText) -> np.ufunc:
    """Attach the docstring of `quantity` of `family` to its ufunc and return the ufunc."""
    with suppress(AttributeError, TypeError):  # settable since NumPy 2.3; before, pickle searches all modules
        kernel.__module__ = f"microfacet._family.{family.name}"
    kernel.__doc__ = _text(quantity, family)  # type: ignore[misc]  # settable since NumPy 2.2
    return kernel


def documented(kernels: object, family: FamilyText) -> tuple[np.ufunc, ...]:
    """Every ufunc of a family with its docstring, in the order of `QUANTITIES`."""
    return tuple(document(getattr(kernels, quantity), quantity, family) for quantity in QUANTITIES)
