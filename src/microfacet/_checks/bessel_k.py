"""Bessel K: the checks of its notebook, and the Lambda it does not print. Printed forms come first."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from mpmath import mp

from microfacet._checks import closed, integrals, k0, routes
from microfacet._checks.check import CLOSED_FORM, QUADRATURE, Check, Sides, both, notebook
from microfacet._checks.routes import Array

FAMILY = "bessel_k"
GRID = tuple(
    {"alpha": alpha, "a": a}
    for alpha, a in product((1e-4, 0.1, 0.7, 1.0, 10.0), (0.05, 0.3, 0.5, 1.0, 1.3, 1.5, 2.0, 10.0, 150.0))
)
COVERED = {"a": (0.01, 1e4)}  # what the second routes have been made for
ENTRY: dict[str, Any] = {"parameters": {"alpha": 0.6, "a": 1.6}, "source": notebook("Bessel K")}
BEYOND: dict[str, Any] = {**ENTRY, "notebook": False}


def D(u: Any, alpha: Any, a: Any) -> Any:
    """The definition; the notebook's integral over the chi distribution returns the same in other powers."""
    s = mp.sqrt(1 - u**2)
    return (
        2
        * s ** (a - 1)
        * (u * alpha) ** -a
        * mp.besselk(1 - a, 2 * s / (u * alpha))
        / (mp.pi * u**3 * alpha * mp.gamma(a))
    )


def D_of_chi(u: Any, alpha: Any, a: Any) -> Any:
    s = mp.sqrt(1 - u**2)
    power = (u * alpha) ** (-1 - a)
    return 2 * s ** (a - 1) * power * mp.besselk(a - 1, 2 * s / (u * alpha)) / (mp.pi * u**2 * mp.gamma(a))


def f(y: Any, a: Any) -> Any:
    return 2 * y ** (a - 1) * mp.besselk(a - 1, 2 * y) / (mp.pi * mp.gamma(a))


def P22(r2: Any, alpha: Any, a: Any) -> Any:
    return f(mp.sqrt(r2) / alpha, a) / alpha**2


def P2(p: Any, alpha: Any, a: Any) -> Any:
    t, nu = abs(p) / alpha, a - mp.mpf(1) / 2
    return 2 * t**nu * mp.besselk(nu, 2 * t) / (mp.sqrt(mp.pi) * mp.gamma(a) * alpha)


def survival(r: Any, alpha: Any, a: Any) -> Any:
    y = r / alpha
    return 2 * y**a * mp.besselk(a, 2 * y) / mp.gamma(a)


# A rounding of u moves the squared slope by eps/2: of little weight next to a logarithm, not next to a power.
CAP = integrals.Cap(
    lambda alpha, a: 1e-7 if a >= 1 else alpha / 10,
    lambda r, alpha, a: 1 - survival(r, alpha, a),
    r"those of slopes below $10^{-7}$, for $a<1$ below $\alpha/10$, which cosines in double precision do not"
    " resolve, come in closed form",
)
LEAST = 1e-140  # slope/alpha; below it lies a mass of 1e-14 at a = 0.05


def lambda_of_u(u: Any, alpha: Any, a: Any) -> Any:
    """By the modified Struve function L; of the two terms the second is Pr(slope > cot(theta))."""
    x, nu = u / (alpha * mp.sqrt((1 - u) * (1 + u))), a - mp.mpf(1) / 2
    mean = x**nu * mp.besselk(nu + 1, 2 * x) / (mp.sqrt(mp.pi) * mp.gamma(a))
    products = mp.besselk(nu, 2 * x) * mp.struvel(nu - 1, 2 * x)
    products += mp.struvel(nu, 2 * x) * mp.besselk(nu - 1, 2 * x)
    return mean - (mp.mpf(1) / 2 - x * products)


def _draw(rng: np.random.Generator, n: int, alpha: float, a: float) -> Array:
    chi2 = 2 * rng.standard_gamma(a, n)
    return np.asarray(1 / np.sqrt(1 - alpha**2 * chi2 / 2 * np.log(1 - rng.random(n))))


def _gamma_mixture(k: Any, alpha: float, a: float) -> Sides:
    u = routes.cosine(routes.slopes(alpha))
    average = routes.gamma_average(lambda b, u: routes.kernels("beckmann").D(u, alpha * np.sqrt(b)), a, u)
    return k.D(u, alpha, a), average


def _chi_mixture(k: Any, alpha: float, a: float) -> Sides:
    """The density of n ~ Chi(2a) is 2^(1-a) n^(2a-1) exp(-n^2/2)/Gamma(a); here n = sqrt(2a) e^d."""
    u, c = routes.cosine(routes.slopes(alpha)), routes.stirling(a)

    def integrand(d: Array, u: Array) -> Array:
        density = 2 * np.exp(a * (2 * d - np.expm1(2 * d)) - c)
        roughness = alpha * np.sqrt(a) * np.exp(d)
        return np.asarray(density * routes.kernels("beckmann").D(u, roughness), dtype=np.float64)

    top = max(np.log(1000 / a), 60 / np.sqrt(a)) / 2
    return k.D(u, alpha, a), routes.integrate_exponent(integrand, -50.0, top, u, panels=1000)


def _out_of_reach(alpha: float, a: float) -> str:
    return "" if a >= 0.05 else "slopes that doubles do not reach bear some of the mass"


def _k0(k: Any, alpha: float, a: float) -> Sides:
    return closed.special_case(lambda name: lambda at, alpha: getattr(k, name)(at, alpha, a), alpha, k0)


def _lambda(k: Any, *parameters: float) -> Sides:
    u = routes.incident_cosines(parameters[0])
    mu = 1 / routes.slope_of(u)
    return both(
        (k.Lambda(u, *parameters), routes.exact(lambda_of_u, u, *parameters)),
        (k.Lambda(u, *parameters), routes.mean_excess(k, mu, *parameters) / mu),
    )


CHECKS: tuple[Check, ...] = (
    closed.density(
        D,
        r"D(u) = \frac{2\,(1-u^2)^{(a-1)/2}\,(u\,\alpha)^{-a}}{\pi u^3\alpha\,\Gamma(a)}"
        r"\,K_{1-a}\Big(\frac{2\sqrt{1-u^2}}{u\,\alpha}\Big)\,\Theta(u)",
        remark="; at $u=1$ it has no value",
        **ENTRY,
    ),
    closed.density(
        D_of_chi,
        r"D(u) = \frac{2\,(1-u^2)^{(a-1)/2}\,(u\,\alpha)^{-1-a}}{\pi u^2\,\Gamma(a)}"
        r"\,K_{a-1}\Big(\frac{2\sqrt{1-u^2}}{u\,\alpha}\Big)\,\Theta(u)",
        name="density_of_chi",
        remark=", here as the average over $n$ returns it",
        **ENTRY,
    ),
    Check(
        "gamma_mixture",
        r"Bessel K is Beckmann of roughness $\alpha\sqrt{b}$, averaged over $b\sim\mathrm{Gamma}(a, 1)$",
        r"D(u) = \int_0^\infty \frac{b^{a-1}e^{-b}}{\Gamma(a)}\,D_{\mathrm{Beckmann}}(u; \alpha\sqrt{b})\,db",
        _gamma_mixture,
        QUADRATURE,
        **ENTRY,
    ),
    Check(
        "chi_mixture",
        r"Bessel K is Beckmann of roughness $\alpha n/\sqrt{2}$, averaged over $n\sim\mathrm{Chi}(2a)$",
        r"D(u) = \int_0^\infty \frac{n^{2a-1}e^{-n^2/2}}{2^{a-1}\Gamma(a)}\,"
        r"D_{\mathrm{Beckmann}}\big(u; \tfrac{\alpha n}{\sqrt2}\big)\,dn",
        _chi_mixture,
        QUADRATURE,
        **ENTRY,
    ),
    closed.shape_invariant(
        f,
        r"$\alpha^2 u^4 D$ depends on $y=\tan\theta/\alpha$ and on $a$ alone",
        r"\alpha^2 u^4 D(u) = f(y) = \frac{2 y^{a-1} K_{a-1}(2y)}{\pi\,\Gamma(a)}",
        **ENTRY,
    ),
    integrals.normalization(CAP, **ENTRY),
    closed.slopes_from_D(
        P22,
        r"P_{22}(p, q) = D(u)\,u^4 = \frac{2 r^{a-1}\alpha^{-1-a}}{\pi\,\Gamma(a)}\,"
        r"K_{a-1}\Big(\frac{2r}{\alpha}\Big), \quad r = \sqrt{p^2+q^2}",
        **ENTRY,
    ),
    integrals.slopes_normalized(LEAST, unless=_out_of_reach, **ENTRY),
    integrals.sampling(
        _draw,
        r"u = \frac{1}{\sqrt{1 - \frac{(\alpha n)^2}{2}\ln\xi}}, \quad n \sim \mathrm{Chi}(2a)",
        CAP,
        **{**ENTRY, "parameters": {"alpha": 0.7, "a": 1.3}},
    ),
    Check(
        "lambda",
        r"$\Lambda$, not printed in the notebook, is a sum of Bessel functions $K$ and modified Struve"
        " functions $L$, and follows from $P_2$",
        r"\Lambda = \frac{x^\nu K_{\nu+1}(2x)}{\sqrt{\pi}\,\Gamma(a)} - \frac12"
        r" + x\,[K_\nu L_{\nu-1} + L_\nu K_{\nu-1}](2x), \quad x = \frac{\cot\theta}{\alpha}, \quad"
        r" \nu = a - \tfrac12",
        _lambda,
        QUADRATURE,
        **BEYOND,
    ),
    integrals.sigma_delta(CAP, **BEYOND),
    integrals.marginal(
        P2,
        r"P_2(p) = \int_{-\infty}^{\infty} P_{22}(p, q)\,dq"
        r" = \frac{2|t|^\nu K_\nu(2|t|)}{\sqrt{\pi}\,\Gamma(a)\,\alpha},"
        r"\quad t = \frac{p}{\alpha}, \quad \nu = a - \tfrac12",
        **BEYOND,
    ),
    integrals.survival(
        survival, r"\Pr(\tan\theta > r) = \frac{2y^a K_a(2y)}{\Gamma(a)}, \quad y = r/\alpha", **ENTRY
    ),
    Check(
        "k0",
        r"Bessel K at $a=1$ is K0: $D$, $P_2$, $\Lambda$ and $\sigma$",
        r"D(u; \alpha, a = 1) = D_{K_0}(u; \alpha)",
        _k0,
        CLOSED_FORM,
        parameters={"alpha": 0.8, "a": 1.0},
        fixed=frozenset({"a"}),
        source=notebook("Bessel K"),
        notebook=False,
    ),
)
