"""What a first use of `microfacet.mitsuba` compiles, and what it says meanwhile."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import mitsuba_process
from mitsuba_stub import STUB, VARIANT, Stub


def test_the_first_use_says_what_it_does(stub: Stub, capfd: pytest.CaptureFixture[str]) -> None:
    """On stderr, whether it is a terminal or not; and the second says nothing."""
    (stub.sources / "more.cpp").write_text("int more() { return 1; }\n", encoding="utf-8")
    stub.library()
    said = capfd.readouterr()
    assert said.out == ""
    begin, *compiled, compares, end = said.err.splitlines()
    assert begin.startswith(f"microfacet: compiling the Mitsuba plugins for {VARIANT} (once")
    assert compiled == [f"microfacet:   {k} of 2 sources compiled" for k in (1, 2)]
    assert compares == f"microfacet: comparing the plugins for {VARIANT} with Mitsuba's own"
    assert end.startswith(f"microfacet: the plugins for {VARIANT} took ")
    assert str(stub.cache) in end
    stub.library()
    assert capfd.readouterr().err == ""


def test_nobody_has_to_listen(stub: Stub, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        patch.setattr("sys.stderr", None)
        assert stub.library().exists()
    stub.write(STUB + "// again\n")
    closed = open(os.devnull, "w")  # noqa: SIM115
    closed.close()
    with monkeypatch.context() as patch:
        patch.setattr("sys.stderr", closed)
        assert stub.library().exists()


def compiled_by(stub: Stub, code: str) -> tuple[set[str], str]:
    """The variants for which `code` leaves a library, after the import; and what it says."""
    start = f"""
import pathlib
import mitsuba as mi
from microfacet.mitsuba import _build, _check
_build.SOURCES = pathlib.Path({str(stub.sources)!r})
_check.objection = lambda *_: ""
"""
    done = mitsuba_process.python(start + code, MICROFACET_CACHE=str(stub.cache.parent))
    assert done.returncode == 0, done.stderr
    return {path.name.rpartition("-")[0] for path in stub.cache.glob("*.so")}, done.stderr


def test_an_import_alone_compiles_nothing(stub: Stub) -> None:
    assert compiled_by(stub, "") == (set(), "")


def test_only_the_variant_that_is_set_is_compiled(stub: Stub) -> None:
    variants, said = compiled_by(stub, "mi.set_variant('scalar_spectral')")
    assert variants == {"scalar_spectral"}
    assert "scalar_rgb" not in said


def test_the_trial_of_llvm_is_told(tmp_path: Path) -> None:
    mitsuba_process.require("llvm_ad_rgb")
    code = "from microfacet.mitsuba import _llvm\nassert _llvm.usable()[0]"
    first, second = (mitsuba_process.python(code, MICROFACET_CACHE=str(tmp_path)) for _ in range(2))
    assert first.returncode == second.returncode == 0, first.stderr
    assert first.stderr.startswith("microfacet: trying Dr.Jit's LLVM library")
    assert second.stderr == ""


def test_variants_may_come_in_any_order() -> None:
    """Mitsuba asks scalar_rgb of what kind a plugin is, whichever is set."""
    code = """
try:
    mi.load_dict({"type": "microfacet_conductor", "alpha": -1.0})
except RuntimeError as error:
    print(error)
mi.set_variant("scalar_rgb")
print(mi.load_dict({"type": "microfacet_conductor"}).class_name())
"""
    said, name = mitsuba_process.run(code, "scalar_spectral").splitlines()
    assert "unknown" not in said
    assert said.endswith('microfacet_conductor: "alpha" is -1, roughness lies in (0, 1e4]')
    assert name == "microfacet_conductor"
