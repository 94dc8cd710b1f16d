"""Mitsuba in a process of its own, for one variant: a wrong LLVM library ends the process that uses it.

Where it cannot run, a test is skipped with the reason, or fails with it if MICROFACET_REQUIRE_MITSUBA is set.
"""

from __future__ import annotations

import functools
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from limits import HANG

VARIANTS = ("scalar_rgb", "scalar_spectral", "llvm_ad_rgb", "llvm_ad_spectral")
PRELUDE = "import sys\nimport mitsuba as mi\nmi.set_variant({variant!r})\nimport microfacet.mitsuba\n"


@functools.cache
def hindrance(variant: str) -> str:
    """Why the plugins cannot run here, "" where they can."""
    try:
        from microfacet.mitsuba import _build, _llvm

        _build.find_compiler()
    except ImportError as error:
        return str(error)
    return _llvm.usable()[1] if variant.startswith("llvm") else ""


def require(variant: str) -> None:
    """Skip the test, or fail it where Mitsuba is required, if the plugins cannot run here."""
    reason = hindrance(variant)
    if reason and os.environ.get("MICROFACET_REQUIRE_MITSUBA"):
        pytest.fail(f"Mitsuba is required and cannot run: {reason}")
    if reason:
        pytest.skip(reason)


def python(code: str, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run Python code as it is, with more environment variables."""
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        capture_output=True,
        text=True,
        timeout=HANG,
        env={**os.environ, **environment},
    )


def run(code: str | Path, variant: str, *arguments: str) -> str:
    """What `code`, or the file of that path, prints once the plugins of `variant` are registered.

    It finds `mi`, `microfacet` and `sys`, and the arguments in `sys.argv[1:]`.
    """
    require(variant)
    text = code.read_text(encoding="utf-8") if isinstance(code, Path) else code
    done = python(PRELUDE.format(variant=variant) + text, *arguments)
    assert done.returncode == 0, f"{variant} ended with status {done.returncode}:\n{done.stderr[-4000:]}"
    return done.stdout


def result(code: str | Path, variant: str, *arguments: str) -> Any:
    """The JSON on the last line that `code` prints."""
    return json.loads(run(code, variant, *arguments).splitlines()[-1])
