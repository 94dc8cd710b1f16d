"""Printed text, compiled by what compiles each language and run wherever this machine can run it.

The graphs are made by hand and hold every operation; families and materials are in test_export_families.py.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import export_programs as programs
import export_tools as tools
from graph_cases import CASES, evaluate
from microfacet._export.graph import Graph
from microfacet._export.languages import languages

SHADERS = [name for name in CASES if name != "native"]  # they have no expm1 and no log1p
ROWS = 192


@cache
def graphs(*names: str) -> dict[str, Graph]:
    return {name: CASES[name]() for name in names}


@cache
def rows_of(name: str) -> NDArray[np.float32]:
    """Arguments, drawn once and for all; the first of two is -2 to 2, as are directions, others 0 to 2."""
    rng = np.random.default_rng(5)
    inputs = CASES[name]().inputs
    low = [-2.0 if "." in entry or entry == "u" else 0.01 for entry in inputs]
    return rng.uniform(low, 2.0, (ROWS, len(inputs))).astype(np.float32)


@cache
def expected(name: str) -> NDArray[np.float32]:
    graph = CASES[name]()
    found = [evaluate(graph, dict(zip(graph.inputs, row, strict=True))) for row in rows_of(name)]
    return np.array([list(entry.values()) for entry in found], np.float32)


def assert_same(name: str, results: NDArray[np.float32], circle: float = 2e-5) -> None:
    """Equal up to rounding, and up to what is said of a driver's sine and cosine."""
    error = circle if name == "circle" else 2e-5
    np.testing.assert_allclose(results, expected(name), rtol=error, atol=error, err_msg=name)


@pytest.mark.parametrize("flags", [("-O0",), ("-O2",), ("-O3", "-ffast-math")], ids=" ".join)
@pytest.mark.parametrize(
    ("compiler", "ending"), [("gcc", ".c"), ("clang", ".c"), ("g++", ".cpp")], ids=lambda text: text
)
def test_c_runs(compiler: str, ending: str, flags: tuple[str, ...], tmp_path: Path) -> None:
    extern = 'extern "C" ' if ending == ".cpp" else ""
    names = [name for name in CASES if name != "ends" or "-ffast-math" not in flags]  # no infinity there
    text, functions = programs.text_and_functions("c", graphs(*names))
    source = text + programs.wrapped(languages()["c"], functions, extern)
    library = tools.compiled_c(tmp_path, source, compiler, "-pedantic", *flags, ending=ending)
    for name, function in functions.items():
        assert_same(name, tools.called(library, name, rows_of(name), programs.outputs_of(function)))


@pytest.mark.parametrize("name", SHADERS)
def test_wgsl_runs(name: str) -> None:
    text, functions = programs.text_and_functions("wgsl", graphs(name))
    source = programs.compute_wgsl(languages()["wgsl"], name, functions[name], text)
    assert_same(name, tools.dispatched(source, rows_of(name), programs.outputs_of(functions[name])))


def test_glsl_es_runs_in_a_browser(tmp_path: Path) -> None:
    sources, outputs = {}, {}
    for name in SHADERS:
        text, functions = programs.text_and_functions("glsl-es", graphs(name))
        sources[name] = programs.fragment_es(languages()["glsl-es"], name, functions[name], text)
        outputs[name] = programs.outputs_of(functions[name])
        (tmp_path / f"{name}.frag").write_text(sources[name], "utf-8")
        tools.run(tools.program("glslangValidator"), tmp_path / f"{name}.frag")
    results, _ = tools.drawn(sources, {name: rows_of(name) for name in sources})
    for name, values in results.items():
        assert_same(name, values[:, : outputs[name]], circle=1e-3)


@pytest.mark.parametrize("name", SHADERS)
@pytest.mark.parametrize("language", ["glsl", "hlsl", "slang"])
def test_spirv_is_valid_and_runs(language: str, name: str, tmp_path: Path) -> None:
    """Slang goes through GLSL: its wheel has no back end of its own for SPIR-V."""
    described, (text, functions) = languages()[language], programs.text_and_functions(language, graphs(name))
    function, path, binary = functions[name], tmp_path / f"case.{language}", tmp_path / "case.spv"
    make = programs.compute_glsl if language == "glsl" else programs.compute_hlsl
    path.write_text(make(described, name, function, text), "utf-8")
    validator = tools.program("glslangValidator")
    if language == "slang":
        printed = tmp_path / "case.glsl"
        tools.run(tools.slangc(), path, "-entry", "main", "-stage", "compute", "-target", "glsl",
                  "-warnings-as-errors", "all", "-o", printed)  # fmt: skip
        path = printed
    options = ["-D", "-e", "main"] if language == "hlsl" else []
    warned = tools.run(validator, "-V", "-S", "comp", *options, path, "-o", binary)
    assert "WARNING" not in warned
    tools.run(tools.program("spirv-val"), binary)
    if name != "ends" or language == "glsl":  # the driver's own compiler refuses infinite constants
        assert_same(name, tools.dispatched(binary.read_bytes(), rows_of(name), programs.outputs_of(function)))
