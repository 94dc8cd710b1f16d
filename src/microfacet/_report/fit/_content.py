"""What the page of a fit shows: rows of its tables and its figures."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import microfacet as mf
from microfacet._report._figures import FigureBlock
from microfacet._report._terrain import length, relief_map
from microfacet._report.fit import _figures, _lobes

__all__ = ["Content", "collect"]


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
class Content:
    """All that the page shows."""

    source: str
    command: str
    steps: tuple[str, ...]
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    facts: tuple[tuple[str, str], ...]
    rows: tuple[Row, ...]
    map: FigureBlock | None
    slopes: tuple[FigureBlock, ...]
    scales: FigureBlock | None
    predictions: tuple[Any, ...]
    lobes: FigureBlock
    titles: dict[str, str]
    roughness: tuple[tuple[str, str], ...]


def collect(fitted: Any, command: str, progress: Callable[[str, int, int], None]) -> Content:
    """Tables and figures of one fit."""
    titles = {family.name: family.title for family in mf.families()}
    first = fitted.results[0]
    surface, warnings = fitted.surface, fitted.scales.notes if fitted.scales else ()
    slopes = (surface.slopes() if surface else fitted.slopes) - np.asarray(first.mean_slope)
    blocks = []
    figures = _figures.slope_figures(slopes, fitted.results, titles)
    for done, block in enumerate(figures):
        progress("figures", done, 5)
        blocks.append(block)
    return Content(
        source=fitted.source,
        command=command,
        steps=fitted.steps,
        notes=tuple(note for note in fitted.notes if note not in warnings),
        warnings=warnings,
        facts=_facts(fitted),
        rows=tuple(_row(result, first, titles) for result in fitted.results),
        map=relief_map(surface) if surface else None,
        slopes=tuple(blocks),
        scales=_figures.scale_figure(fitted.scales, titles) if fitted.scales else None,
        predictions=tuple(fitted.predictions),
        lobes=_lobes.lobe_figure(fitted.results, titles),
        titles={result.family: titles[result.family] for result in fitted.results},
        roughness=_roughness(fitted.roughness) if fitted.roughness else (),
    )


def _row(result: Any, first: Any, titles: dict[str, str]) -> Row:
    sectors = [value for value in result.goodness.sectors if math.isfinite(value)]
    parameters = [
        (name, value, result.standard_errors[name])
        if name != "rotation"
        else (name, math.degrees(value), math.degrees(result.standard_errors[name]))
        for name, value in result.params.items()
    ]
    return Row(
        titles[result.family],
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


def _facts(fitted: Any) -> tuple[tuple[str, str], ...]:
    first = fitted.results[0]
    facts = [("Slopes", f"{first.n:,}".replace(",", "\u202f"))]
    if fitted.surface:
        ny, nx = fitted.surface.heights.shape
        dx, dy = fitted.surface.pixel_size
        facts = [
            ("Grid", f"{nx}\u2009×\u2009{ny}, {length(dx)} × {length(dy)}"),
            ("Lag", f"{first.lag} px, {length(first.lag * fitted.pixel)}"),
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
