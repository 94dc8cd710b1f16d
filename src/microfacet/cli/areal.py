"""What commands say of a map apart from its slopes: parameters of ISO 25178-2, spectrum, autocorrelation."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import microfacet as mf
from microfacet.cli.printing import show

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["notes", "print_parameters", "record"]

_DIGITS = 6  # of the many numbers of a spectrum
_LEFT_OUT = ("angles", "angular")  # of the record of a fit: one number for each degree


def record(
    roughness: mf.Roughness | None,
    spectrum: mf.Spectrum | None,
    autocorrelation: mf.Autocorrelation | None,
    every: bool = False,
) -> dict[str, Any]:
    """As parts of a record for JSON, None where there is no map; `every` number of the spectrum or most."""
    from microfacet._surface.parameters import PARAMETERS

    found = _short(spectrum.as_dict()) if spectrum else None
    if found is not None and not every:
        found = {name: value for name, value in found.items() if name not in _LEFT_OUT}
    return {
        "roughness": roughness._asdict() if roughness else None,
        "roughness_units": {name: PARAMETERS[name].unit for name in roughness._fields} if roughness else None,
        "roughness_stencils": {name: PARAMETERS[name].meaning.partition(", ")[2] for name in _STENCILS}
        if roughness
        else None,
        "spectrum": found,
        "autocorrelation": _short(autocorrelation.as_dict()) if autocorrelation else None,
    }


_STENCILS = ("Sdq", "Sdr", "Sdq_adjacent", "Sdr_adjacent")


def notes(spectrum: mf.Spectrum | None, autocorrelation: mf.Autocorrelation | None) -> tuple[str, ...]:
    """What both remark."""
    return (
        *(spectrum.notes if spectrum else ()),
        *(spectrum.abc.notes if spectrum else ()),
        *(autocorrelation.notes if autocorrelation else ()),
    )


def rows(
    roughness: mf.Roughness | None, spectrum: mf.Spectrum | None, autocorrelation: mf.Autocorrelation | None
) -> list[tuple[str, str, str, str]]:
    """Every parameter: its name, value, unit and meaning."""
    from microfacet._surface.parameters import PARAMETERS

    values: dict[str, float] = roughness._asdict() if roughness else {}
    if autocorrelation:
        values |= {"Sal": autocorrelation.Sal, "Str": autocorrelation.Str, "Std": autocorrelation.Std}
    table = [
        (name, *_quantity(value, PARAMETERS[name].unit), PARAMETERS[name].meaning)
        for name, value in values.items()
    ]
    if spectrum and not math.isnan(spectrum.abc.C):
        table += [
            (
                f"ABC {name}",
                _with_error(getattr(spectrum.abc, name), spectrum.abc.errors[name]),
                unit,
                meaning,
            )
            for name, unit, meaning in _ABC
        ]
    return table


_ABC = (
    ("A", "m^4", "of the ABC model A/(1 + (B f)^2)^((C + 1)/2): density at low frequencies f"),
    ("B", "m", "of the ABC model: one over the frequency where the fall begins"),
    ("C", "1", "of the ABC model: a profile's density falls as f^-C, the map's as f^-(C + 1)"),
)


def print_parameters(
    out: Console,
    roughness: mf.Roughness | None,
    spectrum: mf.Spectrum | None,
    autocorrelation: mf.Autocorrelation | None,
) -> None:
    """A table, one parameter a row."""
    table = rows(roughness, spectrum, autocorrelation)
    show(out, ["parameter", "value", "unit", "what it is"], [list(row) for row in table], left=4)


def _quantity(value: float, unit: str) -> tuple[str, str]:
    if unit == "rad":
        return f"{math.degrees(value):.1f}", "degrees"
    return f"{value:.4g}", unit


def _with_error(value: float, error: float) -> str:
    return f"{value:.4g}" + (f"+-{error:.2g}" if math.isfinite(error) else "")


def _short(value: Any) -> Any:
    """Numbers of a record with as many digits as a measured spectrum is worth."""
    if isinstance(value, dict):
        return {name: _short(entry) for name, entry in value.items()}
    if isinstance(value, list):
        return [_short(entry) for entry in value]
    return float(f"{value:.{_DIGITS}g}") if isinstance(value, float) and math.isfinite(value) else value
