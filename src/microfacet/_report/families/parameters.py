"""Which parameters each family of the report is drawn with."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

import microfacet as mf

__all__ = ["Example", "choose", "example"]

#: The curves' parameters, then those of the notebooks' figures: the two routes to sigma, the samples.
_NOTEBOOK: dict[str, tuple[dict[str, float], dict[str, float], dict[str, float]]] = {
    "beckmann": ({"alpha": 0.5}, {"alpha": 0.7}, {"alpha": 1.3}),
    "ggx": ({"alpha": 0.5}, {"alpha": 0.2}, {"alpha": 0.6}),
    "gtr": ({"alpha": 0.5, "gamma": 1.5}, {"alpha": 0.1, "gamma": 1.0}, {"alpha": 0.2, "gamma": 1.0}),
    "student_t": ({"alpha": 0.5, "gamma": 3.0}, {"alpha": 0.7, "gamma": 3.0}, {"alpha": 1.2, "gamma": 2.3}),
    "k0": ({"alpha": 0.5}, {"alpha": 0.8}, {"alpha": 1.7}),
    "bessel_k": ({"alpha": 0.5, "a": 1.6}, {"alpha": 2.1, "a": 1.5}, {"alpha": 0.7, "a": 1.3}),
}

#: The values of a shape parameter that one figure sets side by side.
SHAPES = {"gtr": (1.0, 1.5, 3.0), "student_t": (1.7, 2.0, 5.0), "bessel_k": (0.6, 1.0, 4.0)}


class Example(NamedTuple):
    """A family's distributions as the report draws them."""

    curves: Any
    roughness: tuple[Any, ...]
    shapes: tuple[Any, ...]
    sigma: Any
    samples: Any


def choose(names: Collection[str] | None, parameters: Mapping[str, float] | None) -> list[Any]:
    """The families asked for, in the library's order, after a check of the parameters given for them.

    A parameter that none of the families has, or a value outside its interval, is a ValueError.
    """
    known = [family.name for family in mf.families()]
    for name in names or ():
        if name not in known:
            raise ValueError(f"family must be one of {', '.join(known)}, got {name!r}")
    families = [family for family in mf.families() if not names or family.name in names]
    for name in parameters or {}:
        if not any(parameter.name == name for family in families for parameter in family.parameters):
            raise ValueError(f"{name} is no parameter of {', '.join(family.name for family in families)}")
    for family in families:
        example(family, parameters)
    return families


def example(family: Any, parameters: Mapping[str, float] | None) -> Example:
    """Distributions of a family: the notebooks' parameters, save those that `parameters` replaces."""
    given = parameters or {}
    own = {p.name: given[p.name] for p in family.parameters if p.name in given}
    curves, sigma, samples = (notebook | own for notebook in _NOTEBOOK[family.name])
    roughness = [curves | {"alpha": curves["alpha"] * factor} for factor in (0.5, 1.0, 2.0)]
    shapes = []
    if len(family.parameters) > 1:
        name = family.parameters[1].name
        values = {*SHAPES[family.name], *([own[name]] if name in own else [])}
        shapes = [curves | {name: value} for value in sorted(values)]
    return Example(
        family.cls(**curves),
        tuple(family.cls(**p) for p in roughness),
        tuple(family.cls(**p) for p in shapes),
        family.cls(**sigma),
        family.cls(**samples),
    )
