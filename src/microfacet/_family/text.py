"""What a family says of itself in Python, and its docstrings: what is the same for all is written once.

A family module states its formulas and the values of its examples in a `FamilyText`. `documented` joins them
with the meaning, domain and behaviour of each quantity, and with the parameters that the header states.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from textwrap import fill, indent
from typing import Any

import numpy as np

from microfacet import _core
from microfacet._docs import QUANTITIES

__all__ = ["QUANTITIES", "FamilyText", "ShapeText", "documented"]


@dataclass(frozen=True)
class ShapeText:
    """What a family says of its shape parameter; the interval is in the header.

    Attributes
    ----------
    meaning : str
        What it is, in two or three words: also the help of the command line's option.
    note : str
        What else is to be said of it, in sentences.
    examples : tuple of float
        Ascending values that show what it does; figures set them side by side, tests run at them.
    pictured : float, optional
        The value in pictures where none is given; otherwise the middle one of `examples`.
    fitted : (float, float), optional
        Between which values fits search; otherwise most of the interval (`registry.searched`).
    """

    meaning: str
    note: str
    examples: tuple[float, ...]
    pictured: float | None = None
    fitted: tuple[float, float] | None = None


@dataclass(frozen=True)
class FamilyText:
    """What the docstrings of one family say that those of another do not.

    Attributes
    ----------
    cls : type
        The frozen distribution of the family, whose docstring is one line so far.
    title : str
        How people write the family's name.
    formulas : mapping of str to str
        Plain-text formulas of the quantities that `FORMULAS` does not give.
    at : tuple of float
        The parameters of the examples.
    values : tuple of float
        The value of each of `QUANTITIES` in its example, to six significant digits.
    parameters : mapping of str to ShapeText
        What there is to say of each shape parameter.
    figures : tuple of tuple of float, optional
        The parameters of three figures of the report: the curves, the two routes to sigma, the samples.
    """

    cls: type[Any]
    title: str
    formulas: Mapping[str, str]
    at: tuple[float, ...]
    values: tuple[float, ...]
    parameters: Mapping[str, ShapeText] = field(default_factory=dict)
    figures: tuple[tuple[float, ...], ...] = ()


FORMULAS: Mapping[str, str] = {
    "P2": "P2(p) = integral of P22(p, q) over q",
    "slope_cdf": "F(-p) = (1/pi) integral over t > 0 of T(p cosh t)/cosh t,  T = survival",
    "sigma": "sigma(u) = max(u, 0) + abs(u) Lambda(abs(u))",
    "Lambda": (
        "Lambda(u) = (1/pi) integral over t > 0 of T(cot(theta) cosh t) sinh^2(t)/cosh(t),  T = survival"
    ),
    "G1": "G1(u) = u/sigma(u) = 1/(1 + Lambda(u)) for u > 0",
    "sample_slope": "the root of T(r) = 1 - xi",
    "sample_u": "u = 1/sqrt(1 + sample_slope(xi)^2)",
}
"""What holds for every family: shown where a family has no formula of its own."""

CITATIONS = {
    "beckmann1963scattering": (
        "P. Beckmann and A. Spizzichino, The Scattering of Electromagnetic Waves from Rough Surfaces, 1963"
    ),
    "burley2012disney": "B. Burley, Physically Based Shading at Disney, SIGGRAPH 2012 course",
    "deon2020hitchhiker": "E. d'Eon, notebooks to A Hitchhiker's Guide to Multiple Scattering, 2020",
    "heitz2014masking": (
        "E. Heitz, Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs, JCGT 2014"
    ),
    "ribardiere2017std": (
        "M. Ribardiere et al., Student's t-Distribution of Slopes for Microfacet Based BSDFs, CGF 36, 2017"
    ),
    "trowbridge1975average": (
        "T. S. Trowbridge and K. P. Reitz, Average Irregularity Representation of a Rough Surface, JOSA 1975"
    ),
    "walter2007microfacet": (
        "B. Walter et al., Microfacet Models for Refraction through Rough Surfaces, EGSR 2007"
    ),
}
"""The sources that headers name, by their keys in references.bib."""


def _wrap(text: str, prefix: str = "") -> str:
    return fill(text, 88, initial_indent=prefix, subsequent_indent=prefix)


def _entries(pairs: list[tuple[str, str]], kind: str) -> str:
    return "\n".join(f"{name} : {kind}\n{_wrap(text, '    ')}" for name, text in pairs)


def _interval(lower: float, upper: float) -> str:
    return f"({lower:g}, {upper:g})".replace("e+", "e")


def _shape(family: FamilyText, densities: str = "") -> list[tuple[str, str]]:
    """The shape parameters and what they are, with `densities` where theirs is a wider interval."""
    described = []
    for name, lower, upper, of_densities in family.cls.kernels.parameters:
        said = family.parameters[name]
        wider = densities.format(name=name, lower=of_densities) if of_densities < lower else ""
        interval = _interval(lower, upper)
        described.append((name, f"{said.meaning} (dimensionless), in {interval}; {said.note}{wider}"))
    return described


def _of_ufunc(quantity: str, value: float, family: FamilyText) -> str:
    about, interval = QUANTITIES[quantity], _interval(*_core.roughness)
    arguments = [
        (x.name, f"{x.meaning.capitalize()} (dimensionless), {x.domain}. {x.note}".rstrip())
        for x in about.arguments
    ]
    alpha = (
        f"Roughness, the scale of the slopes (dimensionless), in {interval}: in float32 any normal number."
    )
    formula = family.formulas.get(quantity) or FORMULAS[quantity]
    shape = _shape(family, " Densities need {name} > {lower:g} alone.")
    sources = [CITATIONS[key] for key in family.cls.kernels.sources]
    given = ", ".join(map(str, family.at))
    return f"""{about.summary} {family.title} family.

{indent(formula, "    ")}

Parameters
----------
{_entries([*arguments, ("alpha", alpha), *shape], "array_like")}
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
{chr(10).join(f".. [{i}] {source}" for i, source in enumerate(sources, 1))}

Examples
--------
>>> import microfacet as mf
>>> print(f"{{mf.{family.cls.family}.{quantity}({about.example}, {given}):.6g}}")
{value:.6g}
"""


def _of_class(family: FamilyText, density: float) -> str:
    interval = _interval(*_core.roughness)
    if "alpha_x" in family.cls._names:
        roughness = [
            ("alpha", f"Isotropic roughness, in {interval}; or give both of"),
            ("alpha_x, alpha_y", f"Roughness along the two axes, in {interval}."),
            ("rotation", "Angle of the first axis from +x (radians, counter-clockwise)."),
        ]
    else:
        roughness = [("alpha", f"Roughness, in {interval}.")]
    names = ("alpha", *(name for name, _ in _shape(family)))
    given = ", ".join(f"{name}={value}" for name, value in zip(names, family.at, strict=True))
    return f"""{family.cls.__doc__}

Parameters
----------
{_entries([*roughness, *_shape(family)], "float")}

Raises
------
ValueError
    If a parameter is no number or lies outside its interval; the message names all three.

Examples
--------
>>> import microfacet as mf
>>> ndf = mf.{family.cls.__name__}({given})
>>> print(f"{{ndf.P22({QUANTITIES["P22"].example}):.6g}}")
{density:.6g}
"""


def documented(family: FamilyText) -> tuple[np.ufunc, ...]:
    """Write the docstrings of a family's class and ufuncs; the ufuncs, in the order of `QUANTITIES`."""
    kernels = []
    for quantity, value in zip(QUANTITIES, family.values, strict=True):
        kernel = getattr(family.cls.kernels, quantity)
        with suppress(
            AttributeError, TypeError
        ):  # settable since NumPy 2.3; before, pickle searches all modules
            kernel.__module__ = f"microfacet._family.{family.cls.family}"
        kernel.__doc__ = _of_ufunc(quantity, value, family)  # settable since NumPy 2.2
        kernels.append(kernel)
    family.cls.__doc__ = _of_class(family, family.values[1])
    return tuple(kernels)
