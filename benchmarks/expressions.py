"""What one would write without this library: NumPy and SciPy expressions of the same quantities.

They are textbook forms, not the stable ones, and lose digits in the tails; that is part of the comparison.
Sources: the family pages in docs/family.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import special

Array = np.ndarray[Any, Any]
Expression = Callable[..., Array]


def _tan2(u: Array) -> Array:
    return 1 / (u * u) - 1


def _x(u: Array, alpha: Any) -> Array:
    return u / (alpha * np.sqrt(1 - u * u))


def _upper_and_lower(u: Array, Lambda: Array) -> Array:
    """sigma from Lambda(|u|)."""
    return np.maximum(u, 0) + abs(u) * Lambda


def beckmann_D(u: Array, alpha: Any) -> Array:
    """exp(-tan^2/alpha^2)/(pi alpha^2 u^4)."""
    u2 = u * u
    return np.exp(-_tan2(u) / alpha**2) / (np.pi * alpha**2 * (u2 * u2))


def beckmann_Lambda_erfcx(u: Array, alpha: Any) -> Array:
    """Keeps more of the tail than the form with erf."""
    x = _x(u, alpha)
    return np.exp(-x * x) * (1 / (np.sqrt(np.pi) * x) - special.erfcx(x)) / 2


def beckmann_Lambda_erf(u: Array, alpha: Any) -> Array:
    """The form most papers print."""
    x = _x(u, alpha)
    return (special.erf(x) - 1 + np.exp(-x * x) / (np.sqrt(np.pi) * x)) / 2


def beckmann_sigma(u: Array, alpha: Any) -> Array:
    """(u (1 + erf x) + alpha s exp(-x^2)/sqrt(pi))/2."""
    s = np.sqrt(1 - u * u)
    x = u / (alpha * s)
    return (u * (1 + special.erf(x)) + alpha / np.sqrt(np.pi) * s * np.exp(-x * x)) / 2


def ggx_D(u: Array, alpha: Any) -> Array:
    """alpha^2/(pi (1 + (alpha^2 - 1) u^2)^2)."""
    d = 1 + (alpha**2 - 1) * (u * u)
    return alpha**2 / np.pi / (d * d)


def ggx_Lambda(u: Array, alpha: Any) -> Array:
    """(sqrt(1 + alpha^2 tan^2) - 1)/2."""
    return (np.sqrt(1 + alpha**2 * _tan2(u)) - 1) / 2


def ggx_sigma(u: Array, alpha: Any) -> Array:
    """(u + sqrt(u^2 + alpha^2 s^2))/2."""
    u2 = u * u
    return (u + np.sqrt(u2 + alpha**2 * (1 - u2))) / 2


def gtr_D(u: Array, alpha: Any, gamma: Any) -> Array:
    """Burley's form."""
    a2 = alpha**2
    c = (gamma - 1) * (a2 - 1) / (np.pi * (1 - a2 ** (1 - gamma)))
    return c * (1 + (a2 - 1) * (u * u)) ** -gamma


def student_t_D(u: Array, alpha: Any, gamma: Any) -> Array:
    """(1 + tan^2/(alpha^2 k))^-gamma/(pi alpha^2 u^4)."""
    u2 = u * u
    return (1 + _tan2(u) / (alpha**2 * (gamma - 1))) ** -gamma / (np.pi * alpha**2 * (u2 * u2))


def student_t_Lambda(u: Array, alpha: Any, gamma: Any) -> Array:
    """The form of docs/family/student_t.md, by SciPy's 2F1."""
    k = gamma - 1
    y = k * alpha**2 * _tan2(u)
    z = y / (1 + y)
    front = special.beta(1.5, gamma - 1.5) / (2 * np.pi)
    return front * z**k * np.sqrt(1 + y) * special.hyp2f1(1, gamma - 1.5, gamma, z)


def student_t_sigma(u: Array, alpha: Any, gamma: Any) -> Array:
    """By Lambda above and below the horizon."""
    return _upper_and_lower(u, student_t_Lambda(u, alpha, gamma))


def k0_D_k0(u: Array, alpha: Any) -> Array:
    """2 K_0(2 tan/alpha)/(pi alpha^2 u^4)."""
    u2 = u * u
    return 2 * special.k0(2 / alpha * np.sqrt(_tan2(u))) / (np.pi * alpha**2 * (u2 * u2))


def k0_D_kv(u: Array, alpha: Any) -> Array:
    """The same by the function of any order."""
    u2 = u * u
    return 2 * special.kv(0, 2 / alpha * np.sqrt(_tan2(u))) / (np.pi * alpha**2 * (u2 * u2))


def k0_Lambda(u: Array, alpha: Any) -> Array:
    """exp(-2x)/(4x)."""
    x = _x(u, alpha)
    return np.exp(-2 * x) / (4 * x)


def k0_sigma(u: Array, alpha: Any) -> Array:
    """By Lambda above and below the horizon."""
    return _upper_and_lower(u, k0_Lambda(abs(u), alpha))


def bessel_k_D(u: Array, alpha: Any, a: Any) -> Array:
    """2 y^(a-1) K_{a-1}(2y)/(pi Gamma(a) alpha^2 u^4), y = tan/alpha."""
    u2 = u * u
    y = np.sqrt(_tan2(u)) / alpha
    front = 2 / (np.pi * special.gamma(a) * alpha**2)
    return front * y ** (a - 1) * special.kv(a - 1, 2 * y) / (u2 * u2)


def bessel_k_Lambda(u: Array, alpha: Any, a: Any) -> Array:
    """K_nu and modified Struve functions L_nu, nu = a - 1/2."""
    x, nu = _x(u, alpha), a - 0.5
    k_nu, struve = special.kv(nu, 2 * x), special.modstruve
    tail = 0.5 - x * (k_nu * struve(nu - 1, 2 * x) + struve(nu, 2 * x) * special.kv(nu - 1, 2 * x))
    return x**nu * special.kv(nu + 1, 2 * x) / (np.sqrt(np.pi) * special.gamma(a)) - tail


def bessel_k_sigma(u: Array, alpha: Any, a: Any) -> Array:
    """By Lambda above and below the horizon."""
    return _upper_and_lower(u, bessel_k_Lambda(abs(u), alpha, a))


#: What each quantity is compared with, named by what dominates its cost.
EXPRESSIONS: dict[tuple[str, str], dict[str, Expression]] = {
    ("beckmann", "D"): {"NumPy": beckmann_D},
    ("beckmann", "Lambda"): {"erfcx": beckmann_Lambda_erfcx, "erf": beckmann_Lambda_erf},
    ("beckmann", "sigma"): {"erf": beckmann_sigma},
    ("ggx", "D"): {"NumPy": ggx_D},
    ("ggx", "Lambda"): {"NumPy": ggx_Lambda},
    ("ggx", "sigma"): {"NumPy": ggx_sigma},
    ("gtr", "D"): {"NumPy": gtr_D},
    ("student_t", "D"): {"NumPy": student_t_D},
    ("student_t", "Lambda"): {"hyp2f1": student_t_Lambda},
    ("student_t", "sigma"): {"hyp2f1": student_t_sigma},
    ("k0", "D"): {"k0": k0_D_k0, "kv": k0_D_kv},
    ("k0", "Lambda"): {"NumPy": k0_Lambda},
    ("k0", "sigma"): {"NumPy": k0_sigma},
    ("bessel_k", "D"): {"kv": bessel_k_D},
    ("bessel_k", "Lambda"): {"kv, modstruve": bessel_k_Lambda},
    ("bessel_k", "sigma"): {"kv, modstruve": bessel_k_sigma},
}
