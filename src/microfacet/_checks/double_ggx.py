"""Double GGX: the checks of its notebook, and the marginal it does not print. Printed forms come first."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp

from microfacet._checks import closed, integrals, routes
from microfacet._checks.check import CLOSED_FORM, QUADRATURE, Check, Sides, both, notebook
from microfacet._checks.routes import Array

FAMILY = "double_ggx"
GRID = tuple({"alpha": alpha} for alpha in (1e-4, 1e-2, 0.1, 0.5, 1.0, 3.0, 10.0))
ENTRY: dict[str, Any] = {"parameters": {"alpha": 0.7}, "source": notebook("Double GGX")}
BEYOND: dict[str, Any] = {**ENTRY, "notebook": False}


def D(u: Any, alpha: Any) -> Any:
    s2 = (1 - u) * (1 + u)
    w = (alpha * u) ** 2 / s2
    return -(alpha**2) * (s2 + mp.exp(w) * (s2 + (alpha * u) ** 2) * mp.ei(-w)) / (mp.pi * s2**3)


def _U(x: Any) -> Any:
    """sqrt(pi) times Tricomi's function, of x = cot(theta)/alpha."""
    return mp.sqrt(mp.pi) * mp.hyperu(-mp.mpf(1) / 2, 0, 1 / x**2)


def lambda_of_x(x: Any) -> Any:
    return (_U(x) - 1) / 2


def bessel_lambda_of_x(x: Any) -> Any:
    z = 1 / (2 * x**2)
    return (z * mp.exp(z) * (mp.besselk(0, z) + mp.besselk(1, z)) - 1) / 2


def _x(u: Any, alpha: Any) -> Any:
    return u / (alpha * mp.sqrt((1 - u) * (1 + u)))


def lambda_of_u(u: Any, alpha: Any) -> Any:
    return lambda_of_x(_x(u, alpha))


def sigma(u: Any, alpha: Any) -> Any:
    return (u + abs(u) * _U(_x(u, alpha))) / 2


def P22(r2: Any, alpha: Any) -> Any:
    w = alpha**2 / r2
    return -(alpha**2) * (r2 + mp.exp(w) * (r2 + alpha**2) * mp.ei(-w)) / (mp.pi * r2**3)


def P2(p: Any, alpha: Any) -> Any:
    t = abs(p) / alpha
    z = 1 / (2 * t**2)
    bracket = (1 + 2 * z) * mp.besselk(0, z) - 2 * z * mp.besselk(1, z)
    return z / t * mp.exp(z) * bracket / alpha


def survival(r: Any, alpha: Any) -> Any:
    w = (alpha / r) ** 2
    return w * mp.exp(w) * mp.e1(w)


def _draw(rng: np.random.Generator, n: int, alpha: float) -> Array:
    xi = rng.random(n)
    return np.asarray(1 / np.sqrt(1 - alpha**2 * xi / ((1 - xi) * np.log(1 - rng.random(n)))))


def _ggx_mixture(k: Any, alpha: float) -> Sides:
    def mean(name: str, at: Array) -> Array:
        ggx = getattr(routes.kernels("ggx"), name)
        return routes.gamma_average(lambda b, u: ggx(u, alpha / np.sqrt(b)), 1.0, at)

    normal, u = routes.cosine(routes.slopes(alpha)), routes.incident_cosines(alpha)
    places = (("D", normal), ("sigma", u), ("sigma", -u), ("Lambda", u))
    return both(*((getattr(k, name)(at, alpha), mean(name, at)) for name, at in places))


def _bessel(k: Any, alpha: float) -> Sides:
    u = routes.incident_cosines(alpha)
    return k.Lambda(u, alpha), routes.exact(lambda u, alpha: bessel_lambda_of_x(_x(u, alpha)), u, alpha)


CHECKS: tuple[Check, ...] = (
    closed.density(
        D,
        r"D(u) = -\frac{\alpha^2\,\Theta(u)}{\pi(1-u^2)^3}\left(1-u^2"
        r" + e^w\,(1+u^2(\alpha^2-1))\,\mathrm{Ei}(-w)\right), \quad w = \frac{\alpha^2u^2}{1-u^2}",
        remark="; at $u=1$ it is 0/0",
        **ENTRY,
    ),
    *closed.projected_area(sigma, lambda_of_u, **ENTRY),
    closed.lambda_of_x(
        lambda_of_x,
        r"$\Lambda$ depends on $x=\cot\theta/\alpha$ alone",
        r"\Lambda = \frac{1}{2}\left(\sqrt{\pi}\,U\Big({-\frac{1}{2}}, 0, \frac{1}{x^2}\Big) - 1\right)",
        **ENTRY,
    ),
    Check(
        "lambda_bessel",
        r"Tricomi's function $U$ in $\Lambda$ is a sum of two Bessel functions",
        r"\Lambda = \frac{1}{2}\left(z e^z (K_0(z) + K_1(z)) - 1\right),"
        r"\quad z = \frac{1}{2x^2}, \quad x = \frac{\cot\theta}{\alpha}",
        _bessel,
        CLOSED_FORM,
        **ENTRY,
    ),
    closed.shape_invariant(
        lambda y: -(y**2 + mp.exp(1 / y**2) * (1 + y**2) * mp.ei(-1 / y**2)) / (mp.pi * y**6),
        r"$\alpha^2 u^4 D$ depends on $y=\tan\theta/\alpha$ alone",
        r"\alpha^2 u^4 D(u) = f(y) = -\frac{y^2 + e^{1/y^2}(1+y^2)\,\mathrm{Ei}(-1/y^2)}{\pi y^6}",
        **ENTRY,
    ),
    Check(
        "ggx_mixture",
        r"Double GGX is GGX of roughness $\alpha/\sqrt{b}$, averaged over $b$ with density $e^{-b}$, as GGX"
        r" is Beckmann: $D$, $\sigma$ and $\Lambda$",
        r"D(u) = \int_0^\infty e^{-b}\,D_{\mathrm{GGX}}\Big(u; \frac{\alpha}{\sqrt{b}}\Big)\,db",
        _ggx_mixture,
        QUADRATURE,
        **ENTRY,
    ),
    closed.slopes_from_D(
        P22,
        r"P_{22}(p, q) = D(u)\,u^4 = -\frac{\alpha^2}{\pi r^6}\left(r^2 + e^{\alpha^2/r^2}(r^2+\alpha^2)\,"
        r"\mathrm{Ei}\Big({-\frac{\alpha^2}{r^2}}\Big)\right), \quad r^2 = p^2+q^2",
        **ENTRY,
    ),
    integrals.slopes_normalized(**ENTRY),
    integrals.sigma_delta(**ENTRY),
    integrals.normalization(**BEYOND),
    integrals.sampling(_draw, r"u = \frac{1}{\sqrt{1 - \frac{\alpha^2\xi_1}{(1-\xi_1)\ln\xi_2}}}", **BEYOND),
    integrals.marginal(
        P2,
        r"P_2(p) = \int_{-\infty}^{\infty} P_{22}(p, q)\,dq"
        r" = \frac{z e^z}{|p|}\left((1+2z)K_0(z) - 2z K_1(z)\right), \quad z = \frac{\alpha^2}{2p^2}",
        **BEYOND,
    ),
    integrals.lambda_from_marginal(**BEYOND),
    integrals.survival(
        survival, r"\Pr(\tan\theta > r) = w e^w E_1(w), \quad w = \frac{\alpha^2}{r^2}", **ENTRY
    ),
)
