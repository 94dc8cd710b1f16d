"""The numbers of a texture: integrals for one roughness and one shape, over all cosines."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._bsdf.conductor import Conductor
from microfacet._bsdf.quadrature import escaped
from microfacet._bsdf.split_sum import SchlickParts

__all__ = ["CHANNELS", "row"]

Array = NDArray[np.float64]

#: What the channels of each kind of texture hold.
CHANNELS = {
    "albedo": ("albedo", "average_albedo"),
    "energy": ("missing", "missing_average"),
    "split_sum": ("scale", "bias"),
}
_NODES = 64


class Row(NamedTuple):
    """Values (cosines, channels), and the largest difference of the last two levels of the quadrature."""

    values: Array
    error: float


def row(kind: str, ndf: Any, cosine: Array) -> Row:
    """The texels of one roughness."""
    if kind == "split_sum":
        found = escaped(SchlickParts(ndf), _directions(cosine))
        return Row(found.reflected, float(found.error.max()))
    found = escaped(Conductor(ndf), _directions(cosine))
    average, average_error = _average(ndf)
    # What is missing of nearly 1 is rounding, or the error of the quadrature, and may come out below 0.
    missing = np.maximum(1 - found.reflected[:, 0], 0.0)
    pair = np.stack((missing, np.full_like(missing, average)), -1)
    return Row(pair if kind == "energy" else 1 - pair, max(float(found.error.max()), average_error))


@lru_cache(maxsize=256)
def _average(ndf: Any) -> tuple[float, float]:
    """What is missing of the light from all sides, 2 int (1 - E(c)) c dc, and the error of the integrand.

    The cube root of the cosine spreads the angles near the horizon, where a smooth surface misses the most.
    """
    x, weights = np.polynomial.legendre.leggauss(_NODES)
    x, weights = (x + 1) / 2, weights / 2
    found = escaped(Conductor(ndf), _directions(x**3))
    missing = np.maximum(1 - found.reflected[:, 0], 0.0)
    return float(weights * 6 * x**5 @ missing), float(weights * 6 * x**5 @ found.error[:, 0])


def _directions(cosine: Array) -> Array:
    sine = np.sqrt((1 - cosine) * (1 + cosine))
    return np.stack((sine, np.zeros_like(cosine), cosine), -1)
