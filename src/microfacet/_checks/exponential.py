"""Exponential: the checks of its notebook, which approximates Lambda. The printed forms come first."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp

from microfacet._checks import bessel_k, closed, integrals, routes
from microfacet._checks.check import CLOSED_FORM, QUADRATURE, Check, Sides, both, notebook
from microfacet._checks.routes import Array

FAMILY = "exponential"
GRID = tuple({"alpha": alpha} for alpha in (1e-4, 1e-2, 0.1, 0.8, 1.0, 2.1, 10.0))
ENTRY: dict[str, Any] = {"parameters": {"alpha": 0.8}, "source": notebook("Exponential")}
BEYOND: dict[str, Any] = {**ENTRY, "notebook": False}
A = 1.5  # the Bessel K that it is


def f(y: Any) -> Any:
    return 2 * mp.exp(-2 * y) / mp.pi


def D(u: Any, alpha: Any) -> Any:
    return 2 * mp.exp(-2 * mp.sqrt(1 - u**2) / (u * alpha)) / (mp.pi * u**4 * alpha**2)


def P22(r2: Any, alpha: Any) -> Any:
    return f(mp.sqrt(r2) / alpha) / alpha**2


def P2(p: Any, alpha: Any) -> Any:
    t = abs(p) / alpha
    return 4 * t * mp.besselk(1, 2 * t) / (mp.pi * alpha)


def survival(r: Any, alpha: Any) -> Any:
    return (1 + 2 * r / alpha) * mp.exp(-2 * r / alpha)


def lambda_of_u(u: Any, alpha: Any) -> Any:
    return bessel_k.lambda_of_u(u, alpha, mp.mpf(A))


def sigma(u: Any, alpha: Any) -> Any:
    """Both sides of the horizon."""
    return max(u, 0) + abs(u) * lambda_of_u(abs(u), alpha)


def lambda_of_ei(x: Any) -> Any:
    """That of the Ei density, by which the notebook approximates."""
    mean = mp.exp(-(x**2)) * (1 + x**2) / (3 * mp.sqrt(mp.pi) * x)
    return mean - (3 + 2 * x**2) * mp.erfc(x) / 6


def _draw(rng: np.random.Generator, n: int, alpha: float) -> Array:
    """Beckmann of roughness alpha sqrt(b), b ~ Gamma(3/2, 1)."""
    squares = -rng.standard_gamma(A, n) * np.log(1 - rng.random(n))
    return np.asarray(1 / np.sqrt(1 + alpha**2 * squares))


def _gamma_mixture(k: Any, alpha: float) -> Sides:
    u = routes.cosine(routes.slopes(alpha))
    average = routes.gamma_average(lambda b, u: routes.kernels("beckmann").D(u, alpha * np.sqrt(b)), A, u)
    return k.D(u, alpha), average


def _chi_mixture(k: Any, alpha: float) -> Sides:
    """The density of n ~ Chi(3) is sqrt(2/pi) n^2 exp(-n^2/2); here n = e^d."""
    u = routes.cosine(routes.slopes(alpha))

    def integrand(d: Array, u: Array) -> Array:
        density = np.sqrt(2 / np.pi) * np.exp(3 * d - np.exp(2 * d) / 2)
        rough = routes.kernels("beckmann").D(u, alpha * np.exp(d) / np.sqrt(2))
        return np.asarray(density * rough, dtype=np.float64)

    return k.D(u, alpha), routes.integrate_exponent(integrand, -25.0, 4.0, u, panels=400)


_AT = (1e-5, 0.1, 0.2, 0.5, 1.0, 1.2, 1.5, 2.0, 3.0, 4.0)  # cot(theta)/alpha


def _approximated(k: Any, alpha: float) -> Sides:
    """The least ratio of the approximation to G1: by the library, by the exact Lambda, as stated."""
    mu = alpha * np.array(_AT)
    u = mu / np.hypot(1.0, mu)

    def approximation(u: Any, alpha: Any) -> Any:
        return 1 / (1 + lambda_of_ei(1 / (alpha * routes.tan2(u) ** 0.5) / mp.mpf("1.7")))

    def ratio(u: Any, alpha: Any) -> Any:
        return approximation(u, alpha) * (1 + lambda_of_u(u, alpha))

    ours = np.min(routes.exact(approximation, u, alpha) / k.G1(u, alpha))
    return both(([ours], [np.min(routes.exact(ratio, u, alpha))]), ([np.round(ours, 5)], [0.99563]))


def _bessel_k(k: Any, alpha: float) -> Sides:
    """D, P2, Lambda, sigma against the same of Bessel K, which are other code of the library."""
    return closed.special_case(lambda name: lambda at, alpha: getattr(k, name)(at, alpha), alpha, _Forms)


class _Forms:
    """Bessel K's printed forms at a = 3/2."""

    @staticmethod
    def P22(r2: Any, alpha: Any) -> Any:
        return bessel_k.P22(r2, alpha, mp.mpf(A))

    @staticmethod
    def P2(p: Any, alpha: Any) -> Any:
        return bessel_k.P2(p, alpha, mp.mpf(A))

    lambda_of_u = staticmethod(lambda_of_u)
    sigma = staticmethod(sigma)


def _lambda(k: Any, alpha: float) -> Sides:
    u = routes.incident_cosines(alpha)
    mu = 1 / routes.slope_of(u)
    return both(
        (k.Lambda(u, alpha), routes.exact(lambda_of_u, u, alpha)),
        (k.Lambda(u, alpha), routes.mean_excess(k, mu, alpha) / mu),
    )


CHECKS: tuple[Check, ...] = (
    closed.density(
        D,
        r"D(u) = \frac{2\,\Theta(u)}{\pi\alpha^2u^4}\exp\left(-\frac{2\sqrt{1-u^2}}{u\,\alpha}\right)",
        **ENTRY,
    ),
    Check(
        "gamma_mixture",
        r"Exponential is Beckmann of roughness $\alpha\sqrt{b}$, averaged over"
        r" $b\sim\mathrm{Gamma}(3/2, 1)$",
        r"D(u) = \frac{2}{\sqrt\pi}\int_0^\infty \sqrt{b}\,e^{-b}\,"
        r"D_{\mathrm{Beckmann}}(u; \alpha\sqrt{b})\,db",
        _gamma_mixture,
        QUADRATURE,
        **ENTRY,
    ),
    Check(
        "chi_mixture",
        r"Exponential is Beckmann of roughness $\alpha n/\sqrt{2}$, averaged over $n\sim\mathrm{Chi}(3)$",
        r"D(u) = \sqrt{\tfrac{2}{\pi}}\int_0^\infty n^2 e^{-n^2/2}\,"
        r"D_{\mathrm{Beckmann}}\big(u; \tfrac{\alpha n}{\sqrt2}\big)\,dn",
        _chi_mixture,
        QUADRATURE,
        **ENTRY,
    ),
    closed.shape_invariant(
        f,
        r"$\alpha^2 u^4 D$ depends on $y=\tan\theta/\alpha$ alone",
        r"\alpha^2 u^4 D(u) = f(y) = \frac{2 e^{-2y}}{\pi}",
        **ENTRY,
    ),
    integrals.normalization(**BEYOND),
    closed.slopes_from_D(
        P22,
        r"P_{22}(p, q) = D(u)\,u^4 = \frac{2}{\pi\alpha^2}\exp\Big(-\frac{2\sqrt{p^2+q^2}}{\alpha}\Big)",
        **ENTRY,
    ),
    integrals.slopes_normalized(**ENTRY),
    integrals.sigma_delta(**{**ENTRY, "parameters": {"alpha": 2.1}}),
    Check(
        "masking_by_ei",
        r"The notebook, for which $\Lambda$ is unknown, takes that of Ei at $1.7\,\alpha$: its $G_1$ is off"
        r" by up to $0.437\,\%$, at grazing angles. The rational function that it fits to $G_1$ next is one"
        r" of $x/1.7$, but is printed with the argument $x$, where it is up to $71\,\%$ off",
        r"\min_x \frac{1 + \Lambda(x)}{1 + \Lambda_{\mathrm{Ei}}(x/1.7)} = 0.99563, \quad"
        r" x = \frac{\cot\theta}{\alpha}",
        _approximated,
        CLOSED_FORM,
        **ENTRY,
    ),
    integrals.sampling(
        _draw,
        r"u = \frac{1}{\sqrt{1 - \frac{(\alpha n)^2}{2}\ln\xi}}, \quad n \sim \mathrm{Chi}(3)",
        **{**ENTRY, "parameters": {"alpha": 2.3}},
    ),
    Check(
        "lambda",
        r"$\Lambda$ is that of Bessel K at $a = 3/2$, a sum of Bessel functions $K$ and modified Struve"
        " functions $L$, and follows from $P_2$",
        r"\Lambda = \frac{2x K_2(2x)}{\pi} - \frac12 + x\,[K_1 L_0 + L_1 K_0](2x),"
        r" \quad x = \frac{\cot\theta}{\alpha}",
        _lambda,
        QUADRATURE,
        **BEYOND,
    ),
    integrals.marginal(
        P2,
        r"P_2(p) = \int_{-\infty}^{\infty} P_{22}(p, q)\,dq = \frac{4t K_1(2t)}{\pi\alpha},"
        r"\quad t = \frac{|p|}{\alpha}",
        **BEYOND,
    ),
    integrals.survival(survival, r"\Pr(\tan\theta > r) = (1 + 2y)\,e^{-2y}, \quad y = r/\alpha", **ENTRY),
    Check(
        "bessel_k",
        r"Exponential is Bessel K at $a=3/2$: $D$, $P_2$, $\Lambda$ and $\sigma$",
        r"D(u; \alpha) = D_{\mathrm{Bessel\,K}}(u; \alpha, a = \tfrac32)",
        _bessel_k,
        CLOSED_FORM,
        **BEYOND,
    ),
)
