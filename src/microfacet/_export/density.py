"""What is exported: a family, a distribution of one, or a density of the user's own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from microfacet import _core
from microfacet._family import Family, Parameter, families
from microfacet._frozen import Distribution
from microfacet._radial import RadialNDF
from microfacet._user_family import UserFamily

__all__ = ["AXES", "Density", "density_of"]

AXES = ("alpha_x", "alpha_y", "rotation")


@dataclass(frozen=True)
class Density:
    """A family by its name and parameters, or a density of the user's own.

    Attributes
    ----------
    own : dict of str to float
        The values of its parameters, where a distribution was given.
    radial : RadialNDF, optional
        The user's density.
    """

    name: str
    title: str
    parameters: tuple[Parameter, ...]
    anisotropic: bool
    own: Mapping[str, float]
    family: Family | None = None
    radial: RadialNDF | None = None

    @property
    def exact(self) -> bool:
        """Whether its formulas are accurate in single precision, so that its shape may vary."""
        from microfacet._graphs import exact_in_float32

        return exact_in_float32.get(self.name, False)

    @property
    def tabulated(self) -> tuple[str, ...]:
        """The parameters that tables are made for, where all of them are given; none where formulas do."""
        from microfacet._graphs import shorter_from_tables

        if self.family is None or (self.exact and not shorter_from_tables[self.name]):
            return ()
        shape = self.parameters[1:] if self.anisotropic else self.parameters
        return tuple(parameter.name for parameter in shape)

    @property
    def tables_alone(self) -> bool:
        """Whether it is recorded from tables, whatever its parameters are."""
        return self.radial is not None or not (self.exact or self.tabulated)

    def tables(self, values: Mapping[str, float | None], float64: bool) -> bytes | None:
        """The tables for these values, None where formulas do; ValueError where neither is accurate."""
        if self.radial is not None:
            made: bytes | None = self.radial.kernels.tables(float64, self.radial._handle)
            return made
        shape = [values[name] for name in self.tabulated]
        if self.family is None or None in shape or (self.exact and not shape):
            return None
        made = self.family.cls.kernels.tables(float64, *shape)
        if made is None and not self.exact:
            given = " and ".join(f"{name} = {values[name]:g}" for name in self.tabulated)
            raise ValueError(f"{self.name}: tables in single precision are not accurate enough at {given}")
        return made

    def at(self, values: Mapping[str, float]) -> Distribution:
        """The frozen distribution."""
        if self.radial is not None:
            restore, (cls, _, *rest) = self.radial.__reduce__()
            axes = (values.get("alpha_x", values.get("alpha")), values.get("alpha_y", values.get("alpha")))
            found: Distribution = restore(cls, (*axes, values.get("rotation", 0.0)), *rest)
            return found
        assert self.family is not None
        return self.family.cls(**values)


def density_of(given: str | Distribution | UserFamily) -> Density:
    """The family of that name, or of a distribution with the values of its parameters."""
    if isinstance(given, UserFamily) and given.ndf is not None:
        given = given.ndf
    if isinstance(given, RadialNDF):
        roughness = (Parameter("alpha", *_core.roughness),)
        title = "user's"
        return Density("radial", title, roughness, True, _shortest(given.parameters), radial=given)
    if isinstance(given, Distribution):
        family = next((family for family in families() if type(given) is family.cls), None)
        if family is None:
            raise ValueError(f"a {type(given).__name__} cannot be exported: give a family or a RadialNDF")
        return _of_family(family, _shortest(given.parameters) if family.anisotropic else given.parameters)
    known = {family.name: family for family in families()}
    if not isinstance(given, str) or given not in known:
        raise ValueError(f"family must be one of {', '.join(known)}, or a distribution, got {given!r}")
    return _of_family(known[given], {})


def _of_family(family: Family, own: Mapping[str, float]) -> Density:
    return Density(family.name, family.title, family.parameters, family.anisotropic, own, family)


def _shortest(values: Mapping[str, float]) -> dict[str, float]:
    """One roughness instead of two axes where these are equal."""
    if values["alpha_x"] != values["alpha_y"] or values["rotation"]:
        return dict(values)
    return {"alpha": values["alpha_x"], **{name: x for name, x in values.items() if name not in AXES}}
