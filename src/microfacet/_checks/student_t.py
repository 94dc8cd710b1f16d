"""Student-T: the checks of its notebook, and its two limits. Printed forms (mpmath arguments) come first."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np
from mpmath import mp

from microfacet._checks import beckmann, closed, ggx, integrals, routes, symbolic
from microfacet._checks.check import CLOSED_FORM, LIMIT, QUADRATURE, Check, Sides, notebook
from microfacet._checks.routes import Array

FAMILY = "student_t"
GRID = tuple(
    {"alpha": alpha, "gamma": gamma}
    for alpha, gamma in product(
        (1e-4, 0.1, 0.7, 1.0, 10.0), (1.5001, 1.51, 1.6, 2.0, 2.3, 2.5, 3.0, 10.0, 1e3, 1e6)
    )
)
COVERED = {"gamma": (1.0, 1e6)}  # what the second routes have been made for
ENTRY: dict[str, Any] = {"parameters": {"alpha": 0.7, "gamma": 3.0}, "source": notebook("Student-T")}
EXACT = {**ENTRY, "parameters": {"alpha": 1 / 3, "gamma": 3.0}}
BEYOND: dict[str, Any] = {**ENTRY, "notebook": False}


def too_heavy(alpha: float, gamma: float) -> str:
    """The mean slope is the integral of r^(2 - 2 gamma): where it ends within the range of doubles."""
    return "" if gamma >= 1.6 else "the tail of the mean slope reaches beyond the range of double precision"


def sigma(u: Any, alpha: Any, gamma: Any) -> Any:
    k, scale = gamma - 1, alpha * mp.sqrt((1 - u) * (1 + u) * (gamma - 1))
    z = (u / scale) ** 2
    half = mp.mpf(1) / 2
    mean = scale * mp.gamma(k - half) / (2 * mp.sqrt(mp.pi) * mp.gamma(k)) * (1 + z) ** (half - k)
    below = (
        mp.gamma(k + half) / (mp.sqrt(mp.pi) * scale * mp.gamma(k)) * mp.hyp2f1(half, k + half, 3 * half, -z)
    )
    return u / 2 + mean + u**2 * below


def lambda_of_u(u: Any, alpha: Any, gamma: Any) -> Any:
    k, half = gamma - 1, mp.mpf(1) / 2
    v = (1 - u) * (1 + u) * k
    power = 2 * alpha ** (2 * k) * (u**2 + v * alpha**2) ** (half - k) * v**k
    # The incomplete Beta function of a negative argument and (-1)^-gamma are complex, their product is real.
    beta = mp.betainc(k, half - k, 0, -v * alpha**2 / u**2)
    complex_part = mp.mpc(-1) ** -gamma * u * (2 * gamma - 3) * beta
    return mp.gamma(k - half) / (4 * mp.sqrt(mp.pi) * u * mp.gamma(k)) * (power + complex_part)


def lambda_of_x(x: Any, gamma: Any) -> Any:
    k, half = gamma - 1, mp.mpf(1) / 2
    power = 2 * (x**2 + k) ** (half - k) / mp.gamma(gamma)
    regularized = mp.hyp2f1(k, k + half, gamma, -k / x**2) / mp.gamma(gamma)
    rest = x ** (1 - 2 * k) * (2 * gamma - 3) * regularized / k
    return k**gamma * mp.gamma(k - half) / (4 * mp.sqrt(mp.pi) * x) * (power - rest)


def D(u: Any, alpha: Any, gamma: Any) -> Any:
    return (1 + (1 - u**2) / (u**2 * alpha**2 * (gamma - 1))) ** -gamma / (mp.pi * u**4 * alpha**2)


def P22(r2: Any, alpha: Any, gamma: Any) -> Any:
    k = gamma - 1
    return alpha ** (2 * k) * (r2 + alpha**2 * k) ** -gamma * k**gamma / mp.pi


def P2(p: Any, alpha: Any, gamma: Any) -> Any:
    k, half = gamma - 1, mp.mpf(1) / 2
    norm = mp.gamma(k + half) * k**gamma / (mp.sqrt(mp.pi) * mp.gamma(gamma))
    return norm * alpha ** (2 * k) * (p**2 + alpha**2 * k) ** (half - gamma)


def survival(r: Any, alpha: Any, gamma: Any) -> Any:
    return (1 + r**2 / (alpha**2 * (gamma - 1))) ** (1 - gamma)


def _draw(rng: np.random.Generator, n: int, alpha: float, gamma: float) -> Array:
    power = np.expm1(-np.log1p(-rng.random(n)) / (gamma - 1))
    return np.asarray(1 / np.sqrt(1 + alpha**2 * (gamma - 1) * power))


def _beckmann_mixture(k: Any, alpha: float, gamma: float) -> Sides:
    u = routes.cosine(routes.slopes(alpha))
    mixture = routes.gamma_average(
        lambda b, u: routes.kernels("beckmann").D(u, alpha * np.sqrt((gamma - 1) / b)), gamma - 1, u
    )
    return k.D(u, alpha, gamma), mixture


def _ggx(k: Any, alpha: float, gamma: float) -> Sides:
    return closed.special_case(lambda name: lambda at, alpha: getattr(k, name)(at, alpha, gamma), alpha, ggx)


def _beckmann_limit(k: Any, alpha: float, gamma: float) -> Sides:
    """The families differ by a power series in h = 1/(gamma - 1), of which h, h/2, h/4 remove two terms."""

    def extrapolated(name: str) -> Callable[[Array, float], Array]:
        def limit(at: Array, alpha: float) -> Array:
            h1, h2, h4 = (getattr(k, name)(at, alpha, 1 + (gamma - 1) * n) for n in (1, 2, 4))
            return np.asarray((8 * h4 - 6 * h2 + h1) / 3)

        return limit

    # The last point may lie at x = 20, where the series is one in (x^4/2) h: too far for three terms.
    return closed.special_case(extrapolated, alpha, beckmann, last=-1)


CHECKS: tuple[Check, ...] = (
    closed.density(
        D,
        r"D(u) = \frac{\Theta(u)}{\pi\alpha^2u^4}"
        r"\left(1+\frac{1-u^2}{u^2\alpha^2(\gamma-1)}\right)^{-\gamma}",
        **ENTRY,
    ),
    *closed.projected_area(sigma, lambda_of_u, symbolic=symbolic.STUDENT_T, **EXACT),
    closed.lambda_of_x(
        lambda_of_x,
        r"$\Lambda$ depends on $x=\cot\theta/\alpha$ and on $\gamma$ alone",
        r"\Lambda = \frac{k^\gamma\,\Gamma(\gamma-\frac32)}{4\sqrt{\pi}\,\Gamma(\gamma)\,x}\left("
        r"2(x^2+k)^{3/2-\gamma} - \frac{2\gamma-3}{k\,x^{2\gamma-3}}\,"
        r"{}_2F_1\big(k, \gamma-\tfrac12; \gamma; \tfrac{-k}{x^2}\big)\right), \quad k = \gamma - 1",
        **ENTRY,
    ),
    closed.shape_invariant(
        lambda y, gamma: ((gamma - 1) / (gamma - 1 + y**2)) ** gamma / mp.pi,
        r"$\alpha^2 u^4 D$ depends on $y=\tan\theta/\alpha$ and on $\gamma$ alone",
        r"\alpha^2 u^4 D(u) = f(y) = \frac{1}{\pi}\left(\frac{\gamma-1}{\gamma-1+y^2}\right)^{\gamma}",
        **ENTRY,
    ),
    Check(
        "beckmann_mixture",
        r"Student-T is Beckmann of roughness $\alpha\sqrt{(\gamma-1)/b}$, averaged over"
        r" $b\sim\mathrm{Gamma}(\gamma-1, 1)$",
        r"D(u) = \int_0^\infty \frac{b^{\gamma-2}e^{-b}}{\Gamma(\gamma-1)}\,"
        r"D_{\mathrm{Beckmann}}\big(u; \alpha\sqrt{(\gamma-1)/b}\big)\,db",
        _beckmann_mixture,
        QUADRATURE,
        **ENTRY,
    ),
    integrals.normalization(**ENTRY),
    closed.slopes_from_D(
        P22,
        r"P_{22}(p, q) = D(u)\,u^4 = \frac{\alpha^{2\gamma-2}(\gamma-1)^\gamma}"
        r"{\pi\,(p^2+q^2+\alpha^2(\gamma-1))^{\gamma}}",
        **ENTRY,
    ),
    integrals.slopes_normalized(**ENTRY),
    integrals.marginal(
        P2,
        r"P_2(p) = \int_{-\infty}^{\infty} P_{22}(p, q)\,dq = \frac{\alpha^{2k}\,k^\gamma\,"
        r"\Gamma(\gamma-\frac12)}{\sqrt{\pi}\,\Gamma(\gamma)}\,(p^2+k\,\alpha^2)^{1/2-\gamma},"
        r"\quad k = \gamma - 1",
        **ENTRY,
    ),
    integrals.sigma_delta(unless=too_heavy, **ENTRY),
    integrals.sampling(
        _draw,
        r"u = \frac{1}{\sqrt{1 + \alpha^2(\gamma-1)\big((1-\xi)^{1/(1-\gamma)} - 1\big)}}",
        **{**ENTRY, "parameters": {"alpha": 1.2, "gamma": 2.3}},
    ),
    integrals.survival(
        survival,
        r"\Pr(\tan\theta > r) = \left(1 + \frac{r^2}{\alpha^2(\gamma-1)}\right)^{1-\gamma}",
        **ENTRY,
    ),
    Check(
        "ggx",
        r"Student-T at $\gamma=2$ is GGX: $D$, $P_2$, $\Lambda$ and $\sigma$",
        r"D(u; \alpha, \gamma = 2) = D_{\mathrm{GGX}}(u; \alpha)",
        _ggx,
        CLOSED_FORM,
        parameters={"alpha": 0.7, "gamma": 2.0},
        fixed=frozenset({"gamma"}),
        source="Ribardière et al. 2017",
        notebook=False,
    ),
    Check(
        "beckmann_limit",
        r"Student-T tends to Beckmann as $\gamma$ grows: $D$, $P_2$, $\Lambda$ and $\sigma$, extrapolated in"
        r" $1/(\gamma-1)$",
        r"\lim_{\gamma\to\infty} D(u; \alpha, \gamma) = D_{\mathrm{Beckmann}}(u; \alpha)",
        _beckmann_limit,
        LIMIT,
        parameters={"alpha": 0.7, "gamma": 2.5e5},
        fixed=frozenset({"gamma"}),
        source="Ribardière et al. 2017",
        notebook=False,
    ),
)
