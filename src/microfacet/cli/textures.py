"""Lookup textures among the outputs of `microfacet bake`: their options, and what is written."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from microfacet._files import replacing
from microfacet.cli.printing import announce, progress_line, say, where

__all__ = ["is_texture", "require_only", "taken", "texture_options", "write_texture"]

SUFFIXES = (".exr", ".raw")
#: The options that each sort of output takes alone.
_TEXTURES = (
    "format", "size", "half", "cosine_mapping", "roughness_mapping", "check", "snippets", "prefix",
)  # fmt: skip
_DATASETS = (
    "alpha", "material", "eta", "k", "cos_theta", "azimuth", "scattering", "walks", "seed", "dask", "memory",
)  # fmt: skip


class _Size(click.ParamType[Any]):
    """WIDTHxHEIGHT, or one number for both."""

    name = "size"

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """As two numbers."""
        if isinstance(value, tuple):
            return value
        found = re.fullmatch(r"([0-9]{1,6})(?:x([0-9]{1,6}))?", value)
        if found is None:
            self.fail(f"a size is WIDTHxHEIGHT, such as 64x64, got {value!r}", param, ctx)
        return int(found[1]), int(found[2] or found[1])


_OPTIONS = (
    click.option(
        "--format", type=click.Choice(["exr", "raw"]), help="Of a texture, if FILE does not say it."
    ),
    click.option(
        "--size", type=_Size(), default=(64, 64), metavar="WxH", help="Cosines x roughnesses; 64x64."
    ),
    click.option("--half", is_flag=True, help="Texels in half precision."),
    click.option(
        "--cosine-mapping",
        type=click.Choice(["linear", "sqrt"]),
        default="linear",
        help="What has even steps along a row: the cosine, or its root.",
    ),
    click.option(
        "--roughness-mapping",
        type=click.Choice(["sqrt", "linear"]),
        default="sqrt",
        help="The same from row to row: the root of alpha, or alpha.",
    ),
    click.option(
        "--check",
        type=click.IntRange(min=0),
        default=32,
        help="Roughnesses at which to measure the lookup; 32.",
    ),
    click.option(
        "--snippet", "snippets", multiple=True, metavar="LANGUAGE", help="Also write FILE.glsl, say; repeat."
    ),
    click.option("--prefix", metavar="NAME", help="Of the names in snippets; FAMILY_ otherwise."),
)


def texture_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """The options of textures, for a command."""
    for option in reversed(_OPTIONS):
        function = option(function)
    return function


def is_texture(output: str, format: str | None) -> bool:
    """Whether a texture is asked for, rather than a dataset."""
    return format is not None or Path(output).suffix in SUFFIXES


def require_only(ctx: click.Context, texture: bool) -> None:
    """UsageError where an option was given that this sort of output does not take."""
    names = {parameter.name: parameter.opts[0] for parameter in ctx.command.params}
    for name in _DATASETS if texture else _TEXTURES:
        if ctx.get_parameter_source(name) is not ParameterSource.DEFAULT:
            whose = "datasets (.nc, .zarr)" if texture else "lookup textures (.exr, .raw)"
            raise click.UsageError(f"{names[name]} is an option of {whose} alone")


def taken(options: dict[str, Any]) -> dict[str, Any]:
    """The options of textures, which are no longer among the others then."""
    return {name: options.pop(name) for name in _TEXTURES}


def write_texture(
    kind: str,
    family: Any,
    shape: Any,
    output: str,
    threads: int | None,
    as_json: bool,
    *,
    half: bool,
    snippets: tuple[str, ...],
    prefix: str | None,
    **options: Any,
) -> None:
    """Bake it, write it and its snippets, and say where they are and how far a lookup is off."""
    import microfacet as mf
    from microfacet._bake.texture.snippets import require_names, suffix

    prefix = require_names(snippets, f"{getattr(family, 'name', family)}_" if prefix is None else prefix)
    with progress_line() as progress:
        table = mf.lookup_texture(
            kind.replace("-", "_"),
            family,
            dtype="float16" if half else "float32",
            shape=shape,
            output=output,
            threads=threads,
            progress=progress,
            **options,
        )
    written = [output]
    for language in snippets:
        written.append(f"{output}{suffix(language)}")
        with replacing(written[-1]) as stream:
            stream.write(table.snippet(language, prefix).encode())
    if as_json:
        _, height, width, _ = table.values.shape
        found = {"size": [width, height], "slices": len(table.values), "channels": list(table.channels)}
        paths = {"path": where(output), "snippets": [where(path) for path in written[1:]]}
        announce(json.dumps({**paths, **found, "errors": table.errors}), *written)
        return
    for path in written:
        announce(where(path), *written)
    if "lookup" in table.errors:
        found = table.errors["lookup"]
        parts = (
            f"{name} {found[name]['mean']:.1e} and {found[name]['largest']:.1e}" for name in table.channels
        )
        say(f"error of what is read between the texels, mean and largest: {', '.join(parts)}")
