"""What the figures depend on: processor, memory, versions."""

from __future__ import annotations

import os
import platform
import time
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import microfacet as mf
from microfacet import _core

PACKAGES = ("numpy", "scipy", "mitsuba", "drjit", "dask", "jax")


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def processor() -> str:
    """The processor's name as the system gives it."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def caches() -> dict[str, int]:
    """Sizes of the data caches of the first core in bytes, by level; empty where the system does not say."""
    sizes = {}
    for index in sorted(Path("/sys/devices/system/cpu/cpu0/cache").glob("index*")):
        try:
            kind, level, size = ((index / name).read_text().strip() for name in ("type", "level", "size"))
        except OSError:
            continue
        if kind != "Instruction" and size.endswith(("K", "M")):
            sizes[f"L{level}"] = int(size[:-1]) * (1024 if size.endswith("K") else 1024**2)
    return sizes


def available_memory() -> int:
    """Bytes that can be allocated without swapping; a cautious guess where the system does not say."""
    try:
        for line in Path("/proc/meminfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) * 1024
    except OSError:
        pass
    return 2 * 1024**3


def instruction_set() -> str:
    """Which of the compiled kernels run."""
    return str(_core.isa)


def versions() -> dict[str, str]:
    """Versions by package; those not installed are left out."""
    found = {"microfacet": mf.__version__, "Python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def busy(seconds: float = 0.3) -> float:
    """How many processors work while this process sleeps; nan where the system does not say."""

    def idle_and_all() -> tuple[int, int]:
        fields = [int(n) for n in Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:9]]
        return fields[3] + fields[4], sum(fields)

    try:
        before = idle_and_all()
        time.sleep(seconds)
        after = idle_and_all()
    except (OSError, ValueError):
        return float("nan")
    return (os.cpu_count() or 1) * (1 - (after[0] - before[0]) / max(1, after[1] - before[1]))


def describe() -> dict[str, object]:
    """All of the above, for the result file."""
    return {
        "processor": processor(),
        "cores": cores(),
        "caches": caches(),
        "instruction_set": instruction_set(),
        "system": f"{platform.system()} {platform.machine()}",
        "busy": busy(),
        "versions": versions(),
    }
