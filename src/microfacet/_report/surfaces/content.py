"""What a page shows of a fitted surface: rows of its tables and its figures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import microfacet as mf
from microfacet._fit.result import FitResult, remarks
from microfacet._report import Progress
from microfacet._report.figure import FigureBlock, thousands
from microfacet._report.surfaces import figures
from microfacet._report.surfaces.relief import length, relief_map

__all__ = ["Content", "MeasuredSurface", "collect", "measured_surface"]


@dataclass(frozen=True)
class Row:
    """One family: its parameters with their errors, and how far it is behind the first."""

    title: str
    name: str
    parameters: tuple[tuple[str, float, float], ...]
    behind: float
    error: float
    tied: bool
    aic: float
    bic: float
    anderson_darling: float
    worst_sector: float | None


@dataclass(frozen=True)
class MeasuredSurface:
    """A surface or slopes, and the families fitted to them, as every page shows them."""

    source: str
    steps: tuple[str, ...]
    notes: tuple[str, ...]
    facts: tuple[tuple[str, str], ...]
    rows: tuple[Row, ...]
    map: FigureBlock | None
    slopes: tuple[FigureBlock, ...]


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
    roughness: tuple[tuple[str, str], ...]


def measured_surface(
    measured: mf.Surface | mf.SlopeSample, results: Sequence[FitResult], progress: Progress = lambda *_: None
) -> MeasuredSurface:
    """Rows and figures of the fits to a surface or to slopes."""
    surface = measured if isinstance(measured, mf.Surface) else None
    slopes = measured.slopes() if isinstance(measured, mf.Surface) else measured.values
    centred = slopes - np.asarray(results[0].mean_slope)
    blocks = []
    for done, block in enumerate(figures.slope_figures(centred, results)):
        progress("figures", done, 5)
        blocks.append(block)
    return MeasuredSurface(
        source=measured.source,
        steps=measured.steps,
        notes=tuple(remarks(results)),
        facts=_facts(surface, results[0]),
        rows=tuple(_row(result, results[0]) for result in results),
        map=relief_map(surface) if surface else None,
        slopes=tuple(blocks),
    )


def collect(fitted: Any, command: str, progress: Progress) -> Content:
    """Tables and figures of the page of one fit."""
    return Content(
        measured=measured_surface(fitted.measured, fitted.results, progress),
        command=command,
        warnings=fitted.scales.notes if fitted.scales else (),
        scales=figures.scale_figure(fitted.scales) if fitted.scales else None,
        predictions=tuple(fitted.predictions),
        lobes=figures.lobe_figure(fitted.results),
        titles={result.family: figures.look(result.family)["label"] for result in fitted.results},
        roughness=_roughness(fitted.roughness) if fitted.roughness else (),
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
        tuple(parameters),
        result.held_out - first.held_out,
        result.held_out_error,
        result.tied,
        result.aic - first.aic,
        result.bic - first.bic,
        result.goodness.anderson_darling,
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


def _roughness(values: Any) -> tuple[tuple[str, str], ...]:
    lengths = {"Sq", "Sa", "Sp", "Sv", "Sz"}
    return tuple(
        (name, length(number) if name in lengths and number > 0 else f"{number:.4g}")
        for name, number in values._asdict().items()
    )
