"""Beckmann: the checks of its notebook. The printed forms (mpmath arguments) come first, then the table."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp

from microfacet._checks import closed, integrals, symbolic
from microfacet._checks.check import Check, notebook
from microfacet._checks.routes import Array

FAMILY = "beckmann"
GRID = tuple({"alpha": alpha} for alpha in (1e-4, 1e-2, 0.1, 0.5, 1.0, 3.0, 10.0))
ENTRY: dict[str, Any] = {"parameters": {"alpha": 0.7}, "source": notebook("Beckmann")}


def sigma(u: Any, alpha: Any) -> Any:
    s = mp.sqrt((1 - u) * (1 + u))
    x = u / (alpha * s)
    return (u * mp.erfc(-x) + alpha * s * mp.exp(-(x**2)) / mp.sqrt(mp.pi)) / 2


def lambda_of_x(x: Any) -> Any:
    return (mp.exp(-(x**2)) / (mp.sqrt(mp.pi) * x) - mp.erfc(x)) / 2


def lambda_of_u(u: Any, alpha: Any) -> Any:
    return lambda_of_x(u / (alpha * mp.sqrt((1 - u) * (1 + u))))


def D(u: Any, alpha: Any) -> Any:
    return mp.exp(-(1 / u**2 - 1) / alpha**2) / (alpha**2 * mp.pi * u**4)


def P22(r2: Any, alpha: Any) -> Any:
    return mp.exp(-r2 / alpha**2) / (mp.pi * alpha**2)


def P2(p: Any, alpha: Any) -> Any:
    return mp.exp(-((p / alpha) ** 2)) / (mp.sqrt(mp.pi) * alpha)


def _draw(rng: np.random.Generator, n: int, alpha: float) -> Array:
    return np.asarray(1 / np.sqrt(1 - alpha**2 * np.log(1 - rng.random(n))))


CHECKS: tuple[Check, ...] = (
    closed.density(
        D,
        r"D(u) = \frac{1}{\pi\alpha^2u^4}\exp\left(-\frac{u^{-2}-1}{\alpha^2}\right)\Theta(u)",
        **ENTRY,
    ),
    *closed.projected_area(sigma, lambda_of_u, symbolic=symbolic.BECKMANN, **ENTRY),
    closed.lambda_of_x(
        lambda_of_x,
        r"$\Lambda$ depends on $x=\cot\theta/\alpha$ alone",
        r"\Lambda = \frac{1}{2}\left(\mathrm{erf}\,x - 1 + \frac{e^{-x^2}}{\sqrt{\pi}\,x}\right)",
        **ENTRY,
    ),
    closed.shape_invariant(
        lambda y: mp.exp(-(y**2)) / mp.pi,
        r"$\alpha^2 u^4 D$ depends on $y=\tan\theta/\alpha$ alone",
        r"\alpha^2 u^4 D(u) = f(y) = \frac{e^{-y^2}}{\pi}, \quad u = \frac{1}{\sqrt{1 + y^2\alpha^2}}",
        **ENTRY,
    ),
    integrals.normalization(**ENTRY),
    closed.slopes_from_D(
        P22, r"P_{22}(p, q) = D(u)\,u^4 = \frac{e^{-(p^2+q^2)/\alpha^2}}{\pi\alpha^2}", **ENTRY
    ),
    integrals.slopes_normalized(**ENTRY),
    integrals.marginal(
        P2,
        r"P_2(p) = \int_{-\infty}^{\infty} P_{22}(p, q)\,dq = \frac{e^{-p^2/\alpha^2}}{\sqrt{\pi}\,\alpha}",
        **ENTRY,
    ),
    integrals.lambda_from_marginal(**ENTRY),
    integrals.sigma_delta(**ENTRY),
    integrals.sampling(
        _draw, r"u = \frac{1}{\sqrt{1 - \alpha^2 \ln\xi}}", **{**ENTRY, "parameters": {"alpha": 1.3}}
    ),
    integrals.survival(
        lambda r, alpha: mp.exp(-((r / alpha) ** 2)), r"\Pr(\tan\theta > r) = e^{-r^2/\alpha^2}", **ENTRY
    ),
)
