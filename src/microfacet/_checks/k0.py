"""K0: the checks of its notebook. The printed forms (mpmath arguments) come first, then the table."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp

from microfacet._checks import closed, integrals, routes
from microfacet._checks.check import CLOSED_FORM, QUADRATURE, Check, Sides, both, notebook
from microfacet._checks.routes import Array

FAMILY = "k0"
GRID = tuple({"alpha": alpha} for alpha in (1e-4, 1e-2, 0.1, 0.5, 1.0, 3.0, 10.0))
ENTRY: dict[str, Any] = {"parameters": {"alpha": 0.8}, "source": notebook("K0")}


def lambda_of_x(x: Any) -> Any:
    return mp.exp(-2 * x) / (4 * x)


def lambda_of_u(u: Any, alpha: Any) -> Any:
    return lambda_of_x(u / (alpha * mp.sqrt((1 - u) * (1 + u))))


def sigma(u: Any, alpha: Any) -> Any:
    """Both branches."""
    scale = alpha * mp.sqrt((1 - u) * (1 + u))
    return max(u, 0) + scale / 4 * mp.exp(-2 * abs(u) / scale)


def D(u: Any, alpha: Any) -> Any:
    return 2 * mp.besselk(0, 2 * mp.sqrt(1 - u**2) / (u * alpha)) / (mp.pi * u**4 * alpha**2)


def P22(r2: Any, alpha: Any) -> Any:
    return 2 * mp.besselk(0, 2 * mp.sqrt(r2) / alpha) / (mp.pi * alpha**2)


def P2(p: Any, alpha: Any) -> Any:
    return mp.exp(-2 * abs(p) / alpha) / alpha


def survival(r: Any, alpha: Any) -> Any:
    return 2 * r / alpha * mp.besselk(1, 2 * r / alpha)


CAP = integrals.Cap(
    lambda alpha: 1e-7,
    lambda r, alpha: 1 - survival(r, alpha),
    "those of slopes below $10^{-7}$, which cosines in double precision do not resolve, come in closed form",
)


def _draw(rng: np.random.Generator, n: int, alpha: float) -> Array:
    logs = np.log(1 - rng.random(n)) * np.log(1 - rng.random(n))
    return np.asarray(1 / np.sqrt(1 + alpha**2 * logs))


def _beckmann_mixture(k: Any, alpha: float) -> Sides:
    u = routes.cosine(routes.slopes(alpha))
    return k.D(u, alpha), routes.gamma_average(
        lambda b, u: routes.kernels("beckmann").D(u, alpha * np.sqrt(b)), 1.0, u
    )


def _near_normal(y: Array) -> Array:
    """K_0(2y) = -(log y + gamma_E)(1 + y^2 + y^4/4) + y^2 + 3 y^4/8 + ..., y -> 0."""
    return np.asarray(-(np.log(y) + np.euler_gamma) * (1 + y**2 + y**4 / 4) + y**2 + 3 * y**4 / 8)


def _singular(k: Any, alpha: float) -> Sides:
    """With y = tan(theta)/alpha -> 0."""
    u = 1 - alpha**2 * 2.0 ** -np.arange(24.0, 44.0, 4.0)
    u = np.minimum(u, 1 - 2.0**-52)
    scale = np.pi * alpha**2
    return both(
        (scale / 2 * u**4 * k.D(u, alpha), _near_normal(routes.slope_of(u) / alpha)),
        ([1 / k.D(1.0, alpha)], [0.0]),
        ([scale * routes.kernels("beckmann").D(1.0, alpha)], [1.0]),
    )


OFF_MIRROR = np.array([1e-2, 1e-4, 1e-8])  # radians


def _printed_brdf(off: Any, incidence: Any, alpha: Any) -> Any:
    """Of a mirror, in the plane of incidence: the facets that are seen lean by half of `off`."""
    ui, uo, um = mp.cos(incidence), mp.cos(incidence + off), mp.cos(off / 2)
    hidden = sum(lambda_of_u(u, alpha) for u in (ui, uo) if u < 1)
    return P22(mp.tan(off / 2) ** 2, alpha) / um**4 / (4 * ui * uo * (1 + hidden))


def _brdf(k: Any, alpha: float) -> Sides:
    """At 1 rad by slopes, for the cosine of half of 1e-8 rounds to 1; at the normal by the material."""
    import microfacet as mf

    def at_1_rad(rough: float) -> Array:
        ui, uo, um = np.cos(1.0), np.cos(1.0 + OFF_MIRROR), np.cos(OFF_MIRROR / 2)
        G2 = 1 / (1 + k.Lambda(ui, rough) + k.Lambda(uo, rough))
        return np.asarray(k.P22(np.tan(OFF_MIRROR / 2), 0.0, rough) / um**4 * G2 / (4 * ui * uo))

    def at_normal(ndf: Any, off: Array) -> Array:
        wo = np.stack([np.sin(off), np.zeros_like(off), np.cos(off)], axis=-1)
        return np.asarray(mf.Conductor(ndf).eval([0.0, 0.0, 1.0], wo) / wo[:, 2])

    def printed(incidence: float, rough: float) -> Array:
        return routes.exact(_printed_brdf, [[off, incidence] for off in OFF_MIRROR.tolist()], rough)

    pairs: list[Sides] = []
    for rough in (alpha, 10 * alpha, 100 * alpha):
        k0, mirror, scale = mf.K0(alpha=rough), np.zeros(1), 2 * np.pi * rough**2
        near = at_normal(k0, OFF_MIRROR)
        pairs += [
            (at_1_rad(rough), printed(1.0, rough)),
            (near, printed(0.0, rough)),
            (scale * near[-1:], _near_normal(OFF_MIRROR[-1:] / (2 * rough))),
            (1 / at_normal(k0, mirror), [0.0]),
            (2 * scale * at_normal(mf.Beckmann(alpha=rough), mirror), [1.0]),
        ]
    return both(*pairs)


CHECKS: tuple[Check, ...] = (
    closed.density(
        D,
        r"D(u) = \frac{2\,\Theta(u)}{\pi\alpha^2u^4}\,K_0\Big(\frac{2\sqrt{1-u^2}}{u\,\alpha}\Big)",
        remark="; at $u=1$ it has no value",
        **ENTRY,
    ),
    *closed.projected_area(sigma, lambda_of_u, **ENTRY),
    closed.lambda_of_x(
        lambda_of_x,
        r"$\Lambda$ depends on $x=\cot\theta/\alpha$ alone",
        r"\Lambda = \frac{e^{-2x}}{4x}",
        **ENTRY,
    ),
    Check(
        "beckmann_mixture",
        r"K0 is Beckmann of roughness $\alpha\sqrt{b}$, averaged over $b$ with density $e^{-b}$",
        r"D(u) = \int_0^\infty e^{-b}\,D_{\mathrm{Beckmann}}(u; \alpha\sqrt{b})\,db",
        _beckmann_mixture,
        QUADRATURE,
        **ENTRY,
    ),
    Check(
        "singular_at_normal",
        r"$D$ grows like $-\ln y$, $y=\tan\theta/\alpha$, towards the normal, where Beckmann's ends at"
        r" $1/(\pi\alpha^2)$",
        r"\frac{\pi\alpha^2}{2}\,u^4 D(u) = -\ln y - \gamma_E + o(1) \to \infty,"
        r"\quad \pi\alpha^2 D_{\mathrm{Beckmann}}(1) = 1",
        _singular,
        CLOSED_FORM,
        **integrals.where_cosines_resolve({**ENTRY, "parameters": {"alpha": 0.5}}),
    ),
    Check(
        "brdf_singular",
        r"However rough, the BRDF of a mirror is infinite in the mirror direction: towards it, at $\delta$ of"
        r" $10^{-2}$, $10^{-4}$ and $10^{-8}$ rad, it grows like $-\ln\delta$, even for $100\alpha$",
        r"4\pi\alpha^2 u_i u_o\,(1+\Lambda_i+\Lambda_o)\,\cos^4\tfrac{\delta}{2}\,f = 2K_0(2t)"
        r" = -2\ln t - 2\gamma_E + o(1) \to \infty, \quad t = \frac{\tan(\delta/2)}{\alpha}",
        _brdf,
        CLOSED_FORM,
        **{**ENTRY, "parameters": {"alpha": 0.5}},
    ),
    closed.shape_invariant(
        lambda y: 2 * mp.besselk(0, 2 * y) / mp.pi,
        r"$\alpha^2 u^4 D$ depends on $y=\tan\theta/\alpha$ alone",
        r"\alpha^2 u^4 D(u) = f(y) = \frac{2 K_0(2y)}{\pi}",
        **ENTRY,
    ),
    integrals.normalization(CAP, **{**ENTRY, "parameters": {"alpha": 0.6}}),
    closed.slopes_from_D(
        P22,
        r"P_{22}(p, q) = D(u)\,u^4 = \frac{2}{\pi\alpha^2} K_0\Big(\frac{2\sqrt{p^2+q^2}}{\alpha}\Big)",
        **ENTRY,
    ),
    integrals.slopes_normalized(**ENTRY),
    integrals.sigma_delta(CAP, **ENTRY),
    integrals.sampling(
        _draw,
        r"u = \frac{1}{\sqrt{1 + \alpha^2 \ln\xi_1 \ln\xi_2}}",
        CAP,
        **{**ENTRY, "parameters": {"alpha": 1.7}},
    ),
    integrals.marginal(
        P2,
        r"P_2(p) = \int_{-\infty}^{\infty} P_{22}(p, q)\,dq = \frac{e^{-2|p|/\alpha}}{\alpha}",
        notebook=False,
        **ENTRY,
    ),
    integrals.survival(survival, r"\Pr(\tan\theta > r) = 2y K_1(2y), \quad y = r/\alpha", **ENTRY),
)
