"""The rules of ARCHITECTURE.md that a machine can check.

Data flows one way, one list of families drives everything, names stay free, importing is quick.
"""

from __future__ import annotations

import ast
import importlib
import pathlib
import pkgutil
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import microfacet as mf

ROOT = pathlib.Path(__file__).parent.parent
HEADERS = ROOT / "include" / "microfacet"
PACKAGE = ROOT / "src" / "microfacet"

# Lower layers first. A file includes or imports from layers below its own, and from its own folder.
CPP_LAYERS = ("core", "approx", "special", "family", "tabulated", "smith", "bsdf", "record")
PYTHON_LAYERS = (
    {
        "_arrays",
        "_calls",
        "_core",
        "_files",
        "_graphs",
        "_installation",
        "_optional",
        "_text",
        "_threads",
        "_value",
    },
    {"_docs", "_quantities"},
    {"_sampling"},
    {"_frozen", "_densities"},
    {"_family", "_radial", "_slope_table", "_bsdf"},
    {"_user_family"},
    {"__init__"},  # the public names; what lies above them it loads on demand only
    {"testing", "plot", "_checks", "_surface", "_bake", "_export", "_optics"},
    {"_profile"},
    {"_fit", "_density_files", "mitsuba"},
    {"_render"},
    {"_report"},
    {"cli"},
    {"__main__"},
)
LONGEST = {".hpp": 200, ".py": 300}

headers = sorted(HEADERS.rglob("*.hpp"))
modules = sorted(PACKAGE.rglob("*.py"))
each_family = pytest.mark.parametrize("family", mf.families(), ids=lambda family: family.name)


def relative(path: pathlib.Path) -> str:
    return path.relative_to(ROOT).as_posix()


# Layers


@pytest.mark.parametrize("path", headers, ids=relative)
def test_headers_include_lower_layers(path: pathlib.Path) -> None:
    text = path.read_text(encoding="utf-8")
    own = path.relative_to(HEADERS).parts[0]
    for name in re.findall(r'#include\s*"([^"]+)"', text):
        assert name.startswith("microfacet/"), f"{name}: include it as microfacet/..."
        other = name.split("/")[1]
        assert CPP_LAYERS.index(other) <= CPP_LAYERS.index(own), f"{relative(path)} looks up to {name}"
    # What records a graph computes no numbers: it may allocate.
    allocates = set() if own == "record" else {"string", "vector", "map"}
    for name in re.findall(r"#include\s*<([^>]+)>", text):
        assert name not in {"iostream", "cstdio", "fstream", "Python.h"} | allocates, f"no {name} in the core"


def layer_of(module: str) -> int:
    """The layer of microfacet.<module>..., by the first part of its name."""
    top = module.split(".")[1] if "." in module else "__init__"
    for rank, names in enumerate(PYTHON_LAYERS):
        if top in names:
            return rank
    raise AssertionError(f"{module}: give it a layer in PYTHON_LAYERS and in ARCHITECTURE.md")


def module_name(path: pathlib.Path) -> str:
    parts = ("microfacet", *path.relative_to(PACKAGE).with_suffix("").parts)
    return ".".join(part for part in parts if part != "__init__")


def imports(tree: ast.Module, package: str) -> Iterator[tuple[str, bool]]:
    """Names of ours that a module imports, and whether it does so when it is itself imported."""

    def deferred(node: ast.AST) -> bool:
        types_only = isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        return types_only or isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)

    inside = {id(inner) for node in ast.walk(tree) if deferred(node) for inner in ast.walk(node)}
    for node in ast.walk(tree):
        found: list[str] = []
        if isinstance(node, ast.Import):
            found = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                base = ".".join(
                    [*package.split(".")[: len(package.split(".")) - node.level + 1], base]
                ).strip(".")
            # `from microfacet import _files` names a module, `from microfacet._files import x` a thing in it
            is_module = [f"{base}.{alias.name}" for alias in node.names]
            found = [name if exists(name) else base for name in is_module]
        for name in found:
            if name.split(".")[0] == "microfacet":
                yield name, id(node) not in inside


def exists(module: str) -> bool:
    path = PACKAGE.parent.joinpath(*module.split("."))
    return path.is_dir() or path.with_suffix(".py").exists()


@pytest.mark.parametrize("path", modules, ids=relative)
def test_modules_import_lower_layers(path: pathlib.Path) -> None:
    own = module_name(path)
    package = own if path.name == "__init__.py" else own.rpartition(".")[0]
    own_top = own.split(".")[1:2]
    for name, at_import in imports(ast.parse(path.read_text(encoding="utf-8")), package):
        if name.split(".")[1:2] == own_top and own_top:
            continue  # its own folder
        if own == "microfacet" and not at_import:
            continue  # the public names load the layers above on demand
        assert layer_of(name) < layer_of(own), f"{relative(path)} imports {name}"


@pytest.mark.parametrize("path", headers + modules, ids=relative)
def test_rooms_are_short(path: pathlib.Path) -> None:
    if "do not edit by hand" not in path.read_text(encoding="utf-8")[:500]:
        assert path.read_text(encoding="utf-8").count("\n") <= LONGEST[path.suffix]


# Public names


def public_functions() -> dict[str, Callable[[], Any]]:
    """How to call each public function and class, by name."""
    slopes = np.random.default_rng(1).normal(size=(400, 2)) * 0.2
    calls: dict[str, Callable[[], Any]] = {
        "families": mf.families,
        "get_cmake_dir": mf.get_cmake_dir,
        "get_include": mf.get_include,
        "export": lambda: mf.export("c", "ggx", ["D"]),
        "array_functions": lambda: mf.array_functions("ggx").D([0.0, 0.6, 0.8], alpha=0.3),
        "bake": lambda: mf.bake("energy", "ggx", alpha=1.0, cos_theta=2),
        "lookup_texture": lambda: mf.lookup_texture("split_sum", "ggx", size=(2, 2), check=0),
        "sample_terrain": mf.sample_terrain,
        "testing": lambda: mf.testing.sidak(0.01, 2),
        "roughness": lambda: mf.roughness(mf.sample_terrain()),
        "material_ratio": lambda: mf.material_ratio(mf.sample_terrain()).core(),
        "spectrum": lambda: mf.spectrum(mf.sample_terrain()),
        "autocorrelation": lambda: mf.autocorrelation(mf.sample_terrain()),
        "synthesize": lambda: mf.synthesize(mf.Beckmann(alpha=0.3), (32, 32)),
        "brdf_table": lambda: mf.brdf_table(mf.GGX(alpha=0.3), polar=[0, 30], azimuth=0, n=16),
        "spatial_bandwidth": lambda: mf.spatial_bandwidth(550e-9),
        "compare": lambda: mf.compare([slopes, 2 * slopes], "beckmann"),
        "fit": lambda: mf.fit(slopes, families=["beckmann"]),
        "fit_scales": lambda: mf.fit_scales(mf.sample_terrain(), [4], "beckmann"),
        "fit_table": lambda: mf.fit_table(mean_square_slopes=0.03),
        "fresnel_average": lambda: mf.fresnel_average(1.5),
        "fresnel_conductor": lambda: mf.fresnel_conductor(0.5, 0.2, 3.4),
        "fresnel_dielectric": lambda: mf.fresnel_dielectric(0.5, 1.5),
    }
    for family in mf.families():
        values = {
            p.name: 0.3 if p.name == "alpha" else min(p.lower + 1.25, (p.lower + p.upper) / 2)
            for p in family.parameters
        }
        calls[family.cls.__name__] = lambda make=family.cls, values=values: make(**values).sigma(
            [0.0, 0.6, 0.8]
        )
        calls[family.name] = lambda kernels=family.kernels, values=values: kernels.sigma(
            0.5, *values.values()
        )
    return calls


NEED_INPUT = {
    "read_density",
    "read_normal_map",
    "read_profile",
    "read_refractive_index",
    "read_slopes",
    "read_surface",
}  # files


def test_every_public_name_works_twice() -> None:
    """The second call finds what the first one found: no module that it loaded has taken its name."""
    calls = public_functions()
    types_only = {name for name in mf.__all__ if isinstance(getattr(mf, name), type)} | {"__version__"}
    forgotten = set(mf.__all__) - set(calls) - NEED_INPUT - types_only
    assert not forgotten, f"say in this test how to call {sorted(forgotten)}"
    for name, call in calls.items():
        before = getattr(mf, name)
        call()
        call()
        assert getattr(mf, name) is before, name
    assert set(mf.__all__) <= set(dir(mf))


def test_no_module_bears_the_name_of_a_public_function() -> None:
    submodules = {module.name for module in pkgutil.iter_modules([str(PACKAGE)])}
    functions = {name for name in mf.__all__ if not isinstance(getattr(mf, name), type(mf))}
    assert not submodules & functions


# Importing


def test_importing_is_light_and_quick() -> None:
    """The first result comes within half a second of processor time; the bound has room for slow machines."""
    heavy = ("matplotlib", "scipy", "mpmath", "click", "rich", "jinja2", "latex2mathml", "mitsuba", "dask")
    program = f"""
import sys, time
import numpy
begin = time.process_time()
import microfacet as mf
value = mf.student_t.sigma(0.5, 0.3, 2.5)
mf.StudentT(alpha=0.3, gamma=2.5).D([0.0, 0.0, 1.0])
seconds = time.process_time() - begin
print(seconds, *sorted(set(name.split(".")[0] for name in sys.modules) & set({heavy!r})))
"""
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    seconds, *loaded = result.stdout.split()
    assert not loaded
    assert float(seconds) < 2


@pytest.mark.parametrize("path", modules, ids=relative)
def test_every_module_imports_on_its_own(path: pathlib.Path) -> None:
    importlib.import_module(module_name(path))


# One list of families


@each_family
def test_a_family_has_all_its_parts(family: Any) -> None:
    for part in (
        HEADERS / "family" / f"{family.name}.hpp",
        PACKAGE / "_family" / f"{family.name}.py",
        ROOT / "tests" / "family" / f"test_{family.name}.py",
        ROOT / "docs" / "family" / f"{family.name}.md",
    ):
        assert part.exists(), f"{relative(part)} is missing"
    assert f"family_tag<{family.name}>" in (HEADERS / "family" / "all.hpp").read_text(encoding="utf-8")


def test_no_family_is_outside_the_list() -> None:
    names = {family.name for family in mf.families()}
    listed = set(
        re.findall(r"family_tag<(\w+)>", (HEADERS / "family" / "all.hpp").read_text(encoding="utf-8"))
    )
    assert listed == names
    for folder, pattern in (("tests/family", r"test_(\w+)\.py"), ("docs/family", r"(\w+)\.md")):
        found = {m.group(1) for path in (ROOT / folder).iterdir() if (m := re.fullmatch(pattern, path.name))}
        assert found == names, folder
