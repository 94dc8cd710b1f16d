"""Erfc: the checks of its notebook, and the marginal it does not print. Printed forms (mpmath) come first."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp

from microfacet._checks import closed, integrals
from microfacet._checks.check import QUADRATURE, Check, notebook
from microfacet._checks.ei import beckmann_mixture
from microfacet._checks.routes import Array

FAMILY = "erfc"
GRID = tuple({"alpha": alpha} for alpha in (1e-4, 1e-2, 0.1, 0.5, 1.0, 3.0, 10.0))
ENTRY: dict[str, Any] = {"parameters": {"alpha": 0.7}, "source": notebook("Erfc")}
BEYOND: dict[str, Any] = {**ENTRY, "notebook": False}


def D(u: Any, alpha: Any) -> Any:
    s = mp.sqrt((1 - u) * (1 + u))
    return mp.erfc(s / (alpha * u)) / (2 * mp.sqrt(mp.pi) * alpha * u**3 * s)


def lambda_of_x(x: Any) -> Any:
    last = (mp.exp(-(x**2)) + x**2 * mp.e1(x**2)) / (mp.sqrt(mp.pi) * x)
    return (-2 * mp.erfc(x) + last) / 4


def lambda_of_u(u: Any, alpha: Any) -> Any:
    return lambda_of_x(u / (alpha * mp.sqrt((1 - u) * (1 + u))))


def sigma(u: Any, alpha: Any) -> Any:
    s = alpha * mp.sqrt((1 - u) * (1 + u))
    x = u / s
    area = 2 * u * mp.erfc(-x) + s * mp.exp(-(x**2)) / mp.sqrt(mp.pi)
    return (area + u**2 * mp.gammainc(0, x**2) / (mp.sqrt(mp.pi) * s)) / 4


def P22(r2: Any, alpha: Any) -> Any:
    r = mp.sqrt(r2)
    return mp.erfc(r / alpha) / (2 * mp.sqrt(mp.pi) * r * alpha)


def P2(p: Any, alpha: Any) -> Any:
    return mp.e1((p / alpha) ** 2) / (2 * mp.sqrt(mp.pi) * alpha)


def survival(r: Any, alpha: Any) -> Any:
    y = r / alpha
    return mp.exp(-(y**2)) - mp.sqrt(mp.pi) * y * mp.erfc(y)


# A rounding of u moves the squared slope by eps/2, which counts next to a power.
CAP = integrals.Cap(
    lambda alpha: alpha / 10,
    lambda r, alpha: 1 - survival(r, alpha),
    r"those of slopes below $\alpha/10$, of which cosines in double precision do not resolve the least, come"
    " in closed form",
)


def _draw(rng: np.random.Generator, n: int, alpha: float) -> Array:
    return np.asarray(1 / np.sqrt(1 - (alpha * rng.random(n)) ** 2 * np.log(1 - rng.random(n))))


CHECKS: tuple[Check, ...] = (
    closed.density(
        D,
        r"D(u) = \frac{\Theta(u)}{2\alpha u^3\sqrt{\pi-\pi u^2}}\,"
        r"\mathrm{erfc}\,\frac{\sqrt{1-u^2}}{\alpha u}",
        remark="; at $u=1$ it has no value",
        **ENTRY,
    ),
    *closed.projected_area(sigma, lambda_of_u, **ENTRY),
    closed.lambda_of_x(
        lambda_of_x,
        r"$\Lambda$ depends on $x=\cot\theta/\alpha$ alone",
        r"\Lambda = \frac{1}{4}\left(-2\,\mathrm{erfc}\,x"
        r" + \frac{e^{-x^2} + x^2 E_1(x^2)}{\sqrt{\pi}\,x}\right)",
        **ENTRY,
    ),
    Check(
        "beckmann_mixture",
        r"Erfc is Beckmann of roughness $\alpha m$, averaged over $m$ uniform in $(0,1)$: $D$, $\sigma$ and"
        r" $\Lambda$",
        r"D(u) = \int_0^1 D_{\mathrm{Beckmann}}(u; \alpha m)\,dm",
        lambda k, alpha: beckmann_mixture(k, alpha, lambda m: alpha * m),
        QUADRATURE,
        **ENTRY,
    ),
    closed.shape_invariant(
        lambda y: mp.erfc(y) / (2 * mp.sqrt(mp.pi) * y),
        r"$\alpha^2 u^4 D$ depends on $y=\tan\theta/\alpha$ alone",
        r"\alpha^2 u^4 D(u) = f(y) = \frac{\mathrm{erfc}\,y}{2\sqrt{\pi}\,y}",
        **ENTRY,
    ),
    integrals.normalization(CAP, **ENTRY),
    closed.slopes_from_D(
        P22,
        r"P_{22}(p, q) = D(u)\,u^4 = \frac{1}{2\sqrt{\pi}\,r\,\alpha}\,\mathrm{erfc}\,\frac{r}{\alpha},"
        r"\quad r = \sqrt{p^2+q^2}",
        **ENTRY,
    ),
    integrals.slopes_normalized(**ENTRY),
    integrals.sigma_delta(CAP, **ENTRY),
    integrals.sampling(_draw, r"u = \frac{1}{\sqrt{1 - (\alpha\,\xi_1)^2 \ln\xi_2}}", CAP, **BEYOND),
    integrals.marginal(
        P2,
        r"P_2(p) = \int_{-\infty}^{\infty} P_{22}(p, q)\,dq = \frac{1}{2\sqrt{\pi}\,\alpha}\,"
        r"E_1\Big(\frac{p^2}{\alpha^2}\Big)",
        **BEYOND,
    ),
    integrals.lambda_from_marginal(**BEYOND),
    integrals.survival(
        survival,
        r"\Pr(\tan\theta > r) = e^{-y^2} - \sqrt{\pi}\,y\,\mathrm{erfc}\,y, \quad y = r/\alpha",
        **ENTRY,
    ),
)
