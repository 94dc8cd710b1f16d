"""Statements of closed forms that hold for every family, as factories of table entries.

The caller gives its printed forms, functions of arbitrary-precision arguments, and the remaining fields of
`Check` as keywords.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from microfacet._checks import routes
from microfacet._checks.check import CLOSED_FORM, Check, Sides, both

Form = Callable[..., Any]
Kernels = Callable[[str], Callable[[routes.Array, float], routes.Array]]


def special_case(kernels: Kernels, alpha: float, forms: Any, last: int | None = None) -> Sides:
    """D, P2, Lambda and sigma against another family's printed forms (a module such as ``_ggx``).

    ``kernels(name)`` is the function of that name of (argument, alpha); the points end before `last`.
    """
    u, r = routes.incident_cosines(alpha)[:last], routes.slopes(alpha)[:last]
    pairs = (
        ("D", routes.cosine(r), lambda u, alpha: forms.P22(routes.tan2(u), alpha) / u**4),
        ("P2", r, forms.P2),
        ("Lambda", u, forms.lambda_of_u),
        ("sigma", u, forms.sigma),
        ("sigma", -u, forms.sigma),
    )
    return both(*((kernels(name)(at, alpha), routes.exact(form, at, alpha)) for name, at, form in pairs))


def shape_invariant(form: Form, statement: str, latex: str, **entry: Any) -> Check:
    """f(y) = alpha^2 u^4 D at y = tan(theta)/alpha, for two roughnesses; `form(y, shape)`."""

    def of_u(u: Any, alpha: Any, *shape: Any) -> Any:
        return form(routes.tan2(u) ** 0.5 / alpha, *shape)

    def at(k: Any, alpha: float, *shape: float) -> Sides:
        u = routes.cosine(routes.slopes(alpha))
        return alpha**2 * u**4 * k.D(u, alpha, *shape), routes.exact(of_u, u, alpha, *shape)

    return Check("shape_invariant", statement, latex, _of_two(at), CLOSED_FORM, **entry)


def lambda_of_x(form: Form, statement: str, latex: str, **entry: Any) -> Check:
    """Lambda as a function of x = cot(theta)/alpha, for two roughnesses; `form(x, shape)`."""

    def of_u(u: Any, alpha: Any, *shape: Any) -> Any:
        return form(1 / (alpha * routes.tan2(u) ** 0.5), *shape)

    def at(k: Any, alpha: float, *shape: float) -> Sides:
        u = routes.incident_cosines(alpha)
        return k.Lambda(u, alpha, *shape), routes.exact(of_u, u, alpha, *shape)

    return Check("lambda_of_x", statement, latex, _of_two(at), CLOSED_FORM, **entry)


def _of_two(at: Callable[..., Sides]) -> Callable[..., Sides]:
    """`at` for alpha and alpha/3: one roughness alone cannot show that a function does not depend on it."""
    return lambda k, alpha, *shape: both(*(at(k, each, *shape) for each in (alpha, alpha / 3)))


def projected_area(sigma_form: Form, lambda_form: Form, **entry: Any) -> tuple[Check, Check]:
    """Both identities between sigma and Lambda, each ufunc against the printed form of the other."""

    def upper(k: Any, *parameters: float) -> Sides:
        u = routes.incident_cosines(parameters[0])
        return both(
            (
                k.sigma(u, *parameters),
                routes.exact(lambda u, *p: u * (1 + lambda_form(u, *p)), u, *parameters),
            ),
            ((1 + k.Lambda(u, *parameters)) * u, routes.exact(sigma_form, u, *parameters)),
        )

    def lower(k: Any, *parameters: float) -> Sides:
        u = routes.incident_cosines(parameters[0])
        return both(
            (k.sigma(-u, *parameters), routes.exact(lambda u, *p: u * lambda_form(u, *p), u, *parameters)),
            (u * k.Lambda(u, *parameters), routes.exact(lambda u, *p: sigma_form(-u, *p), u, *parameters)),
        )

    return (
        Check(
            "sigma_upper",
            r"The projected area above the horizon is $u\,(1+\Lambda(u))$",
            r"\sigma(u) = u\,(1 + \Lambda(u)), \quad 0 < u < 1",
            upper,
            CLOSED_FORM,
            **entry,
        ),
        Check(
            "sigma_lower",
            r"The projected area below the horizon is $u\,\Lambda(u)$",
            r"\sigma(-u) = u\,\Lambda(u), \quad 0 < u < 1",
            lower,
            CLOSED_FORM,
            **entry,
        ),
    )


def density(form: Form, latex: str, name: str = "density", remark: str = "", **entry: Any) -> Check:
    """D as it is printed, `form(u, parameters)` for u > 0, and 0 from the horizon down.

    `remark` ends the statement: what the printed form lacks, or where it breaks down.
    """

    def sides(k: Any, *parameters: float) -> Sides:
        u = np.append(routes.cosine(routes.slopes(parameters[0])), routes.incident_cosines(parameters[0]))
        below = np.concatenate([[0.0, -1.0], -u])
        return both(
            (k.D(u, *parameters), routes.exact(form, u, *parameters)),
            (k.D(below, *parameters), np.zeros(below.size)),
        )

    return Check(
        name,
        r"The density is the printed form above the horizon and 0 below, by the step $\Theta$" + remark,
        latex,
        sides,
        CLOSED_FORM,
        **entry,
    )


def slopes_from_D(form: Form, latex: str, **entry: Any) -> Check:
    """P22 follows from D; `form(r2, parameters)` is its printed form."""
    name = entry.pop("name", "slopes_from_D")

    def sides(k: Any, *parameters: float) -> Sides:
        u = routes.cosine(routes.slopes(parameters[0]))
        r, azimuth = routes.slope_of(u), np.linspace(0.2, 6.0, u.size)
        p, q = r * np.cos(azimuth), r * np.sin(azimuth)
        pq = np.stack([p, q], axis=-1)
        return both(
            (
                k.D(u, *parameters) * u**4,
                routes.exact(lambda u, *a: form(routes.tan2(u), *a), u, *parameters),
            ),
            (k.P22(p, q, *parameters), routes.exact(lambda p, q, *a: form(p**2 + q**2, *a), pq, *parameters)),
        )

    return Check(
        name,
        r"The joint density of slopes follows from $D$ at $u=1/\sqrt{1+p^2+q^2}$",
        latex,
        sides,
        CLOSED_FORM,
        **entry,
    )
