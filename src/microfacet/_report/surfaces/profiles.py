"""What a page shows of a fitted profile: its traces, its slopes along the line, its spectrum."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

import microfacet as mf
from microfacet._profile.parameters import PARAMETERS
from microfacet._report.figure import GRID, INK, FigureBlock, inline_svg, panel, thousands
from microfacet._report.surfaces import figures
from microfacet._report.surfaces.relief import length, unit_of

__all__ = ["PARAMETERS", "profile_facts", "profile_figures", "trace_figure"]

_SHOWN = 5  # traces
_COLUMNS = 900  # of a drawn trace; in each the lowest and the highest height

Vector = NDArray[np.float64]


def profile_facts(profile: mf.Profile, first: Any) -> tuple[tuple[str, str], ...]:
    """What stands above the page's tables."""
    return (
        ("Traces", f"{len(profile)} of {thousands(profile.points)} points"),
        ("Spacing", length(profile.spacing)),
        ("Length", length(profile.length)),
        ("Valid", f"{100 * profile.valid_fraction:.3g} %"),
        ("Lag", f"{first.lag} points, {length(first.lag * profile.spacing)}"),
        ("Slopes", thousands(first.n)),
        ("Worth", f"{first.n_effective:.0f} independent ones"),
        ("Mean slope", f"{first.mean_slope[0]:.3g}"),
    )


def trace_figure(profile: mf.Profile) -> FigureBlock:
    """Heights along the line, one trace above the other."""
    shown = profile.traces[:_SHOWN]
    along, along_name = unit_of(profile.length)
    heights = np.concatenate([trace[np.isfinite(trace)] for trace in shown])
    up, up_name = unit_of(max(float(np.quantile(np.abs(heights), 0.9)), 1e-12))
    figure = Figure(figsize=(8.6, 1.2 + 1.5 * len(shown)))
    axes = figure.subplots(len(shown), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    for ax, trace in zip(axes, shown, strict=True):
        _draw_trace(ax, trace, profile.spacing / along, up)
        ax.axhline(0.0, color=GRID, linewidth=1)
    axes[-1].set_xlabel(along_name)
    figure.supylabel(up_name, fontsize=14, x=0.02)
    figure.subplots_adjust(left=0.1, right=0.98, top=0.97, bottom=0.62 / figure.get_figheight(), hspace=0.12)
    lines = "the lines" if len(shown) == len(profile) else f"{len(shown)} of {len(profile)} lines"
    first = f"The prepared heights along {'the line' if len(profile) == 1 else lines}"
    return FigureBlock(
        "traces",
        (inline_svg(figure, "traces-p", "Heights against the place along the line"),),
        f"{first}, {length(profile.spacing)} apart, with heights on a scale of their own.",
    )


def profile_figures(profile: mf.Profile, results: Sequence[Any]) -> Iterator[FigureBlock]:
    """Histogram of the slopes along the line, quantiles of their size, spectrum, one by one."""
    slopes = profile.slopes(results[0].lag) - results[0].mean_slope[0]
    across = np.column_stack((slopes, np.zeros_like(slopes)))
    yield FigureBlock(
        "slopes",
        (figures.histogram("histx", across, results, 0.0),),
        "Slopes along the line: the measured density and $P_2$ of the families that fit best; below, "
        "measured over fitted. The band is two standard deviations of as many slopes as these are worth.",
    )
    yield figures.quantile_figure(
        results,
        "Quantiles of the size of the slope along the line, measured over fitted, against the share of "
        "slopes beyond. A family whose curve bends down where few lie has too heavy a tail, one whose curve "
        "bends up there too light a one.",
    )
    spectrum = profile.psd()
    yield FigureBlock(
        "spectrum",
        (panel("psd", "Power spectral density of the heights", partial(_spectrum, profile, spectrum)),),
        "Power spectral density of the heights along the line, one-sided, by Welch’s method: the mean of "
        f"{spectrum.segments} spectra. The area below it is $R_q^2$.",
    )


def _draw_trace(ax: Axes, trace: Vector, spacing: float, up: float) -> None:
    """The trace, or the lowest and highest height in as many columns as can be told apart."""
    if trace.size <= 2 * _COLUMNS:
        ax.plot(spacing * np.arange(trace.size), trace / up, color=INK, linewidth=0.9)
        return
    width = -(-trace.size // _COLUMNS)
    padded = np.pad(trace, (0, -trace.size % width), constant_values=np.nan).reshape(-1, width)
    known = np.isfinite(padded).any(axis=1)
    low, high = (
        np.where(known, find(np.where(np.isfinite(padded), padded, fill), axis=1), np.nan) / up
        for find, fill in ((np.min, np.inf), (np.max, -np.inf))
    )
    x = spacing * width * (np.arange(low.size) + 0.5)
    ax.fill_between(x, low, high, color=INK, linewidth=0.6)


def _spectrum(profile: mf.Profile, spectrum: Any, ax: Axes) -> None:
    unit, name = unit_of(profile.spacing * 20)
    ax.loglog(spectrum.frequencies * unit, spectrum.psd / unit**3, color=INK, linewidth=1.1)
    if profile.cutoff is not None:
        ax.axvline(unit / profile.cutoff, color=INK, linewidth=1, linestyle=(0, (4, 2)), label="cut-off")
    ax.set(xlabel=f"waves per {name}", ylabel=f"{name}³")
