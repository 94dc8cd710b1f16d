"""Importing microfacet.mitsuba: plugins are checked, variants have to fit, LLVM has to work."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

import mitsuba_process
from microfacet._optional import sentence
from mitsuba_stub import EXPORT, VARIANT, Stub

# The check


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        ("{ __builtin_trap(); }", "the check of the plugins for scalar_rgb ended with status -"),
        ('{ return "no room"; }', "the check of the plugins for scalar_rgb ended with status 1: no room"),
        ("{ return nullptr; }", "unknown plugin"),
    ],
    ids=["crash", "refusal", "nothing registered"],
)
def test_a_library_that_fails_is_not_loaded_here(stub: Stub, body: str, sentence: str) -> None:
    stub.monkeypatch.undo()  # the true check
    code = f"""
import pathlib, sys
from microfacet.mitsuba import _build
_build.SOURCES = pathlib.Path({str(stub.sources)!r})
try:
    _build.library({VARIANT!r})
except ImportError as error:
    print(error)
"""
    stub.write(EXPORT + body + "\n")
    done = mitsuba_process.python(code, MICROFACET_CACHE=str(stub.cache))
    assert sentence in done.stdout, done.stderr
    assert not list(stub.cache.rglob("*.json"))  # the next time it may go better


@pytest.mark.skipif(os.uname().machine != "x86_64", reason="the option is one of x86-64")
def test_plugins_of_another_memory_layout_are_refused() -> None:
    """Compiled for an x86-64 without SSE 4.2, Mitsuba's vectors are others, and images silently wrong."""
    mitsuba_process.require(VARIANT)
    code = """
import mitsuba as mi
import microfacet.mitsuba
from microfacet.mitsuba import _build
_build.instruction_set = lambda: ("-O0",)  # quicker, and without -march
try:
    mi.set_variant("scalar_rgb")
except ImportError as error:
    print(error)
try:
    mi.load_dict({"type": "microfacet_conductor"})
except RuntimeError as error:
    print("unknown plugin" in str(error))
"""
    done = mitsuba_process.python(code)
    sentence, absent = done.stdout.splitlines()
    assert sentence.startswith("the plugins compiled for scalar_rgb are not used: their ")
    assert absent == "True"


# Importing


def test_plugins_come_with_the_variant() -> None:
    """With the one that is set, with any set later, and in none of them twice."""
    code = """
import ctypes
before, loads = ctypes.CDLL, []
ctypes.CDLL = lambda path: loads.append(path) or before(path)
mi.set_variant("scalar_spectral")
mi.set_variant("scalar_rgb")
mi.set_variant("scalar_spectral")
microfacet.mitsuba.register()
print(mi.load_dict({"type": "microfacet_conductor"}) is not None, len(loads))
"""
    assert mitsuba_process.run(code, VARIANT).split() == ["True", "1"]


@pytest.mark.parametrize("name", ["mitsuba", "drjit", "nanobind", "platformdirs"])
def test_what_is_not_installed_is_named(name: str) -> None:
    mitsuba_process.require(VARIANT)
    code = f"import sys; sys.modules[{name!r}] = None\nimport microfacet.mitsuba"
    last = mitsuba_process.python(code).stderr.strip().splitlines()[-1]
    assert last == f"ImportError: {sentence('microfacet.mitsuba needs', name)}"


def test_names_that_are_no_variants() -> None:
    mitsuba_process.require(VARIANT)
    import microfacet.mitsuba

    with pytest.raises(ValueError, match=r"variant must be one of scalar_rgb, .*, got 'scalar_grey'"):
        microfacet.mitsuba.register("scalar_grey")


def test_a_variant_has_to_be_set() -> None:
    mitsuba_process.require(VARIANT)
    code = "import microfacet.mitsuba\nmicrofacet.mitsuba.register()"
    last = mitsuba_process.python(code).stderr.strip().splitlines()[-1]
    assert last.endswith("there is no variant to register plugins for: call mitsuba.set_variant first")


# LLVM


def usable(**environment: str) -> Any:
    code = "import json\nfrom microfacet.mitsuba import _llvm\nprint(json.dumps(_llvm.usable()))"
    done = mitsuba_process.python(code, **environment)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_no_llvm_library(tmp_path: Path) -> None:
    mitsuba_process.require(VARIANT)
    works, reason = usable(DRJIT_LIBLLVM_PATH=str(tmp_path / "none.so"), MICROFACET_CACHE=str(tmp_path))
    assert not works
    assert reason.startswith("Dr.Jit finds no LLVM library that it can load: install")
    assert not list(tmp_path.rglob("llvm-*"))


def test_a_library_that_works_is_remembered(tmp_path: Path) -> None:
    mitsuba_process.require("llvm_ad_rgb")
    assert usable(MICROFACET_CACHE=str(tmp_path)) == [True, ""]
    (memory,) = tmp_path.rglob("llvm-*.json")
    stamp = memory.stat().st_ino
    assert usable(MICROFACET_CACHE=str(tmp_path)) == [True, ""]
    assert memory.stat().st_ino == stamp


def test_an_llvm_that_ends_the_process_is_found_out(tmp_path: Path) -> None:
    """LLVM 15 does not know an instruction that Dr.Jit uses on x86-64."""
    mitsuba_process.require(VARIANT)
    old = Path("/usr/lib/x86_64-linux-gnu/libLLVM-15.so.1")
    if not old.exists():
        pytest.skip("there is no LLVM 15 here")
    works, reason = usable(DRJIT_LIBLLVM_PATH=str(old), MICROFACET_CACHE=str(tmp_path))
    assert not works
    assert reason.startswith(f"Dr.Jit cannot work with {old} (LLVM ERROR")
