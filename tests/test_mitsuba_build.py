"""How `microfacet.mitsuba` comes by its plugins: compiler, cache, check, LLVM. Not what they render.

Most of it compiles a source of one line in place of the plugins.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from limits import HANG
from mitsuba_stub import STUB, VARIANT, Stub

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
