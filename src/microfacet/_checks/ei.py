"""Ei: the checks of its notebook, and the tails it does not print. Printed forms (mpmath) come first."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp

from microfacet._checks import closed, integrals, routes
from microfacet._checks.check import QUADRATURE, Check, Sides, both, notebook
from microfacet._checks.routes import Array

FAMILY = "ei"
GRID = tuple({"alpha": alpha} for alpha in (1e-4, 1e-2, 0.1, 0.5, 1.0, 3.0, 10.0))
ENTRY: dict[str, Any] = {"parameters": {"alpha": 0.7}, "source": notebook("Ei")}
BEYOND: dict[str, Any] = {**ENTRY, "notebook": False}


def D(u: Any, alpha: Any) -> Any:
    return mp.gammainc(0, routes.tan2(u) / alpha**2) / (mp.pi * alpha**2 * u**4)


def lambda_of_x(x: Any) -> Any:
    first = mp.exp(-(x**2)) * (1 + x**2) / (3 * mp.sqrt(mp.pi) * x)
    return first - (3 + 2 * x**2) * mp.erfc(x) / 6


def lambda_of_u(u: Any, alpha: Any) -> Any:
    return lambda_of_x(u / (alpha * mp.sqrt((1 - u) * (1 + u))))


def sigma(u: Any, alpha: Any) -> Any:
    return max(u, 0) + abs(u) * lambda_of_u(abs(u), alpha)


def P22(r2: Any, alpha: Any) -> Any:
    return mp.gammainc(0, r2 / alpha**2) / (mp.pi * alpha**2)


def P2(p: Any, alpha: Any) -> Any:
    t = abs(p) / alpha
    return 2 * (mp.exp(-(t**2)) / mp.sqrt(mp.pi) - t * mp.erfc(t)) / alpha


def survival(r: Any, alpha: Any) -> Any:
    y = (r / alpha) ** 2
    return mp.exp(-y) - y * mp.e1(y)


CAP = integrals.Cap(
    lambda alpha: 1e-7,
    lambda r, alpha: 1 - survival(r, alpha),
    "those of slopes below $10^{-7}$, which cosines in double precision do not resolve, come in closed form",
)


def _draw(rng: np.random.Generator, n: int, alpha: float) -> Array:
    return np.asarray(1 / np.sqrt(1 - alpha**2 * rng.random(n) * np.log(1 - rng.random(n))))


def beckmann_mixture(k: Any, alpha: float, roughness: Any) -> Sides:
    """D, sigma and Lambda against the mean of Beckmann's at ``roughness(m)``, m uniform in (0, 1)."""

    def mean(name: str, at: Array) -> Array:
        beckmann = getattr(routes.kernels("beckmann"), name)
        return routes.uniform_average(lambda m, u: beckmann(u, roughness(m)), at)

    normal, u = routes.cosine(routes.slopes(alpha)), routes.incident_cosines(alpha)
    places = (("D", normal), ("sigma", u), ("sigma", -u), ("Lambda", u))
    return both(*((getattr(k, name)(at, alpha), mean(name, at)) for name, at in places))


CHECKS: tuple[Check, ...] = (
    closed.density(
        D,
        r"D(u) = \frac{\Theta(u)}{\pi\alpha^2u^4}\,\Gamma\Big(0, \frac{u^{-2}-1}{\alpha^2}\Big)",
        remark="; at $u=1$ it has no value",
        **ENTRY,
    ),
    closed.lambda_of_x(
        lambda_of_x,
        r"$\Lambda$ depends on $x=\cot\theta/\alpha$ alone",
        r"\Lambda = \frac{e^{-x^2}(1+x^2)}{3\sqrt{\pi}\,x} - \frac{3+2x^2}{6}\,\mathrm{erfc}\,x",
        **ENTRY,
    ),
    Check(
        "beckmann_mixture",
        r"Ei is Beckmann of roughness $\alpha\sqrt{m}$, averaged over $m$ uniform in $(0,1)$: $D$, $\sigma$"
        r" and $\Lambda$",
        r"D(u) = \int_0^1 D_{\mathrm{Beckmann}}(u; \alpha\sqrt{m})\,dm",
        lambda k, alpha: beckmann_mixture(k, alpha, lambda m: alpha * np.sqrt(m)),
        QUADRATURE,
        **ENTRY,
    ),
    closed.shape_invariant(
        lambda y: mp.gammainc(0, y**2) / mp.pi,
        r"$\alpha^2 u^4 D$ depends on $y=\tan\theta/\alpha$ alone",
        r"\alpha^2 u^4 D(u) = f(y) = \frac{\Gamma(0, y^2)}{\pi}",
        **ENTRY,
    ),
    integrals.normalization(CAP, **ENTRY),
    closed.slopes_from_D(
        P22,
        r"P_{22}(p, q) = D(u)\,u^4 = \frac{1}{\pi\alpha^2}\,\Gamma\Big(0, \frac{p^2+q^2}{\alpha^2}\Big)",
        **ENTRY,
    ),
    integrals.slopes_normalized(**ENTRY),
    integrals.sigma_delta(CAP, **ENTRY),
    *closed.projected_area(sigma, lambda_of_u, **BEYOND),
    integrals.sampling(_draw, r"u = \frac{1}{\sqrt{1 - \alpha^2 \xi_1 \ln\xi_2}}", CAP, **BEYOND),
    integrals.marginal(
        P2,
        r"P_2(p) = \int_{-\infty}^{\infty} P_{22}(p, q)\,dq = \frac{2}{\alpha}\,\mathrm{ierfc}\,t,"
        r"\quad t = \frac{|p|}{\alpha}, "
        r"\quad \mathrm{ierfc}\,t = \frac{e^{-t^2}}{\sqrt{\pi}} - t\,\mathrm{erfc}\,t",
        **BEYOND,
    ),
    integrals.lambda_from_marginal(**BEYOND),
    integrals.survival(survival, r"\Pr(\tan\theta > r) = E_2(y^2), \quad y = r/\alpha", **ENTRY),
)
