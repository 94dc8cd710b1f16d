"""Figures of what is lateral: power spectral density, its model, its directions, and the autocorrelation."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from microfacet._report.figure import INK, REFERENCE, SERIES, FigureBlock, inline_svg, panel
from microfacet._report.surfaces.relief import length, shades, unit_of

__all__ = ["lateral_figures"]

_TALL = (5.4, 5.4)
_LONGEST = 300  # points of a curve


def lateral_figures(spectrum: Any, autocorrelation: Any) -> tuple[FigureBlock, ...]:
    """Two figures: of the spectrum and of the autocorrelation."""
    return (
        FigureBlock("spectrum", (_density(spectrum), _directions(spectrum)), _about_spectrum(spectrum)),
        FigureBlock(
            "autocorrelation",
            (_picture(autocorrelation), _fall(autocorrelation)),
            _about_autocorrelation(autocorrelation),
        ),
    )


def _density(spectrum: Any) -> str:
    """The density over the frequency, its model, and that of the sectors with the most and the least."""

    def draw(ax: Axes) -> None:
        f, psd, errors = spectrum.frequencies, spectrum.psd, spectrum.errors
        for (color, dashes), (label, sector) in zip(SERIES[1:], _extremes(spectrum), strict=False):
            seen = np.isfinite(spectrum.directional[sector])
            ax.plot(
                f[seen],
                spectrum.directional[sector][seen],
                color=color,
                linestyle=dashes,
                linewidth=1.2,
                label=label,
            )
        low = np.maximum(psd - 2 * errors, psd / 10)
        ax.fill_between(f, low, psd + 2 * errors, color=SERIES[0][0], alpha=0.18, linewidth=0)
        ax.plot(f, psd, color=SERIES[0][0], label="all directions")
        if math.isfinite(spectrum.abc.A):
            ax.plot(f, spectrum.abc.psd(f), label="ABC model", **REFERENCE)
        ax.set(xscale="log", yscale="log", xlabel="cycles per metre", ylabel="density, m$^4$")
        top = float(np.max(psd))
        ax.set_ylim(max(float(np.min(psd)) / 3, top * 1e-14), top * 8)

    return panel("psd", "Power spectral density against spatial frequency, with the ABC model", draw)


def _extremes(spectrum: Any) -> list[tuple[str, int]]:
    """The sectors nearest to the direction of the largest density and across it."""
    count = spectrum.sectors.size
    along = round(spectrum.Std / math.pi * count) % count
    return [
        (f"along {np.degrees(spectrum.sectors[sector]):.0f}°", sector)
        for sector in (along, (along + count // 2) % count)
    ]


def _directions(spectrum: Any) -> str:
    figure = Figure(figsize=_TALL)
    ax: Any = figure.add_subplot(projection="polar")
    around = np.concatenate((spectrum.angles, spectrum.angles + np.pi))
    shares = spectrum.angular * math.pi / spectrum.mean_square
    ax.plot(np.append(around, 0.0), np.append(np.tile(shares, 2), shares[0]), color=SERIES[0][0])
    ax.plot([spectrum.Std, spectrum.Std + np.pi], [float(shares.max())] * 2, linewidth=0)
    ax.plot([spectrum.Std] * 2, [0, float(shares.max())], **REFERENCE)
    ax.plot([spectrum.Std + np.pi] * 2, [0, float(shares.max())], **REFERENCE)
    ax.set_rlabel_position(0)
    ax.yaxis.set_major_locator(MaxNLocator(4))
    ax.tick_params(labelsize=11)
    figure.subplots_adjust(left=0.1, right=0.9, top=0.93, bottom=0.07)
    return inline_svg(figure, "psdangle", "Polar plot of the mean square height by direction")


def _about_spectrum(spectrum: Any) -> str:
    model = spectrum.abc
    said = ""
    if math.isfinite(model.errors["C"]):
        said = (
            f" The ABC model $A/(1 + (B f)^2)^{{(C+1)/2}}$ has $B$ = {length(model.B)} "
            f"± {length(model.errors['B'])} and $C$ = {model.C:.3g} ± {model.errors['C']:.2g}."
        )
    window = "no window" if spectrum.window is None else f"a {spectrum.window} window"
    return (
        "Power spectral density of the heights from their plane, averaged over rings of the frequency plane "
        f"({window}), with two standard errors, and over 15° about two directions.{said} Beside or below it, "
        "the mean square height by direction, 1 where it is the same in all; the line is Std, "
        f"{math.degrees(spectrum.Std):.0f}° from $x$."
    )


def _picture(found: Any) -> str:
    """The autocorrelation about the shift of zero, with the contour to which it has to fall."""
    figure = Figure(figsize=_TALL)
    ax = figure.add_subplot()
    rows, columns = found.picture.shape
    dx, dy = found.picture_pixel
    unit, name = unit_of(0.5 * max(rows * dy, columns * dx))
    x, y = columns * dx / unit / 2, rows * dy / unit / 2
    ax.imshow(
        found.picture,
        extent=(-x, x, -y, y),
        origin="lower",
        cmap=shades(),
        vmin=min(-0.2, float(found.picture.min())),
        vmax=1,
    )
    across = (np.arange(columns) - columns // 2) * dx / unit
    up = (np.arange(rows) - rows // 2) * dy / unit
    if min(rows, columns) > 1 and found.picture.min() < found.threshold:
        ax.contour(across, up, found.picture, levels=[found.threshold], colors=[INK], linewidths=1.2)
    ax.grid(visible=False)
    ax.set(xlabel=f"shift, {name}", ylabel=f"shift, {name}")
    figure.subplots_adjust(left=0.17, right=0.97, top=0.97, bottom=0.13)
    return inline_svg(figure, "acf", "Map of the autocorrelation with the contour at the threshold")


def _fall(found: Any) -> str:
    def draw(ax: Axes) -> None:
        unit, name = unit_of(float(found.lengths[-1]) / 2)
        thin = max(1, found.lengths.size // _LONGEST)
        ax.plot(found.lengths[::thin] / unit, found.values[::thin], color=SERIES[0][0])
        ax.axhline(found.threshold, **REFERENCE)
        ax.axhline(0, color=INK, linewidth=0.8)
        for end in (found.Sal, found.longest):
            if math.isfinite(end):
                ax.plot([end / unit] * 2, [0, found.threshold], color=INK, linewidth=1)
        ax.set(xlabel=f"shift, {name}", ylabel="autocorrelation", xlim=(0, None))

    return panel("acfradial", "Autocorrelation against the shift, averaged over all directions", draw)


def _about_autocorrelation(found: Any) -> str:
    said = f"Sal, the shortest fall to {found.threshold:g}, is {length(found.Sal)}" if found.Sal > 0 else ""
    if math.isfinite(found.Str):
        said += f", the longest {length(found.longest)}; Str, their ratio, is {found.Str:.2g}"
    return (
        "Autocorrelation of the heights from their plane: as a map of shifts with the contour at "
        f"{found.threshold:g}, and averaged over all directions, with the shortest and the longest fall. "
        f"{said}."
    )
