"""How long a test waits for what may hang.

A limit on wall-clock time ends what would never end, and says nothing about speed: a busy machine may be a
hundred times as slow as a quiet one. What a test measures it measures in processor time.
"""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable
from typing import Any

__all__ = ["HANG", "wait_for"]

HANG = 1800.0  # seconds


def wait_for(condition: Callable[[], Any], process: subprocess.Popen[Any]) -> None:
    """Return once the condition holds; AssertionError if the process ends before that, or hangs."""
    deadline = time.monotonic() + HANG
    while not condition():
        assert process.poll() is None, f"the process ended with status {process.returncode}"
        assert time.monotonic() < deadline
        time.sleep(0.005)
