"""Arguments from all over the floating-point numbers, and what the documented domain promises of each.

Half of them are random patterns of bits; the others are spread over magnitudes, near the rims of their
intervals or special.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

COSINES = ("D", "sigma", "Lambda", "G1")
NEED_MEAN = ("sigma", "Lambda", "G1")  # of the slope, which a heavier tail lacks
SHARES = ("slope_cdf", "survival", "G1", "sample_u")
ULP_ABOVE_1 = 8  # cosines up to here count as 1


def patterns(rng: np.random.Generator, n: int, dtype: type) -> Array:
    """Any bits."""
    size = 8 * np.dtype(dtype).itemsize
    return rng.integers(0, 2**size, n, dtype=f"uint{size}").view(dtype)


def magnitudes(rng: np.random.Generator, lower: float, upper: float, n: int, dtype: type) -> Array:
    with np.errstate(all="ignore"):
        return np.exp(rng.uniform(np.log(float(lower)), np.log(float(upper)), n)).astype(dtype)


def _special(rng: np.random.Generator, n: int, dtype: type, *more: float) -> Array:
    f = np.finfo(dtype)
    numbers = (0, -0.0, 1, -1, 0.5, np.inf, -np.inf, np.nan, f.tiny, f.smallest_subnormal, f.max, *more)
    with np.errstate(all="ignore"):
        return rng.choice(np.array(numbers).astype(dtype), n)


def _mixed(rng: np.random.Generator, *columns: Array) -> Array:
    return np.choose(rng.integers(0, len(columns), len(columns[0])), columns)


def values(quantity: str, rng: np.random.Generator, alpha: Array) -> Array:
    """The argument before the parameters: a cosine, a uniform number or a slope, some near alpha."""
    n, dtype = len(alpha), alpha.dtype.type
    f, sign = np.finfo(dtype), rng.choice([-1, 1], n).astype(dtype)
    any_bits, below_1 = patterns(rng, n, dtype), 1 - magnitudes(rng, f.eps / 4, 1, n, dtype)
    with np.errstate(all="ignore"):
        near = sign * alpha * magnitudes(rng, 1e-4, 1e4, n, dtype)
        if quantity in COSINES:
            rim = [1 + k * f.eps for k in (1, 3, ULP_ABOVE_1, 2 * ULP_ABOVE_1, 1e5)]
            special = _special(rng, n, dtype, *rim, *(-x for x in rim))
            small = sign * magnitudes(rng, f.tiny, 1, n, dtype)
            return _mixed(rng, any_bits, small, sign * below_1, special, near / np.hypot(dtype(1), near))
        special = _special(rng, n, dtype, 1 - f.epsneg, 1e-12, -1e-12)
        if quantity.startswith("sample"):
            return _mixed(rng, any_bits, magnitudes(rng, f.tiny, 1, n, dtype), below_1, special)
        return _mixed(rng, any_bits, sign * magnitudes(rng, f.tiny, f.max, n, dtype), near, special)


def roughness(family: Any, rng: np.random.Generator, n: int, dtype: type) -> Array:
    f, domain = np.finfo(dtype), family.parameters[0]
    lower, upper = max(1.001 * domain.lower, float(f.tiny)), min(0.999 * domain.upper, float(f.max))
    usual, wide = magnitudes(rng, 1e-4, 10, n, dtype), magnitudes(rng, lower, upper, n, dtype)
    rim = _special(rng, n, dtype, domain.lower, domain.upper, lower, upper)
    return _mixed(rng, patterns(rng, n, dtype), usual, usual, wide, wide, rim)


def shapes(family: Any, rng: np.random.Generator, n: int, dtype: type) -> list[Array]:
    columns = []
    for domain in family.parameters[1:]:
        f = np.finfo(dtype)
        upper = min(0.999 * domain.upper, float(f.max))
        usual, wide = (
            (domain.lower + magnitudes(rng, *ends, n, np.float64)).astype(dtype)
            for ends in ((1e-4, 200), (max(f.tiny, 1e-300), upper))
        )
        rim = _special(
            rng, n, dtype, domain.lower, domain.lower + 4 * float(f.eps), upper, 1.5, 2, 3, 40, 400
        )
        columns.append(_mixed(rng, patterns(rng, n, dtype), usual, usual, wide, rim))
    return columns


def domain(family: Any, quantity: str, columns: list[Array]) -> tuple[Array, Array]:
    """Where the result has to be a number, and where nan. Numbers below the normal ones count as 0."""
    f = np.finfo(columns[0].dtype)
    columns = [np.where(abs(c) < f.tiny, c.dtype.type(0), c) for c in columns]
    first = len(columns) - len(family.parameters)
    numbers = ~np.any([np.isnan(c) for c in columns], axis=0)
    x = columns[0]
    with np.errstate(invalid="ignore"):  # some patterns are signalling nans
        of_densities = [own.lower for own in family.parameters]
        of_densities[1:] = [lower for *_, lower in family.cls.kernels.parameters]
        for parameter, wider, column in zip(family.parameters, of_densities, columns[first:], strict=True):
            lower, exact = parameter.lower if quantity in NEED_MEAN else wider, column.astype(float)
            numbers &= (exact > lower) & (exact < parameter.upper)
        if quantity in COSINES:
            numbers &= abs(x) <= 1 + ULP_ABOVE_1 * f.eps
        elif quantity.startswith("sample"):
            numbers &= (x >= 0) & (x < 1)
        elif quantity == "survival":
            numbers &= x >= 0
    return numbers, ~numbers


def possible(quantity: str, result: Array) -> Array:
    """Whether a number can be this quantity at all."""
    if quantity in SHARES:
        return (result >= 0) & (result <= 1)
    if quantity == "Lambda":
        return (result >= 0) | (result <= -1)
    return result >= 0
