"""`--density FILE`: a density of one's own wherever a family may stand."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import click

import microfacet as mf
from microfacet._user_family import family_of

__all__ = ["DensityCommand", "densities_option", "density_option", "filled", "own_family"]

Command = Callable[..., Any]
_GIVEN = "microfacet.density"
_ROUGHNESS = ("alpha", "alpha_x", "alpha_y")


class DensityCommand(click.Command):
    """A command whose argument FAMILY is left out where there is a --density."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Look for the option before the parser looks for the argument."""
        ctx.meta[_GIVEN] = any(text == "--density" or text.startswith("--density=") for text in args)
        return super().parse_args(ctx, args)

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """All parameters, but FAMILY where a file stands for it."""
        found = super().get_params(ctx)
        return [one for one in found if one.name != "family" or not ctx.meta.get(_GIVEN)]


def own_family(path: str) -> Any:
    """The family of the density in a file, called like the file where that is a word."""
    ndf = mf.read_density(path)
    stem = Path(path).stem
    known = stem.isidentifier() and len(stem) <= 40 and stem not in {family.name for family in mf.families()}
    return family_of(ndf, stem if known else "density", stem if stem.isprintable() else "density")


def density_option(command: Command) -> Command:
    """The option; the command, a `DensityCommand`, gets the family in place of a name."""

    @click.option(
        "--density",
        metavar="FILE",
        type=click.Path(dir_okay=False),
        help="In place of FAMILY: one's own density.",
    )
    @functools.wraps(command)
    def wrapped(density: str | None, **rest: Any) -> Any:
        return command(**rest) if density is None else command(**rest | {"family": own_family(density)})

    return wrapped


def densities_option(command: Command) -> Command:
    """The option where several families may be named, and several densities: the command's `families` has
    both, where a density is given without any of them all families.
    """

    @click.option(
        "--density",
        "densities",
        multiple=True,
        metavar="FILE",
        type=click.Path(dir_okay=False),
        help="A density of one's own besides the families; repeat for several.",
    )
    @functools.wraps(command)
    def wrapped(families: tuple[Any, ...], densities: tuple[str, ...], **rest: Any) -> Any:
        if densities:
            named = families or tuple(family.name for family in mf.families() if not family.singular)
            families = (*named, *map(own_family, densities))
        return command(families=families, **rest)

    return wrapped


def filled(family: Any, values: Mapping[str, float]) -> dict[str, float]:
    """The values, with the roughness that a density brings where none is given."""
    brought: Mapping[str, float] = getattr(family, "roughness", {})
    return dict(values) if any(name in values for name in _ROUGHNESS) else {**brought, **values}
