r"""The plane of slopes in panels, on each of which the light that facets of these slopes scatter is smooth.

In standard space (slopes divided by the roughness) a slope has the polar coordinates r, phi, phi = 0 where
facets turn away from wi. With t = tan(theta_i), d the real slope of the unit vector of azimuth phi and d_p
its part along wi:

    a mirror sends light up     where |r d + t| < sqrt(1 + t^2), so r < 1/(t d_p + sqrt(t^2 d_p^2 + |d|^2)),
    a facet faces wi            where r t d_p < 1,
    it does not reflect all     where cos(theta_i) - sin(theta_i) r d_p > c sqrt(1 + r^2 |d|^2), c the cosine
                                of the critical angle: a cap around wi, of which a ray meets one piece,
    light that passes sinks     beyond the smaller r with r^2 |d|^2 + 2 t r d_p + c^2/cos(theta_i)^2 = 1,
                                where theta_i is beyond the critical angle; before it the facet sends it up.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from microfacet._frozen import Distribution

__all__ = ["Panels", "panels"]

Array = NDArray[np.float64]

_STEEPEST = 170.0  # log of a slope whose fourth power is a number


class Panels(NamedTuple):
    """Intervals of log r, each of one azimuth and for the direction with that number."""

    direction: NDArray[np.int64]
    along_x: Array  # the real slope of the unit vector
    along_y: Array
    begin: Array
    end: Array
    singular: NDArray[np.bool_]  # the integrand ends, or begins, with a root or a power
    weight: Array

    def cut(self, first: int, last: int) -> Panels:
        """The panels from `first` up to `last`."""
        return Panels(*(values[first:last] for values in self))  # type: ignore[arg-type]


class _Stretch(NamedTuple):
    x: float
    y: float
    turn: float

    @classmethod
    def of(cls, ndf: Distribution) -> _Stretch:
        """alpha_x, alpha_y and rotation; of GTR, whose alpha is no stretch, ones."""
        return cls(*ndf._values[:3]) if "alpha_x" in ndf._names else cls(1.0, 1.0, 0.0)


def panels(ndf: Distribution, wi: Array, critical: Array, passes: bool, level: int) -> Panels:
    """For directions `wi` (directions, 3), above: the slopes that mirror light up, or let it pass."""
    stretch = _Stretch.of(ndf)
    sine = np.hypot(wi[:, 0], wi[:, 1])
    azimuth = np.arctan2(wi[:, 1], wi[:, 0]) - stretch.turn
    first = np.arctan2(stretch.y * np.sin(azimuth), stretch.x * np.cos(azimuth))  # of standard space
    corners = _corners(stretch, azimuth, first, sine, wi[:, 2], critical)
    phi, weight = _azimuths(corners, level, stretch.x == stretch.y)
    angle = first[:, np.newaxis] + phi
    x, y = stretch.x * np.cos(angle), stretch.y * np.sin(angle)
    greatest = np.hypot(stretch.x * np.cos(azimuth), stretch.y * np.sin(azimuth))
    d_p, length = greatest[:, np.newaxis] * np.cos(phi), np.hypot(x, y)
    begin, limit, cuts = _limits(sine, wi[:, 2], critical, d_p, length, passes)
    edges, singular = _snapped(_edges(ndf, passes), cuts)
    low, high = edges[..., :-1], edges[..., 1:]
    inside = (high > low) & (low >= begin[..., np.newaxis]) & (high <= limit[..., np.newaxis])
    which, at, _ = kept = np.nonzero(inside & (weight > 0)[..., np.newaxis])
    cosine, sine_ = np.cos(stretch.turn), np.sin(stretch.turn)
    return Panels(
        which,
        (x * cosine - y * sine_)[which, at],
        (x * sine_ + y * cosine)[which, at],
        low[kept],
        high[kept],
        (singular[..., :-1] | singular[..., 1:])[kept],
        (stretch.x * stretch.y * weight)[which, at],
    )


def _limits(
    sine: Array, cosine: Array, critical: Array, d_p: Array, length: Array, passes: bool
) -> tuple[Array, Array, Array]:
    """Logs of r where the slopes of an azimuth begin and end, and all at which a panel has to end."""
    s, c, critical = sine[:, np.newaxis], cosine[:, np.newaxis], critical[:, np.newaxis]
    lean = s / c * d_p
    # On the great circle of normals that a ray is, wi . m = size cos(tilt + beyond).
    across = s * d_p / length
    size, beyond = np.hypot(c, across), np.arctan2(across, c)
    half = np.arccos(np.minimum(critical / size, 1.0))
    steepest = np.arctan(np.exp(_STEEPEST))
    with np.errstate(divide="ignore", invalid="ignore"):
        nearest = np.log(np.tan(np.clip(-beyond - half, 0.0, steepest)) / length)
        farthest = np.log(np.tan(np.clip(half - beyond, 0.0, steepest)) / length)
        if passes:
            facing = np.where(lean > 0, -np.log(np.maximum(lean, 1e-300)), np.inf)
            end = np.where(critical > 0, farthest, facing)
            gap, push = np.maximum(critical**2 - c**2, 0.0), np.abs(s * d_p)
            sinks = np.log(gap / c / (push + np.sqrt(np.maximum(push**2 - length**2 * gap, 0.0))))
            sinks = np.where(gap > 0, sinks, -np.inf)
            begin = np.minimum(np.maximum(nearest, sinks), end)
            return begin, end, np.stack((begin, end), -1)
        root = np.hypot(lean, length)
        end = np.log(np.where(lean > 0, 1 / (np.abs(lean) + root), (root + np.abs(lean)) / length**2))
    cuts = np.stack((np.minimum(nearest, end), np.minimum(farthest, end), end), -1)
    return np.full_like(end, -np.inf), end, cuts if (critical > 0).any() else cuts[..., 2:]


def _corners(
    stretch: _Stretch, azimuth: Array, first: Array, sine: Array, cosine: Array, critical: Array
) -> Array:
    """Angles phi, ascending around the circle, where limits have a corner or rays begin to miss the cap."""
    quarter = np.full_like(sine, np.pi / 2)
    if not critical.any():
        return np.stack((-quarter, quarter, 3 * quarter), -1)
    s = np.maximum(sine, 1e-300)
    touching = np.arccos(np.maximum(-np.sqrt(np.maximum(critical**2 - cosine**2, 0.0)) / s, -1.0))
    steep = np.arccos(np.maximum(-critical / s, -1.0))
    real = np.stack((touching, steep, 2 * np.pi - steep, 2 * np.pi - touching), -1)
    rotated = azimuth[:, np.newaxis] + real
    standard = np.arctan2(np.sin(rotated) / stretch.y, np.cos(rotated) / stretch.x) - first[:, np.newaxis]
    inner = np.clip(np.mod(standard, 2 * np.pi), np.pi / 2, 3 * np.pi / 2)
    return np.sort(np.column_stack((-quarter, quarter, inner, 3 * quarter)), axis=-1)


def _azimuths(corners: Array, level: int, symmetric: bool) -> tuple[Array, Array]:
    """Angles phi and their weights, (directions, angles): tanh-sinh quadrature between corners.

    H. Takahasi and M. Mori, Double exponential formulas for numerical integration, 1974.
    """
    step = 0.4 * 0.5**level
    tau = np.arange(step / 2, 2.9, step)
    tau = np.concatenate((-tau[::-1], tau))
    inner = np.pi / 2 * np.sinh(tau)
    weight = step * np.pi / 2 * np.cosh(tau) / np.cosh(inner) ** 2
    half = np.diff(corners)[..., np.newaxis] / 2
    phi = (corners[:, :-1, np.newaxis] + half * (1 + np.tanh(inner))).reshape(len(corners), -1)
    weights = (half * weight).reshape(len(corners), -1)
    if symmetric:  # the other half of the circle is the same
        weights = np.where((phi > 0) & (phi < np.pi), 2 * weights, 0.0)
    return phi, weights


def _snapped(edges: Array, cuts: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Edges for each ray, moved to cuts that are near them, and which of the edges are cuts."""
    cuts = np.clip(cuts, edges[0], edges[-1])
    reach = np.empty_like(edges)
    reach[1:-1] = np.minimum(np.diff(edges)[1:], np.diff(edges)[:-1]) / 2
    reach[[0, -1]] = 0.0
    moved = np.broadcast_to(edges, (*cuts.shape[:-1], len(edges)))
    for k in range(cuts.shape[-1]):
        cut = cuts[..., k : k + 1]
        moved = np.where(np.abs(edges - cut) < reach, cut, moved)
    values = np.concatenate((moved, cuts), axis=-1)
    values.sort(axis=-1)
    singular = np.zeros(values.shape, bool)
    for k in range(cuts.shape[-1]):
        singular |= values == cuts[..., k : k + 1]
    return values, singular


@lru_cache(maxsize=256)
def _edges(ndf: Distribution, passes: bool) -> Array:
    """Edges of panels of log r: steps of the log odds of a slope below r, none longer than 1 near r = 1."""
    standard = (1.0, *ndf._arguments[3:]) if "alpha_x" in ndf._names else ndf._arguments
    odds = np.arange(-21.0, 28.0, 2.0)
    edges = list(np.log(ndf.kernels.sample_slope(1 / (1 + np.exp(-odds)), *standard)))
    # Heavy tails: on until the projected area E[r; r > R] of the steeper facets is negligible.
    while passes and edges[-1] < _STEEPEST:
        steep = np.exp(edges[-1])
        if steep * float(ndf.kernels.survival(steep, *standard)) < 1e-12:
            break
        edges.append(edges[-1] + 2.0)
    fine = [edges[0]]
    for edge in edges[1:]:
        if fine[-1] < -3.0 < edge:
            fine.append(-3.0)
        parts = int(np.ceil(edge - fine[-1])) if edge > -3.0 else 1
        fine.extend(np.linspace(fine[-1], edge, parts + 1)[1:])
    result = np.array(fine)
    result.setflags(write=False)
    return result
