"""Several caller threads: a ufunc releases the interpreter's lock, so each works on a part of the arrays."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor, wait
from itertools import pairwise

from .kernels import Call


def parts(length: int, count: int) -> list[slice]:
    """`count` slices of nearly equal size that cover `length`."""
    ends = [length * k // count for k in range(count + 1)]
    return [slice(begin, end) for begin, end in pairwise(ends)]


def together(pool: Executor, calls: Sequence[Call]) -> Call:
    """One call that makes all `calls` at once and returns when the last is done."""

    def run() -> None:
        wait([pool.submit(call) for call in calls])

    return run
