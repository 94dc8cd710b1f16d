"""Slopes as a likelihood needs them: checked, centred, thinned out, and with a finite resolution."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["MAX_SLOPES", "Slopes", "prepare"]

#: Slopes used at most, unless the caller asks for more. Neighbouring slopes of a measured map depend on each
#: other, so a larger share of them takes time without adding as much information as their number suggests.
MAX_SLOPES = 60_000

_SEED = 0
_FEWEST = 20
# Far beyond any surface: a larger slope is a mistake in the units.
_STEEPEST = 1e6
# Slopes closer than this part of their median size are equal but for rounding.
_ROUNDING = 1e-9

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Slopes:
    """Centred slopes, and their whitened form.

    Whitened slopes are ``z = stretch^-1 slope``, isotropic with median length 1 but for what is left to fit.
    They are kept as three quadratic forms, in which the squared radius is linear whatever stretch remains:
    ``A (z_x^2 + z_y^2) + B (z_x^2 - z_y^2) + C 2 z_x z_y``.
    """

    radius: Vector  # of the slopes as measured
    sum_: Vector
    difference: Vector
    product: Vector
    stretch: NDArray[np.float64]
    mean: tuple[float, float]
    notes: tuple[str, ...]

    @property
    def n(self) -> int:
        return self.sum_.size

    def part(self, size: int) -> Slopes:
        """Every k-th slope, so that about `size` remain, for a cheap first search."""
        every = slice(None, None, max(1, self.n // size))
        return replace(
            self,
            radius=self.radius[every],
            sum_=self.sum_[every],
            difference=self.difference[every],
            product=self.product[every],
        )


def prepare(slopes: ArrayLike, max_slopes: int | None) -> Slopes:
    """Check, centre, thin out and whiten `slopes`; `ValueError` says in one sentence what is wrong."""
    array = _checked(slopes)
    notes: tuple[str, ...] = ()
    # The densities are symmetric, so the median estimates their mean; it settles where the sample mean does
    # not (infinite variance, a density infinite at its centre).
    mean = np.median(array, axis=0)
    if max_slopes is not None and len(array) > max_slopes:
        notes = (f"fitted to {max_slopes} of {len(array)} slopes, drawn at random with seed {_SEED}",)
        chosen = np.random.default_rng(_SEED).choice(len(array), max_slopes, replace=False)
        array = array[np.sort(chosen)]
    squares, central = _squares(*(array - mean).T)
    if central > 0.01:
        notes += (
            f"{central:.0%} of the slopes equal the mean slope, which favours densities infinite there",
        )
    stretch = _stretch(squares)
    p2, q2, pq = squares
    inverse = np.linalg.inv(stretch)
    x2, y2, xy = (
        (inverse[i, 0] * inverse[j, 0]) * p2
        + (inverse[i, 1] * inverse[j, 1]) * q2
        + (inverse[i, 0] * inverse[j, 1] + inverse[i, 1] * inverse[j, 0]) * pq
        for i, j in ((0, 0), (1, 1), (0, 1))
    )
    return Slopes(
        np.sqrt(p2 + q2), x2 + y2, x2 - y2, 2 * xy, stretch, (float(mean[0]), float(mean[1])), notes
    )


def _squares(p: Vector, q: Vector) -> tuple[tuple[Vector, Vector, Vector], float]:
    """p^2, q^2, p q, with a finite resolution at the centre, and the share of slopes that lie there.

    The density of k0 and bessel_k is infinite at slope 0, where quantised heights put many slopes, so the
    likelihood of the slopes as points has no maximum. A measured slope of 0 means some slope of its cell of
    quantisation: it counts with the mean squares p^2 = step_p^2 / 12, q^2 = step_q^2 / 12 of that cell.
    """
    scale = float(np.median(np.hypot(p, q)))
    if scale == 0:
        raise ValueError(
            "slopes: more than half of them are equal, which leaves no density to fit (try a larger lag)"
        )
    step_p, step_q = _step(p, _ROUNDING * scale), _step(q, _ROUNDING * scale)
    central = (np.abs(p) < step_p / 2) & (np.abs(q) < step_q / 2)
    p2 = np.where(central, step_p**2 / 12, p * p)
    q2 = np.where(central, step_q**2 / 12, q * q)
    return (p2, q2, np.where(central, 0.0, p * q)), float(np.mean(central))


def _step(values: Vector, rounding: float) -> float:
    """The step of quantised values; `rounding`, which is next to nothing, for values that do not repeat."""
    gaps = np.diff(np.sort(values))
    distinct = gaps[gaps > rounding]
    if len(distinct) == 0 or len(distinct) > len(values) / 2:
        return rounding
    # Most gaps are one step, those in the tails are several: a low quantile, and no single odd gap.
    return float(np.quantile(distinct, 0.1))


def _stretch(squares: tuple[Vector, Vector, Vector]) -> NDArray[np.float64]:
    """The symmetric matrix that makes standard slopes of median length 1 into these, estimated robustly.

    Axes and anisotropy are Tyler's M-estimator, which does not depend on the radial density at all. (A
    covariance would: for heavy tails it is infinite.) D. E. Tyler, A distribution-free M-estimator of
    multivariate scatter, Annals of Statistics 15, 1987.
    """
    p2, q2, pq = squares
    # Equal size along x and y to begin with, so that the iteration starts near its end.
    widths = np.sqrt([np.median(p2), np.median(q2)])
    widths = np.where(widths > 0, widths, np.sqrt([np.mean(p2), np.mean(q2)]))
    p2, q2, pq = p2 / widths[0] ** 2, q2 / widths[1] ** 2, pq / (widths[0] * widths[1])
    a, b = 0.0, 0.0  # scatter matrix ((1 + a, b), (b, 1 - a))
    for _ in range(50):
        weight = 1 / np.maximum((1 - a) * p2 + (1 + a) * q2 - 2 * b * pq, 1e-30)
        total = np.sum(weight * (p2 + q2))
        a, b = float(np.sum(weight * (p2 - q2)) / total), float(np.sum(weight * 2 * pq) / total)
        if 1 - math.hypot(a, b) < 1e-10:
            raise ValueError("slopes: all of them lie on one line, which has no density in two dimensions")
    inverse_scatter = np.array([[1 - a, -b], [-b, 1 + a]]) / np.outer(widths, widths)
    radius2 = (
        inverse_scatter[0, 0] * squares[0]
        + inverse_scatter[1, 1] * squares[1]
        + 2 * inverse_scatter[0, 1] * squares[2]
    )
    values, axes = np.linalg.eigh(np.linalg.inv(inverse_scatter) * np.median(radius2))
    return np.asarray(axes @ np.diag(np.sqrt(values)) @ axes.T)


def _checked(slopes: ArrayLike) -> NDArray[np.float64]:
    try:
        array: NDArray[Any] = np.asarray(slopes)
    except ValueError:  # rows of different lengths
        array = np.empty(0, dtype=object)
    if array.ndim != 2 or array.shape[1] != 2 or array.dtype.kind not in "iuf":
        raise ValueError(
            f"slopes must be a Surface or real numbers of shape (N, 2), got {array.dtype}, {array.shape}"
        )
    if len(array) < _FEWEST:
        raise ValueError(f"slopes: at least {_FEWEST} are needed, got {len(array)}")
    array = array.astype(np.float64)
    bad = ~(np.abs(array) <= _STEEPEST).all(axis=1)
    if bad.any():
        row = int(np.argmax(bad))
        raise ValueError(
            f"slopes must be finite and lie in [-{_STEEPEST:g}, {_STEEPEST:g}], "
            f"got {tuple(array[row].tolist())} in row {row}"
        )
    for name, column in zip(("first", "second"), array.T, strict=True):
        if np.ptp(column) == 0:
            raise ValueError(
                f"slopes: the {name} component is constant ({column[0]:g}), there is nothing to fit"
            )
    return array
