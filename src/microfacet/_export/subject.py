"""Of what functions on arrays are made: a family or a distribution, its parameters and their domains."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import Any

from microfacet._export.density import AXES, Density, density_of
from microfacet._export.guard import Interval
from microfacet._family import Family, families
from microfacet._frozen import Distribution

__all__ = ["Subject", "optics_of", "subject_of"]

_OWNER = "array_functions"
# Densities of slopes exist where the projected area may not: their quantities, by name.
_OF_DENSITY = {"D", "P22", "P2", "slope_cdf", "survival", "sample", "pdf"}
# What materials take; a conductor of which nothing is said is a mirror.
_OPTICS = {
    "conductor": {"eta": Interval(0.0, math.inf, with_upper=True), "k": Interval(0.0, math.inf, True)},
    "dielectric": {"eta": Interval(0.0, math.inf)},
}
_MIRROR = {"eta": math.inf, "k": 0.0}


def optics_of(quantity: str) -> Mapping[str, Interval]:
    """What a material's quantity takes beside the parameters of a distribution."""
    return _OPTICS.get(quantity.partition("_")[0], {})


@dataclass(frozen=True)
class Subject:
    """A density, and the values of the parameters that need not be given.

    Attributes
    ----------
    density : Density
    names : tuple of str
        Its parameters, as functions take them.
    fixed : dict
        Those that have a value.
    source : str or Distribution
        The name of a family, or what the user gave.
    """

    density: Density
    names: tuple[str, ...]
    fixed: Mapping[str, float]
    source: str | Distribution

    @property
    def anisotropic(self) -> bool:
        """Whether it has alpha_x, alpha_y and rotation."""
        return "alpha_x" in self.names

    def domain(self, name: str, quantity: str) -> Interval:
        """Where a parameter is valid for a quantity."""
        if name == "rotation":
            return Interval(-math.inf, math.inf)
        optics = optics_of(quantity)
        if name in optics:
            return optics[name]
        roughness, *shape = self.density.parameters
        for parameter in shape:
            if parameter.name == name:
                return Interval(self._lower(name, quantity, parameter.lower), parameter.upper)
        return Interval(roughness.lower, roughness.upper)

    def _lower(self, name: str, quantity: str, usual: float) -> float:
        if quantity not in _OF_DENSITY or self.density.family is None:
            return usual
        lower: dict[str, float] = {known: x for known, _, _, x in self.density.family.cls.kernels.parameters}
        return lower[name]

    def given(self, quantity: str, parameters: Mapping[str, Any]) -> dict[str, float | None]:
        """The parameters of a call: None where it gives them, else their values.

        Raises
        ------
        TypeError
            If one is not a parameter, or one is missing.
        """
        own: dict[str, float | None] = dict.fromkeys(optics_of(quantity))
        if quantity.startswith("conductor"):
            own |= _MIRROR
        defaults: dict[str, float | None] = {**dict.fromkeys(self.names), **own, **self.fixed}
        for name in parameters:
            if name not in defaults:
                raise TypeError(
                    f"{_OWNER}: {quantity} of {self.density.name} has no parameter {name!r}; "
                    f"it has {', '.join(defaults)}"
                )
        missing = [name for name, value in defaults.items() if value is None and name not in parameters]
        if missing:
            raise TypeError(f"{_OWNER}: {quantity} of {self.density.name} needs {' and '.join(missing)}")
        return {name: None if name in parameters else value for name, value in defaults.items()}


def subject_of(thing: Any, anisotropic: bool | None) -> Subject:
    """The family that `thing` names or is, or the distribution.

    Raises
    ------
    ValueError
        If it is no family, or `anisotropic` is not what it can be.
    """
    source = thing if isinstance(thing, Distribution) else _family_of(thing)
    density = density_of(source)
    own = dict(density.own)
    if anisotropic is None:
        anisotropic = "alpha_x" in own
    if anisotropic and not density.anisotropic:
        raise ValueError(f"{_OWNER}: {density.name} has no anisotropic form")
    if "alpha_x" in own and not anisotropic:
        raise ValueError(f"{_OWNER}: {thing!r} is anisotropic, got anisotropic=False")
    if anisotropic and "alpha" in own:
        own["alpha_x"] = own["alpha_y"] = own.pop("alpha")
    shape = tuple(parameter.name for parameter in density.parameters[1:])
    names = (*(AXES if anisotropic else ("alpha",)), *shape)
    return Subject(density, names, {"rotation": 0.0, **own} if anisotropic else own, source)


def _family_of(thing: Any) -> str:
    for family in families():
        by = thing if isinstance(thing, str | type | ModuleType | Family) else None
        if by in (family.name, family.cls, family.kernels, family):
            return family.name
    names = ", ".join(family.name for family in families())
    raise ValueError(f"{_OWNER}: give a family ({names}) or a distribution, got {thing!r}")
