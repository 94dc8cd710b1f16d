"""MaterialX: a document of node definitions, and a file beside it for each language of its generators."""

from __future__ import annotations

import re
from dataclasses import replace
from xml.sax.saxutils import escape

from microfacet._export.file import Content, Tables, commented, function_of, plain_file
from microfacet._export.language import Language
from microfacet._export.languages import glsl_es, metal, osl, slang
from microfacet._export.printer import Function

__all__ = ["LANGUAGE"]

# What each target of a shader generator reads; GLSL is also for ESSL and Vulkan. A file is read once for each
# node that is used, hence the guards.
_TARGETS = {
    "genglsl": replace(glsl_es.LANGUAGE, preamble="", note="", out_only=True),
    "genosl": replace(
        osl.LANGUAGE, note="", ending=".osl", vectors={2: "vector2", 3: "vector", 4: "vector4"}, out_only=True
    ),
    "genmsl": replace(metal.LANGUAGE, preamble="", function="{type} {name}({parameters}) {{", out_only=True),
    "genslang": replace(slang.LANGUAGE, out_only=True),
}
_TYPES = {1: "float", 2: "vector2", 3: "vector3", 4: "vector4"}
_VALUES = {1: "0", 2: "0.5, 0.5", 3: "0, 0, 1", 4: "0.5, 0.5, 0.5, 0.5"}


def _quoted(text: str) -> str:
    return '"' + escape(text, {'"': "&quot;"}) + '"'


def _default(name: str, count: int, content: Content) -> str:
    """A value that is in the domain of an argument."""
    if name in content.intervals:
        lower, upper = content.intervals[name]
        value = f"{0.3 if lower < 0.3 < upper else min(lower + 1.25, 0.5 * (lower + upper)):g}"
        return ", ".join([value] * count)
    return _VALUES[count]


def _definition(name: str, content: Content, function: Function) -> list[str]:
    full = content.prefix + name
    inputs = [
        f'    <input name="{argument}" type="{_TYPES[count]}" value="{_default(argument, count, content)}" />'
        for argument, _, count in function.parameters
    ]
    outputs = [
        f'    <output name="{"out" if len(function.results) == 1 else result}" type="{_TYPES[count]}" />'
        for result, _, count in function.results
    ]
    head = f'  <nodedef name="ND_{full}" node="{full}" nodegroup="pbr" doc={_quoted(content.meanings[name])}>'
    return [head, *inputs, *outputs, "  </nodedef>"]


def _possible(language: Language, content: Content) -> tuple[dict[str, Function], str]:
    """The functions that a target can have, and why not the last that it cannot."""
    functions, refused = {}, ""
    for name in content.graphs:
        try:
            functions[name] = function_of(language, content, name, Tables(language, content.prefix))
        except ValueError as error:
            refused = str(error)
    return functions, refused


def _document(content: Content, stem: str) -> dict[str, str]:
    """The text of the document, and of the files beside it."""
    files: dict[str, str] = {}
    implementations: dict[str, list[str]] = {name: [] for name in content.graphs}
    definitions: dict[str, Function] = {}
    for target, language in _TARGETS.items():
        functions, refused = _possible(language, content)
        file = f"{stem}_{target}{language.ending}"
        for name, function in functions.items():
            definitions.setdefault(name, function)
            full = content.prefix + name
            implementations[name].append(
                f'  <implementation name="IM_{full}_{target}" nodedef="ND_{full}" target="{target}" '
                f"file={_quoted(file)} function={_quoted(full)} />"
            )
        if functions:
            graphs = {name: content.graphs[name] for name in functions}
            text = plain_file(language, replace(content, graphs=graphs, head=[]))
            guard = re.sub(r"\W", "_", f"{content.prefix}{target}").upper()
            files[file] = (
                f"{commented(language, content.head)}\n\n#ifndef {guard}\n#define {guard}\n\n{text}\n#endif\n"
            )
    lines = ['<?xml version="1.0"?>', f'<materialx version="1.39" doc={_quoted(chr(10).join(content.head))}>']
    for name, listed in implementations.items():
        if not listed:
            raise ValueError(refused)
        lines += [*_definition(name, content, definitions[name]), *listed]
    return {f"{stem}.mtlx": "\n".join([*lines, "</materialx>"]) + "\n", **files}


LANGUAGE = Language(
    name="materialx",
    title="MaterialX",
    ending=".mtlx",
    vectors={2: "vector2", 3: "vector3", 4: "vector4"},
    note=f"Node definitions, with implementations for {', '.join(_TARGETS)} in the files beside this one.",
    document=_document,
)
