"""The shape parameters at which tests run: what a family states, or harder values that a test has for it."""

from __future__ import annotations

from collections.abc import Mapping

import microfacet as mf

__all__ = ["NAMES", "one_shape", "several_shapes"]

#: Of the shape parameter of each family that has one.
NAMES = {family.name: family.parameters[1].name for family in mf.families() if len(family.parameters) > 1}


def several_shapes(harder: Mapping[str, tuple[float, ...]]) -> dict[str, tuple[float, ...]]:
    """A few values for each family with a shape parameter."""
    return {
        family.name: harder.get(family.name, family.parameters[1].examples)
        for family in mf.families()
        if family.name in NAMES
    }


def one_shape(harder: Mapping[str, float]) -> dict[str, dict[str, float]]:
    """One value, as keyword arguments, for each family; none for those without a shape parameter."""
    return {
        family.name: {own.name: harder.get(family.name, own.pictured) for own in family.parameters[1:]}
        for family in mf.families()
    }
