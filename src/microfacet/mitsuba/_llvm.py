"""Whether Dr.Jit's LLVM backend can run here, found out in a process of its own.

Dr.Jit loads whatever LLVM library it finds first. One that is too old for it is refused, one that cannot
compile its instructions (LLVM 15 on x86-64) ends the process at the first render.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
import subprocess
import sys
import tempfile
from contextlib import suppress
from glob import glob
from pathlib import Path

import drjit

from microfacet.mitsuba import _cache, _check
from microfacet.mitsuba._progress import progress

__all__ = ["usable"]

SECONDS = 1800  # it may hang; how long it takes depends on what else the machine does
ADVICE = "install another (Debian: apt install libllvm19) or name one in DRJIT_LIBLLVM_PATH"
# Where Dr.Jit and the dynamic linker look.
PLACES = ("/usr/lib/*/libLLVM*.so*", "/usr/lib*/libLLVM*.so*", "/usr/local/lib/libLLVM*.so*")
TRIAL = """
import mitsuba as mi
mi.set_variant("llvm_ad_rgb")
try:
    import drjit as dr
    dr.eval(dr.sqrt(dr.arange(mi.Float, 16)))
    with open("/proc/self/maps") as maps:
        print(next((line.split()[-1] for line in maps if "libLLVM" in line), ""), flush=True)
except OSError:
    print(flush=True)
film = {"type": "hdrfilm", "width": 8, "height": 8}
scene = mi.load_dict({
    "type": "scene",
    "integrator": {"type": "path", "max_depth": 3},
    "light": {"type": "constant"},
    "ball": {"type": "sphere", "center": [0, 0, 4], "material": {"type": "roughconductor", "alpha": 0.3}},
    "sensor": {"type": "perspective", "film": film},
})
assert dr.all(dr.isfinite(mi.render(scene, spp=2).array))
print("rendered")
"""


@functools.cache
def usable() -> tuple[bool, str]:
    """Whether variants with LLVM run, and one sentence why not (empty where they do).

    A library that has run is remembered, with all that may take its place, in the cache.
    """
    remembered = _cache.directory() / f"llvm-{_surroundings()}.json"
    try:
        if _cache.read_private(remembered) is True:
            return True, ""
    except (OSError, ValueError):
        pass
    progress("trying Dr.Jit's LLVM library (once, some seconds)")
    works, reason = _try()
    if works:
        with suppress(OSError, ImportError):  # it is only quicker with a memory
            _cache.write_private(remembered, True)
    return works, reason


def _surroundings() -> str:
    """A name for the LLVM libraries in reach and for the Dr.Jit that chooses among them."""
    named = [os.environ.get(name, "") for name in ("DRJIT_LIBLLVM_PATH", "LD_LIBRARY_PATH")]
    patterns = [named[0], *PLACES, *(f"{folder}/libLLVM*" for folder in named[1].split(os.pathsep) if folder)]
    files = sorted({path for pattern in patterns for path in glob(pattern)})
    seen = [(path, os.stat(path).st_mtime_ns) for path in files if os.path.exists(path)]
    return hashlib.sha256(json.dumps([drjit.__version__, named, seen]).encode()).hexdigest()[:20]


def _try() -> tuple[bool, str]:
    # A home of its own, because kernels that another LLVM has compiled lie in the usual one.
    with tempfile.TemporaryDirectory() as home:
        environment = {**_check.environment(), "HOME": home}
        try:
            done = subprocess.run(
                [sys.executable, "-P", "-c", TRIAL],
                capture_output=True,
                text=True,
                errors="replace",
                env=environment,
                timeout=SECONDS,
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            return False, f"the trial of Dr.Jit with LLVM did not end: {error}"
    lines = done.stdout.split("\n")
    if done.returncode == 0 and "rendered" in lines:
        return True, ""
    if not lines[0]:
        return False, f"Dr.Jit finds no LLVM library that it can load: {ADVICE}"
    said = [line.strip() for line in done.stderr.splitlines() if "error" in line.lower()]
    why = f" ({said[0][:100]})" if said else ""
    return False, f"Dr.Jit cannot work with {Path(lines[0])}{why}: {ADVICE}"
