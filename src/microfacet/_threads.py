"""Parts of a large computation, on as many threads as the process may use.

The kernels and NumPy's loops release the interpreter's lock. Threads are started for each call and end with
it, so that a process which forks inherits none.
"""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import TypeVar

__all__ = ["WORTH_THREADS", "blocks", "in_threads", "processors", "threads"]

# Evaluations of a closed form, some milliseconds, of which starting threads takes a tenth.
WORTH_THREADS = 1 << 19
_PARTS = 4  # for each thread, so that all end at about the same time
Part = TypeVar("Part")
Result = TypeVar("Result")


_CONTROL_GROUP = Path("/sys/fs/cgroup")


def processors() -> int:
    """How many processors this process may use: those it may run on, and what its container's quota allows.

    A quota of one and a half processors counts as two.
    """
    count = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(1, math.ceil(min(count, _quota())))


def _quota() -> float:
    """Processors that the control group grants (version 2 of Linux' control groups, or 1); inf without."""
    for names in (("cpu.max",), ("cpu/cpu.cfs_quota_us", "cpu/cpu.cfs_period_us")):
        try:
            quota, period = " ".join((_CONTROL_GROUP / name).read_text() for name in names).split()
            if float(quota) > 0 and float(period) > 0:
                return float(quota) / float(period)
        except (OSError, ValueError):  # there is none, or it says "max"
            continue
    return math.inf


def threads() -> int:
    """How many threads to use: `MICROFACET_THREADS`, by default the processors that this process may run on.

    One where the caller is not the main thread: whoever works on several threads is using the processors.
    """
    if threading.current_thread() is not threading.main_thread():
        return 1
    wanted = os.environ.get("MICROFACET_THREADS")
    if wanted is None:
        return processors()
    if not (wanted.isascii() and wanted.isdigit() and int(wanted) >= 1):
        raise ValueError(f"MICROFACET_THREADS must be a whole number in [1, inf), got {wanted!r}")
    return int(wanted)


def blocks(count: int) -> list[slice]:
    """Slices that make up range(count), several for every thread."""
    size = -(-count // (_PARTS * threads()))
    return [slice(first, first + size) for first in range(0, count, size)]


def in_threads(function: Callable[[Part], Result], parts: Sequence[Part]) -> list[Result]:
    """`function` of every part, in the order of the parts; the first exception ends the rest."""
    count = min(threads(), len(parts)) if len(parts) > 1 else 1
    if count == 1:
        return [function(part) for part in parts]
    results: dict[int, Result] = {}
    left: SimpleQueue[int] = SimpleQueue()
    for i in range(len(parts)):
        left.put(i)
    ended = threading.Event()

    # One task a thread: an interrupt that comes while tasks are handed to the pool can leave its lock behind.
    def work() -> None:
        try:
            while not ended.is_set():
                try:
                    i = left.get_nowait()
                except Empty:
                    return
                results[i] = function(parts[i])
        except BaseException:
            ended.set()
            raise

    pool = ThreadPoolExecutor(count)
    try:
        futures = [pool.submit(copy_context().run, work) for _ in range(count)]
        for future in futures:
            future.result()
        return [results[i] for i in range(len(parts))]
    finally:
        ended.set()
        pool.shutdown()
