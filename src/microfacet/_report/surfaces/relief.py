"""Heights as shaded relief."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LightSource, LinearSegmentedColormap
from matplotlib.figure import Figure

from microfacet._report.figure import INK, FigureBlock, inline_svg

__all__ = ["length", "relief_map", "shades", "unit_of"]

# As in an atlas, from valley to summit; the lightness only rises, so that it reads without colour.
_RELIEF = LinearSegmentedColormap.from_list("relief", ["#46605f", "#728b75", "#aab088", "#d8c89b", "#f6efe0"])
_SCALE = 1.15  # inches to the right of the map for the scale of heights
_LENGTHS = ((1e3, "km"), (1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"))


def shades() -> Any:
    """The colours of heights, for what else is drawn as an image."""
    return _RELIEF


def relief_map(surface: Any) -> FigureBlock:
    """The heights as shaded relief with a scale bar."""
    heights, mask = surface.heights, surface.mask
    dx, dy = surface.pixel_size
    ny, nx = heights.shape
    thin = max(1, max(ny, nx) // 480)
    unit, name = unit_of(0.5 * max(nx * dx, ny * dy))
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
    full, tall = width + 0.9 + _SCALE, height + 1.1
    figure = Figure(figsize=(full, tall))
    ax = figure.add_axes((0.75 / full, 0.65 / tall, width / full, height / tall))
    ax.imshow(image, extent=(0, nx * dx / unit, 0, ny * dy / unit), origin="lower", interpolation="nearest")
    ax.grid(visible=False)
    ax.set(xlabel=f"{name}", ylabel=f"{name}")
    _scale_bar(ax, nx * dx, unit)
    beside = figure.add_axes(((width + 0.95) / full, 0.65 / tall, 0.2 / full, height / tall))
    _height_scale(beside, float(low), float(high))
    steps = f"{nx}\u2009×\u2009{ny} heights, {length(dx)} × {length(dy)} apart"
    return FigureBlock(
        "surface-map",
        (inline_svg(figure, "surface-m", "Shaded relief of the prepared heights"),),
        f"The prepared heights as shaded relief, lit from the north-west ({steps}); light is high. The scale "
        "covers 98 % of the heights: higher and lower ones have the colour of its ends, and shade makes the "
        "colours of slopes lighter and darker than those of the scale.",
    )


def _height_scale(ax: Axes, low: float, high: float) -> None:
    """The colours of the heights, with their unit."""
    unit, name = unit_of(max(abs(low), abs(high)))
    ends = low / unit, high / unit if high > low else low / unit + 1
    column = np.linspace(0, 1, 256)[:, np.newaxis]
    ax.imshow(column, cmap=_RELIEF, extent=(0, 1, *ends), aspect="auto", origin="lower")
    ax.grid(visible=False)
    ax.set_xticks([])
    ax.yaxis.tick_right()
    ax.yaxis.set_label_position("right")
    ax.set_ylabel(f"height, {name}")
    for side in ("top", "right"):
        ax.spines[side].set_visible(True)


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


def unit_of(metres: float) -> tuple[float, str]:
    """The unit in which a length is easiest to read, in metres, and its name."""
    return next(((size, name) for size, name in _LENGTHS if metres >= size), _LENGTHS[-1])


def length(metres: float) -> str:
    """A length in the unit in which it is easiest to read."""
    size, name = unit_of(metres)
    return f"{metres / size:.4g}\u202f{name}"
