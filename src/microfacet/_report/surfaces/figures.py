"""Figures of a fit: histograms with residuals, quantiles, roughness by direction, parameters against the lag,
and the lobes that a mirror of each family would reflect.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cache, partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, NullLocator
from numpy.typing import NDArray
from scipy.optimize import brentq

import microfacet as mf
from microfacet import plot
from microfacet._family.looks import symbol
from microfacet._fit.result import FitResult, one_a_family
from microfacet._fit.scales import by_family
from microfacet._report.figure import INK, REFERENCE, FigureBlock, inline_svg, panel
from microfacet._report.surfaces.relief import length

__all__ = [
    "best_families",
    "histogram",
    "lobe_figure",
    "look",
    "quantile_figure",
    "scale_figure",
    "slope_figures",
]

_BINS = 101
_INCIDENCES = (30, 75)
_TALL = (5.4, 5.4)

Vector = NDArray[np.float64]

_SHOWN = 6  # more curves cannot be told apart


def best_families(results: Sequence[FitResult]) -> list[FitResult]:
    """The families that fit best, each with the symmetry that ranks first."""
    return one_a_family(results)[:_SHOWN]


def slope_figures(slopes: Vector, results: Sequence[Any]) -> Iterator[FigureBlock]:
    """Histograms along both axes, quantiles of the radius, roughness by direction, one by one.

    `results` has one of each family.
    """
    first = next((result.params["rotation"] for result in results if "rotation" in result.params), 0.0)
    panels = []
    for key, azimuth in (("x", first), ("y", first + 0.5 * np.pi)):
        panels.append(histogram(f"hist{key}", slopes, results, azimuth))
    degrees = np.degrees(first)
    yield FigureBlock(
        "slopes",
        tuple(panels),
        f"Slopes along both axes of the roughness ({degrees:.0f}° and {degrees + 90:.0f}° from $x$): the "
        "measured density and the marginal $P_2$ of the families that fit best; below, measured over fitted. "
        "The band is two standard deviations of as many slopes as these are worth.",
    )
    yield quantile_figure(
        results,
        "Quantiles of the radial slope in standard space, measured over fitted, against the share of slopes "
        "that lie beyond. A family whose curve bends down where few do has too heavy a tail, one whose curve "
        "bends up there too light a one.",
    )
    yield FigureBlock("directions", (_directions(slopes, results),), _DIRECTIONS)


def quantile_figure(results: Sequence[Any], caption: str) -> FigureBlock:
    """Measured over fitted quantiles, of these families."""
    name = "Quantiles of the slope, measured over fitted"
    return FigureBlock("quantiles", (panel("qq", name, partial(_quantiles, results), legend=None),), caption)


_DIRECTIONS = (
    "Roughness by direction: the median of the absolute slope along each azimuth, measured (points) and of "
    "the families that fit best (curves). Points off the curves at some azimuths show an anisotropy that is "
    "not an ellipse."
)


def scale_figure(scales: Any) -> FigureBlock:
    """Roughness and shape against the lag, for the families that fit best at the first."""
    lengths = np.asarray(scales.lengths)
    by_lag = by_family(scales.results)
    names = list(by_lag[0])[:_SHOWN]
    shapes = {
        family.name: family.parameters[1].name
        for family in mf.families()
        if family.name in names and len(family.parameters) > 1
    }

    def roughness(ax: Axes) -> None:
        for name in names:
            values = [math.sqrt(math.prod(fits[name].roughness)) for fits in by_lag]
            ax.plot(lengths, values, marker="o", markersize=4, **look(name))
        if scales.noise_lags:
            reach = lengths[: len(scales.noise_lags)]
            start = math.sqrt(math.prod(by_lag[0][names[0]].roughness))
            ax.plot(reach, 0.8 * start * reach[0] / reach, label="noise: 1/lag", **REFERENCE)
        _axes_of_scales(ax, lengths, r"$\sqrt{\alpha_x \alpha_y}$")

    def shape(ax: Axes) -> None:
        for name, own in shapes.items():
            values = [fits[name].params[own] for fits in by_lag]
            errors = np.nan_to_num([fits[name].standard_errors[own] for fits in by_lag])
            ax.errorbar(lengths, values, yerr=errors, marker="o", markersize=4, **look(name))
        symbols = ", ".join(f"${symbol(own)}$" for own in dict.fromkeys(shapes.values()))
        _axes_of_scales(ax, lengths, symbols)

    panels = [panel("scalea", "Roughness of each family against the lag", roughness)]
    if shapes:
        panels.append(panel("scales", "Shape parameters against the lag", shape))
    return FigureBlock(
        "scales",
        tuple(panels),
        "Roughness and shape against the lag over which slopes are taken. Roughness has no value without it; "
        "where it falls as 1/lag, it is that of noise.",
    )


def lobe_figure(results: Sequence[Any]) -> FigureBlock:
    """f |cos| in the plane of incidence, of these families at two angles."""

    def draw(degrees: int, ax: Axes) -> None:
        theta = np.radians(np.linspace(-89.5, 89.5, 359))
        wo = np.stack((np.sin(theta), np.zeros_like(theta), np.cos(theta)), axis=-1)
        incidence = np.radians(degrees)
        wi = np.array([-np.sin(incidence), 0.0, np.cos(incidence)])
        peak = 0.0
        for result in results:
            lobe = mf.Conductor(result.ndf).eval(wi, wo)
            peak = max(peak, float(np.median(np.sort(lobe)[-20:])))
            ax.plot(np.degrees(theta), lobe, **look(result.family))
        ax.axvline(degrees, **REFERENCE)
        ax.set(yscale="log", ylim=(1e-5 * peak, 4 * peak), xlim=(-90, 90), xticks=range(-90, 91, 30))
        ax.set(xlabel="direction out, degrees", ylabel=r"$f\,|\cos\theta_o|$")

    return FigureBlock(
        "lobes",
        tuple(
            panel(f"lobe{degrees}", f"Reflected lobes at {degrees} degrees", partial(draw, degrees))
            for degrees in _INCIDENCES
        ),
        f"What the surface would reflect if it were a perfect mirror, along x, of light from "
        f"{_INCIDENCES[0]}° and {_INCIDENCES[1]}° (its mirror image is the thin line): single scattering "
        "with correlated masking. Where the curves part, the choice of the family is seen.",
    )


def _axes_of_scales(ax: Axes, lengths: Vector, label: str) -> None:
    ax.set(xscale="log", yscale="log", xlabel="lag", ylabel=label)
    shown = lengths[:: 1 + len(lengths) // 5]
    ax.set_xticks(shown, [length(one) for one in shown])
    ax.xaxis.set_minor_locator(NullLocator())
    low, high = ax.get_ylim()
    ticks = [step * 10.0**power for power in range(-9, 10) for step in (1, 2, 5)]
    seen = [tick for tick in ticks if low <= tick <= high]
    ax.set_yticks(seen, [f"{tick:g}" for tick in seen])
    ax.yaxis.set_minor_locator(NullLocator())


def histogram(name: str, slopes: Vector, results: Sequence[Any], azimuth: float) -> str:
    """Slopes along an azimuth, measured and fitted, and their ratio."""
    along = slopes @ np.array([np.cos(azimuth), np.sin(azimuth)])
    extent = float(np.quantile(np.abs(along), 0.9995))
    counts, edges = np.histogram(along, bins=_BINS, range=(-extent, extent))
    middles = (edges[:-1] + edges[1:]) / 2
    figure = Figure(figsize=_TALL)
    top, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1.3))
    figure.subplots_adjust(hspace=0.06, bottom=0.12)
    fitted = {look(result.family)["label"]: result.ndf for result in results}
    plot.slope_histogram(slopes, fitted, top, azimuth=azimuth, log=True, bins=_BINS)
    top.set(xlabel="")
    top.legend(loc="lower center", ncols=2)
    share = results[0].n_effective / results[0].n
    for result in results:
        cdf = np.asarray(plot.turned(result.ndf, azimuth).slope_cdf(edges))
        expected = np.diff(cdf) * along.size
        seen = counts > 0
        ratio = counts[seen] / np.maximum(expected[seen], 1e-300)
        below.plot(middles[seen], ratio, **look(result.family) | {"linewidth": 1.2})
        if result is results[0]:
            width = 2 / np.sqrt(np.maximum(expected * share, 1e-300))
            below.fill_between(middles, np.exp(-width), np.exp(width), color=INK, alpha=0.12, linewidth=0)
    below.axhline(1.0, **REFERENCE)
    below.set(xlabel="slope", ylabel="ratio", yscale="log", ylim=(0.2, 5), yticks=[0.2, 1, 5])
    below.set_yticklabels(["0.2", "1", "5"])
    below.minorticks_off()
    degrees = np.degrees(azimuth)
    return inline_svg(
        figure, name, f"Slope histogram along {degrees:.0f} degrees with all fits and their ratio"
    )


def _quantiles(results: Sequence[Any], ax: Axes) -> None:
    for result in results:
        goodness = result.goodness
        beyond = 1 - np.asarray(goodness.probabilities)
        ax.plot(
            beyond,
            np.asarray(goodness.observed) / np.asarray(goodness.expected),
            **look(result.family),
        )
    ax.axhline(1.0, **REFERENCE)
    ax.set(xscale="log", yscale="log", xlabel="share of slopes beyond", ylabel="measured / fitted quantile")
    ax.set(ylim=(0.3, 8), yticks=[0.5, 1, 2])
    ax.set_yticklabels(["0.5", "1", "2"])
    ax.minorticks_off()
    ax.invert_xaxis()
    ax.legend(loc="upper center", ncols=2)


def _directions(slopes: Vector, results: Sequence[Any]) -> str:
    figure = Figure(figsize=_TALL)
    ax: Any = figure.add_subplot(projection="polar")
    every = slopes[:: max(1, len(slopes) // 100_000)]
    points = np.radians(np.arange(0, 180, 7.5))
    medians = np.array([np.median(np.abs(every @ [np.cos(angle), np.sin(angle)])) for angle in points])
    around = np.concatenate((points, points + np.pi))
    ax.plot(around, np.tile(medians, 2), "o", color=INK, markersize=4, label="measured", linestyle="none")
    angles = np.linspace(0, np.pi, 61)
    for result in results:
        widths = [_median_slope(result.ndf, angle) for angle in angles]
        ax.plot(np.concatenate((angles, angles + np.pi)), widths * 2, **look(result.family))
    ax.set_rlabel_position(0)
    ax.yaxis.set_major_locator(MaxNLocator(4))
    ax.tick_params(labelsize=11)
    figure.subplots_adjust(left=0.1, right=0.9, top=0.93, bottom=0.24)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.09), ncols=3)
    return inline_svg(
        figure, "polar", "Polar plot of the median absolute slope by azimuth, measured and fitted"
    )


def _median_slope(ndf: Any, azimuth: float) -> float:
    """The median of the absolute slope along an azimuth: where the marginal's distribution function is
    3/4.
    """
    marginal = plot.turned(ndf, azimuth)
    return math.exp(brentq(lambda t: float(marginal.slope_cdf(math.exp(t))) - 0.75, -30.0, 15.0, xtol=1e-4))


@cache
def look(name: str) -> dict[str, Any]:
    """How a family is drawn, and its title; one of one's own goes by its name."""
    titles = {family.name: family.title for family in mf.families()}
    color, dashes = plot.style(name)
    return {"label": titles.get(name, name), "color": color, "linestyle": dashes}
