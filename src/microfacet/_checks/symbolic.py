"""Proofs by computer algebra, beside the numbers. SymPy is optional: without it they say "not run"."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from typing import Any

from microfacet._optional import installed

__all__ = ["BECKMANN", "CONFIRMED", "GGX", "HENYEY_GREENSTEIN", "NOT_RUN", "REFUTED", "STUDENT_T", "Algebra"]

CONFIRMED, REFUTED, NOT_RUN = "confirmed", "refuted", "not run"


@dataclass(frozen=True)
class Algebra:
    """A proof of a statement, for the values `at` of some parameters and for every value of the others.

    ``differences(sympy)`` are expressions in symbols, each the difference of two sides.
    """

    differences: Callable[[Any], tuple[Any, ...]]
    at: Mapping[str, float] = field(default_factory=dict)

    def verdict(self, parameters: Mapping[str, float]) -> str:
        """What the algebra says at `parameters`: `CONFIRMED`, `REFUTED`, or `NOT_RUN`."""
        if any(parameters[name] != value for name, value in self.at.items()) or not installed("sympy"):
            return NOT_RUN
        return CONFIRMED if _vanish(self.differences) else REFUTED


@cache
def _vanish(differences: Callable[[Any], tuple[Any, ...]]) -> bool:
    sp = import_module("sympy")
    return all(sp.simplify(difference) == 0 for difference in differences(sp))


def _both_identities(sigma: Any, Lambda: Any, u: Any) -> tuple[Any, ...]:
    return (1 + Lambda(u)) * u - sigma(u), Lambda(u) * u - sigma(-u)


def _symbols(sp: Any) -> tuple[Any, Any, Any]:
    """cos(theta), sin(theta) and alpha; no proof needs that the squares of the first two add up to 1."""
    u, s, alpha = sp.symbols("u s alpha", positive=True)
    return u, s, alpha


def _beckmann(sp: Any) -> tuple[Any, ...]:
    u, s, alpha = _symbols(sp)

    def gauss(x: Any) -> Any:
        return sp.exp(-(x**2)) / sp.sqrt(sp.pi)

    def sigma(u: Any) -> Any:
        x = u / (alpha * s)
        return (u * (1 + sp.erf(x)) + alpha * s * gauss(x)) / 2

    def Lambda(u: Any) -> Any:
        x = u / (alpha * s)
        return (sp.erf(x) - 1 + gauss(x) / x) / 2

    return _both_identities(sigma, Lambda, u)


def _ggx(sp: Any) -> tuple[Any, ...]:
    u, _, alpha = _symbols(sp)
    root = sp.sqrt(alpha**2 - alpha**2 * u**2 + u**2)
    return _both_identities(lambda u: (root + u) / 2, lambda u: (root / u - 1) / 2, u)


def _student_t(sp: Any) -> tuple[Any, ...]:
    """At gamma = 3, where every function is algebraic."""
    u, s, alpha = _symbols(sp)
    gamma, half = sp.Integer(3), sp.Rational(1, 2)
    k = gamma - 1

    def hyp2f1(a: Any, b: Any, c: Any, z: Any) -> Any:
        t = sp.Symbol("t")
        return sp.hyperexpand(sp.hyper((a, b), (c,), t)).subs(t, z)

    def sigma(u: Any) -> Any:
        scale = alpha * s * sp.sqrt(k)
        z = (u / scale) ** 2
        mean = scale * sp.gamma(k - half) / (2 * sp.sqrt(sp.pi) * sp.gamma(k)) * (1 + z) ** (half - k)
        norm = sp.gamma(k + half) / (sp.sqrt(sp.pi) * scale * sp.gamma(k))
        return u / 2 + mean + u**2 * norm * hyp2f1(half, k + half, 3 * half, -z)

    def Lambda(u: Any) -> Any:
        v = s**2 * k
        z = -v * alpha**2 / u**2
        beta = z**k / k * hyp2f1(k, k + half, k + 1, z)  # incomplete Beta function of z; k and 1/2 - k
        power = 2 * alpha ** (2 * k) * (u**2 + v * alpha**2) ** (half - k) * v**k
        brackets = power + (-1) ** (-gamma) * u * (2 * gamma - 3) * beta
        return sp.gamma(k - half) / (4 * sp.sqrt(sp.pi) * u * sp.gamma(k)) * brackets

    return _both_identities(sigma, Lambda, u)


def _henyey_greenstein(sp: Any) -> tuple[Any, ...]:
    """The ratio of two positive functions, squared."""
    u, _, alpha = _symbols(sp)
    g, c = (1 - alpha) / (1 + alpha), 2 * u**2 - 1
    phase = (1 - g**2) / (4 * sp.pi * sp.sqrt(1 + g**2 - 2 * g * c) ** 3)
    density = alpha * (1 + alpha) / (2 * sp.pi * sp.sqrt(1 + u**2 * (alpha**2 - 1)) ** 3)
    return ((4 * phase / density) ** 2 - 1,)


BECKMANN, GGX, HENYEY_GREENSTEIN = Algebra(_beckmann), Algebra(_ggx), Algebra(_henyey_greenstein)
STUDENT_T = Algebra(_student_t, {"gamma": 3.0})
