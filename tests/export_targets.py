"""Where exported functions run: targets take columns of inputs for several functions and give results."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import export_programs as programs
import export_tools as tools
from export_choices import file_of, named, rows_of
from microfacet._export.choice import Choice
from microfacet._export.evaluate import Evaluator
from microfacet._export.languages import languages
from microfacet._export.libraries import library_of

__all__ = ["TARGETS", "Columns", "Results", "Target"]

Columns = Mapping[str, NDArray[Any]]
Results = dict[str, NDArray[Any]]
Target = Callable[[Choice, Mapping[str, Columns]], dict[str, Results]]


def on_numpy(choice: Choice, given: Mapping[str, Columns]) -> dict[str, Results]:
    found = {}
    for name, columns in given.items():
        graph = choice.graph(name, True)
        inputs = [columns[entry].astype(np.float32) for entry in graph.inputs]
        values = Evaluator(graph, library_of("numpy"))(inputs)
        found[name] = {
            entry: np.asarray(value) for (entry, _), value in zip(graph.results, values, strict=True)
        }
    return found


def on_c(compiler: str, flags: list[str], choice: Choice, given: Mapping[str, Columns]) -> dict[str, Results]:
    text, functions, graphs = file_of("c", choice, list(given))
    flags = [*flags, "-Wno-unused-function"]  # what is always there in a header is no fault in it
    ending, extern = (".cpp", 'extern "C" ') if "++" in compiler else (".c", "")
    source = text + programs.wrapped(languages()["c"], functions, extern)
    with tempfile.TemporaryDirectory() as folder:
        library = tools.compiled_c(Path(folder), source, compiler, *flags, ending=ending)
    return {
        name: named(
            graphs[name],
            tools.called(library, name, rows_of(function, given[name]), programs.outputs_of(function)),
        )
        for name, function in functions.items()
    }


def on_wgsl(choice: Choice, given: Mapping[str, Columns]) -> dict[str, Results]:
    found = {}
    for name, columns in given.items():
        text, functions, graphs = file_of("wgsl", choice, [name])
        source = programs.compute_wgsl(languages()["wgsl"], name, functions[name], text)
        outputs = programs.outputs_of(functions[name])
        values = tools.dispatched(source, rows_of(functions[name], columns), outputs)
        found[name] = named(graphs[name], values)
    return found


def on_webgl(choice: Choice, given: Mapping[str, Columns]) -> dict[str, Results]:
    sources, rows, graphs = {}, {}, {}
    for name, columns in given.items():
        text, functions, found = file_of("glsl-es", choice, [name])
        sources[name] = programs.fragment_es(languages()["glsl-es"], name, functions[name], text)
        rows[name], graphs[name] = rows_of(functions[name], columns), found[name]
    results, _ = tools.drawn(sources, rows, width=512)
    return {name: named(graphs[name], results[name]) for name in sources}


#: By the words that documents use.
TARGETS: dict[str, Target] = {
    "NumPy": on_numpy,
    "C -O0": partial(on_c, "g++", ["-O0"]),
    "C -O2": partial(on_c, "clang", ["-O2"]),
    "C -O3 -ffast-math": partial(on_c, "g++", ["-O3", "-ffast-math"]),
    "clang -O3 -ffast-math": partial(on_c, "clang", ["-O3", "-ffast-math"]),
    "WGSL": on_wgsl,
    "WebGL 2": on_webgl,
}
