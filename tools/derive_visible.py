"""Derive where the inversion of visible slopes starts: include/microfacet/special/coefficients/visible.hpp.

    python tools/derive_visible.py > include/microfacet/special/coefficients/visible.hpp

Of K0 Lambert's W. Of Beckmann the polynomials of smith/visible/started.hpp in X/(1.5 + X),
X = abs(cot(theta)), and the root of the depth. A step of Halley's method makes an error of 1e-2 one of 1e-7:
weighted least squares in double precision, whose weights follow the errors (Lawson), are near enough to the
minimax. A slope may be off by a part of itself, or of the distance to its end, that grows as less probability
lies beyond: what counts is the probability after the step.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from remez import array
from scipy.special import erfcx
from surfaces import bivariate, bivariate_header

Array = NDArray[Any]
ROUNDS = 40
WIDTH, DEPTH = 1.5, 2.0  # of the variables X/(WIDTH + X) and root/(DEPTH + root)
DEEPEST, LEAST = 26.6, 1e-17  # the root of the largest depth in float64, and the least 1 - xi
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


def chebyshev(n: int) -> Array:
    """Points in (0, 1), dense at both ends."""
    return np.asarray((1 - np.cos(np.pi * (np.arange(n) + 0.5) / n)) / 2)


def grid(largest: float, deepest: float) -> tuple[Array, Array]:
    """X and the root of the depth."""
    s = chebyshev(22)
    x = np.unique(np.minimum(WIDTH * s / (1 - s), largest))[:, None]
    root = np.concatenate([deepest * chebyshev(26) ** 1.5, np.geomspace(1e-3, deepest, 26)])
    x, root = np.broadcast_arrays(x, np.unique(root)[None, :])
    return np.asarray(x), np.asarray(root)


def density(t: Array) -> Array:
    return np.asarray(np.exp(-t * t) / np.sqrt(np.pi))


def tail(t: Array) -> Array:
    """slope_sf/P2."""
    return np.asarray(np.sqrt(np.pi) / 2 * erfcx(t))


def excess(t: Array) -> Array:
    """mean_excess/P2: a difference, or a series where it would cancel."""
    y = 0.25 / np.maximum(t * t, 1.0)
    return np.asarray(
        np.where(t < 30, 0.5 - t * tail(t), y * (1 - y * (6 - y * (60 - y * (840 - y * 15120)))))
    )


def solved(depth: Callable[[Array], Array], wanted: Array, low: float, high: float) -> Array:
    """Where a depth that rises with log v is what is wanted."""
    below, above = np.full(wanted.shape, low), np.full(wanted.shape, high)
    for _ in range(100):
        middle = (below + above) / 2
        less = depth(middle) < wanted
        below, above = np.where(less, middle, below), np.where(less, above, middle)
    return np.asarray((below + above) / 2)


def fit(shape: tuple[int, int], x: Array, depth: Array, values: Array, weights: Array) -> tuple[float, Array]:
    """Coefficients (powers of depth, powers of x) by the positive weights, and the largest weighted error."""
    used = weights > 0
    x, depth, values, weights = x[used], depth[used], values[used], weights[used]
    powers = (depth[:, None] ** np.arange(shape[0]))[:, :, None]
    rows = (powers * (x[:, None] ** np.arange(shape[1]))[:, None, :]).reshape(values.size, -1)
    lawson, best = weights.copy(), (np.inf, np.zeros(rows.shape[1]))
    for _ in range(ROUNDS):
        c = np.linalg.lstsq(rows * lawson[:, None], values * lawson, rcond=None)[0]
        errors = np.abs(rows @ c - values) * weights
        if errors.max() < best[0]:
            best = float(errors.max()), c
        lawson = lawson * (errors / errors.max() + 1e-3) ** 0.3
        lawson /= lawson.max()
    return best[0], best[1].reshape(shape)


def upper() -> tuple[float, Array]:
    """P over what it is where the logarithm of the probability is a parabola."""
    x, root = grid(1e4, DEEPEST)
    part = x * tail(np.zeros(1)) + 0.5
    t = np.exp(solved(lambda y: np.exp(2 * y) - np.log((x * tail(np.exp(y)) + 0.5) / part), root**2, -28, 7))
    b = x / part
    start = 2 * root**2 / (b + np.sqrt(b * b + (2 * b * b + 2 / part) * root**2))
    return fit((4, 5), x / (WIDTH + x), root / (DEPTH + root), t / start, start / t)


def below() -> tuple[float, Array]:
    """What (P - X)(P + X) has beyond the depth, over its root."""
    x, root = grid(1e4, DEEPEST)

    def depth(y: Array) -> Array:
        v = np.exp(y)
        return np.asarray(v * (2 * x + v) - np.log((v * tail(x + v) + excess(x + v)) / excess(x)))

    v = np.exp(solved(depth, root**2, -28, 7))
    values, weights = (v * (2 * x + v) - root**2) / root, root / (2 * x * v + 2 * v * v)
    return fit((4, 5), x / (WIDTH + x), root / (DEPTH + root), values, weights)


def lower() -> tuple[float, Array]:
    """-log((X + P)/X) (WIDTH + X)/depth."""
    x, root = grid(1e3, 6.2)

    def part(t: Array) -> Array:
        half = np.minimum(x - t, 10.0) / 2
        y = t[..., None] + half[..., None] * (1 + NODES)
        return np.asarray((half[..., None] * WEIGHTS * (x[..., None] - y) * density(y)).sum(-1))

    whole = part(np.zeros_like(x))
    odds = solved(lambda y: -np.log(np.maximum(part(x / (1 + np.exp(y))), 1e-300) / whole), root**2, 40, -40)
    t, rest = x / (1 + np.exp(odds)), x / (1 + np.exp(-odds))
    beyond = np.exp(-(root**2)) * whole / (x + excess(x) * density(x))
    short = np.minimum(t + 0.05, 0.7)
    tolerance = np.minimum(
        np.minimum(rest, short) / np.cbrt(beyond + LEAST), np.where(rest > 0.3 * t, 4 * short, 9.0)
    )
    values = -np.log(rest / x) / root**2 * (WIDTH + x)
    weights = np.where(beyond > LEAST, rest * root**2 / (WIDTH + x) / tolerance, 0.0)
    return fit((5, 6), x / (WIDTH + x), root, values, weights)


def k0(largest: float, degree: int) -> tuple[float, list[float], list[float]]:
    """g/s with (1 + g) exp(-g) = exp(-s^2/2) as a quotient whose numerator has one degree more."""
    s = largest * chebyshev(160) + 1e-6
    ratio = solved(lambda g: g - np.log1p(g), s * s / 2, 0, 800) / s
    small = s < 1e-2  # where that cancels
    ratio[small] = (1 + s * (1 / 3 + s * (1 / 36 - s / 270)))[small]
    weight, denominator, best = np.ones_like(s), np.ones_like(s), (np.inf, np.zeros(0), np.zeros(0))
    unit = s / largest
    for _ in range(ROUNDS):
        scale = weight / (denominator * ratio)
        above, below = unit[:, None] ** np.arange(degree + 2), unit[:, None] ** np.arange(1, degree + 1)
        rows = np.hstack([above * scale[:, None], -below * (ratio * scale)[:, None]])
        c = np.linalg.lstsq(rows, ratio * scale, rcond=None)[0]
        denominator = 1 + below @ c[degree + 2 :]
        errors = np.abs(above @ c[: degree + 2] / denominator / ratio - 1)
        if errors.max() < best[0]:
            powers = largest ** -np.arange(degree + 2.0)
            best = (
                errors.max(),
                c[: degree + 2] * powers,
                np.append(1.0, c[degree + 2 :] * powers[1 : degree + 1]),
            )
        weight = weight * (errors / errors.max() + 1e-3) ** 0.3
    return float(best[0]), list(best[1]), list(best[2])


def text() -> str:
    """The header."""
    parts = []
    for bits, kind, largest, degree in ((32, np.float32, 13.4, 3), (64, np.float64, 37.8, 4)):
        error, numerator, denominator = k0(largest, degree)
        comment = f"g/s with (1 + g) exp(-g) = exp(-s^2/2), s <= {largest}: relative error {error:.1e}"
        numerator, denominator = ([float(f"{v:.10g}") for v in values] for values in (numerator, denominator))
        parts.append(array(f"k0_excess_numerator_{bits}", comment, numerator, kind))
        parts.append(array(f"k0_excess_denominator_{bits}", "", denominator, kind))
    for made in (upper, below, lower):
        error, c = made()
        comment = f"{(made.__doc__ or '').rstrip('.')}: error {error:.1e}"
        values = [float(f"{v:.6g}") for v in c.ravel()]  # no more digits than any library agrees on
        parts.append(
            bivariate(f"visible_{made.__name__}", comment, (c.shape[1],) * len(c), values, np.float32)
        )
    return bivariate_header("derive_visible.py", parts).replace(" in 60 digits", "")


if __name__ == "__main__":
    print(text(), end="")
