"""The command `microfacet export`: a family as source text of another language."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any

import click

import microfacet as mf
from microfacet._export.choice import SCHEMES
from microfacet._export.functions import FRESNEL, FUNCTIONS, GROUPS, OPTICS
from microfacet._export.languages import languages
from microfacet.cli.densities import DensityCommand, density_option
from microfacet.cli.parameters import shape_options
from microfacet.cli.printing import announce, console, show, where

__all__ = ["export"]

_AXES = {"alpha_x": "Roughness along x.", "alpha_y": "Roughness along y."}


def _parameter_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """An option for each parameter that a family or a material has; those given become `fixed`."""
    before = {"alpha": "Roughness.", **_AXES}
    after = dict.fromkeys(OPTICS, "Of materials.")

    @functools.wraps(command)
    def wrapped(shape_given: dict[str, float], **given: Any) -> Any:
        fixed = {name: given.pop(name) for name in (*before, *after)}
        rotation = given.pop("rotation")
        fixed["rotation"] = None if rotation is None else math.radians(rotation)
        fixed = {name: value for name, value in fixed.items() if value is not None}
        return command(fixed=fixed | shape_given, **given)

    wrapped = click.option("--rotation", type=float, metavar="DEGREES", help="Of the axes.")(wrapped)
    return _options(before)(shape_options()(_options(after)(wrapped)))


def _options(helps: dict[str, str]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    def decorate(command: Callable[..., Any]) -> Callable[..., Any]:
        for name, text in reversed(helps.items()):
            flag = f"--{name.replace('_', '-')}"
            command = click.option(flag, name, type=float, metavar="X", help=text)(command)
        return command

    return decorate


def _show_list(ctx: click.Context, _: click.Parameter, asked: bool) -> None:
    """Print the languages and functions, and end."""
    if asked:
        rows = [[language.name, language.title, language.note] for language in languages().values()]
        show(console(), ["language", "title", "note"], rows, left=3)
        click.echo("\nfunctions: " + ", ".join((*FUNCTIONS, *GROUPS)))
        ctx.exit()


def _names(_: click.Context, __: click.Parameter, text: str | None) -> list[str] | None:
    return None if text is None else [name.strip() for name in text.split(",") if name.strip()]


@click.command(cls=DensityCommand)
@click.argument("language")
@click.argument("family")
@density_option
@click.option("--functions", callback=_names, metavar="NAMES", help="Separated by commas.",
              default="D,G1,sample_visible,pdf_visible", show_default=True)  # fmt: skip
@click.option("--free", callback=_names, metavar="NAMES", help="Arguments; all that have no value otherwise.")
@_parameter_options
@click.option("--anisotropic", is_flag=True, help="Roughness along two axes.")
@click.option("--fresnel", type=click.Choice(FRESNEL), default="conductor", help="Of conductors.")
@click.option("--channels", type=click.Choice(["1", "3"]), default="1", help="Wavelengths of conductors.")
@click.option("--retroreflective", is_flag=True, help="Conductors send light back whence it came.")
@click.option("--scheme", type=click.Choice(SCHEMES), default="mixture", help="Of visible normals.")
@click.option("--prefix", default="", metavar="P", help="What the names of all functions begin with.")
@click.option("-o", "--output", type=click.Path(dir_okay=False), help="A file; standard output otherwise.")
@click.option("--list", is_flag=True, is_eager=True, expose_value=False, callback=_show_list,
              help="Print the languages and functions.")  # fmt: skip
def export(
    language: str,
    family: Any,
    functions: list[str],
    free: list[str] | None,
    fixed: dict[str, float],
    channels: str,
    output: str | None,
    **options: Any,
) -> None:
    """Write the formulas of a family as source text of another language, in single precision.

    \b
    Examples:
      microfacet export glsl student_t
      microfacet export c ggx --functions D,sigma --anisotropic -o ggx.h
      microfacet export glsl --density own.json --functions D,G1
      microfacet export wgsl student_t --functions conductor --gamma 2.5 --fresnel schlick -o metal.wgsl
    """
    given: dict[str, Any] = {**options, **fixed}
    text = mf.export(language, family, functions, free=free, path=output, channels=int(channels), **given)
    if output is None:
        click.echo(text, nl=False)
    else:
        announce(where(output), output)
