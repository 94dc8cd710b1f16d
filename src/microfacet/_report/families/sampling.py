"""Figures of visible normals: their slopes, their picture at grazing incidence, and the noise they save."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.stats import qmc

import microfacet as mf
from microfacet import plot
from microfacet._report.families.parameters import Example
from microfacet._report.figure import REFERENCE, SERIES, FigureBlock, inline_svg, name_panel, panel, thousands

__all__ = ["ROUGHNESSES", "conductor_noise", "sampling_figures", "towards", "visible_slope_density"]

Array = NDArray[np.float64]

INCIDENCES = (30.0, 75.0, 95.0)  # degrees; the last looks up from below the horizon
GRAZING = 85.0
ROUGHNESSES = (0.1, 0.4, 0.8)
ANGLES = np.linspace(0.0, GRAZING, 14)
METAL = (0.2, 3.9)  # index of refraction and absorption, about those of copper in red light
_SLOPES = 200_000
_NORMALS = 400_000
_BINS = 60
_WEIGHTS = 13  # log2 of the points for each variance


def sampling_figures(family: Any, example: Example) -> Iterator[FigureBlock]:
    """The figures of one family's visible normals."""
    yield _slopes(family, example.curves)
    yield _picture(family, example.curves)
    yield _noise(family, example.curves)


def towards(degrees: Any) -> Array:
    """Directions at these angles from the macronormal, in the plane of x: exactly horizontal at 90."""
    parts = np.sin(np.radians(degrees)), 0.0, np.sin(np.radians(90.0 - degrees))
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def _uniforms(ndf: Any, n: int, seed: int = 1) -> Array:
    return np.random.default_rng(seed).random((n, ndf.visible_dims))


def visible_slope_density(ndf: Any, w: Array, p: Array) -> Array:
    """Density of the slope along x of the normals seen from `w` = (s, 0, c): (c - s p)+ P2(p)/sigma(w)."""
    return np.asarray(np.maximum(w[2] - w[0] * p, 0.0) * ndf.P2(p) / ndf.sigma(w))


def _slopes(family: Any, ndf: Any) -> FigureBlock:
    reach = 4.0 * plot.short_parameters(ndf.parameters)["alpha"]
    drawn = []
    for degrees in INCIDENCES:
        m = np.asarray(ndf.sample_visible(towards(degrees), _uniforms(ndf, _SLOPES)))
        counts, edges = np.histogram(-m[:, 0] / m[:, 2], bins=90, range=(-reach, 0.6 * reach))
        drawn.append((degrees, counts / (_SLOPES * np.diff(edges)), edges))

    def draw(ax: Axes, log: bool) -> None:
        for (degrees, heights, edges), (color, _) in zip(drawn, SERIES, strict=False):
            ax.stairs(heights, edges, fill=True, color=color, alpha=0.25, baseline=1e-12 if log else 0.0)
            p = np.linspace(edges[0], edges[-1], 202)  # even: p = 0 may be singular
            density = visible_slope_density(ndf, towards(degrees), p)
            ax.plot(p, density, color=color, label=f"{degrees:g}°")
        ax.set(xlabel="slope $p$ in the plane of incidence", ylabel="density", xlim=(edges[0], edges[-1]))
        top = max(float(heights.max()) for _, heights, _ in drawn)
        if log:
            ax.set_yscale("log")
        ax.set_ylim((1e-4 * top, 2.0 * top) if log else (0.0, 1.1 * top))

    name, title = family.name, family.title
    words = f"{title}: slopes of sampled visible normals from three directions, and their density"
    return FigureBlock(
        f"{name}-visible-slopes",
        (
            panel(f"{name}-vs", words, lambda ax: draw(ax, False), "upper right"),
            panel(f"{name}-vsl", f"{words}, logarithmic", lambda ax: draw(ax, True), "lower center"),
        ),
        f"Slopes of {thousands(_SLOPES)} sampled normals seen from three directions, by their angle from the "
        f"macronormal ({plot.label(ndf.parameters)}), under the density they must follow, "
        "$(u-sp)^+P_2(p)/\\sigma(u)$. Facets that lean towards the viewer have $p<0$; from below the horizon "
        "(95°) no others are seen.",
    )


def _disc() -> tuple[Array, NDArray[np.bool_], float]:
    """Directions at the centres of an equal-area map of the hemisphere; which exist; steradians of each."""
    centres = (np.arange(_BINS) + 0.5) / _BINS * 2.0 - 1.0
    x, y = np.meshgrid(centres, centres)
    r2 = x * x + y * y  # = 2 sin(theta/2)^2 = 1 - cos(theta)
    inside = r2 < 1.0
    s = np.sqrt(np.maximum(2.0 - r2, 0.0))  # sin(theta)/r
    return np.stack([s * x, s * y, 1.0 - r2], axis=-1), inside, 2.0 * np.pi / (np.pi * (_BINS / 2) ** 2)


def _picture(family: Any, ndf: Any) -> FigureBlock:
    w = towards(GRAZING)
    centres, inside, area = _disc()
    m = np.asarray(ndf.sample_visible(w, _uniforms(ndf, _NORMALS)))
    scale = 1.0 / np.sqrt(1.0 + m[:, 2])
    counts, _, _ = np.histogram2d(
        m[:, 1] * scale, m[:, 0] * scale, bins=_BINS, range=((-1.0, 1.0), (-1.0, 1.0))
    )
    somewhere = np.where(inside[..., None], centres, [0.0, 0.0, 1.0])
    exact = np.where(inside, ndf.pdf_visible(somewhere, w), np.nan)
    top = float(np.max(exact[np.isfinite(exact)]))
    shown: dict[str, Any] = {"norm": LogNorm(1e-4 * top, top), "extent": (-1, 1, -1, 1), "origin": "lower"}

    def image(name: str, values: Array, words: str) -> str:
        figure = Figure(figsize=(5.4, 4.6))
        ax = figure.add_axes((0.08, 0.1, 0.72, 0.85))
        drawn = ax.imshow(
            np.where(values > 0.0, values, np.nan), interpolation="nearest", cmap="viridis", **shown
        )
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        ax.plot(np.cos(turn), np.sin(turn), color=REFERENCE["color"], linewidth=0.8)
        ax.grid(visible=False)
        ax.set(xticks=[], yticks=[], aspect="equal", xlim=(-1.02, 1.02), ylim=(-1.02, 1.02), xlabel="$x$")
        name_panel(figure, words)
        ax.spines[:].set_visible(False)
        bar = figure.add_axes((0.83, 0.17, 0.035, 0.7))
        figure.colorbar(drawn, cax=bar).set_label("per steradian")
        return inline_svg(figure, name, f"{family.title}: {words} of visible normals at {GRAZING:g} degrees")

    return FigureBlock(
        f"{family.name}-visible-normals",
        (
            image(f"{family.name}-vh", np.where(inside, counts / (_NORMALS * area), np.nan), "histogram"),
            image(f"{family.name}-vd", exact, "exact density"),
        ),
        f"The hemisphere of normals from above, in equal areas, seen from $+x$ at {GRAZING:g}° "
        f"({plot.label(ndf.parameters)}): the histogram of {thousands(_NORMALS)} sampled normals, counted in "
        "cells, and the exact density of visible normals, on the same logarithmic scale.",
    )


def conductor_noise(ndf: Any, degrees: float, visible: bool, points: Array) -> tuple[float, float]:
    """Mean and standard deviation of the light that one sample of a metal reflects under a white sky."""
    w = towards(degrees)
    drawn = ndf.sample_visible(w, points[:, : ndf.visible_dims]) if visible else ndf.sample(points[:, :2])
    m = np.asarray(drawn)
    cosine = m @ w
    wo = 2.0 * cosine[:, None] * m - w
    reflected = (cosine > 0.0) & (wo[:, 2] > 0.0)
    cosine, wo, z = cosine[reflected], wo[reflected], m[reflected, 2]
    factor = 1.0 / ndf.G1(w) if visible else cosine / (w[2] * z)
    weights = np.zeros(len(points))
    weights[reflected] = mf.fresnel_conductor(cosine, *METAL) * ndf.G2(w, wo) * factor
    return float(weights.mean()), float(weights.std())


def _deviations(ndf: Any, visible: bool, points: Array) -> Array:
    """Relative standard deviation at every angle."""
    means, deviations = np.transpose([conductor_noise(ndf, degrees, visible, points) for degrees in ANGLES])
    return np.asarray(deviations / means)


def _noise(family: Any, ndf: Any) -> FigureBlock:
    points = qmc.Sobol(3, rng=np.random.default_rng(1)).random_base2(_WEIGHTS)
    rough = [
        family.cls(**(plot.short_parameters(ndf.parameters) | {"alpha": alpha})) for alpha in ROUGHNESSES
    ]
    visible = [_deviations(each, True, points) for each in rough]
    every = [_deviations(each, False, points) for each in rough]
    gain = [(b / a) ** 2 for a, b in zip(visible, every, strict=True)]

    def lines(ax: Axes, curves: list[Array], labels: bool, dash: Any = "-") -> None:
        for alpha, curve, (color, _) in zip(ROUGHNESSES, curves, SERIES, strict=False):
            label = rf"$\alpha = {alpha:g}$" if labels else None
            ax.semilogy(ANGLES, curve, color=color, linestyle=dash, label=label)
        ax.set(xlabel="angle of incidence (degrees)", xlim=(0, GRAZING))

    def deviations(ax: Axes) -> None:
        lines(ax, visible, True)
        lines(ax, every, False, (0, (4, 2)))
        ax.set(ylabel="deviation / mean")

    def ratio(ax: Axes) -> None:
        lines(ax, gain, True)
        ax.axhline(1.0, **REFERENCE)
        ax.set(ylabel="variance, all / visible")

    name, title = family.name, family.title
    last = ", ".join(
        f"{curve[-1]:.3g} at $\\alpha={alpha:g}$" for alpha, curve in zip(ROUGHNESSES, gain, strict=True)
    )
    return FigureBlock(
        f"{name}-noise",
        (
            panel(f"{name}-nd", f"{title}: noise of one sample against the angle", deviations),
            panel(f"{name}-nr", f"{title}: variance of all normals over visible ones", ratio),
        ),
        "The noise of a metal (single scattering, white sky) by visible normals, where a sample weighs "
        "$F\\,G_2/G_1\\le 1$ (solid), and by all normals (dashed). The ratio of the variances says "
        f"how many times as many samples all normals take; at {GRAZING:g}° it is {last}.",
    )
