"""The shortest uses in docs/export.md, compiled with what their commands make, and run where they can be."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import export_tools as tools
import microfacet as mf
from microfacet.cli import main

DOCUMENT = (Path(__file__).parents[1] / "docs" / "export.md").read_text("utf-8")
USES = dict(re.findall(r"```([\w-]+)\n(.*?)```", DOCUMENT, flags=re.DOTALL))


@pytest.fixture
def made(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """What the command of the document for a language makes, beside its use, which is use.ENDING."""
    language = request.param
    (words,) = re.findall(rf"`microfacet export ({language} .*? -o [\w.]+)`", DOCUMENT)
    *options, name = words.split()
    result = CliRunner().invoke(main, ["export", *options, str(tmp_path / name)])
    assert result.exit_code == 0, result.output
    return tmp_path / name


def use_of(fence: str, made: Path, ending: str) -> Path:
    path = made.parent / f"use.{ending}"
    path.write_text(USES[fence], "utf-8")
    return path


@pytest.mark.parametrize("made", ["c"], indirect=True)
@pytest.mark.parametrize("compiler", ["gcc", "g++", "clang"])
def test_the_use_in_c_runs(compiler: str, made: Path) -> None:
    source = use_of("c", made, "c")
    tools.run(tools.program(compiler), *tools.FLAGS, source, "-o", made.parent / "use", "-lm")
    assert float(tools.run(made.parent / "use")) > 0


@pytest.mark.parametrize("made", ["cuda"], indirect=True)
def test_the_use_in_cuda_compiles(made: Path) -> None:
    tools.run(tools.nvcc(), "-std=c++17", "-arch=sm_90", "-ptx", "-Werror", "all-warnings",
              use_of("cuda", made, "cu"), "-o", made.parent / "use.ptx")  # fmt: skip


@pytest.mark.parametrize(
    ("made", "fence", "options"),
    [("glsl", "glsl", ["-V"]), ("glsl-es", "glsl-es", []), ("hlsl", "hlsl", ["-D", "-V", "-e", "main"])],
    indirect=["made"],
)
def test_the_use_in_glsl_and_hlsl_compiles(made: Path, fence: str, options: list[str]) -> None:
    source = use_of(fence, made, "frag")
    text = source.read_text("utf-8").replace(f"// {made.name}\n", made.read_text("utf-8"))
    source.write_text(text, "utf-8")
    output = ["-o", made.parent / "use.spv"] if "-V" in options else []
    said = tools.run(tools.program("glslangValidator"), "-S", "frag", *options, source, *output)
    assert "WARNING" not in said


@pytest.mark.parametrize("made", ["slang"], indirect=True)
def test_the_use_in_slang_compiles(made: Path) -> None:
    tools.run(tools.slangc(), use_of("slang", made, "slang"), "-entry", "main", "-stage", "fragment",
              "-target", "hlsl", "-o", made.parent / "use.hlsl")  # fmt: skip


@pytest.mark.parametrize("made", ["wgsl"], indirect=True)
def test_the_use_in_wgsl_runs(made: Path) -> None:
    normals = np.array(
        [[0, 0, 1, 0], [0.6, 0, 0.8, 0]], np.float32
    )  # vectors of three have the place of four
    found = tools.dispatched(made.read_text("utf-8") + USES["wgsl"], normals, 1)[:, 0]
    ndf = mf.StudentT(alpha=0.3, gamma=2.5)
    np.testing.assert_allclose(found, ndf.D(normals[:, :3].astype(np.float64)), rtol=1e-5)


@pytest.mark.parametrize("made", ["osl"], indirect=True)
def test_the_use_in_osl_compiles(made: Path) -> None:
    tools.compiled_osl(use_of("osl", made, "osl"), made.parent / "use.oso")


@pytest.mark.parametrize("made", ["materialx"], indirect=True)
def test_the_use_in_materialx_is_valid(made: Path) -> None:
    if importlib.util.find_spec("MaterialX") is None:
        tools.missing("the package MaterialX")
    import MaterialX as mx

    library, document = mx.createDocument(), mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
    mx.readFromXmlFile(document, str(use_of("xml", made, "mtlx")))
    document.setDataLibrary(library)
    valid, message = document.validate()
    assert valid, message
    assert document.getNode("density").getNodeDef() is not None
