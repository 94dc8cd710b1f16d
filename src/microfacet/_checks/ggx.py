"""GGX, in which the notebooks' families meet: the statements for Beckmann, beyond the five notebooks."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp

from microfacet._checks import closed, integrals
from microfacet._checks.check import Check
from microfacet._checks.routes import Array

FAMILY = "ggx"
GRID = tuple({"alpha": alpha} for alpha in (1e-4, 1e-2, 0.1, 0.5, 1.0, 3.0, 10.0))
ENTRY: dict[str, Any] = {
    "parameters": {"alpha": 0.2},
    "source": "Trowbridge and Reitz 1975; Walter et al. 2007",
    "notebook": False,
}


def lambda_of_x(x: Any) -> Any:
    return (mp.sqrt(1 + 1 / x**2) - 1) / 2


def lambda_of_u(u: Any, alpha: Any) -> Any:
    return lambda_of_x(u / (alpha * mp.sqrt((1 - u) * (1 + u))))


def sigma(u: Any, alpha: Any) -> Any:
    return (u + mp.sqrt(u**2 + alpha**2 * (1 - u) * (1 + u))) / 2


def P22(r2: Any, alpha: Any) -> Any:
    return alpha**2 / (mp.pi * (r2 + alpha**2) ** 2)


def P2(p: Any, alpha: Any) -> Any:
    return alpha**2 / (2 * mp.sqrt(p**2 + alpha**2) ** 3)


def _draw(rng: np.random.Generator, n: int, alpha: float) -> Array:
    xi = rng.random(n)
    return np.asarray(1 / np.sqrt(1 + alpha**2 * xi / (1 - xi)))


CHECKS: tuple[Check, ...] = (
    *closed.projected_area(sigma, lambda_of_u, **ENTRY),
    closed.lambda_of_x(
        lambda_of_x,
        r"$\Lambda$ depends on $x=\cot\theta/\alpha$ alone",
        r"\Lambda = \frac{1}{2}\left(\sqrt{1 + \frac{1}{x^2}} - 1\right)",
        **ENTRY,
    ),
    closed.shape_invariant(
        lambda y: 1 / (mp.pi * (1 + y**2) ** 2),
        r"$\alpha^2 u^4 D$ depends on $y=\tan\theta/\alpha$ alone",
        r"\alpha^2 u^4 D(u) = f(y) = \frac{1}{\pi (1 + y^2)^2}",
        **ENTRY,
    ),
    integrals.normalization(**ENTRY),
    closed.slopes_from_D(
        P22, r"P_{22}(p, q) = D(u)\,u^4 = \frac{\alpha^2}{\pi(p^2+q^2+\alpha^2)^2}", **ENTRY
    ),
    integrals.slopes_normalized(**ENTRY),
    integrals.marginal(
        P2,
        r"P_2(p) = \int_{-\infty}^{\infty} P_{22}(p, q)\,dq = \frac{\alpha^2}{2(p^2+\alpha^2)^{3/2}}",
        **ENTRY,
    ),
    integrals.lambda_from_marginal(**ENTRY),
    integrals.sigma_delta(**ENTRY),
    integrals.sampling(
        _draw,
        r"u = \frac{1}{\sqrt{1 + \alpha^2\,\xi/(1-\xi)}}",
        **{**ENTRY, "parameters": {"alpha": 0.6}},
    ),
    integrals.survival(
        lambda r, alpha: alpha**2 / (alpha**2 + r**2),
        r"\Pr(\tan\theta > r) = \frac{\alpha^2}{\alpha^2 + r^2}",
        **ENTRY,
    ),
)
