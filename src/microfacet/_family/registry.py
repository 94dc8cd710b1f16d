"""What the library says of its families: names, classes, parameters with their domains, sources."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import product
from types import ModuleType
from typing import Any

from microfacet import _core
from microfacet._family.text import FamilyText, ShapeText
from microfacet._frozen import Distribution

__all__ = ["UNBOUNDED", "Family", "Parameter", "describe", "searched"]

UNBOUNDED = 1e100  # what is as good as infinite as the end of an interval


@dataclass(frozen=True)
class Parameter:
    """A parameter and the open interval in which every quantity of its family is defined.

    Attributes
    ----------
    name : str
        As of the keyword argument.
    lower, upper : float
        The ends of the interval.
    meaning : str
        What it is, in a few words; of a shape parameter.
    examples : tuple of float
        Ascending values of a shape parameter that show what it does.
    pictured : float
        The value of a shape parameter in pictures where none is given.
    fitted : (float, float)
        Between which values of a shape parameter fits search.

    Examples
    --------
    >>> import microfacet as mf
    >>> mf.families()[2].parameters[1].examples
    (1.0, 1.5, 3.0)
    """

    name: str
    lower: float
    upper: float
    meaning: str = field(default="", repr=False)
    examples: tuple[float, ...] = field(default=(), repr=False)
    pictured: float = field(default=math.nan, repr=False, compare=False)
    fitted: tuple[float, float] = field(default=(math.nan, math.nan), repr=False, compare=False)


@dataclass(frozen=True)
class Family:
    """One family of distributions.

    Attributes
    ----------
    name : str
        The string that stands for the family everywhere, for instance in ``microfacet.student_t``.
    title : str
        How people write it.
    cls : type
        Its frozen distribution.
    kernels : module
        Its ufuncs.
    parameters : tuple of Parameter
        `alpha`, then the shape parameter if it has one.
    sources : tuple of str
        Keys of references.bib.
    anisotropic : bool
        Whether it takes alpha_x, alpha_y and rotation.
    singular : bool
        Whether all facets have one slope: there is no density to fit or to integrate.
    shapes : tuple of tuple of float
        Sets of shape parameters that show what the family can be; one empty set where it has none.
    figures : tuple of tuple of float
        All parameters of three figures of the report: the curves, the two routes to sigma, the samples.

    Examples
    --------
    >>> import microfacet as mf
    >>> for family in mf.families()[:3]:
    ...     print([family.cls(0.3, *shape).family for shape in family.shapes])
    ['beckmann']
    ['ggx']
    ['gtr', 'gtr', 'gtr']
    """

    name: str
    title: str
    cls: type[Distribution]
    kernels: ModuleType
    parameters: tuple[Parameter, ...]
    sources: tuple[str, ...]
    anisotropic: bool
    singular: bool
    shapes: tuple[tuple[float, ...], ...]
    figures: tuple[tuple[float, ...], ...]

    def __reduce__(self) -> tuple[Any, ...]:  # a module does not pickle; there is one record of a family
        return _named, (self.name,)


def _named(name: str) -> Family:
    from microfacet._family import families

    return next(family for family in families() if family.name == name)


def searched(lower: float, upper: float) -> tuple[float, float]:
    """Where fits search for a shape: from 0.01 to 150 above the end of an unbounded interval, beyond which a
    family is at its limit for practical purposes; else all but a thousandth at either end.
    """
    if upper >= UNBOUNDED:
        return lower + 0.01, lower + 150.0
    return lower + 1e-3 * (upper - lower), upper - 1e-3 * (upper - lower)


def _parameter(said: ShapeText, name: str, lower: float, upper: float) -> Parameter:
    middle = said.examples[len(said.examples) // 2] if said.pictured is None else said.pictured
    fitted = said.fitted or searched(lower, upper)
    return Parameter(name, lower, upper, said.meaning, said.examples, middle, fitted)


def describe(module: Any) -> Family:
    """The record of the family that `module` presents; domains and sources come from its C++ header."""
    text: FamilyText = module.TEXT
    core = text.cls.kernels
    own = [_parameter(text.parameters[name], name, lower, upper) for name, lower, upper, _ in core.parameters]
    pictured = [parameter.pictured for parameter in own]
    return Family(
        name=text.cls.family,
        title=text.title,
        cls=text.cls,
        kernels=module,
        parameters=(Parameter("alpha", *_core.roughness, meaning="Roughness"), *own),
        sources=core.sources,
        anisotropic=core.shape_invariant,
        singular=core.singular,
        shapes=tuple(product(*(parameter.examples for parameter in own))),
        figures=text.figures or tuple((alpha, *pictured) for alpha in (0.5, 0.7, 1.2)),
    )
