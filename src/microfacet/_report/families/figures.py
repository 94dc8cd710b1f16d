"""The figures of one family. Each is a list of panels and a caption that states what one sees."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import microfacet as mf
from microfacet import plot
from microfacet._checks import delta_integral
from microfacet._report.families.parameters import Example
from microfacet._report.figure import INK, REFERENCE, SERIES, FigureBlock, inline_svg, panel, thousands

__all__ = ["family_figures", "two_routes"]

DIRECTIONS = 34  # at which the two routes to sigma are compared; even, so that none lies at u = 0
TALL = (5.4, 4.6)
FLAT = 1e-5  # slope


def family_figures(family: Any, example: Example) -> Iterator[FigureBlock]:
    """The figures of one family, one by one, so that a caller can tell how far it is."""
    if family.singular:  # no density to draw
        yield _masking(family, example)
        return
    yield _density(family, example)
    yield _slopes(family, example)
    yield _masking(family, example)
    yield two_routes(family, example)
    yield _samples(family, example)


def _density(family: Any, example: Example) -> FigureBlock:
    def draw(ax: Axes, log: bool) -> None:
        for ndf, (color, dash) in zip(example.roughness, SERIES, strict=False):
            plot.density(ndf, ax, log=log, color=color, linestyle=dash)

    alphas = _values(example.roughness, "alpha")
    name, title = family.name, family.title
    with np.errstate(all="ignore"):
        singular = np.isinf(example.curves.D(np.array([0.0, 0.0, 1.0])))
    seen = (
        "At the normal the density is infinite, so the linear curves leave the frame."
        if singular
        else "On the linear scale the peak narrows as the surface gets smoother."
    )
    return FigureBlock(
        f"{name}-density",
        (
            panel(f"{name}-d", f"{title} density D for alpha {alphas}, linear", lambda ax: draw(ax, False)),
            panel(
                f"{name}-dl", f"{title} density D for alpha {alphas}, logarithmic", lambda ax: draw(ax, True)
            ),
        ),
        f"Density $D$ against the angle from the macronormal, for three roughnesses. {seen} The logarithmic "
        "scale shows how fast steep facets become rare.",
    )


def _slopes(family: Any, example: Example) -> FigureBlock:
    alpha = plot.short_parameters(example.curves.parameters)["alpha"]
    shown = example.shapes or (example.curves,)
    name, title = family.name, family.title
    reference = None if name == "beckmann" else mf.Beckmann(alpha=alpha)

    def draw(ax: Axes, what: Callable[..., Axes], log: bool) -> None:
        for ndf, (color, dash) in zip(shown, SERIES, strict=False):
            what(ndf, ax, log=log, color=color, linestyle=dash)
        if reference is not None:
            what(reference, ax, log=log, label="Beckmann", **REFERENCE)

    shape = family.parameters[-1].name
    shapes = f" for {shape} {_values(shown, shape)}"
    against = "" if reference is None else " The dotted curve is Beckmann with the same $\\alpha$."
    return FigureBlock(
        f"{name}-slopes",
        (
            panel(
                f"{name}-p22",
                f"{title} joint slope density P22(p, 0){shapes}",
                partial(draw, what=plot.joint, log=False),
                "upper right",
            ),
            panel(
                f"{name}-p2",
                f"{title} marginal slope density P2(p){shapes}, logarithmic",
                partial(draw, what=plot.marginal, log=True),
                "lower center",
            ),
        ),
        f"Slope densities at $\\alpha={alpha:g}$: a cut $P_{{22}}(p,0)$ through the joint density, and the "
        f"marginal $P_2(p)$ on a logarithmic scale, where the tails separate.{against}",
    )


def _masking(family: Any, example: Example) -> FigureBlock:
    def draw(ax: Axes, what: Callable[..., Axes]) -> None:
        for ndf, (color, dash) in zip(example.roughness, SERIES, strict=False):
            what(ndf, ax, color=color, linestyle=dash)

    def area(ax: Axes) -> None:
        draw(ax, plot.sigma)
        ax.plot([-1, 0, 1], [0, 0, 1], label=r"$\max(0,u)$", **REFERENCE)

    alphas = _values(example.roughness, "alpha")
    name, title = family.name, family.title
    return FigureBlock(
        f"{name}-masking",
        (
            panel(f"{name}-l", f"{title} Lambda for alpha {alphas}", lambda ax: draw(ax, plot.Lambda)),
            panel(f"{name}-s", f"{title} projected area sigma for alpha {alphas}", area),
        ),
        "Smith's $\\Lambda(u)$ above the horizon, and the projected area $\\sigma(u)$ on the whole sphere. "
        "A smooth surface would follow the dotted $\\max(0,u)$; what lies above it for $u<0$ is seen from "
        "below the horizon.",
    )


def two_routes(family: Any, example: Example) -> FigureBlock:
    """sigma of the library, the delta integral at some directions, and their difference below."""
    ndf = example.sigma
    arguments = tuple(plot.short_parameters(ndf.parameters).values())
    u = np.cos(np.linspace(np.pi, 0.0, DIRECTIONS + 2))[1:-1]
    closed = np.asarray(family.kernels.sigma(u, *arguments), dtype=float)
    # A cosine next to 1 carries no slope, so the flattest normals are counted by their mass.
    flat = 1.0 - family.kernels.survival(FLAT, *arguments)
    integral = np.maximum(u, 0.0) * flat + delta_integral(family.kernels, u, FLAT, *arguments)
    difference = np.abs(closed - integral)
    color = plot.style(family.name)[0]

    figure = Figure(figsize=TALL)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.4, 1), gridspec_kw={"hspace": 0.12})
    figure.subplots_adjust(bottom=0.13)
    plot.sigma(ndf, above, linestyle="-", label="library")
    above.plot(u, integral, "o", markersize=4.5, markerfacecolor="none", color=INK, label="delta integral")
    above.legend(loc="upper left")
    above.set_xlabel("")
    largest = float(np.nanmax(difference))
    below.semilogy(u, np.maximum(difference, 1e-17), "o", markersize=3.5, color=color)
    below.set(xlabel=r"$u = \cos\theta$", ylabel="difference", xlim=(-1, 1))
    below.set_ylim(5e-18, max(1e-13, 10.0 * largest))
    words = plot.label(ndf.parameters)
    return FigureBlock(
        f"{family.name}-routes",
        (
            inline_svg(
                figure, f"{family.name}-r", f"{family.title}: sigma by two routes, and their difference"
            ),
        ),
        f"The projected area by two routes ({words}): the line is the library's $\\sigma(u)$, the circles "
        f"integrate $D$ over rings of normals. Below, their absolute difference (from $10^{{-17}}$ up); "
        f"it is nowhere above {_power(largest)}.",
    )


def _samples(family: Any, example: Example) -> FigureBlock:
    ndf = example.samples
    figure = Figure(figsize=TALL)
    ax = figure.add_subplot()
    figure.subplots_adjust(bottom=0.13)
    n = 200_000
    plot.histogram(ndf, ax, n=n)
    ax.legend(loc="best")
    return FigureBlock(
        f"{family.name}-samples",
        (
            inline_svg(
                figure,
                f"{family.name}-h",
                f"{family.title}: histogram of sampled cosines under their density",
            ),
        ),
        f"The cosine $u$ of {thousands(n)} sampled normals ({plot.label(ndf.parameters)}) under the density "
        "they must follow, $2\\pi u\\,D(u)$.",
    )


def _values(ndfs: tuple[Any, ...], parameter: str) -> str:
    return ", ".join(f"{plot.short_parameters(ndf.parameters)[parameter]:g}" for ndf in ndfs)


def _power(value: float) -> str:
    """A magnitude as LaTeX: 3.2e-13 is $3\\times10^{-13}$, rounded up so that the sentence stays true."""
    if value == 0:
        return "$0$"
    exponent = int(np.floor(np.log10(value)))
    return f"${int(np.ceil(value / 10.0**exponent))}\\times 10^{{{exponent}}}$"
