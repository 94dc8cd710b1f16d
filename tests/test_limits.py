"""No test and no child process fails because the machine is busy: wall-clock limits are for what hangs."""

from __future__ import annotations

import ast
import pathlib
import subprocess
import sys

import pytest
from hypothesis import HealthCheck, settings

import mitsuba_process
from limits import HANG, wait_for

TESTS = pathlib.Path(__file__).parent
MODULES = sorted(TESTS.rglob("*.py"))
PATIENCE = 600.0  # no limit on wall-clock time may be shorter


def keywords(path: pathlib.Path, name: str) -> list[str]:
    """What calls in this file pass under the name."""
    calls = (
        node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.Call)
    )
    return [ast.unparse(word.value) for call in calls for word in call.keywords if word.arg == name]


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.name)
def test_limits_of_tests_are_for_what_hangs(path: pathlib.Path) -> None:
    assert set(keywords(path, "timeout")) <= {"HANG"}, "import HANG from limits"
    assert set(keywords(path, "deadline")) <= {"None"}
    assert HANG >= PATIENCE


def test_examples_may_take_their_time() -> None:
    for known in (settings(), settings(max_examples=3)):
        assert known.deadline is None
        assert HealthCheck.too_slow in known.suppress_health_check


def test_limits_of_child_processes_are_for_what_hangs() -> None:
    from microfacet._surface.read import process

    assert process.HANG >= PATIENCE


def test_limits_of_the_trials_of_mitsuba_are_for_what_hangs() -> None:
    mitsuba_process.require("scalar_rgb")
    from microfacet.mitsuba import _cache, _check, _llvm

    assert min(_check.SECONDS, _llvm.SECONDS, _cache.ABANDONED) >= PATIENCE


def test_waiting_ends_with_the_condition_or_with_the_process(tmp_path: pathlib.Path) -> None:
    code = "import pathlib, sys, time; time.sleep(0.2); pathlib.Path(sys.argv[1]).touch(); time.sleep(0.2)"
    with subprocess.Popen([sys.executable, "-c", code, str(tmp_path / "there")]) as process:
        wait_for((tmp_path / "there").exists, process)
        with pytest.raises(AssertionError, match="ended with status 0"):
            wait_for((tmp_path / "never").exists, process)
