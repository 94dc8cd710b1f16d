"""From the options of a command line to the parameters of a family."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import microfacet as mf

__all__ = ["arguments", "distribution", "family_named", "stretched"]


def family_named(name: str) -> Any:
    """The family of that name; ValueError names those that exist."""
    known = {family.name: family for family in mf.families()}
    if name not in known:
        raise ValueError(f"family must be one of {', '.join(known)}, got {name!r}")
    return known[name]


def arguments(family: Any, values: Mapping[str, float]) -> tuple[float, ...]:
    """The values in the order of the ufuncs; ValueError when one is missing or one too many."""
    names = [parameter.name for parameter in family.parameters]
    missing = [name for name in names if name not in values]
    extra = [name for name in values if name not in names]
    if missing:
        raise ValueError(f"{family.name} needs --{missing[0]}")
    if extra:
        raise ValueError(f"{family.name} has no parameter {extra[0]}, it takes {' and '.join(names)}")
    return tuple(values[name] for name in names)


def distribution(family: Any, values: Mapping[str, float]) -> Any:
    """The frozen distribution; ValueError when a value lies outside its interval."""
    arguments(family, values)
    return family.cls(**values)


def stretched(family: Any, values: Mapping[str, float]) -> Any:
    """The frozen distribution, of one roughness or of two along axes; ValueError when values do not fit."""
    axes = [name for name in values if name in ("alpha_x", "alpha_y", "rotation")]
    if axes and not family.anisotropic:
        raise ValueError(f"{family.name} has no {axes[0]}: its alpha is no stretch")
    try:
        return family.cls(**values)
    except TypeError:  # a parameter that the family does not have, or one that it lacks
        names = " and ".join(parameter.name for parameter in family.parameters)
        given = " and ".join(values) or "none"
        raise ValueError(f"{family.name} takes {names}, got {given}") from None
