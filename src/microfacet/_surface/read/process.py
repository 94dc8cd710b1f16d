"""Readers that are not ours run in a process of their own.

Binary formats, some of them parsed by C libraries, cannot be promised to survive a hostile file. A child
process can: its memory and processor time are limited, and a crash, a hang or a chatty library ends there.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import MAX_PIXELS, SurfaceError

__all__ = ["run"]

#: Seconds of processor time for the whole child, which do not depend on what else the machine does, and
#: seconds after which it hangs: a child that waits for something uses no processor.
PROCESSOR_SECONDS, HANG = 120, 1800.0
# Address space for the child: the interpreter and the library, then what a file of this size can need (an
# int16 map becomes float64, in several copies), within a limit that holds for any file.
_BASE_BYTES, _BYTES_PER_BYTE, _MOST_BYTES = 3 * 2**29, 32, 2**32


def run(
    reader: str, file: Path, bytes_to_read: int, **request: Any
) -> tuple[dict[str, Any], NDArray[np.float64]]:
    """What the reader in the child answers, and its array; `SurfaceError` when there is none, whatever the
    reason."""
    request |= {
        "reader": reader,
        "path": str(file.resolve()),
        "max_pixels": MAX_PIXELS,
        "max_seconds": PROCESSOR_SECONDS,
        "max_bytes": min(_BASE_BYTES + _BYTES_PER_BYTE * bytes_to_read, _MOST_BYTES),
    }
    # The child sees the packages that we see; one BLAS thread, because each reserves address space.
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(entry for entry in sys.path if entry),
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "1",
        "OPENIMAGEIO_THREADS": "1",
    }
    command = [sys.executable, "-P", "-W", "ignore", str(Path(__file__).with_name("child.py"))]
    try:
        done = subprocess.run(
            command,
            input=json.dumps(request).encode(),
            env=environment,
            capture_output=True,
            timeout=HANG,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise SurfaceError(f"reading took longer than {HANG:g} seconds") from None
    if done.returncode == -getattr(signal, "SIGXCPU", 0) < 0:
        raise SurfaceError(f"reading took longer than {PROCESSOR_SECONDS} seconds of processor time")
    return _answer(done.stdout)


def _answer(output: bytes) -> tuple[dict[str, Any], NDArray[np.float64]]:
    """One line of JSON, then the array as float64; anything else means that the child died."""
    start = output.find(b"\n") + 1
    try:
        answer = json.loads(output[:start])
    except ValueError:
        raise SurfaceError("the reader of this format crashed or ran out of memory on the file") from None
    if "error" in answer:
        raise SurfaceError(answer["error"])
    return answer, np.frombuffer(output, dtype=np.float64, offset=start).reshape(answer["shape"])
