"""Interleaved measurement: every contender runs once in every round, so that all see the same machine.

A machine's speed drifts while one measures (other processes, clock rate). Ratios are therefore formed within
a round, and their median and quartiles are reported; the absolute speed is that of the best round.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Times = NDArray[np.float64]

SHORTEST = 1e-4  # seconds; a sample repeats its call until it lasts about this long
ROUNDS = (5, 101)


@dataclass(frozen=True)
class Contender:
    """One thing to be timed: `call` makes `evaluations` evaluations."""

    name: str
    call: Callable[[], object]
    evaluations: int
    before: Callable[[], object] | None = None  # untimed, ahead of each sample


@dataclass(frozen=True)
class Spread:
    """A median with its quartiles."""

    median: float
    lower: float
    upper: float

    @classmethod
    def of(cls, values: Times) -> Spread:
        """Summarise `values`."""
        lower, median, upper = np.quantile(values, (0.25, 0.5, 0.75))
        return cls(float(median), float(lower), float(upper))


def interleave(contenders: Sequence[Contender], seconds: float, *, warm: bool = True) -> dict[str, Times]:
    """Time the contenders round by round for about `seconds` in all.

    Parameters
    ----------
    contenders : sequence of Contender
    seconds : float
        Budget, untimed calls included; at least ROUNDS[0] rounds are made whatever they cost.
    warm : bool
        Precede each sample by an untimed call, so that each contender finds the caches as it leaves them.

    Returns
    -------
    dict
        Seconds per evaluation by name, one value per round; the rounds are in the same order for all.
    """
    single = {c.name: _sample(c, 1, warm=warm) * c.evaluations for c in contenders}
    repeats = {name: max(1, min(10_000, round(SHORTEST / t))) for name, t in single.items()}
    a_round = sum(t * (repeats[name] + warm) for name, t in single.items())
    rounds = int(np.clip(seconds / a_round, *ROUNDS))
    times: dict[str, Times] = {c.name: np.empty(rounds) for c in contenders}
    order = np.random.default_rng(1)
    collecting = gc.isenabled()
    gc.disable()
    try:
        for k in range(rounds):
            for i in order.permutation(len(contenders)):
                contender = contenders[i]
                times[contender.name][k] = _sample(contender, repeats[contender.name], warm=warm)
    finally:
        if collecting:
            gc.enable()
    return times


def _sample(contender: Contender, repeats: int, *, warm: bool) -> float:
    if contender.before:
        contender.before()
    call = contender.call
    if warm:
        call()
    begin = time.perf_counter()
    for _ in range(repeats):
        call()
    return (time.perf_counter() - begin) / (repeats * contender.evaluations)


def speed(times: Times) -> float:
    """Evaluations per second of the best round."""
    return float(1.0 / times.min())


def ratio(ours: Times, theirs: Times) -> Spread:
    """How many times as fast `ours` is as `theirs`, round by round."""
    return Spread.of(theirs / ours)


def ratios(times: Mapping[str, Times], ours: str = "ours") -> dict[str, Spread]:
    """`ratio` of `ours` to every other contender."""
    return {name: ratio(times[ours], other) for name, other in times.items() if name != ours}
