"""GTR: the checks of its notebook, and beyond it Lambda, sigma and sampling at any gamma."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np
from mpmath import mp

from microfacet._checks import closed, ggx, integrals, routes, symbolic
from microfacet._checks.check import CLOSED_FORM, QUADRATURE, Check, Sides, both, notebook
from microfacet._checks.gtr_forms import (
    D_1,
    D_3_2,
    P2,
    P2_1,
    P2_3_2,
    P22,
    P22_1,
    P22_3_2,
    D,
    as_limit,
    henyey_greenstein,
    lambda_1,
    sigma_1,
    survival,
)
from microfacet._checks.routes import Array

FAMILY = "gtr"
GRID = tuple(
    {"alpha": alpha, "gamma": gamma}
    for alpha, gamma in product(
        (1e-4, 0.1, 0.6, 1.0, 1 + 1e-9, 10.0), (0.25, 1.0, 1 + 1e-10, 1.3, 1.5, 2.0, 2.5, 3.0, 6.3, 15.0)
    )
)
COVERED = {"gamma": (0.01, 50.0)}  # what the second routes have been made for
ENTRY: dict[str, Any] = {"parameters": {"alpha": 0.1, "gamma": 1.7}, "source": notebook("GTR")}
BEYOND: dict[str, Any] = {**ENTRY, "notebook": False}
AT_1: dict[str, Any] = {**ENTRY, "parameters": {"alpha": 0.1, "gamma": 1.0}, "fixed": frozenset({"gamma"})}
AT_3_2: dict[str, Any] = {**ENTRY, "parameters": {"alpha": 0.1, "gamma": 1.5}, "fixed": frozenset({"gamma"})}


def _draw(rng: np.random.Generator, n: int, alpha: float, gamma: float) -> Array:
    xi = rng.random(n)
    if alpha == 1:
        return np.sqrt(xi)
    log = xi * 2 * np.log(alpha)
    if gamma != 1:
        log = np.log1p(xi * np.expm1((2 - 2 * gamma) * np.log(alpha))) / (1 - gamma)
    return np.asarray(np.sqrt(np.expm1(log) / np.expm1(2 * np.log(alpha))))


def _special_D(form: Callable[..., Any]) -> Callable[..., Sides]:
    def sides(k: Any, *parameters: float) -> Sides:
        u = routes.cosine(routes.slopes(parameters[0]))
        library = k.D(u, *parameters)
        return both(
            (library, routes.exact(as_limit(form), u, *parameters)),
            (library, routes.exact(as_limit(D), u, *parameters)),
        )

    return sides


def _henyey_greenstein(k: Any, *parameters: float) -> Sides:
    def scattered(u: Any, alpha: Any, gamma: Any) -> Any:
        return 4 * henyey_greenstein(2 * u**2 - 1, (1 - alpha) / (1 + alpha))

    u = np.append(routes.cosine(routes.slopes(parameters[0])), [0.01, 0.5, 1.0])
    return k.D(u, *parameters), routes.exact(scattered, u, *parameters)


def _lambda_1(k: Any, *parameters: float) -> Sides:
    u = routes.incident_cosines(parameters[0])
    mu = 1 / routes.slope_of(u)
    return both(
        (k.Lambda(u, *parameters), routes.exact(as_limit(lambda_1), u, *parameters)),
        (k.Lambda(u, *parameters), routes.mean_excess(k, mu, *parameters) / mu),
    )


def _sigma_1(k: Any, *parameters: float) -> Sides:
    u = routes.incident_cosines(parameters[0])
    slope = routes.slope_of(u)
    below = u * slope * routes.mean_excess(k, 1 / slope, *parameters)
    both_ways = np.concatenate([u, -u])
    return both(
        (k.sigma(both_ways, *parameters), routes.exact(as_limit(sigma_1), both_ways, *parameters)),
        (k.sigma(both_ways, *parameters), np.concatenate([u + below, below])),
    )


def _ggx_mixture(k: Any, alpha: float, gamma: float) -> Sides:
    """The weight w is Beta(gamma, 2 - gamma); its logit y keeps both ends."""
    r = routes.slopes(alpha)
    norm = routes.exact(lambda one, a, g: mp.pi * as_limit(P22)(0, a, g) * a ** (2 * g), [1.0], alpha, gamma)[
        0
    ]
    norm *= float(mp.rgamma(gamma) * mp.rgamma(2 - gamma))

    def integrand(y: Array, r: Array) -> Array:
        log_w, log_rest = -np.logaddexp(0.0, -y), -np.logaddexp(0.0, y)
        alpha2 = np.exp(log_w) * alpha**2 + np.exp(log_rest)
        density = norm * np.exp(gamma * log_w + (2 - gamma) * log_rest) / alpha2
        return np.asarray(density * routes.kernels("ggx").P22(r, 0.0, np.sqrt(alpha2)), dtype=np.float64)

    reach = 40 / min(gamma, 2 - gamma) + 2 * abs(np.log(alpha))
    return k.P22(r, 0.0, alpha, gamma), routes.integrate_exponent(integrand, -reach, reach, r)


def _ggx(k: Any, alpha: float, gamma: float) -> Sides:
    return closed.special_case(lambda name: lambda at, alpha: getattr(k, name)(at, alpha, gamma), alpha, ggx)


def _mixture_range(alpha: float, gamma: float) -> str:
    if gamma >= 2:
        return "the mixing density Beta(gamma, 2 - gamma) exists for 0 < gamma < 2"
    return "" if 0.05 <= gamma <= 1.95 else "the mixing density is all but a point mass"


CHECKS: tuple[Check, ...] = (
    closed.density(
        as_limit(D),
        r"D(u) = \frac{\alpha^{2\gamma}(\alpha^2-1)(\gamma-1)}{\pi(\alpha^{2\gamma}-\alpha^2)}"
        r"\,\frac{\Theta(u)}{(1+u^2(\alpha^2-1))^{\gamma}}",
        remark=r", which the notebook leaves out; $0/0$ stands for its limit",
        **ENTRY,
    ),
    Check(
        "gamma_1",
        r"At $\gamma=1$ the general form of $D$ has a limit with a logarithm",
        r"D(u; \alpha, 1) = \frac{\alpha^2-1}{2\pi\,(1+u^2(\alpha^2-1))\,\ln\alpha}",
        _special_D(D_1),
        CLOSED_FORM,
        **AT_1,
    ),
    Check(
        "gamma_3_2",
        r"At $\gamma=3/2$ the form of $D$ is that of the Henyey–Greenstein phase function",
        r"D(u; \alpha, \tfrac32) = \frac{\alpha(1+\alpha)}{2\pi\,(1+u^2(\alpha^2-1))^{3/2}}",
        _special_D(D_3_2),
        CLOSED_FORM,
        **AT_3_2,
    ),
    Check(
        "henyey_greenstein",
        r"At $\gamma=3/2$ GTR is the phase function of Henyey and Greenstein: light along the normal leaves a"
        r" facet $2\theta$ from the mirror direction, with the density $D/4$ per steradian",
        r"D(u; \alpha, \tfrac32) = 4\,p_{\mathrm{HG}}(2u^2-1; g), \quad p_{\mathrm{HG}}(c; g) ="
        r" \frac{1-g^2}{4\pi\,(1+g^2-2gc)^{3/2}}, \quad g = \frac{1-\alpha}{1+\alpha}",
        _henyey_greenstein,
        CLOSED_FORM,
        symbolic=symbolic.HENYEY_GREENSTEIN,
        **{**AT_3_2, "source": "Henyey and Greenstein 1941", "notebook": False},
    ),
    integrals.normalization(**ENTRY),
    closed.slopes_from_D(
        as_limit(P22),
        r"P_{22}(p, q) = D(u)\,u^4 = \frac{\alpha^{2\gamma}(\alpha^2-1)(\gamma-1)}"
        r"{\pi(\alpha^{2\gamma}-\alpha^2)}\,\frac{(1+p^2+q^2)^{\gamma-2}}{(p^2+q^2+\alpha^2)^{\gamma}}",
        **ENTRY,
    ),
    closed.slopes_from_D(
        as_limit(P22_1),
        r"P_{22}(p, q) = \frac{\alpha^2-1}{2\pi\ln\alpha\,(1+p^2+q^2)(p^2+q^2+\alpha^2)}, \quad \gamma = 1",
        name="slopes_gamma_1",
        **AT_1,
    ),
    closed.slopes_from_D(
        P22_3_2,
        r"P_{22}(p, q) = \frac{\alpha(1+\alpha)}{2\pi\sqrt{1+p^2+q^2}\,(p^2+q^2+\alpha^2)^{3/2}},"
        r"\quad \gamma = \tfrac32",
        name="slopes_gamma_3_2",
        **AT_3_2,
    ),
    integrals.slopes_normalized(**ENTRY),
    integrals.marginal(
        as_limit(P2),
        r"P_2(p) = \int_{-\infty}^{\infty} P_{22}(p, q)\,dq = D(0)\,\frac{\pi}{2}\,A^{-3/2}\,"
        r"{}_2F_1\big(\tfrac32, 2-\gamma; 2; \kappa\big), \quad A = p^2+\alpha^2,"
        r" \quad \kappa = \frac{\alpha^2-1}{A}",
        **ENTRY,
    ),
    integrals.marginal(
        as_limit(P2_1),
        r"P_2(p) = \frac{1}{\ln\alpha^2}\left(\frac{1}{\sqrt{1+p^2}} - \frac{1}{\sqrt{p^2+\alpha^2}}\right),"
        r"\quad \gamma = 1",
        name="marginal_gamma_1",
        **AT_1,
    ),
    integrals.marginal(
        as_limit(P2_3_2),
        r"P_2(p) = \frac{\alpha\,(K(\kappa)-E(\kappa))}{\pi(\alpha-1)\sqrt{p^2+\alpha^2}},"
        r"\quad \kappa = \frac{\alpha^2-1}{p^2+\alpha^2}, \quad \gamma = \tfrac32",
        name="marginal_gamma_3_2",
        **AT_3_2,
    ),
    Check(
        "lambda_gamma_1",
        r"$\Lambda$ at $\gamma=1$ is the printed form, and follows from the density of one slope",
        r"\Lambda(u) = \frac{1}{2\ln\alpha}\left(Q - \frac{1}{u} + \ln\frac{1+1/u}{1+Q}\right),"
        r"\quad Q = \sqrt{1+(u^{-2}-1)\alpha^2}",
        _lambda_1,
        QUADRATURE,
        **AT_1,
    ),
    Check(
        "sigma_gamma_1",
        r"$\sigma$ at $\gamma=1$ is the printed form on both sides of the horizon, and follows from $P_2$",
        r"\sigma(u) = u + \frac{R - 1 + u\,V}{2\ln\alpha},"
        r" \quad V = \mathrm{arsinh}\frac{u}{s} - \ln\frac{u+R}{s},"
        r" \quad s = \sqrt{1-u^2}, \quad R = \sqrt{u^2+\alpha^2 s^2}",
        _sigma_1,
        QUADRATURE,
        **AT_1,
    ),
    integrals.sigma_from_marginal(**AT_1),
    integrals.sigma_delta(**AT_1),
    integrals.lambda_from_marginal(name="lambda", **BEYOND),
    integrals.sigma_delta(name="sigma_delta_general", **BEYOND),
    integrals.sampling(
        _draw,
        r"u^2 = \frac{\big(1+\xi(\alpha^{2-2\gamma}-1)\big)^{1/(1-\gamma)} - 1}{\alpha^2-1}",
        **{**BEYOND, "parameters": {"alpha": 0.3, "gamma": 1.7}},
    ),
    integrals.survival(
        as_limit(survival),
        r"\Pr(\tan\theta > r) = \frac{1}{\alpha^{2-2\gamma} - 1}"
        r"\left(\Big(\frac{1+r^2}{\alpha^2+r^2}\Big)^{\gamma-1} - 1\right)",
        **ENTRY,
    ),
    Check(
        "ggx_mixture",
        r"For $0<\gamma<2$ GTR is a mixture of GGX, of roughnesses $\alpha_b$ between $\alpha$ and 1",
        r"P_{22}(r) = \int_0^1 \frac{\pi D(0)\,b^{\gamma-1}(1-b)^{1-\gamma}}"
        r"{\Gamma(\gamma)\,\Gamma(2-\gamma)\,\alpha_b^2}\,"
        r"P_{22}^{\mathrm{GGX}}(r; \alpha_b)\,db, \quad \alpha_b^2 = b\alpha^2 + 1 - b",
        _ggx_mixture,
        QUADRATURE,
        unless=_mixture_range,
        **BEYOND,
    ),
    Check(
        "ggx",
        r"GTR at $\gamma=2$ is GGX: $D$, $P_2$, $\Lambda$ and $\sigma$",
        r"D(u; \alpha, \gamma = 2) = D_{\mathrm{GGX}}(u; \alpha)",
        _ggx,
        CLOSED_FORM,
        parameters={"alpha": 0.1, "gamma": 2.0},
        fixed=frozenset({"gamma"}),
        source="Burley 2012",
        notebook=False,
    ),
)
