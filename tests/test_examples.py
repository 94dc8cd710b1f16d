"""The examples run, from another folder, and print what they announce."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import mitsuba_process

EXAMPLES = Path(__file__).parents[1] / "examples" / "python"


@pytest.mark.parametrize(
    ("name", "announced"),
    [
        ("compare_families.py", "Student-T"),
        ("fit_surface.py", "nats per slope"),
        ("furnace_sphere.py", "GGX       single   mean light 0.5"),
        ("lobes.py", "diffuse facets  all       largest"),
        ("check_a_sampler.py", "one percent too rough  89 degrees: chi-square fails"),
        ("inverse_rendering.py", "recovered: alpha 0.20, gamma 2.2"),
    ],
)
def test_example_runs(name: str, announced: str, tmp_path: Path) -> None:
    if name == "inverse_rendering.py":
        mitsuba_process.require("llvm_ad_rgb")
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / name)], cwd=tmp_path, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    assert announced in done.stdout
