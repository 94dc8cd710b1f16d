"""Rendering in passes that are added up, so that a caller sees progress and can stop."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["counts", "render"]

LARGEST = 1 << 21  # samples of a pass: a second or two, and some hundred megabytes


def counts(spp: int, pixels: int) -> Iterator[int]:
    """How many samples per pixel the passes take, `spp` together: numbers that Mitsuba's sampler stratifies.

    It divides a pixel in x times y cells with x the root of their number, rounded down.
    """
    while spp > 0:
        count = max(1, min(spp, LARGEST // pixels))
        while count % math.isqrt(count):
            count -= 1
        yield count
        spp -= count


def render(
    scene: Any, size: tuple[int, int], spp: int, seed: int, progress: Callable[[int, int], None]
) -> npt.NDArray[np.float64]:
    """The mean of `spp` samples per pixel, (height, width, channels); the same for the same seed.

    Where Dr.Jit traces, to the last bit but one: its threads add their shares of a pixel in any order.
    """
    import mitsuba as mi

    passes = list(counts(spp, size[0] * size[1]))
    seeds = np.random.SeedSequence(seed).generate_state(len(passes))
    total: Any = 0.0
    done = 0
    for count, own in zip(passes, seeds, strict=True):
        progress(done, spp)
        total = total + count * np.array(mi.render(scene, spp=count, seed=int(own)), dtype=np.float64)
        done += count
    progress(done, spp)
    return np.asarray(total / spp)
