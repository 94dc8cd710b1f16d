"""What a page shows of a fitted surface: rows of its tables and its figures."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import microfacet as mf
from microfacet._fit.result import FitResult, remarks
from microfacet._report import Progress
from microfacet._report.figure import FigureBlock, thousands
from microfacet._report.surfaces import figures, profiles
from microfacet._report.surfaces.lateral import lateral_figures
from microfacet._report.surfaces.relief import length, relief_map
from microfacet._surface.parameters import PARAMETERS

__all__ = ["Content", "MeasuredSurface", "collect", "measured_surface"]


@dataclass(frozen=True)
class Row:
    """One family: its parameters with their errors, and how far it is behind the first."""

    title: str
    name: str
    symmetry: str
    parameters: tuple[tuple[str, float, float], ...]
    behind: float
    error: float
    tied: bool
    aic: float
    bic: float
    anderson_darling: float
    p_value: float
    deviation: float
    worst_sector: float | None


@dataclass(frozen=True)
class MeasuredSurface:
    """A surface or slopes, and the families fitted to them, as every page shows them."""

    source: str
    steps: tuple[str, ...]
    notes: tuple[str, ...]
    fits: bool
    verdict: str
    warnings: tuple[str, ...]
    facts: tuple[tuple[str, str], ...]
    rows: tuple[Row, ...]
    map: FigureBlock | None
    slopes: tuple[FigureBlock, ...]
    traces: int = 0  # of a profile


@dataclass(frozen=True)
class Content:
    """All that the page of a fit shows."""

    measured: MeasuredSurface
    command: str
    warnings: tuple[str, ...]
    scales: FigureBlock | None
    predictions: tuple[Any, ...]
    lobes: FigureBlock
    titles: dict[str, str]
    lateral: tuple[FigureBlock, ...]
    remarks: tuple[str, ...]
    roughness: tuple[tuple[str, str, str], ...]


def measured_surface(
    measured: mf.Surface | mf.Profile | mf.SlopeSample,
    results: mf.FitResults,
    progress: Progress = lambda *_: None,
) -> MeasuredSurface:
    """Rows and figures of the fits to a surface, to a profile or to slopes."""
    drawn: Iterator[FigureBlock]
    place: FigureBlock | None
    if isinstance(measured, mf.Profile):
        facts, place = profiles.profile_facts(measured, results[0]), profiles.trace_figure(measured)
        drawn = profiles.profile_figures(measured, figures.best_families(results))
    else:
        surface = measured if isinstance(measured, mf.Surface) else None
        slopes = measured.slopes() if isinstance(measured, mf.Surface) else measured.values
        facts, place = _facts(surface, results[0]), relief_map(surface) if surface else None
        centred = slopes - np.asarray(results[0].mean_slope)
        drawn = figures.slope_figures(centred, figures.best_families(results))
    blocks = []
    for done, block in enumerate(drawn):
        progress("figures", done, 5)
        blocks.append(block)
    return MeasuredSurface(
        source=measured.source,
        steps=measured.steps,
        notes=tuple(remarks(results)),
        fits=results.verdict.fits,
        verdict=results.verdict.sentence,
        warnings=results.warnings,
        facts=facts,
        rows=tuple(_row(result, results[0]) for result in results),
        map=place,
        slopes=tuple(blocks),
        traces=len(measured) if isinstance(measured, mf.Profile) else 0,
    )


def collect(fitted: Any, command: str, progress: Progress) -> Content:
    """Tables and figures of the page of one fit."""
    families = figures.best_families(fitted.results)
    return Content(
        measured=measured_surface(fitted.measured, fitted.results, progress),
        command=command,
        warnings=fitted.scales.notes if fitted.scales else (),
        remarks=_remarks(fitted.spectrum, fitted.autocorrelation),
        scales=figures.scale_figure(fitted.scales) if fitted.scales else None,
        predictions=tuple(fitted.predictions),
        lobes=figures.lobe_figure(families),
        titles={result.family: figures.look(result.family)["label"] for result in families},
        lateral=lateral_figures(fitted.spectrum, fitted.autocorrelation) if fitted.spectrum else (),
        roughness=_roughness(fitted) if fitted.roughness else (),
    )


def _row(result: FitResult, first: FitResult) -> Row:
    sectors = [value for value in result.goodness.sectors if math.isfinite(value)]
    parameters = [
        (name, value, result.standard_errors[name])
        if name != "rotation"
        else (name, math.degrees(value), math.degrees(result.standard_errors[name]))
        for name, value in result.params.items()
    ]
    return Row(
        figures.look(result.family)["label"],
        result.family,
        result.symmetry,
        tuple(parameters),
        result.held_out - first.held_out,
        result.held_out_error,
        result.tied,
        result.aic - first.aic,
        result.bic - first.bic,
        result.goodness.anderson_darling,
        result.goodness.p_value,
        100 * result.goodness.deviation,
        max(sectors) if sectors else None,
    )


def _facts(surface: mf.Surface | None, first: FitResult) -> tuple[tuple[str, str], ...]:
    facts = [("Slopes", thousands(first.n))]
    if surface is not None:
        ny, nx = surface.heights.shape
        dx, dy = surface.pixel_size
        facts = [
            ("Grid", f"{nx}\u2009×\u2009{ny}, {length(dx)} × {length(dy)}"),
            ("Lag", f"{surface.lag} px, {length(surface.lag * math.sqrt(dx * dy))}"),
            *facts,
            ("Worth", f"{first.n_effective:.0f} independent ones"),
        ]
    p, q = first.mean_slope
    facts.append(("Mean slope", f"{p:.3g}, {q:.3g}"))
    return tuple(facts)


def _remarks(spectrum: Any, autocorrelation: Any) -> tuple[str, ...]:
    if spectrum is None:
        return ()
    return (*spectrum.notes, *spectrum.abc.notes, *autocorrelation.notes)


def _roughness(fitted: Any) -> tuple[tuple[str, str, str], ...]:
    """Every parameter of ISO 25178-2: its name, value with unit, and meaning."""
    values = fitted.roughness._asdict()
    if isinstance(fitted.measured, mf.Profile):
        own = profiles.PARAMETERS
        return tuple(
            (name, _with_unit(own[name].unit, value), own[name].meaning) for name, value in values.items()
        )
    if (found := fitted.autocorrelation) is not None:
        values |= {"Sal": found.Sal, "Str": found.Str, "Std": found.Std}
    known = PARAMETERS
    return tuple(
        (name, _with_unit(known[name].unit, value), known[name].meaning) for name, value in values.items()
    )


def _with_unit(unit: str, value: float) -> str:
    if math.isnan(value):
        return "—"
    if unit == "rad":
        return f"{math.degrees(value):.1f}°"
    return length(value) if unit == "m" and value > 0 else f"{value:.4g}"
