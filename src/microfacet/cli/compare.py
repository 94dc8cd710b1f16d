"""The command `microfacet compare`."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from microfacet._files import is_stdout
from microfacet._text import printable
from microfacet.cli.densities import densities_option
from microfacet.cli.printing import announce, console, finite, progress_line, show, value, where
from microfacet.cli.program import families_option, json_option
from microfacet.cli.surfaces import surface_options

if TYPE_CHECKING:
    import microfacet as mf

__all__ = ["compare"]


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE FILE...")
@surface_options
@families_option
@densities_option
@click.option("--isotropic", "symmetry", flag_value="isotropic", help="Fit one roughness alone.")
@click.option("--anisotropic", "symmetry", flag_value="anisotropic", help="Fit two along their axes alone.")
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False), metavar="FILE", help="Write FILE.csv or .parquet."
)
@json_option
def compare(
    files: tuple[str, ...],
    reading: dict[str, Any],
    families: tuple[Any, ...],
    symmetry: str | None,
    output: str | None,
    as_json: bool,
) -> None:
    """Put surfaces side by side: roughness, parameters, and errors of the differences from the first FILE.

    Every FILE is read and prepared as by `microfacet fit`, with the same options. Slopes are taken at the
    same lag in metres, the longest of the files' own where --lag-length does not say it. The parameters are
    those of the one family that describes all files together best. A difference is marked "differs" where
    chance makes one as large as this among all of them once in twenty times or less.

    \b
    Examples:
      microfacet compare before.x3p after.x3p
      microfacet compare a.al3d b.al3d c.al3d --s-filter 5e-6 --family student_t
      microfacet compare a.npz b.npz --json
    """
    if len(files) < 2:
        raise click.UsageError("give two FILEs or more to compare")
    import microfacet as mf
    from microfacet.cli import batch, surfaces

    taken = output is not None and is_stdout(output)
    if taken and as_json:
        raise click.UsageError("--json prints on the standard output, which --output takes: give a file")
    if output:
        batch.checked_output(output)
    with progress_line() as progress:
        measured = []
        for done, file in enumerate(files):
            progress(f"reading {file}", done, len(files))
            measured.append(surfaces.load(file, **reading))
        chosen = families or None
        found = mf.compare(measured, chosen, symmetry=symmetry, names=files, progress=progress)
    if output:
        batch.save(output, _rows(found))
    if as_json:
        record = {**_record(found), **({"output": where(output)} if output else {})}
        click.echo(json.dumps(finite(record), allow_nan=False))
    elif not taken:
        _print(found)
        if output:
            announce(where(output), output)


def _print(found: mf.Comparison) -> None:
    for note in found.notes:
        click.echo(f"  {printable(note, 400)}", err=True)
    own = [
        [name, "-" if length is None else f"{length:.4g}", ranking[0].family, ranking[0].symmetry]
        for name, length, ranking in zip(found.names, found.lag_lengths, found.rankings, strict=True)
    ]
    out = console()
    show(out, ["file", "lag in metres", "best family", "symmetry"], own, left=1)
    click.echo(f"\nall of them under {found.family} ({found.symmetry}):", err=True)
    click.echo()
    names = [f"{name} - {found.names[0]}" for name in found.names[1:]]
    headings = ["quantity", *found.names]
    for name in names:
        headings += [name, "z", "p", ""]
    rows = []
    for quantity in found.quantities[0]:
        row = [quantity]
        for each in found.quantities:
            row.append(value(*each[quantity]) if quantity in each else "-")
        for differences in found.differences:
            one = next((d for d in differences if d.quantity == quantity), None)
            if one is None:
                row += ["-", "-", "-", ""]
            else:
                verdict = "differs" if one.p_value < 0.05 else ""
                row += [value(one.value, one.error), f"{one.z:.2f}", f"{one.p_value:.2g}", verdict]
        rows.append(row)
    show(out, headings, rows, left=1)


def _record(found: mf.Comparison) -> dict[str, Any]:
    first = found.names[0]
    return {
        "family": found.family,
        "symmetry": found.symmetry,
        "notes": list(found.notes),
        "surfaces": [
            {
                "file": name,
                "lag_length": length,
                "best": {"family": ranking[0].family, "symmetry": ranking[0].symmetry},
                "quantities": {key: {"value": one[0], "error": one[1]} for key, one in own.items()},
            }
            for name, length, ranking, own in zip(
                found.names, found.lag_lengths, found.rankings, found.quantities, strict=True
            )
        ],
        "differences": [
            {"file": name, "from": first, **asdict(one)}
            for name, differences in zip(found.names[1:], found.differences, strict=True)
            for one in differences
        ],
    }


def _rows(found: mf.Comparison) -> list[dict[str, Any]]:
    """One row for every surface and quantity; the first surface has no difference."""
    rows = []
    for number, (name, quantities) in enumerate(zip(found.names, found.quantities, strict=True)):
        differences = {one.quantity: one for one in found.differences[number - 1]} if number else {}
        for quantity, (estimate, error) in quantities.items():
            row: dict[str, Any] = {"file": name, "family": found.family, "symmetry": found.symmetry}
            row |= {"quantity": quantity, "value": estimate, "error": error}
            one = differences.get(quantity)
            values = (one.value, one.error, one.z, one.p_value) if one else (math.nan,) * 4
            row |= dict(zip(("difference", "difference_error", "z", "p_value"), values, strict=True))
            rows.append(row)
    return rows
