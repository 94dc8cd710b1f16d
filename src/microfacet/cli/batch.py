"""A table of many fitted files: one row a file, as CSV or Parquet."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from microfacet._files import ending, replacing
from microfacet._optional import needed, require

if TYPE_CHECKING:
    from microfacet.cli.fits import Failure, Fitted

__all__ = ["ENDINGS", "checked_output", "row", "save"]

ENDINGS = (".csv", ".parquet")
Row = dict[str, Any]
_TEXT = frozenset(("error", "tied", "second", "verdict", "warnings", "notes"))  # also where no row has any


def checked_output(path: str) -> str:
    """The ending of a file that is to be written; an error before anything is computed if it cannot be."""
    found = ending(path, ENDINGS, ".csv")
    if found == ".parquet":
        require("a .parquet file (.csv does not) needs", "parquet")
    if not Path(path).absolute().parent.is_dir():
        raise ValueError(f"--output must lie in an existing folder, got {path!r}")
    return found


def row(file: str, outcome: Fitted | Failure) -> Row:
    """What is known of a file: the map, its roughness, the best fit and how far ahead of the next it is.

    Lengths are in metres. Parameters are columns of their own, with their standard errors.
    """
    from microfacet.cli import fits

    if isinstance(outcome, fits.Failure):
        return {"file": file, "error": outcome.error}
    first, *others = outcome.results
    extent, values = outcome.extent, outcome.roughness
    found: Row = {"file": file, "error": None}
    if extent is not None:
        found |= {
            "pixel_size_x": extent.pixel_size[0],
            "pixel_size_y": extent.pixel_size[1],
            "columns": extent.shape[1],
            "rows": extent.shape[0],
            "valid_fraction": extent.valid_fraction,
            "lag": first.lag,
            "lag_length": first.lag * outcome.pixel if first.lag and outcome.pixel else None,
        }
    if values is not None:
        found |= {name: getattr(values, name) for name in ("Sq", "Sdq", "Rq", "Rdq") if hasattr(values, name)}
    found |= {"n": first.n, "n_effective": first.n_effective}
    found |= {"family": first.family, "symmetry": first.symmetry}
    for name, number in first.params.items():
        found |= {name: number, f"{name}_error": first.standard_errors.get(name)}
    second = next((other for other in others if other.family != first.family), None)
    found |= {
        "held_out": first.held_out,
        "tied": "; ".join(_named(other) for other in others if other.tied),
        "second": second and _named(second),
        "second_held_out": second and second.held_out - first.held_out,
        "second_held_out_error": second and second.held_out_error,
        "anderson_darling": first.goodness.anderson_darling,
        "fits": outcome.results.verdict.fits,
        "p_value": outcome.results.verdict.p_value,
        "verdict": outcome.results.verdict.sentence,
        "warnings": "; ".join(outcome.results.warnings),
        "converged": first.converged,
        "noise": first.lag in outcome.scales.noise_lags if outcome.scales else None,
        "notes": "; ".join(outcome.notes),
    }
    return found


def save(path: str, rows: Sequence[Row]) -> None:
    """Write the rows; a number that is not finite, or that a file does not have, is an empty cell."""
    rows = [{name: _cell(value) for name, value in one.items()} for one in rows]
    with replacing(path) as stream:
        _WRITERS[ending(path, ENDINGS, ".csv")](_columns(rows), rows, stream)


def _named(result: Any) -> str:
    return f"{result.family} ({result.symmetry})"


def _cell(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _columns(rows: Sequence[Row]) -> list[str]:
    """All names, each where the first row that has it puts it: after its neighbour there."""
    found: list[str] = []
    for one in rows:
        at = 0
        for name in one:
            if name not in found:
                found.insert(at, name)
            at = found.index(name) + 1
    return found


def _csv(columns: list[str], rows: Sequence[Row], stream: BinaryIO) -> None:
    text = io.TextIOWrapper(stream, encoding="utf-8", newline="", write_through=True)
    table = csv.DictWriter(text, columns, lineterminator="\n")
    table.writeheader()
    table.writerows(rows)
    text.detach()


def _parquet(columns: list[str], rows: Sequence[Row], stream: BinaryIO) -> None:
    with needed("a .parquet file (.csv does not) needs"):
        import pyarrow
        import pyarrow.parquet

    arrays = {
        name: pyarrow.array([one.get(name) for one in rows], pyarrow.string() if name in _TEXT else None)
        for name in columns
    }
    pyarrow.parquet.write_table(pyarrow.table(arrays), stream)


_WRITERS: dict[str, Callable[[list[str], Sequence[Row], BinaryIO], None]] = {
    ".csv": _csv,
    ".parquet": _parquet,
}
