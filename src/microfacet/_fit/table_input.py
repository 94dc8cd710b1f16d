"""Tables that a user gives, checked; every `ValueError` is one sentence."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["checked_density", "checked_histogram"]

Vector = NDArray[np.float64]


def checked_histogram(edges: ArrayLike, counts: ArrayLike) -> tuple[Vector, Vector]:
    """Edges and counts."""
    borders, numbers = _real(edges, "edges"), _real(counts, "counts")
    if borders.ndim != 1 or numbers.shape != (borders.size - 1,) or numbers.size < 3:
        raise ValueError(
            f"histogram: n >= 3 counts and n + 1 edges are needed, got {numbers.shape}, {borders.shape}"
        )
    if not np.all(np.diff(borders) > 0) or not np.all(np.isfinite(borders[1:-1])):
        raise ValueError("histogram: edges must ascend, and only the outer ones may be infinite")
    if not (np.all((numbers >= 0) & np.isfinite(numbers)) and np.count_nonzero(numbers) >= 3):
        raise ValueError("histogram: counts must be finite and not negative, and three bins not empty")
    return borders, numbers


def checked_density(theta: ArrayLike, values: ArrayLike) -> tuple[Vector, Vector]:
    """Angles and D."""
    angles, numbers = _real(theta, "theta"), _real(values, "D")
    if angles.ndim != 1 or angles.shape != numbers.shape or angles.size < 4:
        raise ValueError(
            f"density: at least 4 angles and as many values are needed, got {angles.shape}, {numbers.shape}"
        )
    if not np.all((angles >= 0) & (angles < math.pi / 2)):
        raise ValueError("density: theta must lie in [0, pi/2), in radians")
    if not np.all((numbers > 0) & np.isfinite(numbers)):
        raise ValueError("density: D must be positive and finite")
    return angles, numbers


def _real(values: ArrayLike, name: str) -> Vector:
    array = np.asarray(values)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{name} must be real numbers, got {array.dtype}")
    return array.astype(np.float64)
