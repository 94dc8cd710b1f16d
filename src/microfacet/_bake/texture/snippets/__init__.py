"""Source texts that read a lookup texture: the formulas once, and a language in a file of its own.

The formulas are written with + - * / and a few functions, which all languages share. `pair`, `.first`,
`.second` and `fetch` are what they differ in; each `Language` says how it writes those.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from microfacet._bake.texture.axes import MAPPINGS, Axis
from microfacet._bake.texture.snippets import c, cuda, glsl, glsl_es, hlsl, metal, osl, slang, wgsl
from microfacet._bake.texture.snippets.language import Language

if TYPE_CHECKING:
    from microfacet._bake.texture.table import LookupTexture

__all__ = ["LANGUAGES", "require_names", "snippet", "suffix"]

LANGUAGES = {
    "glsl": glsl.LANGUAGE,
    "glsl-es": glsl_es.LANGUAGE,
    "hlsl": hlsl.LANGUAGE,
    "wgsl": wgsl.LANGUAGE,
    "slang": slang.LANGUAGE,
    "metal": metal.LANGUAGE,
    "cuda": cuda.LANGUAGE,
    "c": c.LANGUAGE,
    "osl": osl.LANGUAGE,
}


class Function(NamedTuple):
    """Of a snippet: parameters and locals are (type, name[, value]); does it read the texture?"""

    says: str
    type: str
    name: str
    parameters: tuple[tuple[str, str], ...]
    locals: tuple[tuple[str, str, str], ...]
    result: str
    reads: bool = False


_TURQUIN = Function(
    "The factor of a lobe of normal reflectance F0 (Turquin 2019); missing is that of the view.",
    "colour", "turquin", (("colour", "F0"), ("real", "missing")),
    (), "1.0 + F0 * (missing / max(1.0 - missing, 1.0e-6))",
)  # fmt: skip
_FRESNEL_AVERAGE = Function(
    "Schlick's reflectance under light from all sides.",
    "colour", "fresnel_average", (("colour", "F0"),), (), "F0 + (1.0 - F0) / 21.0",
)  # fmt: skip
_KULLA_CONTY = Function(
    "The lobe that is added to a single-scattering one, without the cosine (Kulla and Conty 2017).",
    "colour", "kulla_conty",
    (("colour", "F_average"), ("real", "missing_i"), ("real", "missing_o"), ("real", "missing_average")),
    (
        ("real", "lobe", "missing_i * missing_o / (3.14159265 * max(missing_average, 1.0e-6))"),
        ("real", "average", "1.0 - missing_average"),
    ),
    "F_average * F_average * (average * lobe) / (1.0 - F_average * missing_average)",
)  # fmt: skip
_AMBIENT = Function(
    "Albedo of a lobe of normal reflectance F0, which scales the prefiltered environment (Karis 2013).",
    "colour", "ambient", (("colour", "F0"), ("pair", "scale_bias")),
    (), "F0 * scale_bias.first + scale_bias.second",
)  # fmt: skip
_AMBIENT_COMPENSATED = Function(
    "The same with the energy of all orders, by Turquin's factor: scale + bias is the albedo of a mirror.",
    "colour", "ambient_compensated", (("colour", "F0"), ("pair", "scale_bias")),
    (("real", "albedo", "max(scale_bias.first + scale_bias.second, 1.0e-6)"),),
    "(F0 * scale_bias.first + scale_bias.second) * (1.0 + F0 * ((1.0 - albedo) / albedo))",
)  # fmt: skip


def snippet(table: LookupTexture, language: str, prefix: str) -> str:
    """The text of a language that reads this texture."""
    require_names([language], prefix)
    to = LANGUAGES[language]
    slices, height, width, _ = table.values.shape
    own = f"{prefix}{table.kind}_"  # of helpers, so that two textures of a family can be read by one program
    preamble = to.preamble.replace("$width", str(width)).replace("$height", str(slices * height))
    preamble = preamble.replace("$", own)
    parts = [_head(table, to), *([preamble.rstrip()] if preamble else [])]
    parts += [_printed(function, to, prefix, own) for function in _functions(table)]
    return "\n\n".join(parts) + "\n"


def suffix(language: str) -> str:
    """What the names of files of a language end with."""
    return LANGUAGES[language].suffix


def require_names(languages: Iterable[str], prefix: str) -> str:
    """The prefix; ValueError where it is none, or a language is not one of ours."""
    for language in languages:
        if language not in LANGUAGES:
            raise ValueError(f"snippet: language must be one of {', '.join(LANGUAGES)}, got {language!r}")
    if prefix and not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", prefix):
        raise ValueError(f"snippet: prefix must be the beginning of a name, of ASCII letters, got {prefix!r}")
    return prefix


def _functions(table: LookupTexture) -> list[Function]:
    if table.kind == "split_sum":
        return [_texel(table, "split_sum", "Scale and bias."), _AMBIENT, _AMBIENT_COMPENSATED]
    lobes = [_TURQUIN, _FRESNEL_AVERAGE, _KULLA_CONTY]
    if table.kind == "energy":
        return [_texel(table, "missing_energy", "1 - E, and its average over light from all sides."), *lobes]
    missing = Function(
        "1 - E, and its average over light from all sides.",
        "pair", "missing_energy", (("pair", "albedo"),), (), "pair(1.0 - albedo.first, 1.0 - albedo.second)",
    )  # fmt: skip
    return [_texel(table, "albedo", "E, and its average over light from all sides."), missing, *lobes]


def _texel(table: LookupTexture, name: str, says: str) -> Function:
    """What is read for a cosine, alpha and shape: from one image, or from the slices next to the shape."""
    slices, height, _, _ = table.values.shape
    parameters = [("real", "cosine"), ("real", "alpha")]
    places = [
        ("real", "x", _coordinate(table.cosine, "cosine")),
        ("real", "y", _coordinate(table.roughness, "alpha")),
    ]
    if table.shape is None or slices == 1:
        return Function(says, "pair", name, tuple(parameters), tuple(places), "fetch(x, y)", True)
    parameters.append(("real", table.shape.name))
    edge = 0.5 / height
    places += [
        ("real", "row", f"min(max(y, {edge:.9f}), {1 - edge:.9f})"),
        ("real", "place", f"min(max({_slice(table.shape, slices)}, 0.0), {slices - 1}.0)"),
        ("real", "below", f"min(floor(place), {slices - 2}.0)"),
        ("real", "part", "place - below"),
        ("real", "y0", f"(below + row) / {slices}.0"),
        ("real", "y1", f"(below + 1.0 + row) / {slices}.0"),
        ("pair", "t0", "fetch(x, y0)"),
        ("pair", "t1", "fetch(x, y1)"),
        ("real", "a", "t0.first + (t1.first - t0.first) * part"),
        ("real", "b", "t0.second + (t1.second - t0.second) * part"),
    ]
    return Function(says, "pair", name, tuple(parameters), tuple(places), "pair(a, b)", True)


def _coordinate(axis: Axis, name: str) -> str:
    return MAPPINGS[axis.mapping].text.format(f"max({name}, 0.0)")


def _slice(axis: Axis, slices: int) -> str:
    """The number of the slice, which need not be whole, as a formula of the shape."""
    mapping = MAPPINGS[axis.mapping]
    low, high = (float(mapping.forward(np.array(end))) for end in (axis.low, axis.high))
    return f"({mapping.text.format(axis.name)} - {_number(low)}) * {_number((slices - 1) / (high - low))}"


def _number(value: float) -> str:
    text = f"{abs(value):.9g}"
    text = text if "." in text or "e" in text else text + ".0"
    if "e" in text and "." not in text:
        text = text.replace("e", ".0e")
    return text if value >= 0 else f"(-{text})"


def _printed(function: Function, to: Language, prefix: str, own: str) -> str:
    def declared(pattern: str, kind: str, name: str, value: str = "") -> str:
        return pattern.format(type=to.type(kind, own), name=name, value=to.expression(value, own))

    parameters = [declared(to.parameter, *parameter) for parameter in function.parameters]
    head = to.function.format(
        type=to.type(function.type, own),
        name=prefix + function.name,
        parameters=", ".join(([to.table] if function.reads else []) + parameters),
    )
    lines = [declared(to.local, *local) for local in function.locals]
    lines.append(f"return {to.expression(function.result, own)};")
    return "\n".join([f"// {function.says}", head, *(f"    {line}" for line in lines), "}"])


def _head(table: LookupTexture, to: Language) -> str:
    slices, height, width, _ = table.values.shape
    lines = [
        f"Reads the lookup texture {table.kind} of {table.family}, {width} x {height}"
        + (f" texels in {slices} slices below each other." if slices > 1 else " texels."),
        f"Made by: {table.command}",
        f"Channels: {', '.join(table.channels)}. First row: the smoothest, at texture coordinate 0.",
        f"Bind {to.binding}.",
    ]
    if "lookup" in table.errors:
        found = table.errors["lookup"]
        told = (f"{name} {found[name]['mean']:.1e}, {found[name]['largest']:.1e}" for name in table.channels)
        lines.append(f"Measured error of what is read, mean and largest: {'; '.join(told)}.")
    lines.append(f"{table.metadata['made_by']}, BSD-3-Clause licence.")
    return "\n".join(f"// {line}" for line in lines)
