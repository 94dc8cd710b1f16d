"""Confirmation by computer algebra, beside the numbers. SymPy is optional: without it the answer is None."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import Any

__all__ = ["student_t_projected_area"]


@cache
def student_t_projected_area() -> bool | None:
    """Both identities between the notebook's sigma and Lambda of Student-T, exactly, at its own point.

    gamma = 3, u = 1/2, alpha = 1/3. There all terms are algebraic numbers.
    """
    try:
        sp: Any = import_module("sympy")
    except ImportError:
        return None
    gamma, alpha, cos = sp.Integer(3), sp.Rational(1, 3), sp.Rational(1, 2)
    half, k = sp.Rational(1, 2), gamma - 1

    def hyp2f1(a: Any, b: Any, c: Any, z: Any) -> Any:
        t = sp.Symbol("t")
        return sp.hyperexpand(sp.hyper((a, b), (c,), t)).subs(t, z)

    def sigma(u: Any) -> Any:
        scale = alpha * sp.sqrt((1 - u**2) * k)
        z = (u / scale) ** 2
        mean = scale * sp.gamma(k - half) / (2 * sp.sqrt(sp.pi) * sp.gamma(k)) * (1 + z) ** (half - k)
        norm = sp.gamma(k + half) / (sp.sqrt(sp.pi) * scale * sp.gamma(k))
        return u / 2 + mean + u**2 * norm * hyp2f1(half, k + half, 3 * half, -z)

    v = (1 - cos**2) * k
    z = -v * alpha**2 / cos**2
    beta = z**k / k * hyp2f1(k, k + half, k + 1, z)  # incomplete Beta function of z; k and 1/2 - k
    power = 2 * alpha ** (2 * k) * (cos**2 + v * alpha**2) ** (half - k) * v**k
    brackets = power + (-1) ** (-gamma) * cos * (2 * gamma - 3) * beta
    Lambda = sp.gamma(k - half) / (4 * sp.sqrt(sp.pi) * cos * sp.gamma(k)) * brackets
    return bool(
        sp.simplify((1 + Lambda) * cos - sigma(cos)) == 0 and sp.simplify(Lambda * cos - sigma(-cos)) == 0
    )
