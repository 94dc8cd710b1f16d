"""The accuracy contract: its ranges, its tolerances, and a measurement of the ufuncs against reference.py.

Shared by tests/test_accuracy.py (few points) and tools/measure_accuracy.py (many points, docs/accuracy.md).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from flint import arb

import microfacet as mf
import reference

QUANTITIES = (
    "D", "P22", "P2", "slope_cdf", "sigma", "Lambda", "G1", "survival", "sample_slope", "sample_u",
)  # fmt: skip
SEED = 20240607


@dataclass(frozen=True)
class Contract:
    """Largest relative error where abs(log(value)) < central, and beyond it down to smallest."""

    central: float
    tolerance: float
    tail_tolerance: float
    smallest: float
    largest: float


CONTRACTS = {
    "float64": Contract(50.0, 1e-13, 1e-12, 1e-300, 1e300),
    "float32": Contract(20.0, 4e-6, 5e-5, 1e-37, 1e37),
}

# Strata. A number stands for itself; a function draws one from (generator, alpha, shape parameter or nan).
Draw = Callable[[np.random.Generator, float, float], float]
Stratum = float | Draw
Strata = tuple[Stratum, ...]


def _log(low: float, high: float) -> Draw:
    return lambda rng, alpha, shape: math.exp(rng.uniform(math.log(low), math.log(high)))


def _around(centre: float, low: float, high: float) -> Draw:
    """At a log-uniform distance on either side."""
    distance = _log(low, high)
    return lambda rng, alpha, shape: centre + rng.choice((-1.0, 1.0)) * distance(rng, alpha, shape)


def _offset(centre: float, low: float, high: float, sign: float = 1.0) -> Draw:
    """At a log-uniform distance above, or below."""
    distance = _log(low, high)
    return lambda rng, alpha, shape: centre + sign * distance(rng, alpha, shape)


def _signed(stratum: Stratum) -> Draw:
    return lambda rng, alpha, shape: rng.choice((-1.0, 1.0)) * _value(stratum, rng, alpha, shape)


def _minus(stratum: Stratum) -> Draw:
    return lambda rng, alpha, shape: -_value(stratum, rng, alpha, shape)


def _value(stratum: Stratum, rng: np.random.Generator, alpha: float, shape: float) -> float:
    return stratum if isinstance(stratum, float) else stratum(rng, alpha, shape)


def _slope(low: float, high: float) -> Draw:
    """A slope whose ratio to alpha is log-uniform, within the contract's largest slope."""
    ratio = _log(low, high)
    return lambda rng, alpha, shape: min(alpha * ratio(rng, alpha, shape), 1e6 * max(alpha, 1.0))


def _largest_slope(rng: np.random.Generator, alpha: float, shape: float) -> float:
    return 1e6 * max(alpha, 1.0)


def _wide_slope(rng: np.random.Generator, alpha: float, shape: float) -> float:
    """A slope in units of alpha sqrt(a), the width of bessel_k."""
    width = alpha * math.sqrt(shape) if 1.0 < shape < 1e3 else alpha
    return width * rng.uniform(0.0, 6.0)


def _cosine(cotangent: Draw) -> Draw:
    """The cosine of a direction whose cotangent is drawn."""

    def cosine(rng: np.random.Generator, alpha: float, shape: float) -> float:
        mu = cotangent(rng, alpha, shape)
        return max(mu / math.hypot(1.0, mu), 1e-12)

    return cosine


BELOW_1, BELOW_1_SINGLE = 1.0 - 2.0**-53, 1.0 - 2.0**-24

_SLOPES: Strata = (
    0.0, 1e-30, _log(1e-300, 1e-100), _largest_slope, _log(1e-12, 1e6), _slope(1e-9, 1.0), _slope(1e-2, 5.0),
    _slope(0.5, 26.0), _slope(2.0, 340.0), _slope(1.0, 1e9), _wide_slope, _wide_slope,
)  # fmt: skip
_UPPER_COSINES: Strata = (
    1e-12, 1.0, BELOW_1, BELOW_1_SINGLE, _log(1e-12, 1.0), _offset(1.0, 2.0**-53, 0.5, -1.0),
    _cosine(_slope(1e-6, 1.0)), _cosine(_slope(1e-2, 5.0)), _cosine(_slope(1.0, 25.0)),
    _cosine(_slope(2.0, 340.0)), _cosine(_wide_slope), _cosine(_wide_slope),
)  # fmt: skip
_COSINES: Strata = (0.0, *_UPPER_COSINES, *(_minus(u) for u in _UPPER_COSINES))
_UNIFORMS: Strata = (
    0.0, 0.5, 2.0**-53, BELOW_1, BELOW_1_SINGLE, _log(1e-300, 1e-30), _log(1e-37, 1e-3), _log(1e-3, 1.0),
    _offset(1.0, 2.0**-53, 1.0, -1.0), _offset(1.0, 2.0**-24, 1.0, -1.0),
)  # fmt: skip
_SIGNED_SLOPES: Strata = tuple(_signed(p) for p in _SLOPES)
_ARGUMENTS: dict[str, tuple[Strata, ...]] = {
    "D": (_COSINES,), "P22": (_SIGNED_SLOPES, _SIGNED_SLOPES), "P2": (_SIGNED_SLOPES,),
    "slope_cdf": (_SIGNED_SLOPES,), "sigma": (_COSINES,), "Lambda": (_COSINES,), "G1": (_COSINES,),
    "survival": (_SLOPES,), "sample_slope": (_UNIFORMS,), "sample_u": (_UNIFORMS,),
}  # fmt: skip

_ALPHAS: Strata = (1e-4, 10.0, 1.0, _log(1e-4, 10.0), _log(1e-4, 10.0), _log(1e-2, 2.0))
_SHAPES: dict[str, tuple[Strata, ...]] = {
    "beckmann": (_ALPHAS,),
    "ggx": (_ALPHAS,),
    "k0": (_ALPHAS,),
    "gtr": (
        (*_ALPHAS, 1.0 + 1e-9, 1.0 - 1e-9, _around(1.0, 1e-15, 0.3)),
        (
            0.25, 15.0, 1.0, 1.0 + 1e-10, 1.5, 2.0, _around(1.0, 1e-15, 0.5), _around(2.0, 1e-15, 0.5),
            _log(0.25, 15.0), _log(0.25, 2.0), _log(2.0, 15.0),
        ),
    ),
    "student_t": (
        _ALPHAS,
        (
            1.5001, 1e6, 2.0, 3.0, _around(2.0, 1e-15, 0.4), _offset(1.5, 1e-4, 1.0), _log(1.6, 30.0),
            _log(10.0, 1e6),
        ),
    ),
    "bessel_k": (
        _ALPHAS,
        (
            0.05, 150.0, 0.5, 1.0, 1.5, 2.0, _around(1.0, 1e-15, 0.3), _around(0.5, 1e-15, 0.1),
            _log(0.05, 150.0), _log(0.05, 1.0), _log(1.0, 12.0), _log(2.0, 30.0), _log(2.0, 30.0),
        ),
    ),
}  # fmt: skip
_MEANLESS: Strata = (1.05, _offset(1.0, 0.05, 0.5))  # gamma of student_t where sigma does not exist


def _shapes(family: str) -> tuple[Strata, ...]:
    """Of a family without special values of its own: all over the domain of its shape parameters."""
    (record,) = (record for record in mf.families() if record.name == family)
    domains = ((p.lower, min(p.upper - p.lower, 100.0)) for p in record.parameters[1:])
    return (_ALPHAS, *((_offset(lower, 0.01 * size, 0.99 * size),) for lower, size in domains))


def _strata(family: str, quantity: str) -> list[Strata]:
    """Of the parameters, then of the arguments."""
    alpha, *shape = _SHAPES.get(family) or _shapes(family)
    if family == "student_t" and quantity not in ("sigma", "Lambda", "G1"):
        shape = [(*_MEANLESS, *shape[0])]
    return [alpha, *shape, *_ARGUMENTS[quantity]]


def points(
    family: str, quantity: str, count: int, seed: int = SEED, rounded: bool = True
) -> list[tuple[float, ...]]:
    """Arguments of the ufunc, a Latin sample of the strata.

    ``rounded`` to float32, they serve both precisions. Uniforms that rounding takes to 1 are left out, as are
    numbers that it makes subnormal.
    """
    # One set of points where the functions derive from one integral, which is then computed once.
    shared = {"Lambda": "sigma", "G1": "sigma", "sample_u": "sample_slope"}.get(quantity, quantity)
    rng = np.random.default_rng([seed, *f"{family}.{shared}.{rounded}".encode()])
    strata = _strata(family, quantity)
    columns = [[s[i % len(s)] for i in rng.permutation(max(count, len(s)))[:count]] for s in strata]
    n = reference.FAMILIES[family]
    smallest = float(np.finfo(np.float32).tiny) if rounded else 0.0
    result = []
    for row in zip(*columns, strict=True):
        drawn: list[float] = []
        for stratum in row:
            alpha = drawn[0] if drawn else math.nan
            shape = drawn[1] if len(drawn) >= n == 2 else math.nan
            number = _value(stratum, rng, alpha, shape)
            drawn.append(float(np.float32(number)) if rounded else float(number))
        point = (*drawn[n:], *drawn[:n])
        possible = point[0] < 1.0 or not quantity.startswith("sample")
        if possible and all(x == 0.0 or abs(x) >= smallest for x in point):
            result.append(point)
    return result


@dataclass(frozen=True)
class Measurement:
    arguments: tuple[float, ...]
    result: float
    truth: arb
    error: float  # relative, but absolute for sample_u; 0 for a permitted underflow or overflow
    tolerance: float
    tail: bool

    @property
    def ok(self) -> bool:
        return self.error <= self.tolerance

    def __str__(self) -> str:
        arguments = ", ".join(map(repr, self.arguments))
        truth = self.truth.mid().str(20, radius=False)
        error = f"error {self.error:.2g} > {self.tolerance:g}"
        return f"({arguments}): got {self.result!r}, true {truth}, {error}"


def judge(quantity: str, arguments: tuple[float, ...], result: float, truth: arb, dtype: str) -> Measurement:
    contract = CONTRACTS[dtype]
    size = abs(truth)
    if quantity == "sample_u":
        error = math.inf if math.isnan(result) else abs(result - float(truth))
        return Measurement(arguments, result, truth, error, contract.tolerance, False)
    if truth == 0 or not truth.is_finite():
        error = reference.relative_error(result, truth)
        return Measurement(arguments, result, truth, error, 0.0, False)
    if size < contract.smallest:  # may flush to zero
        error = 0.0 if 0 <= result * (1 if truth > 0 else -1) <= 1.01 * contract.smallest else math.inf
        return Measurement(arguments, result, truth, error, 0.0, True)
    if size > contract.largest and math.isinf(result) and (result > 0) == bool(truth > 0):
        return Measurement(arguments, result, truth, 0.0, 0.0, True)
    tail = not abs(float(size.log())) < contract.central
    tolerance = contract.tail_tolerance if tail else contract.tolerance
    return Measurement(arguments, result, truth, reference.relative_error(result, truth), tolerance, tail)


def measure(
    function: Callable[..., np.ndarray],
    family: str,
    quantity: str,
    dtype: str,
    sample: list[tuple[float, ...]],
) -> Iterator[Measurement]:
    """Judge the ufunc at every point of the sample, which must be representable in dtype."""
    columns = [np.array(column, dtype) for column in zip(*sample, strict=True)]
    results = function(*columns)
    assert results.dtype == dtype, f"{family}.{quantity} returned {results.dtype} for {dtype}"
    for arguments, result in zip(sample, results, strict=True):
        truth = reference.value(family, quantity, *arguments)
        yield judge(quantity, arguments, float(result), truth, dtype)
