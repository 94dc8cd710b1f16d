"""Carries out the walk of docs/add_a_family.md on a copy of the sources, and uses the result.

The copy's package has the compiled kernels that there are, and those of the new family from a module that is
compiled here, with it alone. What uses it runs in a process of its own.
"""

from __future__ import annotations

import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import mitsuba_process
from microfacet import _core

ROOT = pathlib.Path(__file__).parent.parent
WALK = (ROOT / "docs" / "add_a_family.md").read_text(encoding="utf-8")
COMPILER = os.environ.get("CXX") or shutil.which("g++") or shutil.which("clang++")

#: Of the tests that run at every family those that are quick, but for what is compiled and rendered, and for
#: samples of materials: their grids are too coarse for glass as rough as the second lobe of haze makes it.
SUITE = [
    "family/test_haze.py",
    "test_ufuncs.py",
    "test_laws.py",
    "test_domain.py",
    "test_directions.py",
    "test_bsdf.py",
    "test_bsdf_input.py",
    "test_check_statements.py",
    "test_catalogue.py",
    "test_frozen_distributions.py",
    "test_fit.py",
    "test_fit_tables.py",
    "test_accuracy.py",
    "test_docstrings.py",
    "test_sampling.py",
    "test_uniforms.py",
    "test_values.py",
    "test_textures.py",
    "test_report_notation.py",
    "test_documents.py",
    "test_walks.py",
    "test_architecture.py",
    "test_what_families_state.py",
]

RENDER = """
import mitsuba as mi, numpy as np
mi.set_variant("scalar_rgb")
import microfacet as mf, microfacet.mitsuba
from pathlib import Path
wi, wo = np.array([0.6, 0.0, 0.8]), np.array([-0.48, 0.36, 0.8])
at = mi.SurfaceInteraction3f()
at.wi = mi.Vector3f(*wi)
ndf = {"distribution": "haze", "alpha": 0.3, "weight": 0.25}
bsdf = mi.load_dict({"type": "microfacet_conductor", "material": "none", **ndf})
found = bsdf.eval(mi.BSDFContext(), at, mi.Vector3f(*wo))[0]
exact = float(mf.Conductor(mf.Haze(alpha=0.3, weight=0.25)).eval(wi, wo))
assert abs(found / exact - 1) < 1e-5, (found, exact)
rng, total = np.random.default_rng(1), []
for xi in rng.random((4000, 2)):
    drawn, weight = bsdf.sample(mi.BSDFContext(), at, 0.5, mi.Point2f(*xi))
    total.append(weight[0])
albedo = float(mf.Conductor(mf.Haze(alpha=0.3, weight=0.25)).albedo(wi))
assert abs(np.mean(total) - albedo) < 4 * np.std(total) / len(total) ** 0.5, (np.mean(total), albedo)
assert "haze" in str(bsdf)
"""

needs_compiler = pytest.mark.skipif(COMPILER is None, reason="there is no C++ compiler")


def blocks(kind: str, header: str) -> list[Any]:
    """The fenced blocks of the walk whose first line matches, with what the header captures."""
    found = re.findall(rf"^```{kind} {header}\n(.*?)^```", WALK, flags=re.DOTALL | re.MULTILINE)
    return [(places[0] if len(places) == 1 else tuple(places), text) for *places, text in found]


def apply_diff(text: str, diff: str) -> str:
    """Replace the `-` lines, which stand once in the text, with the `+` lines."""
    old = "\n".join(line[1:] for line in diff.splitlines() if line.startswith("-"))
    new = "\n".join(line[1:] for line in diff.splitlines() if line.startswith("+"))
    assert text.count(old) == 1, f"not once in the file: {old}"
    return text.replace(old, new)


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """The sources after the walk."""
    root = tmp_path_factory.mktemp("walk")
    ignored = shutil.ignore_patterns("__pycache__", "*.so", "*.pyd", ".*", "*.png", "*.jpg")
    for folder in ("include", "bindings", "docs", "src", "tests", "tools"):
        shutil.copytree(ROOT / folder, root / folder, ignore=ignored)
    for name in ("pyproject.toml", "references.bib", "README.md", "CHANGELOG.md", "CITATION.cff"):
        shutil.copy(ROOT / name, root / name)
    for kind in ("cpp", "python", "markdown"):
        for path, text in blocks(kind, r"file=(\S+)"):
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text(text, encoding="utf-8")
    for path, text in blocks("toml", r"append=(\S+)"):
        with (root / path).open("a", encoding="utf-8") as file:
            file.write(text)
    for (path, before), text in blocks("python", r"insert=(\S+) before=(\S+)"):
        whole = (root / path).read_text(encoding="utf-8")
        assert whole.count(f"\n{before}") == 1
        (root / path).write_text(whole.replace(f"\n{before}", f"\n{text}{before}"), encoding="utf-8")
    for path, diff in blocks("diff", r"file=(\S+)"):
        (root / path).write_text(
            apply_diff((root / path).read_text(encoding="utf-8"), diff), encoding="utf-8"
        )
    subprocess.run([sys.executable, root / "tools" / "write_formulas.py"], check=True)
    return root


@pytest.fixture(scope="module")
def alone(copy: pathlib.Path) -> pathlib.Path:
    """A folder of headers to be included before the copy's: there the list has the new family alone."""
    listing = pathlib.Path("microfacet") / "family" / "all.hpp"
    text = (copy / "include" / listing).read_text(encoding="utf-8")
    path = copy / "alone" / listing
    path.parent.mkdir(parents=True)
    alone = re.sub(r"std::tuple<family_tag<haze>,[^;]*", "std::tuple<family_tag<haze>>", text)
    path.write_text(alone, encoding="utf-8")
    return copy / "alone"


def compile_extension(sources: list[pathlib.Path], to: pathlib.Path, *flags: object) -> None:
    """The sources side by side, then the module."""
    common = ["-std=c++20", "-O1", "-fPIC", "-ffp-contract=off", "-Wno-psabi", *map(str, flags)]
    common += [f"-I{sysconfig.get_path('include')}", f"-I{np.get_include()}"]
    objects = [to.with_name(f"{to.name}.{source.stem}.o") for source in sources]

    def compile_one(source: pathlib.Path, made: pathlib.Path) -> None:
        subprocess.run([str(COMPILER), *common, "-c", source, "-o", made], check=True)

    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        list(pool.map(compile_one, sources, objects))
    link = ["-shared", *(["-undefined", "dynamic_lookup"] if sys.platform == "darwin" else [])]
    subprocess.run([str(COMPILER), *link, *objects, "-o", to], check=True)


@pytest.fixture(scope="module")
def package(copy: pathlib.Path, alone: pathlib.Path) -> pathlib.Path:
    """The copy's package, with its compiled modules."""
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    core = copy / "src" / "microfacet" / "_core"
    for path in pathlib.Path(_core.__file__).parent.glob(f"*{suffix}"):
        shutil.copy(path, core)
    include = [f"-I{alone}", f"-I{copy}", f"-I{copy / 'include'}"]
    own = ["-DMICROFACET_FAMILY=haze", '-DMICROFACET_FAMILY_HEADER="microfacet/family/haze.hpp"']
    sources = [path for path in sorted((copy / "bindings").glob("*.cpp")) if path.name != "processor.cpp"]
    compile_extension(sources, core / f"walk{suffix}", *include, *own, "-DMICROFACET_MODULE=walk")
    graphs = sorted((copy / "bindings" / "graph").glob("*.cpp"))
    compile_extension(graphs, copy / "src" / "microfacet" / f"_graphs{suffix}", *include)
    with (core / "__init__.py").open("a", encoding="utf-8") as file:
        file.write(LEND)
    return copy / "src"


#: As if the compiled modules had been made with the new family.
LEND = """
from microfacet._core.walk import haze
families = (*families, "haze")
for _name in available:
    import_module(f"{__name__}.{_name}").haze = haze
"""


def python(package: pathlib.Path, *arguments: object) -> None:
    """Run Python on the copy's package; what it prints is shown where it fails."""
    variables = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    variables |= {"PYTHONPATH": str(package), "MICROFACET_CACHE": str(package / "cache")}
    command = [sys.executable, *map(str, arguments)]
    done = subprocess.run(command, cwd=package.parent, env=variables, capture_output=True, text=True)
    assert done.returncode == 0, f"{done.stdout[-6000:]}\n{done.stderr[-3000:]}"


@needs_compiler
def test_every_entry_point(package: pathlib.Path, tmp_path: pathlib.Path) -> None:
    python(package, package.parent / "tests" / "every_entry_point.py", "haze", tmp_path)


@needs_compiler
def test_the_projects_own_tests_pass(package: pathlib.Path) -> None:
    tests = [package.parent / "tests" / name for name in SUITE]
    options = ("-q", "-x", "-p", "no:cacheprovider", "-p", "no:xdist", "-k", "haze")
    python(package, "-m", "pytest", *options, *tests)


@needs_compiler
def test_mitsuba_renders_with_it(package: pathlib.Path) -> None:
    mitsuba_process.require("scalar_rgb")
    python(package, "-c", RENDER)


@needs_compiler
@pytest.mark.parametrize("name", ["test_families", "test_batch"])
def test_the_cpp_tests_take_it_up(copy: pathlib.Path, alone: pathlib.Path, name: str) -> None:
    """They iterate all.hpp, which lists haze alone here: the laws by a dual number, and the SIMD batch."""
    program = copy / name
    flags = ["-std=c++20", "-O0", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror", "-Wno-psabi"]
    # as in tests/cpp/CMakeLists.txt
    if "clang" in str(COMPILER):
        flags.append("-Wno-bitwise-instead-of-logical")
    else:
        flags += ["-Wno-uninitialized", "-Wno-maybe-uninitialized"]
    source = ROOT / "tests" / "cpp" / f"{name}.cpp"
    subprocess.run(
        [str(COMPILER), *flags, f"-I{alone}", f"-I{copy / 'include'}", source, "-o", program], check=True
    )
    subprocess.run([program], check=True)
