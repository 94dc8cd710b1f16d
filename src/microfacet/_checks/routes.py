"""The second routes: everything a check computes without the function it is checking.

Integrals over slopes are taken in the logarithm of the slope, in which the densities are smooth over the many
decades they span, by Gauss-Legendre quadrature on equal panels: no adaptive rule, whose error estimate can be
fooled. Closed forms are evaluated by mpmath at the exact double precision arguments.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

NEAR = (
    1e-17  # lower end of an integral over slopes, in units of alpha; along a line, what lies below is 1e-17
)
FAR = 1e80  # its upper end: a tail like r^-0.2, the heaviest any check integrates, is 1e-16 there

INCIDENT = (
    0.1,
    0.5,
    1.0,
    2.0,
    4.0,
)  # cot(theta)/alpha of the directions at which Lambda and sigma are compared
SLOPES = (0.05, 0.3, 1.0, 2.0, 3.5)  # slope/alpha at which densities are compared


def families() -> dict[str, Any]:
    """The library's own list of families, by name."""
    import microfacet

    return {family.name: family for family in microfacet.families()}


def kernels(family: str) -> Any:
    """The ufuncs of a family."""
    return families()[family].kernels


def cosine(slope: ArrayLike) -> Array:
    """cos(theta) of a normal with this slope."""
    return np.asarray(1 / np.hypot(1.0, slope), dtype=np.float64)


def incident_cosines(alpha: float) -> Array:
    """Cosines u > 0 of directions: at the scale of alpha, and u = 1/2, the notebook's.

    Or the nearest to 1/2 with cot(theta) <= 20 alpha: beyond, printed forms cancel to hundreds of digits.
    """
    mu = np.append(alpha * np.array(INCIDENT), min(np.sqrt(1 / 3), 20 * alpha))
    return np.where(mu == np.sqrt(1 / 3), 0.5, mu / np.hypot(1.0, mu))


def slopes(alpha: float) -> Array:
    """Slopes at the scale of alpha, and one of order one (GTR has both scales)."""
    return np.append(alpha * np.array(SLOPES), 0.7)


def slope_of(u: ArrayLike) -> Array:
    """tan(theta) to rounding: 1 - u*u would lose it near u = 1."""
    cos = np.asarray(u, dtype=np.float64)
    return np.asarray(np.sqrt((1 - cos) * (1 + cos)) / cos, dtype=np.float64)


def exact(function: Callable[..., Any], points: ArrayLike, *parameters: float) -> Array:
    """``function(point, *parameters)`` in arbitrary precision at each point, rounded once at the end.

    `points` may have a last axis of length 2, taken as two arguments (the slopes p, q). Digits are doubled
    until two evaluations agree, since the printed forms cancel; of forms that pass through complex values the
    real part is taken.
    """
    from mpmath import mp

    def value(arguments: list[float]) -> float:
        before = None
        for digits in (25, 50, 100, 200, 400, 800):
            with mp.workdps(digits):
                try:
                    now = mp.re(function(*map(mp.mpf, arguments)))
                except (
                    ZeroDivisionError
                ):  # a difference of nearly equal numbers: more digits will tell them apart
                    continue
                if before is not None and (
                    abs(now - before) <= abs(now) * 1e-18 or abs(now) + abs(before) < 1e-300
                ):
                    return float(now)
            before = now
        return float("nan")

    table = np.asarray(points, dtype=np.float64)
    rows = table if table.ndim == 2 else table[:, np.newaxis]
    return np.array([value([*row, *map(float, parameters)]) for row in rows.tolist()])


def tan2(u: Any) -> Any:
    """tan^2(theta) in arbitrary precision."""
    return (1 - u) * (1 + u) / u**2


def integrate(
    function: Callable[..., Any], lower: ArrayLike, upper: ArrayLike, *arguments: ArrayLike
) -> Array:
    """Integral of ``function(r, *arguments)`` over lower < r < upper (positive), elementwise."""

    def in_log(y: Array, *rest: Array) -> Any:
        return function(np.exp(y), *rest) * np.exp(y)

    return integrate_exponent(in_log, np.log(lower), np.log(upper), *arguments)


def integrate_exponent(
    function: Callable[..., Any], lower: ArrayLike, upper: ArrayLike, *arguments: ArrayLike, panels: int = 1
) -> Array:
    """Integral of ``function(y, *arguments)`` over lower < y < upper, by Gauss-Legendre on `panels` or more.

    A density of slopes, as a function of y = log r, is analytic and bounded for |Im y| < pi/4 (a Gaussian
    grows beyond), so that 24 nodes on a panel of width 1 leave an error of order
    (pi/2 + sqrt(1 + pi^2/4))^-48 = 1e-26.
    """
    first, last, *rest = (
        np.asarray(a)[..., np.newaxis] for a in np.broadcast_arrays(lower, upper, *arguments)
    )
    width = last - first
    count = max(panels, int(np.ceil(np.max(width, initial=1.0, where=np.isfinite(width)))))
    nodes, weights = np.polynomial.legendre.leggauss(24)
    place = ((np.arange(count)[:, np.newaxis] + (nodes + 1) / 2) / count).ravel()
    values = function(first + (last - first) * place, *rest) * np.tile(weights, count)
    return np.asarray(np.sum(values, axis=-1) * (last - first)[..., 0] / (2 * count), dtype=np.float64)


def stirling(shape: float) -> float:
    """log Gamma(shape) - shape log(shape) + shape, three large terms that cancel."""
    from mpmath import mp

    with mp.workdps(40):
        return float(mp.loggamma(shape) - shape * mp.log(shape) + shape)


def gamma_average(function: Callable[..., Any], shape: float, points: ArrayLike) -> Array:
    """Mean of ``function(m, point)`` over m ~ Gamma(shape, 1), integrated in d = log(m/shape).

    With m = shape e^d the density is exp(shape (d - expm1(d)) - stirling). `function` may shift the weight
    far into a tail, so the range is wide: what is left out is below e^-700.
    """
    c, width = stirling(shape), 60 / np.sqrt(shape)
    return integrate_exponent(
        lambda d, point: np.exp(shape * (d - np.expm1(d)) - c) * function(shape * np.exp(d), point),
        -min(100.0, width + 700 / shape),
        max(np.log(1000 / shape), width),
        points,
        panels=1000,  # at a slope of 300 alpha the weight of an exponential density has a width of 0.04
    )


def mass_over_u(k: Any, inner: ArrayLike, outer: ArrayLike, *parameters: float) -> Array:
    """Integral of 2 pi u D(u) du over the normals whose slope lies between `inner` and `outer`.

    The variable is the slope r: u = 1/sqrt(1 + r^2), u du = -u^4 r dr.
    """
    return integrate(lambda r: 2 * np.pi * k.D(cosine(r), *parameters) * cosine(r) ** 4 * r, inner, outer)


def delta_integral(k: Any, u: Array, inner: ArrayLike, *parameters: float) -> Array:
    """The projected area as a superposition of the areas of distributions of one slope:

        sigma(u) = int_0^1 D(ui) Re{2 [sqrt(1 - u^2 - ui^2) + u ui acos(-u ui / (s si))]} dui

    with s = sqrt(1 - u^2), si = sqrt(1 - ui^2). Since (s si)^2 - (u ui)^2 = 1 - u^2 - ui^2 =: h^2, the arc
    cosine is atan2(h, -u ui); where h^2 < 0 the real part is that of h = 0. The integral is split there, at
    the slope |u|/s, beyond which the variable is the excess over it. Slopes below `inner` are left out.
    """
    s = np.sqrt((1 - u) * (1 + u))
    kink = np.abs(u) / s

    def density(r: Array) -> Array:  # D(ui) times -dui/dr
        return np.asarray(k.D(cosine(r), *parameters) * cosine(r) ** 3 * r, dtype=np.float64)

    def beyond(z: Array, u: Array, s: Array, kink: Array) -> Array:
        ui = cosine(kink + z)
        h = s * ui * np.sqrt(z * (z + 2 * kink))
        return density(kink + z) * 2 * (h + u * ui * np.arctan2(h, -u * ui))

    within = integrate(lambda r: density(r) * 2 * np.pi * cosine(r), inner, kink)
    return np.maximum(u, 0.0) * within + integrate(beyond, NEAR * parameters[0], FAR, u, s, kink)


def mass_beyond(k: Any, r: Array, *parameters: float) -> Array:
    """Pr(slope > r) from the joint density of slopes."""
    return integrate(
        lambda z, r: 2 * np.pi * (r + z) * k.P22(r + z, 0.0, *parameters),
        NEAR * np.minimum(r, parameters[0]),
        FAR,
        r,
    )


def mean_excess(k: Any, mu: Array, *parameters: float) -> Array:
    """int_mu^inf (q - mu) P2(q) dq, that is mu Lambda, from the marginal slope density."""
    return integrate(lambda z, mu: z * k.P2(mu + z, *parameters), NEAR * parameters[0], FAR, mu)


def mean_seen(k: Any, u: Array, *parameters: float) -> Array:
    """int_{-inf}^{cot(theta)} (u - p sin(theta)) P2(p) dp, that is sigma.

    For u > 0 the integrand as it stands, split at p = 0. For u < 0, where it would cancel, the variable is
    the excess of -p over |cot(theta)|; P2 is even.
    """
    s, least = np.sqrt((1 - u) * (1 + u)), NEAR * parameters[0]

    def shown(p: Array, u: Array, s: Array) -> Array:
        return np.asarray((u - p * s) * k.P2(p, *parameters), dtype=np.float64)

    cot = np.abs(u) / s
    falling = integrate(lambda p, u, s: shown(-p, u, s), least, FAR, u, s)
    return np.where(u > 0, falling + integrate(shown, least, cot, u, s), s * mean_excess(k, cot, *parameters))


def chi_square(counts: NDArray[np.int_], expected: Array) -> tuple[float, float]:
    """Pearson's statistic and its degrees of freedom."""
    return float(np.sum((counts - expected) ** 2 / expected)), float(len(counts) - 1)


def uniform_average(function: Callable[..., Any], points: ArrayLike) -> Array:
    """Mean of ``function(m, point)`` over m uniform in (0, 1), of which exp(-60) is left out.

    Where `function` is a tail, all its weight lies in the last 1/400, which 24 nodes on 1/16 resolve.
    """
    return integrate_exponent(
        lambda y, point: np.exp(y) * function(np.exp(y), point), -60.0, 0.0, points, panels=1000
    )
