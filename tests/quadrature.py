"""Arbitrary-precision quadrature of positive analytic integrands, with a measured error."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import count

from flint import arb, ctx

TOLERANCE = 1e-22

Integrand = Callable[[arb], arb]


class NotConverged(ArithmeticError):
    """The digits asked for were not reached."""


@cache
def _node(precision: int, spread: int, level: int, j: int) -> tuple[arb, arb]:
    """exp(L sinh(x/L)) and its logarithmic derivative cosh(x/L) at x = j h, h = 2^-level / 2, L = spread."""
    x = arb(j) / (spread * 2 ** (level + 1))
    sinh, cosh = x.sinh_cosh()
    return (spread * sinh).exp(), cosh


def half_line(f: Integrand, scales: Sequence[arb], tolerance: float = TOLERANCE) -> arb:
    """int_0^inf f(q) dq of a positive f whose features lie at about the given scales.

    The trapezoidal rule in the variable x of q = scale exp(L sinh(x/L)), its step halved until two successive
    sums agree to the tolerance. Singularities of f away from q > 0 make it converge exponentially; the sinh
    reaches far algebraic tails.
    """
    logs = [float(s.log()) for s in scales]
    low, high = min(logs), max(logs)
    grid = [low + (high - low) * i / 8 for i in range(9)] if high > low + 1 else [low]
    scale = max((arb(x).exp().mid() for x in grid), key=lambda q: (q * f(q)).mid())
    spread = 4 if high - low < 12 else max(8, int((high - low) / 4))

    def term(level: int, j: int) -> arb:
        exponential, weight = _node(ctx.prec, spread, level, j)
        q = scale * exponential
        return f(q) * q * weight

    negligible = arb(tolerance) * 1e-10
    total, bounds = term(0, 0), [0, 0]
    for side, sign in enumerate((-1, 1)):
        small = 0
        for j in count(1):
            addend = term(0, sign * j)
            total += addend
            small = small + 1 if addend < negligible * total else 0
            bounds[side] = j
            if small >= 2:
                break
            if j > 4000:
                raise NotConverged("the integrand does not decay")
    previous = total / 2
    for level in range(1, 9):
        left, right = bounds[0] << level, bounds[1] << level
        for j in range(1 - left, right, 2):
            total += term(level, j)
        current = total / 2 ** (level + 1)
        if abs(current - previous) < tolerance * current:
            return current
        previous = current
    raise NotConverged("the quadrature did not converge")


@cache
def _gauss_legendre(precision: int, n: int = 12) -> list[tuple[arb, arb]]:
    return [arb.legendre_p_root(n, k, weight=True) for k in range(n)]


def between(density: Integrand, a: arb, b: arb) -> arb:
    """int density d(log r) from a to b, less than one part in 100 away."""
    half = (b / a).log() / 2
    return half * sum((w * density(a * (half * (1 + x)).exp()) for x, w in _gauss_legendre(ctx.prec)), arb(0))
