"""The gate of continuous integration: no kernel may become half as fast as it was.

Speeds are judged by ratios within one process: to NumPy's exp, to the SciPy expression, and (with a wide
margin, since that depends on the machine) to a copy. thresholds.toml holds the least ratios for each
instruction set. A kernel that falls short is measured twice again before it fails: noise passes, a slower
kernel does not.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path

from microfacet import families
from microfacet._graphs import exact_in_float32

from .kernels import KERNELS, Inputs, Kernel
from .machine import instruction_set
from .results import write_whole
from .suite import CACHE, DTYPES, Measurement, elements_in, measure

THRESHOLDS = Path(__file__).with_name("thresholds.toml")
MARGIN = 0.5  # of the measured ratio: a kernel that takes twice as long fails
COPY_MARGIN = 0.2
ATTEMPTS = 3
LONGEST_CALL = 5e-4  # seconds
# Families that have tables alone are computed by the kernels of all tables, which other families' rows watch.
_TABLES_ALONE = {f.name for f in families() if len(f.parameters) == 1 and not exact_in_float32[f.name]}
GATED = tuple(
    kernel
    for kernel in KERNELS
    if (kernel.form != "x, y, z" or kernel.quantity == "D") and kernel.family not in _TABLES_ALONE
)
HEAD = """\
# The least ratios (speed of the kernel over that of the contender) that `make bench-check` lets pass: half of
# what was measured, a fifth for copies. Written by `python -m benchmarks check --record`, once for each value
# of MICROFACET_ISA.
"""

Thresholds = dict[str, dict[str, dict[str, float]]]  # instruction set, "kernel dtype", contender


def read(path: Path = THRESHOLDS) -> Thresholds:
    """All thresholds."""
    return tomllib.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def shortfalls(measurement: Measurement, least: dict[str, float]) -> Iterator[str]:
    """A sentence for each ratio of best speeds that is too small."""
    ours = measurement.speeds["ours"]
    for contender, bound in least.items():
        theirs = measurement.speeds.get(contender)
        if theirs is not None and ours / theirs < bound:
            yield (
                f"{measurement.kernel} in {measurement.dtype} runs at {ours / theirs:.3g} times the speed of "
                f"{contender}; at least {bound:.3g} is expected"
            )


def check(seconds: float, thresholds: Thresholds) -> Iterator[tuple[str, list[str]]]:
    """Measure every kernel that has a threshold here; its name with what falls short, if anything does."""
    known = thresholds.get(instruction_set(), {})
    for dtype in DTYPES:
        for kernel in GATED:
            if least := known.get(f"{kernel.name} {dtype}"):
                found: list[str] = []
                for attempt in range(ATTEMPTS):
                    found = list(shortfalls(_measured(kernel, dtype, seconds * (1 + attempt)), least))
                    if not found:
                        break
                yield kernel.name, found


def _measured(kernel: Kernel, dtype: str, seconds: float) -> Measurement:
    """On an array so short that other processes interrupt no more than some of the calls."""
    length = min(CACHE, max(64, elements_in(kernel, dtype, LONGEST_CALL)))
    measurement = measure(kernel, Inputs(length, dtype), seconds)
    assert measurement is not None  # short arrays are never too slow
    return measurement


def record(seconds: float, path: Path = THRESHOLDS) -> Iterator[str]:
    """Measure and write the thresholds of the instruction set in use, naming each kernel."""
    thresholds = read(path)
    mine = thresholds[instruction_set()] = {}
    for dtype in DTYPES:
        for kernel in GATED:
            m = _measured(kernel, dtype, seconds)
            ours = m.speeds["ours"]
            mine[f"{kernel.name} {dtype}"] = {
                name: float(f"{ours / speed * (COPY_MARGIN if name == 'copy' else MARGIN):.3g}")
                for name, speed in m.speeds.items()
                if name not in ("ours", "own exp")
            }
            yield kernel.name
    write_whole(path, _document(thresholds))


def _document(thresholds: Thresholds) -> str:
    lines = [HEAD]
    for isa in sorted(thresholds):
        lines.append(f"[{isa}]")
        for name, least in thresholds[isa].items():
            inside = ", ".join(f'"{contender}" = {value:g}' for contender, value in least.items())
            lines.append(f'"{name}" = {{ {inside} }}')
        lines.append("")
    return "\n".join(lines)
