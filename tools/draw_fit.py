"""Draw docs/images/fit.png from a measured map: the relief, its slopes with all fits, and roughness against
the lag.

    python tools/draw_fit.py SkiInfiniteFocus.x3p

The map of the page is a sample file of the openGPS project, https://github.com/OpenFMC/x3p.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import click
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.colors import LightSource
from PIL import Image

import microfacet as mf
from microfacet import plot

TARGET = Path(__file__).resolve().parents[1] / "docs" / "images" / "fit.png"


def _relief(ax: Any, surface: mf.Surface) -> None:
    heights = np.nan_to_num(surface.heights[::2, ::2], nan=float(np.nanmedian(surface.heights)))
    ny, nx = surface.heights.shape
    dx, dy = surface.pixel_size
    low, high = np.quantile(heights, [0.01, 0.99])
    light = LightSource(azdeg=315, altdeg=40)
    image = light.shade(
        heights, plt.get_cmap("bone"), vmin=low, vmax=high, dx=2 * dx, dy=-2 * dy, blend_mode="soft"
    )
    ax.imshow(image, origin="lower", extent=(0, 1e3 * nx * dx, 0, 1e3 * ny * dy))
    ax.set(xlabel="mm", ylabel="mm", title="heights")


@click.command()
@click.argument("file", type=click.Path(exists=True))
def main(file: str) -> None:
    """Write the picture."""
    surface = mf.read_surface(file).level()
    titles = {family.name: family.title for family in mf.families()}
    results = mf.fit(surface, symmetry="anisotropic")
    shown = ["student_t", "bessel_k", "ggx", "beckmann"]
    scales = mf.fit_scales(surface, families=shown, symmetry="anisotropic")
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 3.9), layout="constrained")
    _relief(left, surface)
    azimuth = results[0].params["rotation"] + math.pi / 2
    fitted = {titles[result.family]: result.ndf for result in results}
    slopes = surface.slopes() - np.asarray(results[0].mean_slope)
    plot.slope_histogram(slopes, fitted, middle, azimuth=azimuth, log=True)
    middle.set(title=f"slopes along {math.degrees(azimuth):.0f}°, lag 1")
    middle.legend(fontsize=8, loc="lower center", ncols=2)
    for family in [result.family for result in scales.results[0]]:
        fits = [next(fit for fit in at if fit.family == family) for at in scales.results]
        alphas = [math.sqrt(math.prod(fit.roughness)) for fit in fits]
        style = {"color": plot.COLORS[family], "linestyle": plot.DASHES[family], "label": titles[family]}
        right.plot(1e6 * np.asarray(scales.lengths), alphas, marker="o", markersize=4, **style)
    right.set(xscale="log", yscale="log", xlabel="lag in µm", title="sqrt(alpha_x alpha_y) against the lag")
    right.legend(fontsize=8)
    figure.set_dpi(80)
    figure.canvas.draw()
    image = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB")
    image.quantize(128, dither=Image.Dither.NONE).save(TARGET, optimize=True)  # a third of the size


if __name__ == "__main__":
    main()
