"""What the library says of its families: names, classes, parameters with their domains, sources."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType
from typing import Any

from microfacet import _core
from microfacet._frozen import Distribution

__all__ = ["Family", "Parameter", "describe"]


@dataclass(frozen=True)
class Parameter:
    """A parameter and the open interval in which every quantity of its family is defined."""

    name: str
    lower: float
    upper: float


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
    """

    name: str
    title: str
    cls: type[Distribution]
    kernels: ModuleType
    parameters: tuple[Parameter, ...]
    sources: tuple[str, ...]
    anisotropic: bool

    def __reduce__(self) -> tuple[Any, ...]:  # a module does not pickle; there is one record of a family
        return _named, (self.name,)


def _named(name: str) -> Family:
    from microfacet._family import families

    return next(family for family in families() if family.name == name)


def describe(module: Any) -> Family:
    """The record of the family that `module` presents; domains and sources come from its C++ header."""
    cls: type[Distribution] = module.TEXT.cls
    core = cls.kernels
    own = tuple(Parameter(name, lower, upper) for name, lower, upper, _ in core.parameters)
    return Family(
        name=cls.family,
        title=module.TEXT.title,
        cls=cls,
        kernels=module,
        parameters=(Parameter("alpha", *_core.roughness), *own),
        sources=core.sources,
        anisotropic=core.shape_invariant,
    )
