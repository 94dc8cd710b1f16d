"""Parameters of the families as options, and from what is given to a distribution."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping
from typing import Any

import click

import microfacet as mf
from microfacet.cli.densities import filled

__all__ = [
    "arguments",
    "axes_options",
    "distribution",
    "family_named",
    "parameter_options",
    "shape_options",
    "stretched",
]

Command = Callable[..., Any]


def shape_options(
    kind: Any = float, metavar: str = "X", say_pictured: bool = False
) -> Callable[[Command], Command]:
    """An option for each shape parameter that a family has; the command gets those given as
    `shape_given`.

    Values are of `kind`; `say_pictured` has the help name the value where none is given.
    """
    helps: dict[str, dict[str, list[str]]] = {}
    for family in mf.families():
        for own in family.parameters[1:]:
            without = f" ({own.pictured:g} without)" if say_pictured else ""
            helps.setdefault(own.name, {}).setdefault(own.meaning, []).append(f"{family.name}{without}")

    def decorate(command: Command) -> Command:
        @functools.wraps(command)
        def wrapped(**options: Any) -> Any:
            shape = {name: value for name in helps if (value := options.pop(name)) is not None}
            return command(shape_given=shape, **options)

        for name, owners in reversed(helps.items()):
            words = ", ".join(
                f"{meaning[:1].lower()}{meaning[1:]} of {' and '.join(of)}" for meaning, of in owners.items()
            )
            text, flag = f"{words[:1].upper()}{words[1:]}.", f"--{name.replace('_', '-')}"
            wrapped = click.option(flag, name, type=kind, metavar=metavar, help=text)(wrapped)
        return wrapped

    return decorate


def parameter_options(command: Command) -> Command:
    """Options for the parameters of all families; the command gets those given as `parameters`."""

    @click.option("--alpha", type=float, metavar="X", help="Roughness, in slope units.")
    @shape_options()
    @functools.wraps(command)
    def wrapped(alpha: float | None, shape_given: dict[str, float], **rest: Any) -> Any:
        given = {} if alpha is None else {"alpha": alpha}
        return command(parameters=given | shape_given, **rest)

    return wrapped


def axes_options(command: Command) -> Command:
    """Options for roughness along two axes, added to `parameters` (their angle in radians)."""

    @click.option(
        "--alpha-x",
        "--alpha-u",
        "alpha_x",
        type=float,
        metavar="X",
        help="Roughness along x, with --alpha-y in place of --alpha.",
    )
    @click.option("--alpha-y", "--alpha-v", "alpha_y", type=float, metavar="X", help="Roughness along y.")
    @click.option("--rotation", type=float, metavar="DEGREES", help="Of these axes, counter-clockwise.")
    @functools.wraps(command)
    def wrapped(
        parameters: dict[str, float],
        alpha_x: float | None,
        alpha_y: float | None,
        rotation: float | None,
        **rest: Any,
    ) -> Any:
        angle = None if rotation is None else math.radians(rotation)
        axes = {"alpha_x": alpha_x, "alpha_y": alpha_y, "rotation": angle}
        given = {name: value for name, value in axes.items() if value is not None}
        return command(parameters=parameters | given, **rest)

    return wrapped


def family_named(name: Any) -> Any:
    """The family of that name, or one that is there already; ValueError names those that exist."""
    if isinstance(name, mf.Family):
        return name
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
    values = filled(family, values)
    arguments(family, values)
    return family.cls(**values)


def stretched(family: Any, values: Mapping[str, float]) -> Any:
    """The frozen distribution, of one roughness or of two along axes; ValueError when values do not fit."""
    axes = [name for name in values if name in ("alpha_x", "alpha_y", "rotation")]
    if axes and not family.anisotropic:
        raise ValueError(f"{family.name} has no {axes[0]}: its alpha is no stretch")
    values = filled(family, values)
    try:
        return family.cls(**values)
    except TypeError:  # a parameter that the family does not have, or one that it lacks
        names = " and ".join(parameter.name for parameter in family.parameters)
        given = " and ".join(values) or "none"
        raise ValueError(f"{family.name} takes {names}, got {given}") from None
