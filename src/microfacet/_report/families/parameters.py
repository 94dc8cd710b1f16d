"""Which parameters each family of the report is drawn with."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

import microfacet as mf

__all__ = ["Example", "choose", "example"]


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
    """Distributions of a family: the parameters of its figures, save those that `parameters` replaces."""
    given = parameters or {}
    names = [parameter.name for parameter in family.parameters]
    own = {name: given[name] for name in names if name in given}
    curves, sigma, samples = (dict(zip(names, values, strict=True)) | own for values in family.figures)
    roughness = [curves | {"alpha": curves["alpha"] * factor} for factor in (0.5, 1.0, 2.0)]
    shapes: list[dict[str, float]] = []
    for shape in family.parameters[1:]:
        values = {*shape.examples, *([own[shape.name]] if shape.name in own else [])}
        shapes += [curves | {shape.name: value} for value in sorted(values)]
    return Example(
        family.cls(**curves),
        tuple(family.cls(**p) for p in roughness),
        tuple(family.cls(**p) for p in shapes),
        family.cls(**sigma),
        family.cls(**samples),
    )
