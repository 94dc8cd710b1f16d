"""Statements with an integral or a histogram that hold for every family, as factories of table entries.

As in ``_closed``. `cap`, where a factory takes one, is for a density that is infinite at the normal.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from microfacet._checks import routes
from microfacet._checks.check import HISTOGRAM, QUADRATURE, QUADRATURE_OVER_U, Check, Sides, both

Form = Callable[..., Any]

DRAWS = 200_000
BINS = 64


class Cap(NamedTuple):
    """The normals next to an infinite density, which integrals over u take in closed form.

    Their cosines are doubles, which near 1 are too coarse for quadrature. ``slope(parameters)`` is where they
    end, ``mass(slope, parameters)`` the printed probability of a lesser slope, `words` say so in a statement.
    """

    slope: Callable[..., float]
    mass: Form
    words: str


def normalization(cap: Cap | None = None, **entry: Any) -> Check:
    """Height-field normalisation."""

    def sides(k: Any, *parameters: float) -> Sides:
        inner, mass = _inner(cap, *parameters)
        return [mass + routes.mass_over_u(k, inner, routes.FAR, *parameters)], [1.0]

    return Check(
        "normalization",
        _said("The areas of the microfacets, projected on the macrosurface, add up to its area", cap),
        r"\int_0^1 2 \pi u\, D(u)\, du = 1",
        sides,
        QUADRATURE_OVER_U,
        **where_cosines_resolve(entry),
    )


def slopes_normalized(near: float = routes.NEAR, **entry: Any) -> Check:
    """The double integral of P22, in polar coordinates over eight azimuths, from `near` alpha on."""

    def sides(k: Any, *parameters: float) -> Sides:
        azimuth = np.pi / 4 * (np.arange(8) + 0.3)
        per_azimuth = routes.integrate(
            lambda r, phi: k.P22(r * np.cos(phi), r * np.sin(phi), *parameters) * r,
            near * parameters[0],
            routes.FAR,
            azimuth,
        )
        return [np.pi / 4 * np.sum(per_azimuth)], [1.0]

    return Check(
        "slopes_normalized",
        "The joint density of slopes integrates to 1",
        r"\int_{-\infty}^{\infty}\int_{-\infty}^{\infty} P_{22}(p, q)\, dp\, dq = 1",
        sides,
        QUADRATURE,
        **entry,
    )


def marginal(form: Form, latex: str, **entry: Any) -> Check:
    """P2 = int P22 dq, and its printed form `form(p, parameters)`."""
    name = entry.pop("name", "marginal")

    def sides(k: Any, *parameters: float) -> Sides:
        p = np.append(-routes.slopes(parameters[0])[1], routes.slopes(parameters[0]))
        integral = 2 * routes.integrate(
            lambda q, p: k.P22(p, q, *parameters), routes.NEAR * parameters[0], routes.FAR, p
        )
        return both(
            (k.P2(p, *parameters), integral),
            (k.P2(p, *parameters), routes.exact(form, p, *parameters)),
        )

    return Check(
        name,
        "The density of one slope is the integral of the joint density over the other",
        latex,
        sides,
        QUADRATURE,
        **entry,
    )


def lambda_from_marginal(**entry: Any) -> Check:
    """Lambda as the mean excess of the slope over cot(theta)."""
    name = entry.pop("name", "lambda_from_marginal")

    def sides(k: Any, *parameters: float) -> Sides:
        u = routes.incident_cosines(parameters[0])
        mu = 1 / routes.slope_of(u)
        return k.Lambda(u, *parameters), routes.mean_excess(k, mu, *parameters) / mu

    return Check(
        name,
        r"$\Lambda$ follows from the density of one slope",
        r"\Lambda(u) = \frac{1}{\mu}\int_\mu^\infty (q - \mu)\, P_2(q)\, dq, \quad \mu = \cot\theta",
        sides,
        QUADRATURE,
        **entry,
    )


def sigma_from_marginal(**entry: Any) -> Check:
    """sigma as the mean of what the slopes below cot(theta) show."""

    def sides(k: Any, *parameters: float) -> Sides:
        u = routes.incident_cosines(parameters[0])
        both_ways = np.concatenate([u, -u])
        return k.sigma(both_ways, *parameters), routes.mean_seen(k, both_ways, *parameters)

    return Check(
        "sigma_from_marginal",
        r"$\\sigma$ is the mean of what slopes up to $\cot\theta$ show, on both sides of the horizon",
        r"\sigma(u) = \int_{-\infty}^{\mu} \big(u - p\sqrt{1-u^2}\big)\,P_2(p)\,dp,"
        r"\quad \mu = \frac{u}{\sqrt{1-u^2}}",
        sides,
        QUADRATURE,
        **entry,
    )


def sigma_delta(cap: Cap | None = None, **entry: Any) -> Check:
    """sigma as the delta integral over D, both sides of the horizon."""
    name = entry.pop("name", "sigma_delta")

    def sides(k: Any, *parameters: float) -> Sides:
        mu = parameters[0] * np.array([-2.0, -1.0, -0.5, 0.5, 1.0, 2.0])
        u = np.concatenate([mu / np.hypot(1.0, mu), [-0.6, 0.6]])
        # The slopes within the cap are below all |cot(theta)|, so they show their projected area or none.
        inner, mass = _inner(cap, *parameters)
        rhs = np.maximum(u, 0.0) * mass + routes.delta_integral(k, u, inner, *parameters)
        return k.sigma(u, *parameters), rhs

    return Check(
        name,
        _said(
            "The projected area, on the whole sphere, is the sum of those of rings of normals of one slope",
            cap,
        ),
        r"\sigma(u) = \int_0^1 2 D(u_i)\,\mathrm{Re}\left[h + u u_i \arccos\frac{-u u_i}{s s_i}\right] du_i,"
        r"\quad h = \sqrt{1-u^2-u_i^2}, \quad s = \sqrt{1-u^2}, \quad s_i = \sqrt{1-u_i^2}",
        sides,
        QUADRATURE_OVER_U,
        **where_cosines_resolve(entry),
    )


def sampling(draw: Form, latex: str, cap: Cap | None = None, **entry: Any) -> Check:
    """Histogram of u over 2 pi u D(u); `draw(rng, n, parameters)` is the printed sampling formula."""

    def sides(k: Any, *parameters: float) -> Sides:
        rng = np.random.default_rng(zlib.crc32(latex.encode()))
        # A chi-square of these many draws bears errors of 1e-4 in D, so here the cap may be small.
        inner, mass_of_cap = _inner(cap and cap._replace(slope=lambda *_: 1e-6), *parameters)
        edges = np.unique(k.sample_u(np.arange(1, BINS) / BINS, *parameters))
        edges = edges[edges < routes.cosine(inner)]
        if edges.size == 0:  # the sampler returns nan, or the normal alone
            return [np.nan], [1.0]
        cuts = routes.slope_of(edges)
        tail = routes.mass_over_u(k, cuts[0], routes.FAR, *parameters)
        bins = routes.mass_over_u(k, np.append(cuts[1:], inner), cuts, *parameters)
        mass = np.append(tail, bins)
        mass[-1] += mass_of_cap
        statistics = []
        for u in (draw(rng, DRAWS, *parameters), k.sample_u(rng.random(DRAWS // 10), *parameters)):
            counts = np.bincount(np.searchsorted(edges, u), minlength=mass.size)
            statistics.append(routes.chi_square(counts, u.size * mass))
        return max(statistics)

    return Check(
        "sampling",
        r"Normals drawn by the printed formula, and by the library, have the density $2\pi u\,D(u)$",
        latex,
        sides,
        HISTOGRAM,
        **where_cosines_resolve(entry),
    )


def survival(form: Form, latex: str, **entry: Any) -> Check:
    """Pr(slope > r) against the integral of P22, and its printed form `form(r, parameters)`."""

    def sides(k: Any, *parameters: float) -> Sides:
        r = routes.slopes(parameters[0])
        xi = np.linspace(0.1, 0.9, 5)
        drawn = k.sample_slope(xi, *parameters)
        return both(
            (k.survival(r, *parameters), routes.mass_beyond(k, r, *parameters)),
            (k.survival(r, *parameters), routes.exact(form, r, *parameters)),
            (routes.mass_beyond(k, drawn, *parameters), 1 - xi),
        )

    return Check(
        "survival",
        r"The mass of the slopes steeper than $r$; the library's inverse leaves a mass of $1-\xi$ beyond",
        latex,
        sides,
        QUADRATURE,
        **{**entry, "notebook": False},
    )


def where_cosines_resolve(entry: dict[str, Any]) -> dict[str, Any]:
    """The entry, restricted to roughnesses whose normals differ in their cosines, which are doubles."""
    given = entry.get("unless", lambda *parameters: "")

    def unless(alpha: float, *shape: float) -> str:
        return given(alpha, *shape) if alpha >= 1e-5 else "the cosines of slopes of order alpha round to 1"

    return {**entry, "unless": unless}


def _inner(cap: Cap | None, *parameters: float) -> tuple[float, float]:
    """Lower end of an integral over the slope, and the mass below it."""
    if cap is None:
        return routes.NEAR * parameters[0], 0.0
    slope = cap.slope(*parameters)
    return slope, float(routes.exact(cap.mass, [slope], *parameters)[0])


def _said(statement: str, cap: Cap | None) -> str:
    return statement if cap is None else f"{statement}; {cap.words}"
