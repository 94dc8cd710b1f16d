"""Carries out the walk of docs/add_a_family.md on a copy of the sources, and holds the result to every law.

The copy's compiled core has the new family alone, which keeps the build short; its namespace is lent to the
installed package while the test runs.
"""

from __future__ import annotations

import doctest
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import types
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import laws
import microfacet as mf
from microfacet import _core
from microfacet._docs import QUANTITIES
from microfacet._family import registry

ROOT = pathlib.Path(__file__).parent.parent
WALK = (ROOT / "docs" / "add_a_family.md").read_text(encoding="utf-8")
COMPILER = os.environ.get("CXX") or shutil.which("g++") or shutil.which("clang++")

needs_compiler = pytest.mark.skipif(COMPILER is None, reason="there is no C++ compiler")


def blocks(kind: str, header: str) -> list[tuple[str, str]]:
    """The fenced blocks of the walk whose first line matches, with what the header captures."""
    return re.findall(rf"```{kind} {header}\n(.*?)```", WALK, flags=re.DOTALL)


def apply_diff(text: str, diff: str) -> str:
    """Replace the `-` lines, which stand once in the text, with the `+` lines."""
    old = "\n".join(line[1:] for line in diff.splitlines() if line.startswith("-"))
    new = "\n".join(line[1:] for line in diff.splitlines() if line.startswith("+"))
    assert text.count(old) == 1, f"not once in the file: {old}"
    return text.replace(old, new)


def load(name: str, path: pathlib.Path) -> types.ModuleType:
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """The sources after the walk."""
    root = tmp_path_factory.mktemp("walk")
    for folder in ("include", "bindings"):
        shutil.copytree(ROOT / folder, root / folder)
    shutil.copy(ROOT / "tests" / "reference.py", root / "reference.py")
    for kind in ("cpp", "python"):
        for path, text in blocks(kind, r"file=(\S+)"):
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text(text, encoding="utf-8")
    for path, diff in blocks("diff", r"file=(\S+)"):
        (root / path).write_text(
            apply_diff((root / path).read_text(encoding="utf-8"), diff), encoding="utf-8"
        )
    return root


def compile_extension(
    root: pathlib.Path, sources: list[pathlib.Path], to: pathlib.Path, *definitions: str
) -> None:
    flags = ["-std=c++20", "-O1", "-shared", "-fPIC", "-ffp-contract=off", "-Wno-psabi", *definitions]
    if sys.platform == "darwin":
        flags += ["-undefined", "dynamic_lookup"]
    paths = (root, root / "include", sysconfig.get_path("include"), np.get_include())
    include = [f"-I{path}" for path in paths]
    subprocess.run([str(COMPILER), *flags, *include, *sources, "-o", to], check=True)


@pytest.fixture(scope="module")
def family(copy: pathlib.Path) -> Iterator[Any]:
    """The record of the new family, as `microfacet.families()` would have it."""
    listing = copy / "include" / "microfacet" / "family" / "all.hpp"
    alone = re.sub(
        r"std::tuple<family_tag<haze>,[^;]*", "std::tuple<family_tag<haze>>", listing.read_text("utf-8")
    )
    listing.write_text(alone, encoding="utf-8")
    core = copy / f"walk{sysconfig.get_config_var('EXT_SUFFIX')}"
    sources = [path for path in (copy / "bindings").glob("*.cpp") if path.name != "processor.cpp"]
    own = ["-DMICROFACET_FAMILY=haze", '-DMICROFACET_FAMILY_HEADER="microfacet/family/haze.hpp"']
    compile_extension(copy, sources, core, "-DMICROFACET_MODULE=walk", *own)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(_core, "haze", load("microfacet._core_of_the_walk.walk", core).haze, raising=False)
        module = load("microfacet._family.haze", copy / "src" / "microfacet" / "_family" / "haze.py")
        patch.setattr(mf, "haze", module, raising=False)
        yield registry.describe(module)


@needs_compiler
def test_every_law_holds(family: Any) -> None:
    for weight in (0.02, 0.4, 0.9):
        for law in laws.ALL:
            law(laws.Density(family.kernels, (0.3, weight)))
    laws.shape_invariant(laws.Density(family.kernels, (0.3, 0.4)))


@needs_compiler
def test_docstrings_run(family: Any) -> None:
    runner = doctest.DocTestRunner()
    for name in QUANTITIES:
        text = getattr(family.kernels, name).__doc__
        runner.run(doctest.DocTestParser().get_doctest(text, {}, name, None, None))
    assert runner.tries > 0
    assert runner.failures == 0


@needs_compiler
def test_arbitrary_precision_agrees(family: Any, copy: pathlib.Path) -> None:
    (density,) = re.findall(r"```python insert=\S+ before=\S+\n(.*?)```", WALK, flags=re.DOTALL)
    path = copy / "reference.py"
    text = path.read_text(encoding="utf-8").replace(
        "_DENSITIES = {", density + '_DENSITIES = {"haze": haze, ', 1
    )
    path.write_text(text.replace("FAMILIES = {", 'FAMILIES = {"haze": 2, ', 1), encoding="utf-8")
    reference = load("reference_of_the_walk", path)
    for name, variable in (("D", 0.7), ("P2", 0.2), ("slope_cdf", -0.4), ("Lambda", 0.3), ("survival", 0.5)):
        truth = float(reference.value("haze", name, variable, 0.3, 0.25))
        assert_allclose(getattr(family.kernels, name)(variable, 0.3, 0.25), truth, rtol=1e-14)


@needs_compiler
def test_the_test_of_the_walk_passes(family: Any, copy: pathlib.Path) -> None:
    load("test_haze", copy / "tests" / "family" / "test_haze.py").test_lobes()
    with pytest.raises(ValueError, match=r"Haze: weight must lie in \(0, 1\), got 1.5"):
        family.cls(alpha=0.3, weight=1.5)


@needs_compiler
def test_it_is_exported_without_a_further_line(
    family: Any, copy: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its graphs run on arrays as its kernels do, and as text of another language, which C compiles."""
    graphs = copy / f"_graphs{sysconfig.get_config_var('EXT_SUFFIX')}"
    compile_extension(copy, sorted((copy / "bindings" / "graph").glob("*.cpp")), graphs)
    recorder = load("walk._graphs", graphs)
    monkeypatch.setitem(sys.modules, "microfacet._graphs", recorder)
    monkeypatch.setattr(mf, "_graphs", recorder, raising=False)
    for module in ("density", "subject"):
        monkeypatch.setattr(f"microfacet._export.{module}.families", lambda: (family,))
    functions = mf.array_functions("haze")
    w = np.random.default_rng(3).normal(size=(100, 3))
    w /= np.linalg.norm(w, axis=-1, keepdims=True)
    for name in ("D", "Lambda", "sigma"):
        exact = getattr(family.kernels, name)(w[:, 2], 0.3, 0.25)
        assert_allclose(getattr(functions, name)(w, alpha=0.3, weight=0.25), exact, rtol=1e-13)
    header = tmp_path / "haze.h"
    text = mf.export("c", "haze", ["D", "Lambda", "sample_visible", "conductor"], path=header)
    assert "float haze_D(" in text
    subprocess.run(
        [str(COMPILER), "-xc++", "-c", "-Wall", "-Werror", header, "-o", tmp_path / "o"], check=True
    )


@needs_compiler
@pytest.mark.parametrize("name", ["test_families", "test_batch"])
def test_the_cpp_tests_take_it_up(copy: pathlib.Path, family: Any, name: str) -> None:
    """They iterate all.hpp, which now lists haze alone: the laws by a dual number, and the SIMD batch."""
    assert family.name == "haze"
    program = copy / name
    flags = ["-std=c++20", "-O0", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror", "-Wno-psabi"]
    # as in tests/cpp/CMakeLists.txt
    if "clang" in str(COMPILER):
        flags.append("-Wno-bitwise-instead-of-logical")
    else:
        flags += ["-Wno-uninitialized", "-Wno-maybe-uninitialized"]
    source = ROOT / "tests" / "cpp" / f"{name}.cpp"
    subprocess.run([str(COMPILER), *flags, f"-I{copy / 'include'}", source, "-o", program], check=True)
    subprocess.run([program], check=True)
