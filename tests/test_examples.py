"""The examples run, from another folder, and print what they announce."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

import mitsuba_process
from limits import HANG

EXAMPLES = Path(__file__).parents[1] / "examples" / "python"


@pytest.mark.parametrize(
    ("name", "announced"),
    [
        ("compare_families.py", "Student-T"),
        ("fit_surface.py", "nats per slope"),
        ("furnace_sphere.py", "GGX       single   mean light 0.5"),
        ("lobes.py", "diffuse facets  all       largest"),
        ("check_a_sampler.py", "one percent too rough  89 degrees: chi-square fails"),
    ],
)
def test_example_runs(name: str, announced: str, tmp_path: Path) -> None:
    assert announced in said_by(name, tmp_path)


def test_inverse_rendering_recovers_what_was_hidden(tmp_path: Path) -> None:
    mitsuba_process.require("llvm_ad_rgb")
    said = said_by("inverse_rendering.py", tmp_path)
    values = {
        what: [float(x) for x in re.findall(r"\d+\.\d+", line)]
        for what, line in re.findall(r"^(recovered|true): (.*)$", said, flags=re.MULTILINE)
    }
    assert values["recovered"] == pytest.approx(values["true"], rel=0.03)


def said_by(name: str, folder: Path) -> str:
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / name)], cwd=folder, capture_output=True, text=True, timeout=HANG
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
