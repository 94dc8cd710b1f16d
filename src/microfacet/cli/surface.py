"""The command `microfacet surface`."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

import microfacet as mf
from microfacet._text import printable
from microfacet.cli.printing import console, finite, say, show
from microfacet.cli.program import json_option
from microfacet.cli.surfaces import reading_options

if TYPE_CHECKING:
    from microfacet._surface.read.describe import FileSummary, MapSummary

__all__ = ["surface"]

_HEADINGS = ["channel", "pixels", "pixel size", "unit", "valid", "lowest", "highest", "Sq", "Sa", "Sz", "Sdq"]


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@reading_options
@json_option
@click.pass_context
def surface(ctx: click.Context, files: tuple[str, ...], reading: dict[str, Any], as_json: bool) -> None:
    """Say what the files of measured surfaces hold, before anything is fitted.

    Every channel with its size, unit, fraction of valid pixels and, where unit and pixel size are known, its
    roughness after levelling by a plane (ISO 25178-2). What the file does not state, it asks for.

    \b
    Examples:
      microfacet surface scan.x3p
      microfacet surface *.di --json
      microfacet surface depth.png --scale 1e-9 --pixel-size 2e-6,1e-6
    """
    from microfacet._surface.read.describe import describe

    found: list[FileSummary | str] = []
    for file in files:
        try:
            found.append(describe(file, **reading))
        except mf.SurfaceError as caught:
            found.append(str(caught))
    if as_json:
        records = [
            {"file": file, "error": one} if isinstance(one, str) else _record(one)
            for file, one in zip(files, found, strict=True)
        ]
        click.echo(json.dumps(finite(records[0] if len(files) == 1 else {"files": records}), allow_nan=False))
    else:
        _print([one for one in found if not isinstance(one, str)])
    errors = [one for one in found if isinstance(one, str)]
    for error in errors:
        say(error)
    ctx.exit(2 if errors else 0)


def _print(summaries: Sequence[FileSummary]) -> None:
    several = len(summaries) > 1
    rows = [[summary.file, *_row(one)] for summary in summaries for one in summary.maps]
    for summary in summaries:
        click.echo(f"{printable(summary.file, 1000)}: {summary.kind}", err=True)
        if summary.sentence:
            click.echo(f"  {printable(summary.sentence, 400)}", err=True)
        for one in summary.maps:
            name = f"{printable(one.channel.name)}: " if len(summary.maps) > 1 else ""
            for note in (*one.steps, *one.warnings, *filter(None, (one.missing,))):
                click.echo(f"  {name}{printable(note, 400)}", err=True)
    if rows:
        skip = 0 if several else 1
        show(console(), ["file", *_HEADINGS][skip:], [row[skip:] for row in rows], left=1 + several)


def _row(one: MapSummary) -> list[str]:
    channel = one.channel
    pixels = " x ".join(map(str, channel.pixels)) or "-"
    size = "-" if one.pixel_size is None else " x ".join(f"{side:.6g}" for side in one.pixel_size)
    found = [one.lowest, one.highest]
    found += [getattr(one.roughness, name, None) for name in ("Sq", "Sa", "Sz", "Sdq")]
    return [
        channel.name or str(channel.index),
        pixels,
        size,
        channel.unit or "-",
        "-" if one.valid is None else f"{100 * one.valid:.2f} %",
        *("-" if number is None else f"{number:.4g}" for number in found),
    ]


def _record(summary: FileSummary) -> dict[str, Any]:
    """As a record for JSON: lengths in metres, `lowest` and `highest` in the unit of the file."""
    return {
        "file": summary.file,
        "kind": summary.kind,
        "sentence": summary.sentence,
        "channels": [
            {
                "name": one.channel.name,
                "index": one.channel.index,
                "pixels": list(one.channel.pixels),
                "is_height": one.channel.is_height,
                "unit": one.channel.unit,
                "pixel_size": one.pixel_size,
                "valid": one.valid,
                "lowest": one.lowest,
                "highest": one.highest,
                "roughness": None if one.roughness is None else one.roughness._asdict(),
                "missing": one.missing,
                "steps": list(one.steps),
                "warnings": list(one.warnings),
            }
            for one in summary.maps
        ],
    }
