"""Grids of numbers as options of commands."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click
import numpy as np

__all__ = ["GRID"]

# What has even steps in a grid, and its inverse.
_STEPS: dict[str, tuple[Callable[[Any], Any], Callable[[Any], Any]]] = {
    "linear": (lambda x: x, lambda x: x),
    "log": (np.log, np.exp),
    "reciprocal": (lambda x: 1 / x, lambda x: 1 / x),
}


class _Grid(click.ParamType[Any]):
    """Numbers: 0.1,0.2,0.5, or START:STOP:COUNT for even steps, with :log at the end those of logarithms."""

    name = "grid"

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """As a list."""
        try:
            if ":" not in value:
                return [float(part) for part in value.split(",")]
            start, stop, count, *steps = value.split(":")
            if not 1 <= int(count) <= 10**6 or len(steps) > 1:
                raise ValueError
            forward, inverse = _STEPS[steps[0] if steps else "linear"]
            ends = np.array([float(start), float(stop)])
            if steps and not np.all(ends > 0):
                raise ValueError
            first, last = forward(ends)
            return inverse(np.linspace(first, last, int(count)))
        except (ValueError, KeyError):
            self.fail(f"a grid is 0.1,0.2,0.5 or START:STOP:COUNT, got {value!r}", param, ctx)


GRID = _Grid()
