"""PyTorch in a process of its own, which may be that of the system: Debian's package is the small one.

PyPI's brings gigabytes of CUDA libraries. A folder with a link to the system's PyTorch alone, at the end of
the path, serves any Python of the same version; its arrays and NumPy's 2 meet through DLPack. Where there is
none, a test is skipped with the reason, or fails with it if MICROFACET_REQUIRE_EXPORT_TOOLS is set.
"""

from __future__ import annotations

import functools
import importlib.util
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from limits import HANG

SYSTEM = Path("/usr/lib/python3/dist-packages")
PRELUDE = """\
import sys, warnings
sys.path += {path!r}
with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # it is said to be compiled for an older NumPy
    import torch
    torch.zeros(1)
"""


def python(code: str, path: list[str], *arguments: str) -> subprocess.CompletedProcess[str]:
    """A process with more folders at the end of its path, in which `torch` is imported."""
    return subprocess.run(
        [sys.executable, "-c", PRELUDE.format(path=path) + code, *arguments],
        capture_output=True,
        text=True,
        timeout=HANG,
    )


@functools.cache
def found() -> tuple[list[str], str]:
    """What the path needs beside what it has, and why it cannot be imported, "" where it can."""
    path: list[str] = []
    if importlib.util.find_spec("torch") is None:
        if not (SYSTEM / "torch").is_dir():
            return path, "there is no PyTorch, neither here nor in the system's Python"
        folder = Path(tempfile.mkdtemp(prefix="microfacet-torch-"))
        (folder / "torch").symlink_to(SYSTEM / "torch")
        path = [str(folder)]
    done = python("", path)
    return path, "" if done.returncode == 0 else f"PyTorch cannot be imported: {done.stderr[-500:]}"


def run(code: str, *arguments: str) -> str:
    """What the code prints that begins with `torch` imported."""
    path, reason = found()
    if reason and os.environ.get("MICROFACET_REQUIRE_EXPORT_TOOLS"):
        pytest.fail(reason)
    if reason:
        pytest.skip(reason)
    done = python(code, path, *arguments)
    assert done.returncode == 0, f"ended with status {done.returncode}:\n{done.stderr[-4000:]}"
    return done.stdout
