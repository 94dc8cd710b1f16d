"""Slopes as a likelihood needs them: checked, centred, whitened, in groups, and with a finite resolution."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._fit import blocks
from microfacet._fit.draw import SEED

__all__ = [
    "FEWEST",
    "MAX_SLOPES",
    "ROUNDING",
    "STEEPEST",
    "Slopes",
    "chunks_of",
    "prepare",
    "step_of",
]

#: Slopes used at most, unless the caller asks for more; bounds memory (40 bytes each) and time.
MAX_SLOPES = 4_000_000

#: Slopes without which nothing is fitted.
FEWEST = 20
#: Far beyond any surface: a larger slope is a mistake in the units.
STEEPEST = 1e6
#: Slopes closer than this part of their median size are equal but for rounding.
ROUNDING = 1e-9
_PART = 50_000  # slopes from which quantities are estimated that need no more than a percent
_CHUNK = 32_768  # slopes at a time: their arrays stay in the cache

Vector = NDArray[np.float64]


class Chunk(NamedTuple):
    """Slopes that are worked on at a time, all of one fold: where they are, and which groups begin where in
    them.
    """

    fold: int
    where: slice
    groups: NDArray[np.intp]
    starts: NDArray[np.intp]


@dataclass(frozen=True)
class Slopes:
    """Centred slopes in groups (cells of a map), and their whitened form.

    Whitened slopes are ``z = stretch^-1 slope``, isotropic with median length 1 but for what is left to fit.
    They are kept as ``z_x^2, z_y^2, z_x z_y``, in which the squared length after a further linear map is
    linear.
    """

    radius: Vector  # of the slopes as measured
    xx: Vector
    yy: Vector
    xy: Vector
    sizes: NDArray[np.intp]  # slopes in each group
    folds: NDArray[np.intp]  # fold of each group
    chunks: tuple[Chunk, ...]
    on_map: bool  # or along a line: whether groups lie side by side, in a rectangle of this shape
    stretch: NDArray[np.float64]
    mean: tuple[float, ...]
    mean_errors: tuple[float, ...]
    notes: tuple[str, ...]
    shape: tuple[int, int] = blocks.WHOLE

    @property
    def n(self) -> int:
        return self.xx.size

    def totals(self, values: Vector) -> Vector:
        """Sums over each group of a value for each slope."""
        found = np.zeros(len(self.sizes))
        for chunk in self.chunks:
            found[chunk.groups] += np.add.reduceat(values[chunk.where], chunk.starts)
        return found

    def part(self, size: int) -> Slopes:
        """Every k-th slope as one group, so that about `size` remain, for a cheap first search."""
        every = slice(None, None, max(1, self.n // size))
        xx, zero = self.xx[every], np.zeros(1, dtype=np.intp)
        return replace(
            self,
            radius=self.radius[every],
            xx=xx,
            yy=self.yy[every],
            xy=self.xy[every],
            sizes=np.array([xx.size]),
            folds=zero,
            chunks=tuple(chunks_of(np.array([xx.size]), zero)),
            on_map=False,
        )


def chunks_of(sizes: NDArray[np.intp], folds: NDArray[np.intp]) -> Iterator[Chunk]:
    """Groups that follow each other, sorted by fold, in pieces that fit into a cache; large groups are
    cut.
    """
    order = np.argsort(folds, kind="stable")
    order = order[sizes[order] > 0]
    begin, groups, starts, filled = 0, list[int](), list[int](), 0
    for k, group in enumerate(order.tolist()):
        groups.append(group)
        starts.append(filled)
        filled += int(sizes[group])
        last = k + 1 == len(order) or folds[order[k + 1]] != folds[group]
        if not (last or filled + sizes[order[k + 1]] > _CHUNK):
            continue
        if len(groups) > 1 or filled <= _CHUNK:
            where = slice(begin, begin + filled)
            yield Chunk(int(folds[group]), where, np.array(groups), np.array(starts))
        else:
            for first in range(begin, begin + filled, _CHUNK):
                where = slice(first, min(first + _CHUNK, begin + filled))
                yield Chunk(int(folds[group]), where, np.array(groups), np.zeros(1, dtype=np.intp))
        begin, groups, starts, filled = begin + filled, [], [], 0


def prepare(
    slopes: ArrayLike,
    max_slopes: int | None,
    cells: NDArray[np.int16] | None = None,
    notes: tuple[str, ...] = (),
) -> Slopes:
    """Check, centre, group and whiten `slopes`; `ValueError` says in one sentence what is wrong."""
    array = _checked(slopes)
    # The densities are symmetric, so the median estimates their mean; it settles where the sample mean does
    # not (infinite variance), and where the likelihood is infinite at every slope (infinite central density).
    mean = np.median(array, axis=0)
    if max_slopes is not None and len(array) > max_slopes:
        notes += (f"fitted to {max_slopes} of {len(array)} slopes, drawn at random with seed {SEED}",)
        chosen = np.random.default_rng(SEED).choice(len(array), max_slopes, replace=False, shuffle=False)
        chosen.sort()
        array, cells = array[chosen], None if cells is None else cells[chosen]
    squares, central = _squares(*np.ascontiguousarray((array - mean).T))
    if central > 0.01:
        notes += (
            f"{central:.0%} of the slopes equal the mean slope, which favours densities infinite there",
        )
    groups = (np.arange(len(array)) % blocks.GROUPS).astype(np.int16) if cells is None else cells
    count = blocks.GROUPS if cells is None else blocks.CELLS**2
    sizes, folds = np.bincount(groups, minlength=count), blocks.fold_of_group(count)
    place = np.empty(count, dtype=np.int16)
    place[np.argsort(folds, kind="stable")] = np.arange(count)
    order = np.argsort(place[groups], kind="stable")
    p2, q2, pq = (square[order] for square in squares)
    stretch = _stretch(squares)
    inverse = np.linalg.inv(stretch)
    xx, yy, xy = (
        (inverse[i, 0] * inverse[j, 0]) * p2
        + (inverse[i, 1] * inverse[j, 1]) * q2
        + (inverse[i, 0] * inverse[j, 1] + inverse[i, 1] * inverse[j, 0]) * pq
        for i, j in ((0, 0), (1, 1), (0, 1))
    )
    return Slopes(
        radius=np.sqrt(p2 + q2),
        xx=xx,
        yy=yy,
        xy=xy,
        sizes=sizes,
        folds=folds,
        chunks=tuple(chunks_of(sizes, folds)),
        on_map=cells is not None,
        stretch=stretch,
        mean=(float(mean[0]), float(mean[1])),
        mean_errors=_median_errors(array, mean, groups, count, cells is not None),
        notes=notes,
    )


def _median_errors(
    array: NDArray[np.float64], mean: Vector, groups: NDArray[Any], count: int, on_map: bool
) -> tuple[float, float]:
    """Standard errors of the medians: those of the share below, turned into slopes by the sample's quantiles.

    R. S. Woodruff, Confidence intervals for medians and other position measures, JASA 47, 1952.
    """
    result = []
    for column, middle in zip(array.T, mean, strict=True):
        above = np.sign(column - middle)
        if on_map:
            sums = np.bincount(groups, weights=above, minlength=count).astype(np.float64)
            error = max(blocks.variances(sums, True)[0].error, math.sqrt(len(column)))
        else:
            error = math.sqrt(len(column))
        share = min(error / (2 * len(column)), 0.5)
        low, high = np.quantile(column, [0.5 - share, 0.5 + share])
        result.append(float(high - low) / 2)
    return result[0], result[1]


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
    step_p, step_q = step_of(p, ROUNDING * scale), step_of(q, ROUNDING * scale)
    central = (np.abs(p) < step_p / 2) & (np.abs(q) < step_q / 2)
    p2 = np.where(central, step_p**2 / 12, p * p)
    q2 = np.where(central, step_q**2 / 12, q * q)
    return (p2, q2, np.where(central, 0.0, p * q)), float(np.mean(central))


def step_of(values: Vector, rounding: float) -> float:
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
    every = slice(None, None, max(1, squares[0].size // _PART))
    squares = (squares[0][every], squares[1][every], squares[2][every])
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
    if len(array) < FEWEST:
        raise ValueError(f"slopes: at least {FEWEST} are needed, got {len(array)}")
    array = array.astype(np.float64)
    bad = ~(np.abs(array) <= STEEPEST).all(axis=1)
    if bad.any():
        row = int(np.argmax(bad))
        raise ValueError(
            f"slopes must be finite and lie in [-{STEEPEST:g}, {STEEPEST:g}], "
            f"got {tuple(array[row].tolist())} in row {row}: are heights and pixel size in the same unit?"
        )
    for name, column in zip(("first", "second"), array.T, strict=True):
        if np.ptp(column) == 0:
            raise ValueError(
                f"slopes: the {name} component is constant ({column[0]:g}), there is nothing to fit"
            )
    return array
