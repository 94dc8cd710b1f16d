"""The command `microfacet brdf`."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

import click

from microfacet._files import is_stdout
from microfacet._text import printable
from microfacet.cli.densities import DensityCommand, density_option
from microfacet.cli.grids import GRID
from microfacet.cli.parameters import axes_options, family_named, parameter_options, stretched
from microfacet.cli.printing import announce, console, finite, progress_line, say, show, where
from microfacet.cli.program import json_option
from microfacet.cli.surfaces import surface_options

if TYPE_CHECKING:
    import microfacet as mf

__all__ = ["brdf"]

_METRES = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "\u00b5m": 1e-6, "\u03bcm": 1e-6, "nm": 1e-9}


class _Wavelength(click.ParamType[float]):
    """550nm, 0.55um, or metres: 5.5e-7."""

    name = "wavelength"

    def convert(self, value: Any, param: Any, ctx: Any) -> float:
        """In metres."""
        text = str(value).strip()
        number = text.rstrip("mnu\u00b5\u03bc")
        try:
            return float(number) * _METRES[text[len(number) :] or "m"]
        except (ValueError, KeyError):
            self.fail(f"a wavelength is 550nm, 0.55um or metres such as 5.5e-7, got {value!r}", param, ctx)


@click.command(cls=DensityCommand)
@click.argument("family", required=False)
@density_option
@parameter_options
@axes_options
@click.option("--surface", metavar="FILE", help="Fit this measured surface; FAMILY, or the best of all.")
@surface_options
@click.option(
    "--wavelength", "wavelengths", type=_Wavelength(), multiple=True, metavar="LENGTH", default=("550nm",),
    show_default=True, help="550nm, 0.55um, or metres; repeat for several.",
)  # fmt: skip
@click.option(
    "--index", "indices", multiple=True, metavar="N+Kj|FILE",
    help="Refractive index, 0.97+1.87j, one for all wavelengths or one for each; or a table in a file. "
    "A perfect mirror without.",
)  # fmt: skip
@click.option("--theta-i", type=GRID, metavar="GRID", help="Angles of incidence in degrees: 0,30,60.")
@click.option("--phi-i", type=GRID, metavar="GRID", help="Azimuths of the light.")
@click.option("--polar", type=GRID, metavar="GRID", help="Angles of scattered light: START:STOP:COUNT.")
@click.option("--azimuth", type=GRID, metavar="GRID", help="Azimuths of scattered light.")
@click.option(
    "--reference",
    type=click.Choice(["normal", "specular"]),
    help="What scattered light is seen from: normal, and specular for --format zemax.",
)
@click.option("--btdf", is_flag=True, help="Light that passes, of a dielectric.")
@click.option("--single", is_flag=True, help="The first order of scattering alone.")
@click.option("-n", "walks", type=click.IntRange(min=16), metavar="N", help="Random walks per value (4096).")
@click.option("--seed", type=click.IntRange(min=0), default=0, help="Same seed, same walks.")
@click.option("--abg", "wants_abg", is_flag=True, help="Fit A, B and g of the ABg model.")
@click.option(
    "-o", "--output", "outputs", multiple=True, type=click.Path(dir_okay=False), metavar="FILE",
    help="FILE.csv, .nc, .astm or .bsdf; repeat for several.",
)  # fmt: skip
@click.option("--format", "format_", metavar="NAME", help="Of FILE.bsdf: zemax or lighttools.")
@json_option
def brdf(
    family: Any,
    parameters: dict[str, float],
    surface: str | None,
    reading: dict[str, Any],
    indices: tuple[str, ...],
    outputs: tuple[str, ...],
    format_: str | None,
    wants_abg: bool,
    as_json: bool,
    **options: Any,
) -> None:
    """Predict the BRDF of FAMILY, or of a measured surface, as a table for optics programs.

    The table has the first order of scattering in closed form and the others by random walks; what is printed
    is the energy that leaves. Angles are in degrees and directions point away from the surface. Formats are
    described in docs/brdf_tables.md.

    \b
    Examples:
      microfacet brdf ggx --alpha 0.3 --index 0.97+1.87j --wavelength 500nm -o gold.csv
      microfacet brdf --surface scan.x3p --wavelength 633nm --index gold.csv -o scan.nc --abg
      microfacet brdf student_t --alpha 0.2 --gamma 3 --index 1.5 -o glass.bsdf --format zemax
    """
    if surface is None and family is None:
        raise click.UsageError("give a FAMILY, or --surface FILE")
    if surface is None and reading:
        raise click.UsageError(f"--{next(iter(reading)).replace('_', '-')} goes with --surface")
    if surface is not None and parameters:
        raise click.UsageError(f"--{next(iter(parameters)).replace('_', '-')} is fitted with --surface")
    if as_json and any(map(is_stdout, outputs)):
        raise click.UsageError("--json prints on the standard output, which --output takes: give a file")
    import microfacet as mf
    from microfacet._optics import save

    formats = [save.format_of(path, None if save.says_format(path) else format_) for path in outputs]
    chosen = None if family is None else family_named(family)
    with progress_line() as progress:
        measured = None
        if surface is None:
            ndf = stretched(chosen, parameters)
        else:
            measured, fitted = _fitted(surface, reading, chosen, progress)
            ndf = fitted.ndf
        request = _request(options, indices) | {"progress": progress}
        reference = request.pop("reference")
        tables: dict[str, mf.BrdfTable] = {}
        for kind in [reference or ("specular" if one == "zemax" else "normal") for one in formats] or [
            reference or "normal"
        ]:
            if kind not in tables:
                tables[kind] = mf.brdf_table(ndf, reference=kind, **request)
    written = []
    for path, one in zip(outputs, formats, strict=True):
        kind = reference or ("specular" if one == "zemax" else "normal")
        written += tables[kind].save(path, one)
    table = next(iter(tables.values()))
    remarks = [*table.notes, *_remarks(table, measured)]
    fits = table.abg() if wants_abg else None
    if as_json:
        click.echo(json.dumps(finite(_record(table, surface, remarks, fits, written)), allow_nan=False))
        return
    said = f"{ndf.family} with " + ", ".join(f"{name} {value:.4g}" for name, value in ndf.parameters.items())
    for line in (said, *remarks):
        click.echo(f"  {printable(line, 400)}", err=True)
    if not any(map(is_stdout, outputs)):
        _print(table, fits)
    for path in written:
        announce(where(path), *outputs)


def _fitted(file: str, reading: dict[str, Any], family: Any, progress: Any) -> tuple[Any, Any]:
    """What was measured, and the fit of the family, or the best of all."""
    import microfacet as mf
    from microfacet.cli import surfaces

    progress(f"reading {file}", 0, 0)
    measured = surfaces.load(file, **reading)
    values = measured.values if isinstance(measured, mf.SlopeSample) else measured
    best = mf.fit(values, family, progress=progress)[0]
    for note in best.notes:
        say(f"{best.family}: {note}")
    return measured, best


def _request(options: dict[str, Any], indices: tuple[str, ...]) -> dict[str, Any]:
    """The arguments of `brdf_table` that options give."""
    names = ("theta_i", "phi_i", "polar", "azimuth")
    found = {name: options[name] for name in names if options[name] is not None}
    found |= {"n": options["walks"]} if options["walks"] else {}
    if indices:
        found["index"] = _index(indices)
    return found | {
        "wavelengths": list(options["wavelengths"]),
        "reference": options["reference"],
        "scatter": "BTDF" if options["btdf"] else "BRDF",
        "scattering": "single" if options["single"] else "multiple",
        "rng": options["seed"],
    }


def _index(texts: tuple[str, ...]) -> Any:
    """Complex numbers, or the path of a table."""
    try:
        return [complex(text.replace(" ", "").replace("i", "j").replace("jnf", "inf")) for text in texts]
    except ValueError:
        if len(texts) == 1 and os.path.exists(texts[0]):
            return texts[0]
        wrong = texts[0] if len(texts) == 1 else " ".join(texts)
        raise ValueError(
            f"--index must be a number such as 0.97+1.87j or a file that exists, got {wrong[:80]!r}"
        ) from None


def _remarks(table: mf.BrdfTable, measured: Any) -> list[str]:
    """Which lateral scales matter at the shortest wavelength, and whether the slopes were taken at them."""
    import microfacet as mf

    baseline = Sq = None
    if isinstance(measured, mf.Surface):
        baseline, Sq = 2 * measured.lag_length, mf.roughness(measured).Sq
    shortest, light = float(table.wavelengths.min()), float(table.theta_i.min())
    return mf.spatial_bandwidth(shortest, light, Sq=Sq).remarks(baseline)


def _print(table: mf.BrdfTable, fits: list[mf.AbgFit] | None) -> None:
    rows = []
    for k, wavelength in enumerate(table.wavelengths):
        for i, theta in enumerate(table.theta_i):
            for j, phi in enumerate(table.phi_i):
                place = (k, i, j)
                rows.append([f"{wavelength:.4g}", f"{theta:g}", f"{phi:g}"])
                rows[-1] += [f"{table.albedo[place]:.4f}", f"{table.albedo_single[place]:.4f}"]
                rows[-1].append(f"{table.values[place].max():.4g}")
    out = console()
    headings = ["wavelength", "theta_i", "phi_i", "albedo", "of one order", f"largest {table.scatter}"]
    show(out, headings, rows, left=0)
    if fits:
        click.echo()
        lines = [
            [f"{one.wavelength:.4g}", *(f"{value:g}" for value in (one.theta_i, one.phi_i))]
            + [f"{value:.4g}" for value in (one.A, one.B, one.g)]
            + [f"{one.residual:.3f}"]
            for one in fits
        ]
        show(out, [*fits[0]._fields[:-1], "decades"], lines, left=0)


def _record(
    table: mf.BrdfTable,
    surface: str | None,
    remarks: list[str],
    fits: list[mf.AbgFit] | None,
    written: list[str],
) -> dict[str, Any]:
    return {
        "family": table.ndf.family,
        "parameters": {name: float(value) for name, value in table.ndf.parameters.items()},
        "surface": surface,
        "wavelengths": table.wavelengths.tolist(),
        "n": table.index.real.tolist(),
        "k": table.index.imag.tolist(),
        "theta_i": table.theta_i.tolist(),
        "phi_i": table.phi_i.tolist(),
        "scatter": table.scatter,
        "scattering": table.scattering,
        "albedo": table.albedo.tolist(),
        "albedo_error": table.albedo_error.tolist(),
        "albedo_single": table.albedo_single.tolist(),
        "abg": None if fits is None else [one._asdict() for one in fits],
        "remarks": remarks,
        "files": [where(path) for path in written],
    }
