"""Slopes at which a density has to be known, so that a polynomial between them gives it back."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet._densities.curve import Curve

__all__ = ["sampled"]

Array = NDArray[np.float64]
Density = Callable[[Array], Array]  # of log r

_SMOOTH, _CLOSE = 1e-11, 1e-9  # relative errors of what is smooth, and of what is so piece by piece
_MOST_SMOOTH, _MOST = 2000, 20_000  # nodes


def sampled(density: Density) -> dict[str, Any]:
    """Slopes and values (and powers) as a document has them."""
    x, begin, end = _places(density)
    if begin is None and end is None:
        found = _smooth(density, x)
        if found is not None:
            return {"r": np.exp(found).tolist(), "values": density(found).tolist(), "interpolation": "spline"}
    x = _refined(density, x)
    r, values, powers = np.exp(x), density(x), _powers(density, x)
    for edge, side in ((begin, 0), (end, len(x))):
        if edge is not None:
            at = min(side, len(r)) if side else 0
            r, values = np.insert(r, at, math.exp(edge)), np.insert(values, at, 0.0)
            powers = np.insert(powers, at, 0.0)
    return {"r": r.tolist(), "values": values.tolist(), "powers": powers.tolist()}


def _places(density: Density) -> tuple[Array, float | None, float | None]:
    """log r to start from, and where the density begins and ends if it does."""
    x = np.arange(-690.0, 85.5, 0.5)
    values = density(x)
    usable = (values > 1e-290) & (values < 1e290)
    mass = np.where(usable, np.log(np.where(usable, values, 1.0)) + 2.0 * x, -np.inf)
    first = last = int(np.argmax(mass))
    while first > 0 and usable[first - 1]:
        first -= 1
    while last + 1 < len(x) and usable[last + 1]:
        last += 1
    kept, ends = x[first : last + 1], list[float | None]()
    for edge, beyond in ((first, first - 1), (last, last + 1)):
        if not 0 <= beyond < len(x):
            ends.append(None)
            continue
        at = _edge(density, x[edge], x[beyond])
        inner = at + (x[edge] - at) * 1e-6
        kept = np.unique(np.append(kept, inner))
        # Where it underflows it is nearly nothing, and does not end.
        ends.append(at if 1e-250 < density(np.array([inner]))[0] < 1e250 else None)
    begin, end = ends
    return _without_straight_ends(density, kept), begin, end


def _edge(density: Density, inside: float, outside: float) -> float:
    """Where the density ends, or becomes too small or large, between two places."""
    for _ in range(60):
        middle = 0.5 * (inside + outside)
        if 1e-290 < density(np.array([middle]))[0] < 1e290:
            inside = middle
        else:
            outside = middle
    return outside


def _without_straight_ends(density: Density, x: Array) -> Array:
    """The places without those at both ends that the power law of the others gives."""
    logs = np.log(density(x))
    slopes = np.diff(logs) / np.diff(x)
    bent = np.flatnonzero(np.abs(np.diff(slopes)) > 1e-12 * (1.0 + np.abs(slopes[:-1])))
    if not len(bent):
        return x[:: max(1, (len(x) - 1) // 16)]
    return x[max(int(bent[0]) - 8, 0) : int(bent[-1]) + 11]


def _smooth(density: Density, x: Array) -> Array | None:
    """Places through which a spline of high degree is exact between them, if there are such."""
    while 8 <= len(x) <= _MOST_SMOOTH:
        curve = Curve("P22", np.exp(x), density(x), interpolation="spline")
        between = np.concatenate([x[:-1] + t * np.diff(x) for t in (0.3, 0.7)])
        exact = density(between)
        wrong = np.abs(curve(np.exp(between)) / exact - 1.0) > _SMOOTH * (1.0 + 0.01 * np.abs(np.log(exact)))
        here = wrong.reshape(2, -1).any(axis=0)
        if not here.any():
            return x
        here = here | np.append(here[1:], False) | np.append(False, here[:-1])
        x = np.sort(np.concatenate((x, (0.5 * (x[:-1] + x[1:]))[here])))
    return None


def _powers(density: Density, x: Array) -> Array:
    """d log(density)/d log(r), of fourth order; one-sided next to an end."""
    h = 1e-4
    with np.errstate(all="ignore"):
        near, far = (np.log(density(x + k * h)) - np.log(density(x - k * h)) for k in (1, 2))
        central = (8.0 * near - far) / (12.0 * h)
        below = (np.log(density(x)) - np.log(density(x - 1e-7))) / 1e-7
        above = (np.log(density(x + 1e-7)) - np.log(density(x))) / 1e-7
    found = np.where(np.isfinite(central), central, np.where(np.isfinite(below), below, above))
    return np.where(np.isfinite(found), found, 0.0)


def _refined(density: Density, x: Array) -> Array:
    """Places halved until a cubic meets the density between them."""
    settled: list[Array] = []
    low, high = x[:-1], x[1:]
    for _ in range(40):
        y0, y1 = np.log(density(low)), np.log(density(high))
        k0, k1 = _powers(density, low), _powers(density, high)
        width = high - low
        wrong = np.zeros(len(low), dtype=bool)
        for t in (0.25, 0.5, 0.8):
            cubic = (
                (1 + 2 * t) * (1 - t) ** 2 * y0 + t * (1 - t) ** 2 * width * k0
                + t * t * (3 - 2 * t) * y1 - t * t * (1 - t) * width * k1
            )  # fmt: skip
            with np.errstate(divide="ignore"):
                exact = np.log(density(low + t * width))
            wrong |= ~(np.abs(cubic - exact) < _CLOSE * (1.0 + 0.01 * np.abs(exact)))
        settled.append(low[~wrong])
        if not wrong.any() or sum(map(len, settled)) + 2 * int(wrong.sum()) > _MOST:
            settled.append(low[wrong])
            break
        middle = 0.5 * (low[wrong] + high[wrong])
        low, high = np.concatenate((low[wrong], middle)), np.concatenate((middle, high[wrong]))
    else:
        settled.append(low)
    return np.unique(np.append(np.concatenate(settled), x[-1]))
