"""How `microfacet.mitsuba` comes by its plugins: compiler, cache, check, LLVM. Not what they render.

Most of it compiles a source of one line in place of the plugins.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import mitsuba_process
from limits import HANG
from microfacet._optional import sentence

EXPORT = 'extern "C" __attribute__((visibility("default"))) const char* microfacet_register()'
STUB = EXPORT + " { return nullptr; }\n"
VARIANT = "scalar_rgb"


class Stub:
    """A source in place of the plugins, a cache of its own, and an opinion on what is compiled."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        from microfacet.mitsuba import _build, _check

        self.build, self.monkeypatch, self.checks, self.opinion = _build, monkeypatch, 0, ""
        self.sources, self.cache = folder / "plugin", folder / "cache" / "mitsuba"
        self.sources.mkdir()
        self.write(STUB)
        monkeypatch.setattr(_build, "SOURCES", self.sources)
        monkeypatch.setattr(_check, "objection", self._objection)
        monkeypatch.setenv("MICROFACET_CACHE", str(folder / "cache"))
        monkeypatch.delenv("CXX", raising=False)

    def _objection(self, *_: object) -> str:
        self.checks += 1
        return self.opinion

    def write(self, text: str) -> None:
        (self.sources / "stub.cpp").write_text(text, encoding="utf-8")

    def key(self) -> str:
        return str(self.build.key(self.build.find_compiler(), VARIANT))

    def library(self) -> Path:
        return Path(self.build.library(VARIANT))


@pytest.fixture
def stub(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Stub:
    mitsuba_process.require(VARIANT)
    return Stub(tmp_path, monkeypatch)


# The key of the cache


def change_nothing(stub: Stub) -> None:
    stub.write(STUB)


def change_a_source(stub: Stub) -> None:
    stub.write(STUB + "// more\n")


def rename_a_source(stub: Stub) -> None:
    (stub.sources / "stub.cpp").rename(stub.sources / "other.cpp")


def add_a_header(stub: Stub) -> None:
    (stub.sources / "stub.hpp").write_text("", encoding="utf-8")


def change_the_flags(stub: Stub) -> None:
    stub.monkeypatch.setattr(stub.build, "instruction_set", lambda: ("-march=native",))


def change_a_version(stub: Stub) -> None:
    stub.monkeypatch.setattr(stub.build.nanobind, "__version__", "0")


def change_the_compiler(stub: Stub) -> None:
    wrapper = stub.sources.parent / "wrapper"
    wrapper.write_text('#!/bin/sh\nexec g++ "$@"\n', encoding="utf-8")
    wrapper.chmod(0o755)
    stub.monkeypatch.setenv("CXX", str(wrapper))


def change_the_headers(stub: Stub) -> None:
    headers = stub.sources.parent / "include" / "microfacet"
    headers.mkdir(parents=True)
    headers.joinpath("ndf.hpp").write_text("", encoding="utf-8")
    before = stub.build.compile_flags(VARIANT)
    stub.monkeypatch.setattr(stub.build, "compile_flags", lambda _: before)  # it is the content that counts
    stub.monkeypatch.setattr(stub.build.mf, "get_include", lambda: str(headers.parent))


CHANGES = [
    change_a_source,
    rename_a_source,
    add_a_header,
    change_the_flags,
    change_a_version,
    change_the_compiler,
    change_the_headers,
]


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__)
def test_whatever_matters_changes_the_key(stub: Stub, change: Callable[[Stub], None]) -> None:
    before = stub.key()
    change_nothing(stub)
    assert stub.key() == before
    change(stub)
    assert stub.key() != before


def test_variants_have_keys_of_their_own(stub: Stub) -> None:
    compiler = stub.build.find_compiler()
    assert stub.build.key(compiler, "llvm_ad_rgb") != stub.build.key(compiler, VARIANT)


# Compilers


def test_no_compiler(stub: Stub) -> None:
    stub.monkeypatch.setenv("PATH", str(stub.sources))
    with pytest.raises(ImportError, match=r"found no C\+\+ compiler: install g\+\+"):
        stub.library()


@pytest.mark.parametrize(
    ("command", "sentence"),
    [
        ("no-such-g++", "CXX names the compiler 'no-such-g[+][+]', which is not there"),
        ("false", "the compiler 'false' does not run"),
    ],
)
def test_a_broken_compiler(stub: Stub, command: str, sentence: str) -> None:
    stub.monkeypatch.setenv("CXX", command)
    with pytest.raises(ImportError, match=sentence):
        stub.library()


@pytest.mark.skipif(sys.platform == "darwin", reason="there Mitsuba itself is made by clang")
def test_clang_does_not_fit_the_variants_of_drjit(stub: Stub) -> None:
    pretender = stub.sources.parent / "clang++"
    pretender.write_text("#!/bin/sh\necho clang version 19.1.7\n", encoding="utf-8")
    pretender.chmod(0o755)
    stub.monkeypatch.setenv("CXX", str(pretender))
    with pytest.raises(ImportError, match=r"is clang, whose llvm_ad_rgb plugins abort"):
        stub.build.library("llvm_ad_rgb")


def test_sources_that_do_not_compile(stub: Stub) -> None:
    stub.write("int f() { return unheard_of; }\n")
    with pytest.raises(ImportError, match=r"could not compile stub\.cpp for scalar_rgb: .*unheard_of"):
        stub.library()
    assert not list(stub.cache.glob("*.so"))
    assert not list(stub.cache.glob(".*"))
    stub.write(STUB)
    assert stub.library().exists()


# The cache


def test_a_second_import_compiles_nothing(stub: Stub) -> None:
    path = stub.library()
    assert path.parent == stub.cache
    stamp = path.stat().st_ino
    assert stub.library() == path
    assert path.stat().st_ino == stamp
    assert stub.checks == 1


def test_what_the_check_objects_to_is_remembered(stub: Stub) -> None:
    stub.opinion = "the plugins disagree"
    for _ in range(2):
        with pytest.raises(ImportError, match=r"^the plugins disagree$"):
            stub.library()
    assert stub.checks == 1


def damage_library(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:1000])


def damage_record(path: Path) -> None:
    path.with_suffix(".json").write_text("{", encoding="utf-8")


def lose_record(path: Path) -> None:
    path.with_suffix(".json").unlink()


def lose_library(path: Path) -> None:
    path.unlink()


@pytest.mark.parametrize("damage", [damage_library, damage_record, lose_record, lose_library])
def test_half_of_an_entry_is_made_again(stub: Stub, damage: Callable[[Path], None]) -> None:
    path = stub.library()
    whole = path.stat().st_size
    damage(path)
    assert stub.library() == path
    assert path.stat().st_size == whole
    assert stub.checks == 2


def test_only_the_latest_entries_stay(stub: Stub) -> None:
    from microfacet.mitsuba import _cache

    stub.cache.mkdir(parents=True)
    for age in range(_cache.KEPT + 3):
        old = stub.cache / f"scalar_rgb-{age}.so"
        for file in (old, old.with_suffix(".json")):
            file.touch()
            os.utime(file, (1e9 - age, 1e9 - age))
    left = stub.cache / f"{_cache.scratch_prefix}left"
    left.mkdir()
    os.utime(left, (1e9, 1e9))
    path = stub.library()
    kept = {file.name for file in stub.cache.glob("*.so")}
    assert kept == {path.name, *(f"scalar_rgb-{age}.so" for age in range(_cache.KEPT - 1))}
    assert {file.with_suffix(".so").name for file in stub.cache.glob("*.json")} == kept
    assert not left.exists()


def test_a_folder_that_cannot_be_written(stub: Stub) -> None:
    stub.monkeypatch.setenv("MICROFACET_CACHE", "/dev/null/cache")
    with pytest.raises(ImportError, match=r"/dev/null/cache/mitsuba cannot be written .*MICROFACET_CACHE"):
        stub.library()


def test_a_folder_that_others_have_filled(stub: Stub) -> None:
    from microfacet.mitsuba import _cache

    def refuse(*_: object) -> None:
        raise PermissionError

    path = stub.library()
    stub.monkeypatch.setattr(_cache.os, "utime", refuse)
    stub.monkeypatch.setattr(_cache, "locked", refuse)
    assert stub.library() == path


def test_processes_that_need_the_same_compile_it_once(stub: Stub) -> None:
    log, wrapper = stub.sources.parent / "log", stub.sources.parent / "wrapper"
    wrapper.write_text(f'#!/bin/sh\necho "$@" >> {log}\nsleep 0.2\nexec g++ "$@"\n', encoding="utf-8")
    wrapper.chmod(0o755)
    code = f"""
import pathlib
from microfacet.mitsuba import _build, _check
_build.SOURCES = pathlib.Path({str(stub.sources)!r})
_check.objection = lambda *_: ""
print(_build.library({VARIANT!r}))
"""
    command = [sys.executable, "-c", code]
    environment = {**os.environ, "CXX": str(wrapper)}
    several = [
        subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) for _ in range(3)
    ]
    paths = {process.communicate(timeout=HANG)[0] for process in several}
    assert len(paths) == 1
    assert Path(paths.pop().strip()).exists()
    assert sum(" -c " in line for line in log.read_text(encoding="utf-8").splitlines()) == 1


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
