"""Every format that is not ours, through SurfaceTopography in a process of its own.

Forty binary formats, some of them parsed by C libraries, cannot be promised to survive a hostile file. A
child process can: its memory and time are limited, and a crash, a hang or a chatty library ends there.
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.surface import MAX_PIXELS, SurfaceError

__all__ = ["LibraryMap", "read"]

#: Seconds for the whole child; importing the library alone may take ten on a cold disk.
TIMEOUT = 120.0
# Address space for the child: the interpreter and the library, then what a file of this size can need (an
# int16 map becomes float64, in several copies), within a limit that holds for any file.
_BASE_BYTES, _BYTES_PER_BYTE, _MOST_BYTES = 3 * 2**29, 32, 2**32


@dataclass(frozen=True)
class LibraryMap:
    """What the library found: heights in `unit` with nan where invalid, and the pixel size in `unit` if
    stated."""

    heights: NDArray[np.float64]
    pixel_size: tuple[float, float] | None
    unit: str | None
    channel: str


def read(file: Path, channel: int | str | None, bytes_to_read: int) -> LibraryMap:
    """Read `file` with SurfaceTopography; `SurfaceError` when it cannot, for whatever reason."""
    if not _installed():
        raise SurfaceError(
            "only .npy, .npz and .x3p are read without SurfaceTopography, install it with: "
            "pip install 'microfacet[surface]'"
        )
    request = {
        "path": str(file.resolve()),
        "channel": channel,
        "max_pixels": MAX_PIXELS,
        "max_bytes": min(_BASE_BYTES + _BYTES_PER_BYTE * bytes_to_read, _MOST_BYTES),
    }
    # The child sees the packages that we see; one BLAS thread, because each reserves address space.
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(entry for entry in sys.path if entry),
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "1",
    }
    command = [sys.executable, "-P", "-W", "ignore", str(Path(__file__).with_name("library_child.py"))]
    try:
        done = subprocess.run(
            command,
            input=json.dumps(request).encode(),
            env=environment,
            capture_output=True,
            timeout=TIMEOUT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise SurfaceError(f"reading took longer than {TIMEOUT:g} seconds") from None
    return _answer(done.stdout)


def _answer(output: bytes) -> LibraryMap:
    """One line of JSON, then the heights as float64, x fastest; anything else means that the child died."""
    line, _, data = output.partition(b"\n")
    try:
        answer = json.loads(line)
    except ValueError:
        raise SurfaceError("the reader of this format crashed or ran out of memory on the file") from None
    if "error" in answer:
        raise SurfaceError(answer["error"])
    heights = np.frombuffer(data, dtype=np.float64).reshape(answer["shape"])
    size = answer["pixel_size"]
    return LibraryMap(
        heights, None if size is None else (size[0], size[1]), answer["unit"], answer["channel"]
    )


def _installed() -> bool:
    try:
        return importlib.util.find_spec("SurfaceTopography") is not None
    except ValueError:  # sys.modules holds None for it: switched off
        return False
