"""GTR as its notebook prints it: functions of mpmath arguments, each (point, alpha, gamma).

The general forms divide 0 by 0 at gamma = 1, at half-integer and integer gamma and at alpha = 1. There they
stand for their limits, read off 1e-20 beside the point. Unlike those of the other notebooks, the printed
densities have no step at the horizon, below which the library's are 0.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmath import mp


def as_limit(form: Callable[..., Any]) -> Callable[..., Any]:
    """`form(point, alpha, gamma)`, moved aside where it is 0/0 (see the module)."""

    def moved(point: Any, alpha: Any, gamma: Any) -> Any:
        aside = mp.mpf(10) ** -20
        return form(
            point,
            alpha + aside if alpha == 1 else alpha,
            gamma + aside if mp.isint(2 * gamma) else gamma,
        )

    return moved


def D(u: Any, alpha: Any, gamma: Any) -> Any:
    norm = alpha ** (2 * gamma) * (alpha**2 - 1) * (gamma - 1) / (mp.pi * (alpha ** (2 * gamma) - alpha**2))
    return norm * (1 + u**2 * (alpha**2 - 1)) ** -gamma


def D_1(u: Any, alpha: Any, gamma: Any) -> Any:
    return (alpha**2 - 1) / (2 * mp.pi * (1 + u**2 * (alpha**2 - 1)) * mp.log(alpha))


def D_3_2(u: Any, alpha: Any, gamma: Any) -> Any:
    return alpha * (1 + alpha) / (2 * mp.pi * mp.sqrt(1 + u**2 * (alpha**2 - 1)) ** 3)


def P22(r2: Any, alpha: Any, gamma: Any) -> Any:
    norm = alpha ** (2 * gamma) * (alpha**2 - 1) * (gamma - 1) / (mp.pi * (alpha ** (2 * gamma) - alpha**2))
    return norm * (1 + r2) ** (gamma - 2) * (r2 + alpha**2) ** -gamma


def P22_1(r2: Any, alpha: Any, gamma: Any) -> Any:
    return (alpha**2 - 1) / (2 * mp.pi * mp.log(alpha) * (1 + r2) * (r2 + alpha**2))


def P22_3_2(r2: Any, alpha: Any, gamma: Any) -> Any:
    return alpha * (1 + alpha) / (2 * mp.pi * mp.sqrt(1 + r2) * mp.sqrt(r2 + alpha**2) ** 3)


def P2(p: Any, alpha: Any, gamma: Any) -> Any:
    """The notebook's form: two hypergeometric functions beyond their branch point, of which the real part."""
    half, A, B, power = mp.mpf(1) / 2, p**2 + alpha**2, p**2 + 1, alpha ** (2 * gamma)
    z, c = B / A, alpha**2 - 1
    first = 2 * A * (gamma - 2) * mp.hyp2f1(-half, 2 - gamma, 5 * half - gamma, z)
    first -= c * (2 * gamma - 3) * mp.hyp2f1(half, 2 - gamma, 5 * half - gamma, z)
    first *= -mp.gamma(gamma - 3 * half) / (c * mp.sqrt(A) ** 3 * mp.gamma(gamma))
    second = 2 * B ** (gamma - 3 * half) * A**-gamma * mp.gamma(3 * half - gamma) * mp.rgamma(2 - gamma)
    second *= mp.hyp2f1(half, gamma, gamma - half, z)
    return power * c * (gamma - 1) / (2 * mp.sqrt(mp.pi) * (power - alpha**2)) * mp.re(first + second)


def P2_1(p: Any, alpha: Any, gamma: Any) -> Any:
    return (1 / mp.sqrt(1 + p**2) - 1 / mp.sqrt(p**2 + alpha**2)) / mp.log(alpha**2)


def P2_3_2(p: Any, alpha: Any, gamma: Any) -> Any:
    A = p**2 + alpha**2
    m = (alpha**2 - 1) / A
    return alpha * (mp.ellipk(m) - mp.ellipe(m)) / (mp.pi * (alpha - 1) * mp.sqrt(A))


def henyey_greenstein(cosine: Any, g: Any) -> Any:
    """The phase function of Henyey and Greenstein 1941."""
    return (1 - g**2) / (4 * mp.pi * mp.sqrt(1 + g**2 - 2 * g * cosine) ** 3)


def lambda_1(u: Any, alpha: Any, gamma: Any) -> Any:
    Q = mp.sqrt(1 + (1 / u**2 - 1) * alpha**2)
    return (-1 + u * Q + u * mp.log(1 + 1 / u) - u * mp.log(1 + Q)) / (2 * u * mp.log(alpha))


def sigma_1(u: Any, alpha: Any, gamma: Any) -> Any:
    s, R = mp.sqrt(1 - u**2), mp.sqrt(u**2 + alpha**2 - u**2 * alpha**2)
    logs = u * mp.asinh(u / s) + 2 * u * mp.log(alpha) - u * mp.log((u + R) / s)
    return (R - 1 + logs) / (2 * mp.log(alpha))


def survival(r: Any, alpha: Any, gamma: Any) -> Any:
    ratio = ((1 + r**2) / (alpha**2 + r**2)) ** (gamma - 1)
    return (ratio - 1) / (alpha ** (2 - 2 * gamma) - 1)
