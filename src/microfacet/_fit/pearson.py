"""The law of a sum of squares whose terms depend on each other."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from microfacet._fit import blocks

__all__ = ["Covariance", "of_cells", "probability"]

Vector = NDArray[np.float64]


class Covariance(NamedTuple):
    """Of totals, and from how many waves over the map it was estimated (inf: it is known)."""

    matrix: Vector
    number: float


def of_cells(sums: Vector, shape: tuple[int, int] = blocks.WHOLE) -> Covariance:
    """Of the totals of the columns, from their sums over the cells of a map or of a line."""
    waves = blocks.waves(sums, shape)
    _, fall, number = blocks.decline(np.sum(waves**2, axis=1)[:, np.newaxis], shape)
    raised = waves * np.sqrt(blocks.weights(float(fall[0]), shape))[:, np.newaxis]
    return Covariance(len(sums) / len(waves) * raised.T @ raised, float(number[0]))


def probability(totals: Vector, covariance: Covariance) -> float:
    """That the sum of squares of totals with this covariance and no mean exceeds that of these.

    The sum has the moments of a chi-squared number of so many degrees of freedom. J. N. K. Rao & A. J. Scott,
    On chi-squared tests for multiway contingency tables with cell proportions estimated from survey data,
    Annals of Statistics 12, 1984; for an estimated covariance F. E. Satterthwaite, An approximate
    distribution of estimates of variance components, Biometrics Bulletin 2, 1946.
    """
    matrix, count = covariance
    trace, squares = float(np.trace(matrix)), float(np.sum(matrix**2))
    if math.isfinite(count):  # the square of an estimate exceeds the square by its variance
        squares = (squares - trace**2 / count) * count**2 / ((count - 1) * (count + 2))
    if not (math.isfinite(trace) and trace > 0 and math.isfinite(squares)):
        return math.nan
    freedom = min(max(trace**2 / max(squares, 1e-300), 1.0), float(len(totals)))
    ratio = float(totals @ totals) / trace
    if math.isfinite(count):
        return float(stats.f.sf(ratio, freedom, freedom * count))
    return float(stats.chi2.sf(ratio * freedom, freedom))
