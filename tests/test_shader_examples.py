"""The shader examples: made by their script, then drawn, dispatched, run or compiled."""

from __future__ import annotations

import importlib.util
import re
import runpy
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import browser
import export_tools as tools
import microfacet as mf
from limits import HANG

EXAMPLES = Path(__file__).parents[1] / "examples" / "shaders"
ALPHA, GAMMA = 0.25, 2.5
METALS = {
    "ggx": mf.Conductor(mf.GGX(alpha=ALPHA)),
    "student_t": mf.Conductor(mf.StudentT(alpha=ALPHA, gamma=GAMMA)),
}

each_metal = pytest.mark.parametrize("family", METALS)


@pytest.fixture(scope="module")
def shaders(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the script makes, of a fixed shape and a small texture."""
    folder = tmp_path_factory.mktemp("shaders")
    words = ["--output", str(folder), "--fix", f"gamma={GAMMA}", "--size", "8x8"]
    said = tools.run(sys.executable, EXAMPLES / "make.py", *words, cwd=folder)
    assert "page.html, and a folder for each of ggx,student_t" in said
    return folder


@pytest.fixture(scope="module")
def variants(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A shape that is free, Schlick's reflectance, light that goes back."""
    folder = tmp_path_factory.mktemp("variants")
    make = runpy.run_path(str(EXAMPLES / "make.py"))["make"]
    how = {"fresnel": "schlick", "retroreflective": True}
    make(folder, ["student_t"], size=(2, 2), slices=3, **how)
    return folder


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_the_same_call_gives_the_same_bytes(tmp_path: Path) -> None:
    make = runpy.run_path(str(EXAMPLES / "make.py"))["make"]
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        make(tmp_path / name, ["k0"], size=(2, 2))
    assert files(tmp_path / "first") == files(tmp_path / "second")


def test_a_family_that_is_not_there_is_one_sentence(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, EXAMPLES / "make.py", "--families", "phong", "--output", tmp_path / "made"],
        capture_output=True, text=True, timeout=HANG,
    )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr.startswith("Error: families must be of beckmann, ")
    assert not (tmp_path / "made").exists()


# The page


def pictures(page: Path, settings: list[dict[str, Any]], size: int, samples: int) -> list[dict[str, Any]]:
    """What the page draws, in a browser of its own."""
    if importlib.util.find_spec("playwright") is None:
        tools.missing("the package playwright")
    path = browser.find() or tools.missing("a browser")
    from playwright.sync_api import sync_playwright

    flags = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking"]
    found = []
    with sync_playwright() as tool:
        window = tool.chromium.launch(executable_path=path, args=[*flags, "--disable-sync"])
        try:
            view = window.new_page()
            view.goto(f"{page.as_uri()}#still")
            if "needs WebGL" in (view.text_content("#said") or ""):
                tools.missing("WebGL 2 with float textures")
            for one in settings:
                drawn = view.evaluate("([s, size, n]) => picture(s, size, n)", [one, size, samples])
                drawn["pixels"] = np.array(drawn["pixels"]).reshape(size, size, 4)[..., :3]
                found.append(drawn)
        finally:
            window.close()
    return found


def settings(family: str, **changes: Any) -> dict[str, Any]:
    start = {"family": family, "metal": "white", "alpha": ALPHA, "shape": GAMMA}
    return {**start, "furnace": True, "compensated": False, **changes}


def test_the_page_draws_the_furnace_of_the_library(shaders: Path) -> None:
    """A white sphere in white light shows at each place the albedo there, and vanishes with all orders."""
    size = 48
    asked = [settings(family, compensated=c) for family in METALS for c in (False, True)]
    drawn = iter(pictures(shaders / "page.html", asked, size, 32))
    at = ((np.arange(size) + 0.5) / size * 2 - 1) * 1.2
    radius = np.hypot(*np.meshgrid(at, at))
    for metal in METALS.values():
        one, every = (next(drawn)["pixels"][..., 1] for _ in range(2))
        for low, high in ((0.0, 0.3), (0.3, 0.6), (0.6, 0.85)):
            ring = (radius > low) & (radius < high)
            cosine = np.sqrt(1 - radius[ring] ** 2)
            albedo = metal.albedo(np.stack([radius[ring], 0 * cosine, cosine], -1))
            # The standard error of the mean of 32 samples in each of a hundred pixels and more.
            noise = 4 * one[ring].std() / np.sqrt(ring.sum())
            assert abs(one[ring].mean() - albedo.mean()) < noise + 2e-4
            assert abs(every[ring].mean() - 1) < 0.02 + noise  # of 8 x 8 texels
        assert (one[radius > 1.1] == 1).all()


def test_the_page_draws_metals_that_differ(shaders: Path) -> None:
    asked = [settings(family, metal="gold", furnace=False) for family in METALS]
    ggx, student = (entry["pixels"] for entry in pictures(shaders / "page.html", asked, 64, 4))
    for picture in (ggx, student):
        assert np.isfinite(picture).all()
        assert (picture >= 0).all()
    middle = np.s_[16:48, 16:48]
    assert (ggx[middle][..., 0] > ggx[middle][..., 2]).mean() > 0.95  # gold
    assert abs(ggx[middle] - student[middle]).mean() > 0.02
    np.testing.assert_array_equal(ggx[0], student[0])  # behind the sphere


def test_the_page_draws_variants(variants: Path) -> None:
    """Light that goes back sees the sun elsewhere; what the energy was worth does not change."""
    (drawn,) = pictures(variants / "page.html", [settings("student_t", metal="gold", furnace=False)], 32, 2)
    assert np.isfinite(drawn["pixels"]).all()
    assert drawn["pixels"].max() > 0.5
    assert drawn["compiled"] > 0


# WGSL and Slang


def furnace_of(folder: Path, slang: str | None = None) -> Any:
    if importlib.util.find_spec("wgpu") is None:
        tools.missing("the package wgpu")
    tools.dispatched("@compute @workgroup_size(64) fn main() {}", np.zeros((64, 1), np.float32), 1)
    return runpy.run_path(str(EXAMPLES / "furnace.py"))["furnace"](folder, ALPHA, GAMMA, slang)


@pytest.mark.parametrize("slang", [False, True], ids=["wgsl", "slang"])
@each_metal
def test_a_furnace_is_dispatched(family: str, slang: bool, shaders: Path) -> None:
    found = furnace_of(shaders / family, tools.slangc() if slang else None).astype(np.float64)
    cosine = (np.arange(len(found)) + 0.5) / len(found)
    albedo = METALS[family].albedo(np.stack([np.sqrt(1 - cosine**2), 0 * cosine, cosine], -1))
    weight, factor, ratio, height = np.moveaxis(found, -1, 0)
    noise = weight.std(axis=1) / np.sqrt(weight.shape[1])
    assert (np.abs(weight.mean(axis=1) - albedo) < 4 * noise + 1e-5).all()
    assert (np.abs((weight * factor).mean(axis=1) - 1) < 0.02).all()
    np.testing.assert_allclose(ratio[height > 0], weight[height > 0], rtol=1e-5)
    assert (weight[height <= 0] == 0).all()


def test_the_program_of_the_furnace_prints_it(shaders: Path) -> None:
    furnace_of(shaders / "student_t")
    said = tools.run(sys.executable, EXAMPLES / "furnace.py", shaders / "student_t")
    rows = [list(map(float, line.split())) for line in said.splitlines() if re.match(r"\d\.\d{4} ", line)]
    assert len(rows) == 8
    for _, one, library, every in rows:
        assert one == pytest.approx(library, abs=0.02)
        assert every == pytest.approx(1, abs=0.02)


# Compilers


@pytest.mark.parametrize("made", ["shaders", "variants"])
def test_cuda_evaluates_a_million_samples(made: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    folder = request.getfixturevalue(made) / "student_t"
    nvcc = Path(tools.nvcc())
    tools.run(nvcc, "-std=c++17", "-arch=sm_90", "-O2", "-Werror", "all-warnings", folder / "million.cu",
              "-L", nvcc.parents[1] / "lib", "-o", tmp_path / "million")  # fmt: skip
    said = tools.run(tmp_path / "million", folder / "energy.raw", 8, 8)
    if "no CUDA device" in said:
        pytest.skip("it compiled and linked; there is no CUDA device to run it")
    if made == "variants":  # its texture has another size
        return
    metal = mf.Conductor(mf.StudentT(alpha=0.5, gamma=GAMMA))
    for line in said.splitlines()[1:]:
        cosine, one, every, ratio = map(float, line.split())
        assert one == pytest.approx(metal.albedo([np.sqrt(1 - cosine**2), 0, cosine]), abs=5e-3)
        assert every == pytest.approx(1, abs=0.03)
        assert ratio == pytest.approx(one, rel=1e-3)


@pytest.mark.parametrize("made", ["shaders", "variants"])
@pytest.mark.parametrize("target", ["hlsl", "metal", "glsl", "wgsl"])
def test_slang_compiles(target: str, made: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    folder, printed = request.getfixturevalue(made) / "student_t", tmp_path / f"furnace.{target}"
    tools.run(tools.slangc(), folder / "furnace.slang", "-entry", "run", "-stage", "compute",
              "-target", target, "-o", printed)  # fmt: skip
    assert "metal_sample" in printed.read_text()
    if target == "glsl":
        binary = tmp_path / "furnace.spv"
        tools.run(tools.program("glslangValidator"), "-V", "-S", "comp", printed, "-o", binary)
        tools.run(tools.program("spirv-val"), binary)


@each_metal
def test_osl_compiles(family: str, shaders: Path, tmp_path: Path) -> None:
    tools.compiled_osl(shaders / family / "metal.osl", tmp_path / "metal.oso")
    assert "surface metal" in (tmp_path / "metal.oso").read_text()


@pytest.mark.parametrize("made", ["shaders", "variants"])
def test_the_materialx_document_is_valid_and_generates(
    made: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    if importlib.util.find_spec("MaterialX") is None:
        tools.missing("the package MaterialX")
    import MaterialX as mx
    import MaterialX.PyMaterialXGenGlsl as glsl
    import MaterialX.PyMaterialXGenShader as gen

    folder = request.getfixturevalue(made) / "student_t"
    library, document = mx.createDocument(), mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
    mx.readFromXmlFile(document, str(folder / "metal.mtlx"))
    document.setDataLibrary(library)
    valid, message = document.validate()
    assert valid, message
    for name in ("GlslShaderGenerator", "EsslShaderGenerator"):
        generator = getattr(glsl, name).create()
        context = gen.GenContext(generator)
        context.registerSourceCodeSearchPath(mx.getDefaultDataSearchPath())
        context.registerSourceCodeSearchPath(str(folder))
        shader = generator.generate("metal", document.getNode("metal"), context)
        for stage, ending in (("vertex", "vert"), ("pixel", "frag")):
            text = shader.getSourceCode(stage)
            (tmp_path / f"metal.{ending}").write_text(text, "utf-8")
            tools.run(tools.program("glslangValidator"), tmp_path / f"metal.{ending}")
        assert "student_t_conductor_eval(" in text
