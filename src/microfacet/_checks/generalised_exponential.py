"""Generalised exponential: the checks of its notebook, and what it does not print. Printed forms first."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from mpmath import mp

from microfacet._checks import beckmann, closed, exponential, integrals
from microfacet._checks.check import CLOSED_FORM, Check, Sides, both, notebook
from microfacet._checks.routes import Array

FAMILY = "generalised_exponential"
GRID = tuple(
    {"alpha": alpha, "g": g}
    for alpha, g in product((1e-4, 0.1, 0.7, 1.0, 10.0), (0.42, 0.6, 0.8, 1.0, 1.5, 2.0, 3.0, 4.0))
)
COVERED = {"g": (0.4, 4.0)}  # what the second routes have been made for
ENTRY: dict[str, Any] = {
    "parameters": {"alpha": 0.6, "g": 1.5},
    "source": notebook("Generalized Exponential"),
}
BEYOND: dict[str, Any] = {**ENTRY, "notebook": False}


def f(y: Any, g: Any) -> Any:
    return mp.exp(-(y**g)) / (mp.pi * mp.gamma(1 + 2 / g))


def D(u: Any, alpha: Any, g: Any) -> Any:
    exponent = (1 - u**2) ** (g / 2) * (u * alpha) ** -g
    return mp.exp(-exponent) / (mp.pi * u**4 * alpha**2 * mp.gamma((2 + g) / g))


def P22(r2: Any, alpha: Any, g: Any) -> Any:
    return f(mp.sqrt(r2) / alpha, g) / alpha**2


def marginal_of_4(p: Any, alpha: Any, g: Any) -> Any:
    t = abs(p) / alpha
    return mp.sqrt(2) * t * mp.exp(-(t**4) / 2) * mp.besselk(0.25, t**4 / 2) / (mp.pi**1.5 * alpha)


def survival(r: Any, alpha: Any, g: Any) -> Any:
    return mp.gammainc(2 / g, (r / alpha) ** g, regularized=True)


def _draw(rng: np.random.Generator, n: int, alpha: float, g: float) -> Array:
    return np.asarray(1 / np.sqrt(1 + alpha**2 * rng.standard_gamma(2 / g, n) ** (2 / g)))


def _special(forms: Any, scale: float) -> Any:
    """The check that the family is another, of roughness `scale` alpha, at one g."""

    def sides(k: Any, alpha: float, g: float) -> Sides:
        # The points of `special_case` are those of the other family's roughness.
        return closed.special_case(
            lambda name: lambda at, rough: getattr(k, name)(at, rough / scale, g), scale * alpha, forms
        )

    return sides


def _marginal_of(g: float, form: Any, latex: str) -> Check:
    return integrals.marginal(
        form,
        latex,
        name=f"marginal_{g:.0f}",
        **{**ENTRY, "parameters": {"alpha": 0.6, "g": g}, "fixed": frozenset({"g"})},
    )


def _at_zero(k: Any, alpha: float, g: float) -> Sides:
    """What the integrals over P22 are at a slope of 0: the mean slope, and the density along an axis."""
    with mp.workdps(30):
        c = 1 / mp.mpf(g)
        mean = mp.mpf(alpha) * mp.gamma(3 * c) / (mp.pi * mp.gamma(2 * c))
        density = 2 * mp.gamma(1 + c) / (mp.pi * mp.gamma(1 + 2 * c) * mp.mpf(alpha))
        return both(([k.sigma(0.0, alpha, g)], [float(mean)]), ([k.P2(0.0, alpha, g)], [float(density)]))


CHECKS: tuple[Check, ...] = (
    closed.density(
        D,
        r"D(u) = \frac{\Theta(u)}{\pi\alpha^2u^4\,\Gamma(\frac{2+g}{g})}"
        r"\exp\left(-(1-u^2)^{g/2}(u\,\alpha)^{-g}\right)",
        **ENTRY,
    ),
    Check(
        "beckmann",
        r"At $g = 2$ it is Beckmann: $D$, $P_2$, $\Lambda$ and $\sigma$",
        r"D(u; \alpha, g = 2) = D_{\mathrm{Beckmann}}(u; \alpha)",
        _special(beckmann, 1.0),
        CLOSED_FORM,
        **{**ENTRY, "parameters": {"alpha": 0.6, "g": 2.0}, "fixed": frozenset({"g"})},
    ),
    Check(
        "exponential",
        r"At $g = 1$ it is Exponential of roughness $2\alpha$: $D$, $P_2$, $\Lambda$ and $\sigma$",
        r"D(u; \alpha, g = 1) = D_{\mathrm{Exponential}}(u; 2\alpha)",
        _special(exponential, 2.0),
        CLOSED_FORM,
        **{**ENTRY, "parameters": {"alpha": 0.6, "g": 1.0}, "fixed": frozenset({"g"})},
    ),
    closed.slopes_from_D(
        P22,
        r"P_{22}(p, q) = D(u)\,u^4 = \frac{e^{-(r/\alpha)^g}}{\pi\alpha^2\,\Gamma(1+2/g)},"
        r"\quad r^2 = p^2+q^2",
        **ENTRY,
    ),
    integrals.slopes_normalized(**ENTRY),
    _marginal_of(
        2.0,
        lambda p, alpha, g: beckmann.P2(p, alpha),
        r"g = 2,\quad P_2(p) = \int_{-\infty}^{\infty} P_{22}(p, q)\,dq"
        r" = \frac{e^{-p^2/\alpha^2}}{\sqrt{\pi}\,\alpha}",
    ),
    _marginal_of(
        4.0,
        marginal_of_4,
        r"g = 4,\quad P_2(p) = \int_{-\infty}^{\infty} P_{22}(p, q)\,dq"
        r" = \frac{\sqrt2\,t\,e^{-t^4/2}}{\pi^{3/2}\alpha}\,K_{1/4}\big(\tfrac{t^4}{2}\big),"
        r"\quad t = \frac{|p|}{\alpha}",
    ),
    closed.shape_invariant(
        f,
        r"$\alpha^2 u^4 D$ depends on $y=\tan\theta/\alpha$ and on $g$ alone",
        r"\alpha^2 u^4 D(u) = f(y) = \frac{e^{-y^g}}{\pi\,\Gamma(1+2/g)}",
        **ENTRY,
    ),
    integrals.normalization(**BEYOND),
    integrals.lambda_from_marginal(**BEYOND),
    integrals.sigma_delta(**BEYOND),
    Check(
        "at_zero",
        r"Seen at the horizon the area is half of the mean slope along an axis; $P_2$ at 0",
        r"\sigma(0) = \frac{\alpha\,\Gamma(3/g)}{\pi\,\Gamma(2/g)}, \quad"
        r" P_2(0) = \frac{2\,\Gamma(1+1/g)}{\pi\alpha\,\Gamma(1+2/g)}",
        _at_zero,
        CLOSED_FORM,
        **BEYOND,
    ),
    integrals.sampling(
        _draw,
        r"u = \frac{1}{\sqrt{1 + \alpha^2 b^{2/g}}}, \quad b \sim \mathrm{Gamma}(2/g, 1)",
        **{**BEYOND, "parameters": {"alpha": 0.7, "g": 3.0}},
    ),
    integrals.survival(
        survival,
        r"\Pr(\tan\theta > r) = \frac{\Gamma(2/g, y^g)}{\Gamma(2/g)}, \quad y = r/\alpha",
        **ENTRY,
    ),
)
