"""Dirac: the checks of its notebook, two of whose forms lack a factor. The forms with it come first.

The notebook gives the cosine u_d of the ring, here its slope alpha = sqrt(1 - u_d^2)/u_d is given. No number
is the density: what is checked are its integrals.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from mpmath import mp

from microfacet._checks import closed, routes
from microfacet._checks.check import CLOSED_FORM, QUADRATURE, Check, Sides, both, notebook
from microfacet._checks.routes import Array

FAMILY = "dirac"
GRID = tuple({"alpha": alpha} for alpha in (1e-4, 1e-2, 0.1, 0.6, 1.0, 3.0, 10.0))
ENTRY: dict[str, Any] = {"parameters": {"alpha": 0.6}, "source": notebook("Dirac Delta")}
BEYOND: dict[str, Any] = {**ENTRY, "notebook": False}
SHARES = (0.0, 0.05, 0.3, 0.7, 0.95)  # of alpha: where the slopes end all is singular


def cosine_of_ring(alpha: Any) -> Any:
    return 1 / mp.sqrt(1 + alpha**2)


def sigma(u: Any, alpha: Any) -> Any:
    """As it is printed, over 2 pi u_d."""
    ud = cosine_of_ring(alpha)
    sines = mp.sqrt((1 - u) * (1 + u) * (1 - ud) * (1 + ud))
    printed = mp.re(2 * (mp.sqrt(1 - u**2 - ud**2) + u * ud * mp.acos(-u * ud / sines)))
    return printed / (2 * mp.pi * ud)


def lambda_of_u(u: Any, alpha: Any) -> Any:
    return sigma(u, alpha) / u - 1


def lambda_of_x(x: Any) -> Any:
    return (mp.sqrt(1 - x**2) / x - mp.acos(x)) / mp.pi if x < 1 else mp.mpf(0)


def P2(p: Any, alpha: Any) -> Any:
    """Twice what is printed."""
    ud = cosine_of_ring(alpha)
    return 2 * ud / (2 * mp.pi * mp.sqrt(1 - (1 + p**2) * ud**2)) if abs(p) < alpha else mp.mpf(0)


def _directions(alpha: float) -> Array:
    mu = alpha * np.array([0.1, 0.3, 0.5, 0.8, 0.95, 1.5, 3.0])
    return np.asarray(mu / np.hypot(1.0, mu), dtype=np.float64)


def _upper(k: Any, alpha: float) -> Sides:
    u = _directions(alpha)
    return both(
        (k.sigma(u, alpha), routes.exact(sigma, u, alpha)),
        (u * (1 + k.Lambda(u, alpha)), routes.exact(sigma, u, alpha)),
    )


def _lower(k: Any, alpha: float) -> Sides:
    u = _directions(alpha)[:5]  # from below nobody sees a slope of less than cot(theta)
    return both(
        (k.sigma(-u, alpha), routes.exact(lambda u, a: sigma(-u, a), u, alpha)),
        (u * k.Lambda(u, alpha), routes.exact(lambda u, a: u * lambda_of_u(u, a), u, alpha)),
    )


def _of_x(k: Any, alpha: float) -> Sides:
    def of_u(u: Any, alpha: Any) -> Any:
        return lambda_of_x(1 / (alpha * routes.tan2(u) ** 0.5))

    u, thrice = _directions(alpha)[:5], _directions(alpha / 3)[:5]
    return both(
        (k.Lambda(u, alpha), routes.exact(of_u, u, alpha)),
        (k.Lambda(thrice, alpha / 3), routes.exact(of_u, thrice, alpha / 3)),
    )


def _mass(k: Any, alpha: float) -> Sides:
    at = alpha * np.array([1e-9, 0.5, 1 - 1e-12, 1 + 1e-12, 3.0])
    return k.survival(at, alpha), [1.0, 1.0, 1.0, 0.0, 0.0]


def _along_an_axis(k: Any, alpha: float) -> Sides:
    """P2 up to alpha/sqrt(2) by the midpoint rule in p = alpha sin(phi), the library's tail beyond."""
    phi = np.pi / 4 * (np.arange(16) + 0.5) / 16
    p, weight = alpha * np.sin(phi), alpha * np.cos(phi)
    inner = np.pi / 64 * np.sum(k.P2(p, alpha) * weight)  # of p from 0 to alpha/sqrt(2)
    rest = k.slope_cdf(-alpha / np.sqrt(2), alpha)
    return [2 * (inner + rest)], [1.0]


def _marginal(k: Any, alpha: float) -> Sides:
    p = alpha * np.array([-0.3, *SHARES, 1.5])
    return k.P2(p, alpha), routes.exact(P2, p, alpha)


def _lambda(k: Any, alpha: float) -> Sides:
    """With q = alpha cos(f), where P2 dq is df/pi: by a Gauss rule whose nodes keep off the end."""
    u = _directions(alpha)[:4]
    mu = (1 / routes.slope_of(u))[:, np.newaxis]
    nodes, weights = np.polynomial.legendre.leggauss(8)
    last = np.arccos(mu / alpha)
    f = last * (nodes + 1) / 2
    q = alpha * np.cos(f)
    mean = np.sum((q - mu) * k.P2(q, alpha) * alpha * np.sin(f) * weights, axis=-1) * last[:, 0] / 2
    return k.Lambda(u, alpha), mean / mu[:, 0]


def _sampled(k: Any, alpha: float) -> Sides:
    xi = np.linspace(0.0, 0.99, 5)
    cosine = float(1 / np.hypot(1.0, alpha))
    return both((k.sample_slope(xi, alpha), np.full(5, alpha)), (k.sample_u(xi, alpha), np.full(5, cosine)))


_UPPER, _LOWER = closed.projected_area(sigma, lambda_of_u, **ENTRY)
_LACKS = r"; the notebook prints $\sigma$ without the factor $1/(2\pi u_d)$, $u_d = 1/\sqrt{1+\alpha^2}$"

CHECKS: tuple[Check, ...] = (
    replace(
        _UPPER,
        statement=_UPPER.statement + _LACKS,
        latex=r"\sigma(u) = u\,(1 + \Lambda(u)) = \frac{1}{\pi u_d}\,\mathrm{Re}\left[h + u u_d"
        r" \arccos\frac{-u u_d}{s s_d}\right], \quad h = \sqrt{1-u^2-u_d^2}",
        sides=_upper,
    ),
    replace(
        _LOWER,
        statement=_LOWER.statement + ", which the notebook's form without that factor fails to give",
        sides=_lower,
    ),
    Check(
        "normalization",
        "The mass is 1, at the slope of the ring",
        r"\int_0^1 2\pi u\,D(u)\,du = 1, \quad D(u) = \frac{\delta(u - u_d)}{2\pi u_d}",
        _mass,
        CLOSED_FORM,
        **ENTRY,
    ),
    Check(
        "slopes_normalized",
        r"The density of slopes integrates to 1: along an axis, where $P_2$ is a number",
        r"\int_{-\alpha}^{\alpha} P_2(p)\,dp = 1",
        _along_an_axis,
        QUADRATURE,
        **ENTRY,
    ),
    Check(
        "marginal",
        "The density of one slope is twice what the notebook prints, whose integral is 1/2",
        r"P_2(p) = \frac{u_d}{\pi\sqrt{1 - (1+p^2)\,u_d^2}} = \frac{1}{\pi\sqrt{\alpha^2 - p^2}}",
        _marginal,
        CLOSED_FORM,
        **ENTRY,
    ),
    Check(
        "lambda_of_x",
        r"$\Lambda$ depends on $x=\cot\theta/\alpha$ alone",
        r"\Lambda = \frac{1}{\pi}\left(\frac{\sqrt{1-x^2}}{x} - \arccos x\right), \quad 0 < x < 1",
        _of_x,
        CLOSED_FORM,
        **BEYOND,
    ),
    Check(
        "lambda_from_marginal",
        r"$\Lambda$ follows from the density of one slope",
        r"\Lambda(u) = \frac{1}{\mu}\int_\mu^\alpha (q - \mu)\, P_2(q)\, dq, \quad \mu = \cot\theta",
        _lambda,
        QUADRATURE,
        **BEYOND,
    ),
    Check(
        "sampled_slope",
        "All normals have the slope of the ring",
        r"\tan\theta = \alpha",
        _sampled,
        CLOSED_FORM,
        **BEYOND,
    ),
)
