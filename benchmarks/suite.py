"""Kernels beside a copy, exp, NumPy and SciPy: which contenders meet, and what is kept of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np

from microfacet import _core

from .expressions import EXPRESSIONS, Expression
from .kernels import Array, Inputs, Kernel, arguments, bind
from .timing import Contender, Spread, Times, interleave, ratios, speed

DTYPES = ("float32", "float64")
CACHE, MILLION, MEMORY = 1 << 14, 1 << 20, 1 << 26
SLICE = 1 << 15  # expressions run on at most so many elements: their temporaries stay in the cache
LONGEST_PEER = 1e-3  # seconds, for a call of an expression
SLOWEST_CALL = 1.0  # seconds; a kernel that takes longer is left out at that length


@dataclass(frozen=True)
class Measurement:
    """One kernel, precision and length: speeds in evaluations per second, ratios ours/theirs by contender."""

    kernel: str
    dtype: str
    length: int
    threads: int
    speeds: dict[str, float]
    ratios: dict[str, Spread]

    @classmethod
    def of(cls, kernel: str, inputs: Inputs, times: dict[str, Times], threads: int = 1) -> Measurement:
        """Summarise rounds; "ours" is one of the contenders."""
        speeds = {name: speed(t) for name, t in times.items()}
        return cls(kernel, inputs.dtype.name, inputs.length, threads, speeds, ratios(times))

    @classmethod
    def from_dict(cls, record: dict[str, Any]) -> Measurement:
        """The inverse of `as_dict`."""
        spreads = {name: Spread(**spread) for name, spread in record["ratios"].items()}
        return cls(**{**record, "ratios": spreads})

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


def yardsticks(inputs: Inputs) -> list[Contender]:
    """A copy, the library's exp and, for arrays that fit a cache, NumPy's."""
    out, u, n = inputs.out, inputs.u, inputs.length
    calls = {"copy": partial(np.copyto, out, u), "own exp": partial(_core.exp, u, out=out)}
    if n <= MILLION:
        calls["numpy.exp"] = partial(np.exp, u, out=out)
    return [Contender(name, call, n) for name, call in calls.items()]


def peers(kernel: Kernel, inputs: Inputs) -> list[Contender]:
    """The NumPy and SciPy expressions of the same quantity, on a slice."""
    if kernel.form not in ("u", "varying"):
        return []
    given = arguments(kernel, inputs)
    table = EXPRESSIONS.get((kernel.family, kernel.quantity), {})
    return [_peer(name, expression, given) for name, expression in table.items()]


def _peer(name: str, expression: Expression, given: tuple[Any, ...]) -> Contender:
    """On SLICE elements, or as many as a slow expression takes LONGEST_PEER for."""

    def on(length: int) -> Contender:
        cut = [a[:length] if isinstance(a, np.ndarray) else a for a in given]
        return Contender(name, partial(_quiet, expression, cut), len(cut[0]))

    affordable = int(LONGEST_PEER * speed(interleave([on(256)], 0.0)[name]))
    return on(min(SLICE, max(32, affordable)))


def elements_in(kernel: Kernel, dtype: str, seconds: float) -> int:
    """How many elements one call evaluates in `seconds`, judged by its speed on CACHE elements."""
    call = Contender("ours", bind(kernel, Inputs(CACHE, dtype)), CACHE)
    return int(seconds * speed(interleave([call], 0.0)["ours"]))


def _quiet(expression: Expression, given: list[Any]) -> Array:
    with np.errstate(all="ignore"):
        return expression(*given)


def measure(kernel: Kernel, inputs: Inputs, seconds: float, *, beside: bool = True) -> Measurement | None:
    """Time `kernel` among its contenders; None where one call would take too long.

    Parameters
    ----------
    kernel : Kernel
    inputs : Inputs
    seconds : float
        Budget.
    beside : bool
        Whether the NumPy and SciPy expressions take part.
    """
    if inputs.length > CACHE and inputs.length > elements_in(kernel, inputs.dtype.name, SLOWEST_CALL):
        return None
    contenders = [Contender("ours", bind(kernel, inputs), inputs.length), *yardsticks(inputs)]
    contenders += peers(kernel, inputs) if beside else []
    times = interleave(contenders, seconds, warm=inputs.length <= MILLION)
    return Measurement.of(kernel.name, inputs, times)


def plan(kernels: Iterable[Kernel], lengths: Iterable[int]) -> list[tuple[int, str, Kernel]]:
    """Length, precision and kernel of each measurement, in the order that reuses arrays.

    Beyond the cache only functions of a cosine are measured.
    """
    return [
        (length, dtype, kernel)
        for length in lengths
        for dtype in DTYPES
        for kernel in kernels
        if length <= MILLION or kernel.form == "u"
    ]


def run(jobs: Iterable[tuple[int, str, Kernel]], seconds: float) -> Iterator[tuple[str, Measurement | None]]:
    """Carry `plan` out, `seconds` for each kernel (five times that beyond the cache)."""
    inputs: Inputs | None = None
    for length, dtype, kernel in jobs:
        if inputs is None or (inputs.length, inputs.dtype.name) != (length, dtype):
            inputs = None  # frees the arrays before new ones are made
            inputs = Inputs(length, dtype)
        large = length > MILLION
        yield kernel.name, measure(kernel, inputs, seconds * (5 if large else 1), beside=not large)
