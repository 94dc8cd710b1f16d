"""Evaluate one quantity of one family at values given as text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet._console.parameters import arguments
from microfacet._docs import QUANTITIES

__all__ = ["Evaluation", "evaluate", "quantities"]


@dataclass(frozen=True)
class Evaluation:
    """A quantity at some points: `points` has one row per evaluation, `results` one value."""

    family: str
    quantity: str
    parameters: Mapping[str, float]
    points: NDArray[Any]
    results: NDArray[Any]

    def as_dict(self) -> dict[str, Any]:
        """As a record: a single argument is no list, and a float32 has no digits beyond its own."""
        points = self.points[:, 0] if self.points.shape[1] == 1 else self.points
        return {
            "family": self.family,
            "quantity": self.quantity,
            "parameters": dict(self.parameters),
            "dtype": str(self.results.dtype),
            "values": points.tolist(),
            "results": [float(str(value)) for value in self.results],
        }


def quantities(family: Any) -> dict[str, np.ufunc]:
    """The ufuncs of a family by name."""
    kernels = family.kernels
    return {name: value for name in dir(kernels) if isinstance(value := getattr(kernels, name), np.ufunc)}


def evaluate(
    family: Any, quantity: str, values: Iterable[str], parameters: Mapping[str, float], dtype: str
) -> Evaluation:
    """Parse `values`, one evaluation each ("0.3", or "0.1,0.2" where two slopes are taken), and evaluate.

    ValueError for an unknown quantity, text that is no number, values and parameters where the quantity does
    not exist.
    """
    known = quantities(family)
    if quantity not in known:
        raise ValueError(f"quantity must be one of {', '.join(known)}, got {quantity!r}")
    scalars = [np.dtype(dtype).type(value) for value in arguments(family, parameters)]
    ufunc = known[quantity]
    columns = ufunc.nin - len(scalars)
    rows = [_numbers(value, columns, quantity) for value in values]
    points = np.array(rows, dtype=dtype).reshape(-1, columns)
    with np.errstate(all="ignore"):
        results = np.asarray(ufunc(*points.T, *scalars))
    _blame(family, quantity, parameters, points, results)
    _blame_values(quantity, points, results)
    return Evaluation(family.name, quantity, parameters, points, results)


def _numbers(text: str, columns: int, quantity: str) -> Sequence[float]:
    parts = text.replace(",", " ").split()
    try:
        numbers = [float(part) for part in parts]
    except ValueError:
        raise ValueError(f"values must be numbers, got {text.strip()!r}") from None
    if len(numbers) != columns:
        form = "one number" if columns == 1 else f"{columns} numbers such as 0.1,0.2"
        raise ValueError(f"each value of {quantity} must be {form}, got {text.strip()!r}")
    return numbers


def _blame(
    family: Any, quantity: str, parameters: Mapping[str, float], points: NDArray[Any], results: NDArray[Any]
) -> None:
    """Where nothing came out although the points are numbers, name the parameter that lies outside.

    The intervals of the quantities differ (Student-T has a density where its sigma diverges), so the result
    decides, not the interval.
    """
    if not results.size or not np.isnan(results).all() or np.isnan(points).any():
        return
    for parameter in family.parameters:
        value = parameters[parameter.name]
        if not parameter.lower < value < parameter.upper:
            interval = f"({parameter.lower:g}, {parameter.upper:g})"
            raise ValueError(f"{family.name}: {parameter.name} must lie in {interval}, got {value:g}")


def _blame_values(quantity: str, points: NDArray[Any], results: NDArray[Any]) -> None:
    """Name the first value outside the domain: where that begins, to the last digit, the result decides."""
    for argument, column in zip(QUANTITIES[quantity].arguments, points.T, strict=True):
        outside = np.isnan(results) & ((column <= argument.lower) | (column >= argument.upper))
        if outside.any():
            what = f"{quantity}: {argument.name} ({argument.meaning})"
            value = str(column[outside][0]).removesuffix(".0")
            raise ValueError(f"{what} must lie {argument.domain}, got {value}")
