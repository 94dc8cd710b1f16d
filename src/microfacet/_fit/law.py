"""The law of a slope's length, or of its size along a line, under a family: what fits need of kernels."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

__all__ = ["Law"]

Vector = NDArray[np.float64]

_REACH = 700.0  # of logarithms of a slope over alpha


@dataclass(frozen=True)
class Law:
    """Of isotropic slopes.

    Attributes
    ----------
    kernels : module
        Of the family.
    along_line : bool
        Whether slopes are known along one line alone: then the density is that of the slope along it, P2, and
        its size takes the place of the length.
    """

    kernels: Any
    along_line: bool

    def density(self, radius: Vector, alpha: float, *shape: float) -> Vector:
        """P22 at slopes of this length, or P2 at slopes of this size along the line."""
        if self.along_line:
            return np.asarray(self.kernels.P2(radius, alpha, *shape))
        return np.asarray(self.kernels.P22(radius, 0.0, alpha, *shape))

    def beyond(self, radius: Vector, alpha: float, *shape: float) -> Vector:
        """The probability of longer slopes."""
        if self.along_line:
            return 2 * np.asarray(self.kernels.slope_cdf(-radius, alpha, *shape))
        return np.asarray(self.kernels.survival(radius, alpha, *shape))

    def quantile(self, probability: float, alpha: float, *shape: float) -> float:
        """The length below which slopes are with this probability."""
        if not self.along_line:
            return float(self.kernels.sample_slope(probability, alpha, *shape))
        share, cdf = (1 - probability) / 2, self.kernels.slope_cdf

        def excess(log_ratio: float) -> float:
            return float(cdf(-alpha * math.exp(log_ratio), alpha, *shape)) - share

        low, high = -1.0, 1.0
        while low > -_REACH and excess(low) < 0:
            low *= 2
        while high < _REACH and excess(high) > 0:
            high *= 2
        return alpha * math.exp(brentq(excess, low, high, xtol=1e-13))
