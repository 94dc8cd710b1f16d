"""GGX: the checks of its notebook, where it is two mixtures of Beckmann. Printed forms come first."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp

from microfacet._checks import closed, integrals, routes, symbolic
from microfacet._checks.check import QUADRATURE, Check, Sides, both, notebook
from microfacet._checks.routes import Array

FAMILY = "ggx"
GRID = tuple({"alpha": alpha} for alpha in (1e-4, 1e-2, 0.1, 0.5, 1.0, 3.0, 10.0))
ENTRY: dict[str, Any] = {"parameters": {"alpha": 0.2}, "source": notebook("Ground Glass (GGX)")}
BEYOND: dict[str, Any] = {
    "parameters": {"alpha": 0.6},
    "source": "Trowbridge and Reitz 1975; Walter et al. 2007",
    "notebook": False,
}


def lambda_of_x(x: Any) -> Any:
    return (mp.sqrt(1 + 1 / x**2) - 1) / 2


def lambda_of_u(u: Any, alpha: Any) -> Any:
    return lambda_of_x(u / (alpha * mp.sqrt((1 - u) * (1 + u))))


def sigma(u: Any, alpha: Any) -> Any:
    return (u + mp.sqrt(u**2 + alpha**2 * (1 - u) * (1 + u))) / 2


def D(u: Any, alpha: Any) -> Any:
    return alpha**2 / (mp.pi * (1 + u**2 * (alpha**2 - 1)) ** 2)


def P22(r2: Any, alpha: Any) -> Any:
    return alpha**2 / (mp.pi * (r2 + alpha**2) ** 2)


def P2(p: Any, alpha: Any) -> Any:
    return alpha**2 / (2 * mp.sqrt(p**2 + alpha**2) ** 3)


def _draw(rng: np.random.Generator, n: int, alpha: float) -> Array:
    xi = rng.random(n)
    return np.asarray(1 / np.sqrt(1 + alpha**2 * xi / (1 - xi)))


def _frechet_mean(function: Any, alpha: float, points: Any) -> Array:
    """Mean of ``function(b, point)`` over b with Frechet's density 2 alpha^2 exp(-(alpha/b)^2)/b^3."""

    def integrand(b: Array, point: Array) -> Array:
        weight = 2 * (alpha / b) ** 2 * np.exp(-((alpha / b) ** 2)) / b
        return np.asarray(weight * function(b, point), dtype=np.float64)

    return routes.integrate(integrand, 1e-3 * alpha, 1e40 * alpha, points)


def _frechet_mixture(k: Any, alpha: float) -> Sides:
    u = routes.cosine(routes.slopes(alpha))
    return k.D(u, alpha), _frechet_mean(lambda b, u: routes.kernels("beckmann").D(u, b), alpha, u)


def _gamma_mixture(k: Any, alpha: float) -> Sides:
    u = routes.cosine(routes.slopes(alpha))
    beckmann = routes.kernels("beckmann")
    return k.D(u, alpha), routes.gamma_average(lambda b, u: beckmann.D(u, alpha / np.sqrt(b)), 1.0, u)


def _lambda_mixture(k: Any, alpha: float) -> Sides:
    u = routes.incident_cosines(alpha)
    return k.Lambda(u, alpha), _frechet_mean(lambda b, u: routes.kernels("beckmann").Lambda(u, b), alpha, u)


def _mean_roughness(k: Any, alpha: float) -> Sides:
    """The mean of abs(p) is b/sqrt(pi) for Beckmann, and always twice sigma(0)."""
    mean = _frechet_mean(lambda b, _: b, alpha, [0.0])
    return both((mean, [np.sqrt(np.pi) * alpha]), (2 * np.sqrt(np.pi) * k.sigma([0.0], alpha), mean))


def _unbounded_square(k: Any, alpha: float) -> Sides:
    ends = 10.0 ** np.arange(0.0, 31.0, 6.0)
    squares = routes.integrate(
        lambda r: 2 * np.pi * r**3 * k.P22(r, 0.0, alpha), routes.NEAR * alpha, ends * alpha
    )
    return squares / alpha**2, np.log1p(ends**2) - ends**2 / (1 + ends**2)


CHECKS: tuple[Check, ...] = (
    closed.density(D, r"D(u) = \frac{\alpha^2\,\Theta(u)}{\pi(1+u^2(\alpha^2-1))^2}", **ENTRY),
    *closed.projected_area(sigma, lambda_of_u, symbolic=symbolic.GGX, **ENTRY),
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
        **BEYOND,
    ),
    Check(
        "frechet_mixture",
        r"GGX is Beckmann of a roughness $b$ that has a Frechet distribution of shape 2 and scale $\alpha$",
        r"D(u) = \int_0^\infty \frac{2\alpha^2}{b^3}\,e^{-\alpha^2/b^2}\,D_{\mathrm{Beckmann}}(u; b)\,db",
        _frechet_mixture,
        QUADRATURE,
        **ENTRY,
    ),
    Check(
        "gamma_mixture",
        r"GGX is Beckmann of roughness $\alpha/\sqrt{b}$, averaged over $b\sim\mathrm{Gamma}(1, 1)$",
        r"D(u) = \int_0^\infty e^{-b}\,D_{\mathrm{Beckmann}}\Big(u; \frac{\alpha}{\sqrt{b}}\Big)\,db",
        _gamma_mixture,
        QUADRATURE,
        **ENTRY,
    ),
    Check(
        "lambda_mixture",
        r"$\Lambda$ is the same mean of Beckmann's",
        r"\Lambda(u) = \int_0^\infty \frac{2\alpha^2}{b^3}\,e^{-\alpha^2/b^2}\,"
        r"\Lambda_{\mathrm{Beckmann}}(u; b)\,db",
        _lambda_mixture,
        QUADRATURE,
        **ENTRY,
    ),
    Check(
        "mean_roughness",
        r"The mean roughness of these Beckmann surfaces is $\sqrt{\pi}\,\alpha$, and $\sigma(0)$ has it",
        r"\int_0^\infty \frac{2\alpha^2}{b^2}\,e^{-\alpha^2/b^2}\,db = \sqrt{\pi}\,\alpha"
        r" = 2\sqrt{\pi}\,\sigma(0)",
        _mean_roughness,
        QUADRATURE,
        **ENTRY,
    ),
    Check(
        "unbounded_mean_square",
        "The mean square roughness of the mixture, and with it that of the slopes, is unbounded: it grows as"
        " the logarithm of the steepest slope that counts",
        r"\int_0^R 2\pi r^3 P_{22}\,dr = \alpha^2\left(\ln\Big(1 + \frac{R^2}{\alpha^2}\Big)"
        r" - \frac{R^2}{R^2+\alpha^2}\right) \to \infty",
        _unbounded_square,
        QUADRATURE,
        **ENTRY,
    ),
    integrals.survival(
        lambda r, alpha: alpha**2 / (alpha**2 + r**2),
        r"\Pr(\tan\theta > r) = \frac{\alpha^2}{\alpha^2 + r^2}",
        **ENTRY,
    ),
)
