"""Which parameters of a family are arguments of the exported functions, and which are fixed numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from microfacet._export.density import AXES, Density
from microfacet._export.functions import FRESNEL, OPTICS, own_parameters, takes_channels
from microfacet._export.graph import Graph

__all__ = ["SCHEMES", "Choice", "chosen"]

#: How visible normals are drawn: with fewer operations, or continuous in the random numbers.
SCHEMES = ("mixture", "continuous")


@dataclass(frozen=True)
class Choice:
    """The parameters as an export takes them: numbers, and None for arguments.

    Attributes
    ----------
    intervals : dict of str to (float, float)
        The domain of each parameter.
    fresnel, channels, retroreflective
        What kind of conductor; how many wavelengths materials have; whether mirrors send light back.
    scheme
        How visible normals are drawn.
    """

    density: Density
    parameters: dict[str, float | None]
    intervals: dict[str, tuple[float, float]]
    fresnel: str = "conductor"
    channels: int = 1
    retroreflective: bool = False
    scheme: str = "mixture"

    @property
    def free(self) -> list[str]:
        """The names of the arguments."""
        return [name for name, value in self.parameters.items() if value is None]

    @property
    def fixed(self) -> dict[str, float]:
        """The numbers."""
        return {name: value for name, value in self.parameters.items() if value is not None}

    def of(self, function: str) -> dict[str, float | None]:
        """The parameters of one function, components of several wavelengths apart."""
        own = own_parameters(function, self.fresnel)
        found: dict[str, float | None] = {}
        for name, value in self.parameters.items():
            if name in own and self.channels > 1 and takes_channels(function):
                found |= {f"{name}.{letter}": value for letter in "xyz"}
            elif name in own or name not in OPTICS:
                found[name] = value
        return found

    def graph(self, function: str, native: bool, **options: Any) -> Graph:
        """The recorded function."""
        quantity = function
        if takes_channels(function):
            quantity = f"{self.fresnel}_{function.partition('_')[2]}"
            options |= {"channels": self.channels, "retroreflective": self.retroreflective}
        if self.scheme == "mixture":
            quantity = "sample_visible_mixture" if quantity == "sample_visible" else quantity
            options["mixture"] = True
        parameters = self.of(function)
        options["tables"] = self.density.tables(self.parameters, options.get("float64", False))
        if options["tables"] is not None and "alpha" in self.density.tabulated:  # is in the tables
            parameters["alpha"] = 1.0
        return Graph.of(self.density.name, quantity, parameters, native=native, **options)


def _intervals(
    density: Density, functions: Iterable[str], anisotropic: bool, fresnel: str
) -> dict[str, tuple[float, float]]:
    roughness, *shape = density.parameters
    ends = (roughness.lower, roughness.upper)
    angle = (-math.inf, math.inf)
    names = dict(zip(AXES, (ends, ends, angle), strict=True)) if anisotropic else {"alpha": ends}
    names |= {parameter.name: (parameter.lower, parameter.upper) for parameter in shape}
    for function in functions:
        names |= {name: OPTICS[name] for name in own_parameters(function, fresnel)}
    return names


def chosen(
    density: Density,
    functions: tuple[str, ...],
    values: Mapping[str, float],
    free: Iterable[str] | None,
    anisotropic: bool = False,
    fresnel: str = "conductor",
    channels: int = 1,
    retroreflective: bool = False,
    scheme: str = "mixture",
) -> Choice:
    """Sort the parameters into numbers and arguments; ValueError says in one sentence what does not fit."""
    if fresnel not in FRESNEL:
        raise ValueError(f"fresnel must be one of {', '.join(FRESNEL)}, got {fresnel!r}")
    if channels not in (1, 3):
        raise ValueError(f"channels must be 1 or 3, got {channels!r}")
    if scheme not in SCHEMES:
        raise ValueError(f"scheme must be one of {', '.join(SCHEMES)}, got {scheme!r}")
    free = None if free is None else tuple(free)
    anisotropic = anisotropic or any(name in AXES for name in (*values, *(free or ())))
    if anisotropic and not density.anisotropic:
        raise ValueError(f"{density.name} has no axes: its alpha is no stretch")
    intervals = _intervals(density, functions, anisotropic, fresnel)
    for name in (*values, *(free or ())):
        if name not in intervals:
            raise ValueError(
                f"{density.name} has no parameter {name!r} here, it takes {', '.join(intervals)}"
            )
        if name in values and free is not None and name in free:
            raise ValueError(f"{density.name}: {name} is either free or {values[name]}, not both")
    parameters: dict[str, float | None] = {}
    for name, ends in intervals.items():
        if name in values:
            parameters[name] = _inside(density.name, name, values[name], *ends)
        elif name == "rotation" and name not in (free or ()):
            parameters[name] = 0.0
        elif free is None or name in free:
            parameters[name] = None
        else:
            raise ValueError(f"{density.name}: {name} is neither free nor given; give its value, or free it")
    for name in density.tabulated:
        if parameters[name] is None and not density.exact:
            raise ValueError(
                f"{density.name}: {name} must be given: its formulas need double precision, "
                "and the tables that stand for them are of one shape"
            )
    return Choice(density, parameters, intervals, fresnel, channels, retroreflective, scheme)


def _inside(family: str, name: str, value: Any, lower: float, upper: float) -> float:
    kind = ("[", "]") if name in OPTICS else ("(", ")")
    interval = f"{kind[0]}{lower:g}, {upper:g}{kind[1]}"
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{family}: {name} must be a number in {interval}, got {value!r}") from None
    if not (lower < number < upper or (name in OPTICS and lower <= number <= upper)):
        raise ValueError(f"{family}: {name} must lie in {interval}, got {number:g}")
    return number
