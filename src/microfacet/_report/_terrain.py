"""The section on a measured surface: its map, the families fitted to its slopes, and both overlaid."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LightSource, LinearSegmentedColormap
from matplotlib.figure import Figure

import microfacet as mf
from microfacet import plot
from microfacet._report._figures import FigureBlock, panel
from microfacet._report._svg import INK, inline_svg

__all__ = ["FitRow", "MeasuredSurface", "length", "measured_surface", "relief_map"]

MAX_SLOPES = 200_000  # a second of the report's time
# As in an atlas, from valley to summit; the lightness only rises, so that it reads without colour.
_RELIEF = LinearSegmentedColormap.from_list("relief", ["#46605f", "#728b75", "#aab088", "#d8c89b", "#f6efe0"])
_LENGTHS = ((1e3, "km"), (1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"))


@dataclass(frozen=True)
class FitRow:
    """One fitted family, as the table shows it; `behind`, `aic` and `bic` are relative to the first."""

    title: str
    alpha_x: float
    alpha_y: float
    rotation: float | None
    shape: tuple[str, float] | None
    behind: float
    aic: float
    bic: float


@dataclass(frozen=True)
class MeasuredSurface:
    """All that the section shows."""

    source: str
    steps: tuple[str, ...]
    notes: tuple[str, ...]
    n: int
    figures: tuple[FigureBlock, ...]
    rows: tuple[FitRow, ...]


def measured_surface(surface: Any, names: tuple[str, ...]) -> MeasuredSurface:
    """Take the slopes of a prepared surface, fit the families and draw what one sees."""
    slopes = surface.slopes()
    fits = mf.fit(surface, families=names, max_slopes=MAX_SLOPES)
    titles = {family.name: family.title for family in mf.families()}
    best = fits[0]
    rows = tuple(
        FitRow(
            titles[fit.family],
            fit.params["alpha_x" if "alpha_x" in fit.params else "alpha"],
            fit.params["alpha_y" if "alpha_y" in fit.params else "alpha"],
            float(np.degrees(fit.params["rotation"])) if "rotation" in fit.params else None,
            next(((name, fit.params[name]) for name in ("gamma", "a") if name in fit.params), None),
            fit.held_out - best.held_out,
            fit.aic - best.aic,
            fit.bic - best.bic,
        )
        for fit in fits
    )
    return MeasuredSurface(
        source=surface.source,
        steps=(
            *surface.steps,
            f"{_count(len(slopes))} slopes by central differences over {surface.lag} px to either side",
        ),
        notes=_notes(fits, titles),
        n=best.n,
        figures=(relief_map(surface), *_overlays(slopes - np.asarray(best.mean_slope), fits, titles)),
        rows=rows,
    )


def relief_map(surface: Any) -> FigureBlock:
    """The heights as shaded relief with a scale bar."""
    heights, mask = surface.heights, surface.mask
    dx, dy = surface.pixel_size
    ny, nx = heights.shape
    thin = max(1, max(ny, nx) // 480)
    unit, name = _unit(0.5 * max(nx * dx, ny * dy))
    filled = np.where(mask, heights, np.nan)[::thin, ::thin]
    relief = LightSource(azdeg=315, altdeg=40)
    low, high = np.nanquantile(filled, [0.01, 0.99])
    exaggeration = 0.12 * min(nx * dx, ny * dy) / max(high - low, np.finfo(float).tiny)
    image = relief.shade(
        np.nan_to_num(filled, nan=float(low)),  # row 0 is the southern edge; dy < 0 lights it from above
        cmap=_RELIEF,
        vmin=low,
        vmax=high,
        blend_mode="soft",
        vert_exag=exaggeration,
        dx=dx * thin,
        dy=-dy * thin,
    )
    image[..., 3] = np.isfinite(filled)
    width, height = np.array([nx * dx, ny * dy]) * 7.0 / max(nx * dx, ny * dy)
    figure = Figure(figsize=(width + 0.9, height + 1.1))
    ax = figure.add_axes(
        (0.75 / (width + 0.9), 0.65 / (height + 1.1), width / (width + 0.9), height / (height + 1.1))
    )
    ax.imshow(image, extent=(0, nx * dx / unit, 0, ny * dy / unit), origin="lower", interpolation="nearest")
    ax.grid(visible=False)
    ax.set(xlabel=f"{name}", ylabel=f"{name}")
    _scale_bar(ax, nx * dx, unit)
    steps = f"{nx}\u2009×\u2009{ny} heights, {length(dx)} × {length(dy)} apart"
    return FigureBlock(
        "surface-map",
        (inline_svg(figure, "surface-m", "Shaded relief of the prepared heights"),),
        f"The prepared heights as shaded relief, lit from the north-west ({steps}); light is high.",
    )


def _scale_bar(ax: Axes, width: float, unit: float) -> None:
    """A bar of a round length, at most a quarter of the width, above the right end of the map."""
    power = 10.0 ** math.floor(math.log10(width / 4))
    bar = max(step * power for step in (1, 2, 5) if step * power <= width / 4)
    frame = ax.get_xaxis_transform()  # x in units of the map, y in heights of it
    ends = np.array([width - bar, width]) / unit
    ax.plot(
        ends, [1.025, 1.025], transform=frame, color=INK, linewidth=3, solid_capstyle="butt", clip_on=False
    )
    ax.text(ends[0], 1.025, f"{length(bar)} ", transform=frame, ha="right", va="center")


def _overlays(slopes: Any, fits: Any, titles: dict[str, str]) -> list[FigureBlock]:
    axis = float(np.arctan2(*np.linalg.eigh(np.cov(slopes.T))[1][::-1, -1])) % np.pi

    def draw(ax: Axes, azimuth: float, log: bool) -> None:
        fitted = {titles[fit.family]: fit.ndf for fit in fits}
        plot.slope_histogram(slopes, fitted, ax, azimuth=azimuth, log=log)

    blocks = []
    for key, words, azimuth in (("major", "steeper", axis), ("minor", "gentler", axis + 0.5 * np.pi)):
        degrees = np.degrees(azimuth) % 180
        blocks.append(
            FigureBlock(
                f"surface-{key}",
                tuple(
                    panel(
                        f"s{key[:2]}{'l' if log else 'n'}",
                        f"Slope histogram along {degrees:.0f} degrees with the fitted densities, "
                        f"{'logarithmic' if log else 'linear'}",
                        partial(draw, azimuth=azimuth, log=log),
                    )
                    for log in (False, True)
                ),
                f"Slopes along the {words} principal axis ({degrees:.0f}° from x) and the marginal $P_2$ of "
                "each fitted family, linear and logarithmic.",
            )
        )
    return blocks


def _notes(fits: Any, titles: dict[str, str]) -> tuple[str, ...]:
    """What the fits remark, each remark once, with the families it is about unless it is all of them."""
    about: dict[str, list[str]] = {}
    for fit in fits:
        for note in fit.notes:
            about.setdefault(note, []).append(titles[fit.family])
    return tuple(
        note if len(families) == len(fits) else f"{', '.join(families)}: {note}"
        for note, families in about.items()
    )


def _unit(metres: float) -> tuple[float, str]:
    return next(((size, name) for size, name in _LENGTHS if metres >= size), _LENGTHS[-1])


def length(metres: float) -> str:
    """A length in the unit in which it is easiest to read."""
    size, name = _unit(metres)
    return f"{metres / size:.4g}\u202f{name}"


def _count(n: int) -> str:
    return f"{n:,}".replace(",", "\u202f")
