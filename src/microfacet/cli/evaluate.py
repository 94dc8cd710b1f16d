"""The command `microfacet eval`: one quantity of one family at values given as text."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

from microfacet._docs import QUANTITIES
from microfacet.cli.densities import DensityCommand, density_option, filled
from microfacet.cli.parameters import arguments, family_named, parameter_options
from microfacet.cli.printing import console, finite, show
from microfacet.cli.program import NumbersCommand, json_option

__all__ = ["Evaluation", "at", "evaluate"]


class _Command(DensityCommand, NumbersCommand):
    """Both."""


@click.command("eval", cls=_Command)
@click.argument("family")
@click.argument("quantity")
@click.argument("values", nargs=-1, required=True)
@density_option
@parameter_options
@click.option("--dtype", type=click.Choice(["float64", "float32"]), default="float64", help="Precision.")
@json_option
def evaluate(
    family: str,
    quantity: str,
    values: tuple[str, ...],
    parameters: dict[str, float],
    dtype: str,
    as_json: bool,
) -> None:
    """Evaluate QUANTITY of FAMILY at VALUES, or at the lines of stdin where VALUES is "-".

    QUANTITY is D, P22, P2, slope_cdf, sigma, Lambda, G1, survival, sample_slope or sample_u. P22 takes pairs
    of slopes: 0.1,0.2. JSON has no inf and no nan: with --json they become null.

    \b
    Examples:
      microfacet eval ggx Lambda 0.1 0.5 0.9 --alpha 0.3
      microfacet eval beckmann sigma -0.5 --alpha 0.5
      seq 0 0.1 1 | microfacet eval student_t D - --alpha 0.3 --gamma 2.5
      microfacet eval --density own.json Lambda 0.5 --alpha 0.3
    """

    entry = family_named(family)
    lines: Iterable[str] = (line for line in sys.stdin if line.strip()) if values == ("-",) else values
    result = at(entry, quantity, lines, filled(entry, parameters), dtype)
    if as_json:
        click.echo(json.dumps(finite(result.as_dict()), allow_nan=False))
    else:
        _print(result)


def _print(result: Evaluation) -> None:
    """One row per point; every digit that distinguishes the result."""
    names = [argument.name for argument in QUANTITIES[result.quantity].arguments]
    rows = [
        [*map(str, point), str(value)] for point, value in zip(result.points, result.results, strict=True)
    ]
    show(console(), [*names, result.quantity], rows, left=0)


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


def at(
    family: Any, quantity: str, values: Iterable[str], parameters: Mapping[str, float], dtype: str
) -> Evaluation:
    """Parse `values`, one evaluation each ("0.3", or "0.1,0.2" where two slopes are taken), and evaluate.

    ValueError for an unknown quantity, text that is no number, values and parameters where the quantity does
    not exist.
    """
    kernels = family.kernels
    known = {name: getattr(kernels, name) for name in sorted(QUANTITIES)}
    if quantity not in known:
        raise ValueError(f"quantity must be one of {', '.join(known)}, got {quantity!r}")
    scalars = [np.dtype(dtype).type(value) for value in arguments(family, parameters)]
    ufunc = known[quantity]
    columns = len(QUANTITIES[quantity].arguments)
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
