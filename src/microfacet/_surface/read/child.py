"""The child process of `process.py`: a request on stdin, a line of JSON and an array on stdout.

It is run as a script and imports nothing of microfacet, so that it starts with its memory limit in place and
loads only what reading needs: the reader that the request names, a file beside this one.
"""

from __future__ import annotations

import importlib.util
import json
import logging
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np


def main() -> None:
    request = json.load(sys.stdin)
    # Libraries may print; only this function writes to the real stdout.
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    logging.disable()
    limit(request["max_bytes"], request["max_seconds"])
    reader = load(request["reader"])
    try:
        answer, heights = reader.read(request)
    except reader.Unusable as error:
        answer, heights = {"error": str(error)}, None
    except MemoryError:
        answer, heights = {"error": "reading it needs more memory than a file of its size should"}, None
    except Exception as error:
        reason = " ".join(str(error).split())[:200]
        answer, heights = {"error": f"cannot be read ({type(error).__name__}: {reason})"}, None
    output.write(json.dumps(answer).encode() + b"\n")
    if heights is not None:
        output.write(np.ascontiguousarray(heights, dtype=np.float64).data)
    output.flush()
    os._exit(0)  # no destructors of half-opened files


def load(name: str) -> Any:
    """The module of that name beside this one; its folder, full of names of ours, stays off the path."""
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    if spec is None or spec.loader is None:
        raise ImportError(name)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def limit(bytes_: int, seconds: int) -> None:
    """Limit address space and processor time; the kernel ends what takes more time, without a core file."""
    try:
        import resource
    except ImportError:  # Windows has no such limits; the checks of sizes remain
        return
    wanted = {resource.RLIMIT_AS: bytes_, resource.RLIMIT_CPU: seconds, resource.RLIMIT_CORE: 0}
    for kind, value in wanted.items():
        _, hard = resource.getrlimit(kind)
        resource.setrlimit(kind, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard))


if __name__ == "__main__":
    main()
