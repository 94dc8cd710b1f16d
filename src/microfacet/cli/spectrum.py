"""The command `microfacet spectrum`: what the lateral structure of a map says."""

from __future__ import annotations

import json
from typing import Any

import click

import microfacet as mf
from microfacet._text import printable
from microfacet.cli.printing import console, finite, show
from microfacet.cli.program import json_option
from microfacet.cli.surfaces import load, surface_options

__all__ = ["spectrum"]


@click.command()
@click.argument("file")
@surface_options
@click.option(
    "--window",
    default="hann",
    show_default=True,
    metavar="NAME",
    help="A window of scipy.signal, or none: the map continues at its opposite edge.",
)
@click.option("--threshold", type=float, default=0.2, show_default=True, metavar="X", help="For Sal and Str.")
@json_option
def spectrum(file: str, reading: dict[str, Any], window: str, threshold: float, as_json: bool) -> None:
    """Power spectral density and autocorrelation of the height map FILE, levelled by a plane.

    The density is averaged over all directions, in m^4 over cycles per metre, with the ABC model fitted to
    it; Sal, Str and Std are those of ISO 25178-2. With --json the density by direction comes too.

    \b
    Examples:
      microfacet spectrum scan.x3p
      microfacet spectrum scan.x3p --form 2 --json
      microfacet spectrum map.npz --window none
    """
    from microfacet.cli import areal

    surface = load(file, **reading)
    if not isinstance(surface, mf.Surface):
        raise mf.SurfaceError("a spectrum needs a height map, not slopes")
    periodic = window == "none"
    found = mf.spectrum(surface, window=None if periodic else window)
    correlation = mf.autocorrelation(surface, threshold=threshold, periodic=periodic)
    if as_json:
        parts = areal.record(None, found, correlation, every=True)
        about = {"source": surface.source, "steps": surface.steps, "pixel_size": surface.pixel_size}
        record = {**about, "spectrum": parts["spectrum"], "autocorrelation": parts["autocorrelation"]}
        click.echo(json.dumps(finite(record), allow_nan=False))
        return
    click.echo(printable(surface.source), err=True)
    for note in (*surface.steps, *areal.notes(found, correlation)):
        click.echo(f"  {printable(note, 400)}", err=True)
    out = console()
    areal.print_parameters(out, None, found, correlation)
    click.echo()
    model = found.abc.psd(found.frequencies)
    rows = [
        [f"{1 / f:.4g}", f"{f:.4g}", f"{density:.4g}", f"{error:.2g}", f"{fitted:.4g}"]
        for f, density, error, fitted in zip(found.frequencies, found.psd, found.errors, model, strict=True)
    ]
    show(out, ["wavelength/m", "frequency*m", "PSD/m^4", "+-", "ABC model"], rows, left=0)
