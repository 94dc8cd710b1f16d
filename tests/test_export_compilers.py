"""CUDA, Metal, Slang's targets, MaterialX and OSL: compiled by what this machine has, run by what it can."""

from __future__ import annotations

import importlib.util
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import export_programs as programs
import export_shims as shims
import export_tools as tools
import microfacet as mf
from graph_cases import CASES
from microfacet._export.graph import Graph
from microfacet._export.languages import languages
from test_export_languages import SHADERS, assert_same, rows_of


@cache
def graphs(*names: str) -> dict[str, Graph]:
    return {name: CASES[name]() for name in names}


def run_as_cpp(text: str, language: str, cases: dict[str, Any], folder: Path) -> None:
    source = text + programs.wrapped(languages()[language], cases, 'extern "C" ')
    library = tools.compiled_c(folder, source, "g++", "-std=c++20", "-O2", ending=".cpp")
    for name, function in cases.items():
        assert_same(name, tools.called(library, name, rows_of(name), programs.outputs_of(function)))


def test_cuda_compiles_without_warnings(tmp_path: Path) -> None:
    text, functions = programs.text_and_functions("cuda", graphs(*CASES))
    path = tmp_path / "cases.cu"
    path.write_text(
        text + programs.wrapped(languages()["cuda"], functions, 'extern "C" __global__ '), "utf-8"
    )
    tools.run(tools.nvcc(), "-std=c++17", "-arch=sm_90", "-ptx", "-Werror", "all-warnings", path,
              "-o", tmp_path / "cases.ptx")  # fmt: skip
    compiled = (tmp_path / "cases.ptx").read_text("utf-8")
    assert set(re.findall(r"\.visible \.entry run_(\w+)", compiled)) == set(CASES)


def test_cuda_runs_as_cpp(tmp_path: Path) -> None:
    text, functions = programs.text_and_functions("cuda", graphs(*CASES))
    run_as_cpp(shims.CUDA + text, "cuda", functions, tmp_path)


def test_metal_runs_as_cpp(tmp_path: Path) -> None:
    """Apple's compiler is not to be had elsewhere; what of the text is C++ a C++ compiler reads."""
    text, functions = programs.text_and_functions("metal", graphs(*SHADERS))
    text = text.replace("#include <metal_stdlib>", shims.METAL)
    run_as_cpp(text, "metal", functions, tmp_path)


@pytest.mark.parametrize("target", ["metal", "hlsl", "wgsl", "cuda", "cpp"])
def test_slang_prints_other_languages(target: str, tmp_path: Path) -> None:
    for name in SHADERS:
        text, functions = programs.text_and_functions("slang", graphs(name))
        path, printed = tmp_path / f"{name}.slang", tmp_path / f"{name}.{target}"
        source = programs.compute_hlsl(languages()["slang"], name, functions[name], text)
        source = re.sub(r"\[\[vk::.*?\]\]| : register\(.*?\)", "", source).replace("void main(", "void run(")
        path.write_text(source, "utf-8")
        tools.run(tools.slangc(), path, "-entry", "run", "-stage", "compute", "-target", target,
                  "-warnings-as-errors", "all", "-o", printed)  # fmt: skip
        assert f"try_{name}" in printed.read_text()


# MaterialX


def document_of(path: Path, prefix: str, names: list[str]) -> Any:
    """An exported document, with an output of each of its nodes; it has been validated."""
    if importlib.util.find_spec("MaterialX") is None:
        tools.missing("the package MaterialX")
    import MaterialX as mx

    library, document = mx.createDocument(), mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
    mx.readFromXmlFile(document, str(path))
    document.setDataLibrary(library)
    for name in names:
        outputs = document.getNodeDef(f"ND_{prefix}{name}").getOutputs()
        type_ = "multioutput" if len(outputs) > 1 else outputs[0].getType()
        node = document.addNode(f"{prefix}{name}", f"a_{name}", type_)
        output = document.addOutput(f"o_{name}", outputs[0].getType())
        output.setConnectedNode(node)
        if len(outputs) > 1:
            output.setOutputString(outputs[0].getName())
    valid, message = document.validate()
    assert valid, message
    return document


def material_document(folder: Path, names: list[str]) -> Any:
    """The cases as a document."""
    make = languages()["materialx"].document
    assert make is not None
    for file, text in make(programs.content_of(graphs(*names)), "cases").items():
        (folder / file).write_text(text, "utf-8")
    return document_of(folder / "cases.mtlx", "try_", names)


def generated(document: Any, folder: Path, module: str, generator: str, name: str) -> str:
    """The shader of one output."""
    import MaterialX as mx
    import MaterialX.PyMaterialXGenShader as shaders

    made = getattr(importlib.import_module(f"MaterialX.{module}"), generator).create()
    context = shaders.GenContext(made)
    context.registerSourceCodeSearchPath(mx.getDefaultDataSearchPath())
    context.registerSourceCodeSearchPath(str(folder))
    text = made.generate("shader", document.getOutput(f"o_{name}"), context).getSourceCode("pixel")
    assert re.search(rf"\bvoid \w+_{name}\(", text), text
    return str(text)


@pytest.mark.parametrize(
    ("generator", "options"),
    [("GlslShaderGenerator", []), ("EsslShaderGenerator", []), ("VkShaderGenerator", ["-V"])],
)
def test_materialx_generates_glsl(generator: str, options: list[str], tmp_path: Path) -> None:
    document = material_document(tmp_path, SHADERS)
    for name in SHADERS:
        path = tmp_path / f"{name}.frag"
        path.write_text(generated(document, tmp_path, "PyMaterialXGenGlsl", generator, name), "utf-8")
        more = [*options, "-o", tmp_path / "out.spv"] if options else []
        tools.run(tools.program("glslangValidator"), *more, path)


def test_materialx_generates_metal_and_slang(tmp_path: Path) -> None:
    document = material_document(tmp_path, SHADERS)
    for name in SHADERS:
        metal = generated(document, tmp_path, "PyMaterialXGenMsl", "MslShaderGenerator", name)
        assert "thread float&" in metal or "thread float3&" in metal
        path = tmp_path / f"{name}.slang"
        slang = generated(document, tmp_path, "PyMaterialXGenSlang", "SlangShaderGenerator", name)
        path.write_text(slang, "utf-8")
        tools.run(tools.slangc(), path, "-target", "hlsl", "-stage", "fragment", "-entry", "fragmentMain",
                  "-o", tmp_path / "out.hlsl")  # fmt: skip


def test_materialx_generates_osl(tmp_path: Path) -> None:
    """What needs bits or tables has no implementation for OSL, and the document says so by leaving it out."""
    document = material_document(tmp_path, SHADERS)
    for name in set(SHADERS) - {"integers"}:
        text = generated(document, tmp_path, "PyMaterialXGenOsl", "OslShaderGenerator", name)
        assert "output float" in text or "output vector" in text
    assert document.getImplementation("IM_try_integers_genosl") is None
    assert document.getImplementation("IM_try_integers_genglsl") is not None


# OSL


def test_osl_compiles(tmp_path: Path) -> None:
    names = [name for name in SHADERS if name != "integers"]
    text, functions = programs.text_and_functions("osl", graphs(*names))
    for name, function in functions.items():
        path = tmp_path / f"{name}.osl"
        path.write_text(text + programs.osl_shader(name, function), "utf-8")
        tools.compiled_osl(path, tmp_path / f"{name}.oso")


# Families


CONDUCTOR = ("conductor_eval", "conductor_pdf", "conductor_sample")
KINDS = {"free": {"family": "student_t"}, "tables": {"family": "gtr", "alpha": 0.3, "gamma": 1.5}}
each_kind = pytest.mark.parametrize("kind", KINDS)


@each_kind
def test_materials_of_materialx(kind: str, tmp_path: Path) -> None:
    mf.export("materialx", functions=["conductor"], channels=3, path=tmp_path / "metal.mtlx", **KINDS[kind])
    document = document_of(tmp_path / "metal.mtlx", f"{KINDS[kind]['family']}_", list(CONDUCTOR))
    for name in CONDUCTOR:
        path = tmp_path / f"{name}.frag"
        text = generated(document, tmp_path, "PyMaterialXGenGlsl", "GlslShaderGenerator", name)
        path.write_text(text, "utf-8")
        tools.run(tools.program("glslangValidator"), path)


@each_kind
def test_materials_compile(kind: str, tmp_path: Path) -> None:
    """Without a warning: GLSL, HLSL, Slang, CUDA, and C as C++."""

    def file(language: str, head: str = "", tail: str = "", **options: Any) -> Path:
        text = mf.export(language, functions=["D", "G2", "conductor", "dielectric"], **options, **KINDS[kind])
        path = tmp_path / f"metal{languages()[language].ending}"
        path.write_text(head + text + tail, "utf-8")
        return path

    glslang, main = tools.program("glslangValidator"), "\nvoid main() {}\n"
    warned = tools.run(
        glslang, "-V", "-S", "comp", "-o", tmp_path / "a.spv", file("glsl", "#version 450\n", main)
    )
    warned += tools.run(glslang, "-S", "frag", file("glsl-es", "#version 300 es\n", main))
    hlsl = file("hlsl", "", "\n[numthreads(1, 1, 1)]\nvoid main() {}\n", retroreflective=True)
    warned += tools.run(glslang, "-D", "-V", "-S", "comp", "-e", "main", "-o", tmp_path / "b.spv", hlsl)
    assert "WARNING" not in warned
    slang = file("slang", "", "\n[numthreads(1, 1, 1)]\nvoid run() {}\n", channels=3)
    tools.run(tools.slangc(), slang, "-entry", "run", "-stage", "compute", "-target", "hlsl", "-o",
              tmp_path / "c.hlsl", "-warnings-as-errors", "all")  # fmt: skip
    cuda = file("cuda", fresnel="schlick").rename(tmp_path / "metal.cu")
    tools.run(tools.nvcc(), "-std=c++17", "-arch=sm_90", "-ptx", "-Werror", "all-warnings", cuda,
              "-o", tmp_path / "metal.ptx")  # fmt: skip
    file("c")
    for compiler, ending in (("gcc", "c"), ("g++", "cpp"), ("clang", "c"), ("clang++", "cpp")):
        source = tmp_path / f"main.{ending}"
        source.write_text('#include "metal.h"\nint main(void) { return 0; }\n', "utf-8")
        tools.run(tools.program(compiler), *tools.FLAGS, "-pedantic", "-c", source, "-o", tmp_path / "m.o")
