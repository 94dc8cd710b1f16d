"""Slopes of a profile as a likelihood needs them: along one line, in groups that follow each other on it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._fit import blocks
from microfacet._fit.draw import SEED
from microfacet._fit.slopes import FEWEST, ROUNDING, STEEPEST, Slopes, chunks_of, step_of
from microfacet._profile import Profile

__all__ = ["ALONG", "Line", "prepare_line"]

#: Groups along a profile, as many as the cells of a map.
ALONG = blocks.CELLS**2
_TOGETHER = 8  # groups that stay in one fold
_REMARK = (
    "a profile knows the slopes along its line alone: alpha is that of a surface that is as rough in every "
    "direction as along the line"
)

Vector = NDArray[np.float64]


class Line(NamedTuple):
    """The slopes of a profile as a likelihood needs them, and as they are, in order, each with its group."""

    slopes: Slopes
    raw: Vector
    cells: NDArray[np.intp]


def prepare_line(profile: Profile, lag: int, max_slopes: int | None) -> Line:
    """Check, centre and group the slopes of a profile; `ValueError` says in one sentence what is wrong.

    Traces follow each other as if they were one, so that waves and folds of neighbouring groups run along
    all of them.
    """
    everywhere = np.concatenate(list(profile.slopes_of_traces(lag)))
    places = np.flatnonzero(np.isfinite(everywhere))
    values, cells = everywhere[places], places * ALONG // max(everywhere.size, 1)
    if values.size < FEWEST:
        raise ValueError(f"the profile has {values.size} slopes at lag {lag}, at least {FEWEST} are needed")
    if np.abs(values).max() > STEEPEST:
        worst = values[np.argmax(np.abs(values))]
        raise ValueError(
            f"slopes must lie in [-{STEEPEST:g}, {STEEPEST:g}], got {worst:g}: are the units of heights and "
            "positions right?"
        )
    notes: tuple[str, ...] = (_REMARK,)
    centre = _centre(values)
    if max_slopes is not None and values.size > max_slopes:
        notes += (f"fitted to {max_slopes} of {values.size} slopes, drawn at random with seed {SEED}",)
        chosen = np.random.default_rng(SEED).choice(values.size, max_slopes, replace=False, shuffle=False)
        chosen.sort()
        values, cells = values[chosen], cells[chosen]
    size, central = _sizes(values - centre)
    if central > 0.01:
        notes += (
            f"{central:.0%} of the slopes equal the mean slope, which favours densities infinite there",
        )
    sizes = np.bincount(cells, minlength=ALONG)
    folds = np.arange(ALONG) // _TOGETHER % blocks.FOLDS
    order = np.argsort(np.argsort(np.argsort(folds, kind="stable"))[cells], kind="stable")
    radius = size[order]
    scale = float(np.median(radius))
    zero = np.zeros_like(radius)
    slopes = Slopes(
        radius=radius,
        xx=(radius / scale) ** 2,
        yy=zero,
        xy=zero,
        sizes=sizes,
        folds=folds,
        chunks=tuple(chunks_of(sizes, folds)),
        on_map=True,
        stretch=scale * np.eye(2),
        mean=(centre,),
        mean_errors=(_centre_error(values, centre, cells),),
        notes=notes,
        shape=(ALONG, 1),
    )
    return Line(slopes, values, cells)


def _centre(values: Vector) -> float:
    """The median, and of an odd number of slopes not the middle one itself but half of its way to the next:
    densities may be infinite at the centre, and no slope lies there by construction.
    """
    middle = (values.size - 1) // 2
    low, high = np.partition(values, (middle, middle + 1))[middle : middle + 2]
    return float((low + high) / 2)


def _sizes(centred: Vector) -> tuple[Vector, float]:
    """The slopes without their signs, with a finite resolution at the centre, and the share that lies there.

    A measured 0 means some slope of its cell of quantisation, with the mean square step^2/12.
    """
    size = np.abs(centred)
    scale = float(np.median(size))
    if scale == 0:
        raise ValueError(
            "slopes: more than half of them are equal, which leaves no density to fit (try a larger lag)"
        )
    step = step_of(centred, ROUNDING * scale)
    central = size < step / 2
    return np.where(central, step / math.sqrt(12), size), float(np.mean(central))


def _centre_error(values: Vector, centre: float, cells: NDArray[np.intp]) -> float:
    """Standard error of the median: that of the share below, turned into slopes by the sample's quantiles.

    R. S. Woodruff, Confidence intervals for medians and other position measures, JASA 47, 1952.
    """
    sums = np.bincount(cells, weights=np.sign(values - centre), minlength=ALONG).astype(np.float64)
    error = max(blocks.variances(sums, True, (ALONG, 1))[0].error, math.sqrt(values.size))
    share = min(error / (2 * values.size), 0.5)
    low, high = np.quantile(values, [0.5 - share, 0.5 + share])
    return float(high - low) / 2
