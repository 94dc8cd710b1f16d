"""The command `microfacet eval`."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable

import click

from microfacet._console.program import NumbersCommand, json_option, parameter_options

__all__ = ["evaluate"]


@click.command("eval", cls=NumbersCommand)
@click.argument("family")
@click.argument("quantity")
@click.argument("values", nargs=-1, required=True)
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
    """
    from microfacet._console import evaluate as work
    from microfacet._console import records, tables
    from microfacet._console.parameters import family_named

    entry = family_named(family)
    lines: Iterable[str] = (line for line in sys.stdin if line.strip()) if values == ("-",) else values
    result = work.evaluate(entry, quantity, lines, parameters, dtype)
    if as_json:
        click.echo(json.dumps(records.finite(result.as_dict()), allow_nan=False))
    else:
        tables.evaluation(tables.console(), result)
