"""Assertions that hold for the elementwise functions of any family; test_laws.py applies them to all.

``Density`` binds a family's ufuncs to parameters. Integrals are the trapezoidal rule in log(q), exponentially
convergent for these analytic integrands, and never use a function of the library that the asserted one is
derived from.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LOG = np.arange(-90.0, 90.0, 0.05)
_Q = np.exp(_LOG)
MU = np.array([1e-6, 1e-2, 0.3, 1.0, 2.0, 4.0])  # cotangents and slopes, in units of alpha


def half_line(f: Callable[[Array], Array]) -> Array:
    """int_0^inf f(q) dq along the last axis."""
    return 0.05 * np.sum(f(_Q) * _Q, axis=-1)


def interval(f: Callable[[Array], Array], length: Array) -> Array:
    """int_0^length f(y) dy along the last axis by the double exponential rule."""
    x = np.arange(-4.0, 4.0, 0.05)
    fraction = 1.0 / (1.0 + np.exp(-np.pi * np.sinh(x)))  # positive at the lower end
    weight = 0.05 * 0.25 * np.pi * np.cosh(x) / np.cosh(0.5 * np.pi * np.sinh(x)) ** 2
    length = np.asarray(length)[..., None]
    return np.sum(f(length * fraction) * length * weight, axis=-1)


@dataclass(frozen=True)
class Density:
    """The ufuncs of one family with its parameters bound: ``density.P2(p)``."""

    kernels: Any
    parameters: tuple[float, ...]

    def __getattr__(self, name: str) -> Callable[..., Any]:
        function = getattr(self.kernels, name)
        return lambda *x: function(*x, *self.parameters)

    @property
    def alpha(self) -> float:
        return self.parameters[0]

    @property
    def units(self) -> Array:
        """`MU` up to where next to nothing is steeper, and a rounding of a slope is all that counts."""
        return MU[self.survival(self.alpha * MU) > 1e-25]

    @property
    def slopes(self) -> Array:
        return self.alpha * self.units

    @property
    def cosines(self) -> Array:
        return self.slopes / np.hypot(1.0, self.slopes)


def cosine(r: Array) -> Array:
    return 1.0 / np.hypot(1.0, r)


# Densities.


def height_field_normalised(f: Density) -> None:
    """int 2 pi u D du = 1: int_0^u0 = survival(r0), because D may be infinite at u = 1; du = -u^3 r dr."""
    r0 = 1e-3

    def height_field(q: Array) -> Array:
        r = r0 + q
        return 2 * np.pi * r * cosine(r) ** 4 * f.D(cosine(r))

    assert_allclose(half_line(height_field), f.survival(r0), rtol=1e-9)


def slopes_from_D(f: Density) -> None:
    """P22(p, q) = D(u) u^4 at u = 1/sqrt(1 + p^2 + q^2)."""
    p, q = f.slopes, f.slopes[::-1]
    u = cosine(np.hypot(p, q))
    # u is rounded: an error eps in u is one of eps (1 + r^2)/r^2 in r.
    assert_allclose(f.P22(p, q), f.D(u) * u**4, rtol=1e-15 * (1 + 1 / f.alpha**2) * 200)


def slopes_normalised(f: Density) -> None:
    assert_allclose(half_line(lambda r: 2 * np.pi * r * f.P22(r, 0.0)), 1.0, rtol=1e-12)
    assert_allclose(half_line(lambda p: 2 * f.P2(p)), 1.0, rtol=1e-12)


def marginal(f: Density) -> None:
    """P2(p) = int P22(p, q) dq."""
    p = np.concatenate([-f.slopes, f.slopes])
    assert_allclose(f.P2(p), half_line(lambda q: 2 * f.P22(p[:, None], q)), rtol=1e-12)


def slope_cdf(f: Density) -> None:
    """Antisymmetric about 1/2, and the integral of P2, with relative accuracy in the lower tail."""
    p = f.slopes
    assert_allclose(f.slope_cdf(0.0), 0.5, rtol=1e-14)
    assert_allclose(f.slope_cdf(-p) + f.slope_cdf(p), 1.0, rtol=1e-13)
    assert_allclose(f.slope_cdf(-p), half_line(lambda q: f.P2(p[:, None] + q)), rtol=1e-12)


def infinity(f: Density) -> None:
    """Infinite slopes are limits, not nan."""
    ends = np.array([-np.inf, np.inf])
    assert_array_equal(f.slope_cdf(ends), [0.0, 1.0])
    assert_array_equal(f.P2(ends), 0.0)
    assert_array_equal(f.P22(ends, 0.1), 0.0)
    assert_array_equal(f.survival(np.inf), 0.0)


def survival(f: Density) -> None:
    """The mass of P22 beyond the circle; decreasing from 1."""
    r = f.slopes
    assert_allclose(f.survival(0.0), 1.0, rtol=1e-14)

    def ring(q: Array) -> Array:  # of the radius r + q
        return 2 * np.pi * (r[:, None] + q) * f.P22(r[:, None] + q, 0.0)

    assert_allclose(f.survival(r), half_line(ring), rtol=1e-12)
    assert np.all(np.diff(f.survival(r)) < 0)


# Masking.


def lambda_from_marginal(f: Density) -> None:
    """Lambda = (1/mu) int_mu^inf (q - mu) P2(q) dq."""
    mu = f.slopes
    expected = half_line(lambda t: t * f.P2(mu[:, None] + t)) / mu
    # u is rounded, and its rounding reaches mu divided by 1 - u^2.
    assert_allclose(f.Lambda(f.cosines), expected, rtol=1e-12 + 1e-14 * np.max(1 + mu**2))


def projected_area(f: Density) -> None:
    """sigma(u) = u (1 + Lambda), sigma(-u) = u Lambda, and the values at the poles and the horizon."""
    u = f.cosines
    assert_allclose(f.sigma(u), u * (1 + f.Lambda(u)), rtol=1e-13)
    assert_allclose(f.sigma(-u), u * f.Lambda(u), rtol=1e-13)
    assert_allclose(f.Lambda(-u), -1 - f.Lambda(u), rtol=1e-13)
    assert f.sigma(1.0) == 1.0
    assert f.sigma(-1.0) == 0.0
    assert f.Lambda(1.0) == 0.0
    assert np.isposinf(f.Lambda(0.0))
    assert_allclose(f.sigma(0.0), half_line(lambda p: p * f.P2(p)), rtol=1e-12)


def masking(f: Density) -> None:
    u = f.cosines
    assert_allclose(f.G1(u), 1 / (1 + f.Lambda(u)), rtol=1e-14)
    assert_allclose(f.G1(u), u / f.sigma(u), rtol=1e-13)
    assert f.G1(1.0) == 1.0
    assert np.all(f.G1(np.array([0.0, -1e-3, -1.0])) == 0.0)
    assert np.all(f.D(np.array([0.0, -1e-3, -1.0])) == 0.0)


def monotone(f: Density) -> None:
    u = np.linspace(1e-3, 1.0, 400)
    assert np.all(np.diff(f.Lambda(u)) <= 0)
    assert np.all(np.diff(f.G1(u)) >= 0)


def delta_integral(f: Density) -> None:
    """sigma(u) = int D(v) delta(u, v) dv, delta = int max(0, w.m) dphi over the normals m with cosine v.

    In slopes, D(v) delta dv = P22 r dr int max(0, u - s r cos phi) dphi: where r < mu = |u|/s, the whole
    circle counts (or none of it).
    """
    for u in (*f.cosines[1:], *-f.cosines[1:4]):
        s = np.sqrt((1 - u) * (1 + u))
        mu = abs(u) / s

        def crossed(t: Array, u: float = u, s: float = s, mu: float = mu) -> Array:
            r = mu + t
            return (
                f.P22(r, 0.0)
                * r
                * 2
                * (s * np.sqrt(t * (r + mu)) + u * np.arccos(np.clip(-u / s / r, -1, 1)))
            )

        inside = interval(lambda r, u=u: f.P22(r, 0.0) * r * 2 * np.pi * u, np.array(mu)) if u > 0 else 0.0
        assert_allclose(inside + half_line(crossed), f.sigma(u), rtol=1e-10, atol=1e-14)


# Sampling.


def inverse(f: Density) -> None:
    """survival(sample_slope(xi)) = 1 - xi; sample_u is the cosine of the same normal."""
    xi = np.array([0.0, 1e-9, 0.01, 0.3, 0.5, 0.8, 0.99, 1 - 1e-9, 1 - 2.0**-53])
    r = f.sample_slope(xi)
    assert r[0] == 0.0
    assert np.all(np.diff(r) > 0)
    assert_allclose(
        f.survival(r), 1 - xi, rtol=1e-10
    )  # the rounding of r counts up to |d log T/d log r| times
    assert_allclose(f.sample_u(xi), cosine(r), rtol=1e-13)
    mass = interval(lambda y: 2 * np.pi * y * f.P22(y, 0.0), r[1:5])  # small xi carry relative information
    assert_allclose(mass, xi[1:5], rtol=1e-10)


# Scaling.


def shape_invariant(f: Density) -> None:
    """alpha stretches the slopes: P22, P2, slope_cdf, survival and Lambda depend on slope/alpha alone."""
    x, (alpha, *shape) = f.units, f.parameters
    for other in (alpha / 7, alpha * 3):
        g = Density(f.kernels, (other, *shape))
        assert_allclose(alpha**2 * f.P22(alpha * x, 0.0), other**2 * g.P22(other * x, 0.0), rtol=1e-13)
        assert_allclose(alpha * f.P2(alpha * x), other * g.P2(other * x), rtol=1e-13)
        assert_allclose(f.slope_cdf(-alpha * x), g.slope_cdf(-other * x), rtol=1e-13)
        assert_allclose(f.survival(alpha * x), g.survival(other * x), rtol=1e-13)
        assert_allclose(
            f.Lambda(f.cosines), g.Lambda(g.cosines), rtol=1e-12 + 1e-13 * max(f.alpha, g.alpha) ** 2
        )
        xi = np.linspace(0.05, 0.95, 10)
        assert_allclose(f.sample_slope(xi) / alpha, g.sample_slope(xi) / other, rtol=1e-13)


ALL = (
    height_field_normalised, slopes_from_D, slopes_normalised, marginal, slope_cdf, survival, infinity,
    lambda_from_marginal, projected_area, masking, monotone, delta_integral, inverse,
)  # fmt: skip
# Those that integrate D, P22 or P2, or invert the survival function, by rules for functions without an edge.
OF_A_DENSITY = (
    height_field_normalised, slopes_from_D, slopes_normalised, marginal, slope_cdf, survival,
    lambda_from_marginal, projected_area, delta_integral, inverse,
)  # fmt: skip
