"""Figures that set families side by side: all of them, K0 beside Beckmann, and the limits."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

import microfacet as mf
from microfacet import plot
from microfacet._report.families.parameters import example
from microfacet._report.figure import INK, REFERENCE, SERIES, FigureBlock, panel

__all__ = ["comparison_figures", "overview", "reflectance"]

Array = NDArray[np.float64]


def overview(families: Collection[Any], parameters: Mapping[str, float] | None) -> FigureBlock:
    """All families at the same roughness."""
    shown = [(family.title, example(family, parameters).curves) for family in families]
    singular = [family.title for family in families if family.singular]

    def density(ax: Axes) -> None:
        for title, ndf in shown:
            if title not in singular:
                plot.density(ndf, ax, log=True, label=title)
        if len(singular) < len(shown):
            ax.set_ylim(1e-4, None)

    def masking(ax: Axes) -> None:
        for title, ndf in shown:
            plot.Lambda(ndf, ax, label=title)

    at = "; ".join(f"{title} {plot.label(ndf.parameters)}" for title, ndf in shown)
    return FigureBlock(
        "overview",
        (
            panel("o-d", "Density D of every family, logarithmic", density),
            panel("o-l", "Lambda of every family, logarithmic", masking),
        ),
        f"The density $D$ and Smith's $\\Lambda$ of each family ({at}). With the same roughness they differ "
        "by the peak at the normal and, by orders of magnitude, in the tail.",
    )


def comparison_figures(
    names: Collection[str], parameters: Mapping[str, float] | None
) -> Iterator[FigureBlock]:
    """The comparisons whose families are all among `names`."""
    alpha = (parameters or {}).get("alpha")
    if {"k0", "beckmann"} <= set(names):
        yield _k0_beside_beckmann(alpha or 0.5)
        yield _k0_shines_however_rough(alpha or 0.2)
    if {"student_t", "beckmann"} <= set(names):
        yield _student_t_to_beckmann(alpha or 0.5)
    if {"gtr", "ggx"} <= set(names):
        yield _gtr_through_its_special_exponents(alpha or 0.2)


def _k0_beside_beckmann(alpha: float) -> FigureBlock:
    def draw(ax: Axes, log: bool) -> None:
        plot.density(mf.K0(alpha=alpha), ax, log=log, label="K0")
        plot.density(mf.Beckmann(alpha=alpha), ax, log=log, label="Beckmann")

    return FigureBlock(
        "k0-beckmann",
        (
            panel("kb-d", "D of K0 and Beckmann, linear", lambda ax: draw(ax, False)),
            panel("kb-l", "D of K0 and Beckmann, logarithmic", lambda ax: draw(ax, True)),
        ),
        f"K0 beside Beckmann at $\\alpha={alpha:g}$. K0 rises without bound at the macronormal, falls below "
        "Beckmann at middle angles and above it again at steep ones; both integrate to one.",
    )


def reflectance(ndf: Any, off: Array) -> Array:
    """The BRDF of a mirror lit along its normal, at these angles from the mirror direction."""
    wo = np.stack([np.sin(off), np.zeros_like(off), np.cos(off)], axis=-1)
    return np.asarray(mf.Conductor(ndf).eval([0.0, 0.0, 1.0], wo) / wo[:, 2])


def _k0_shines_however_rough(alpha: float) -> FigureBlock:
    off = np.geomspace(1e-8, 1.0, 240)
    curves = [
        (rough, reflectance(mf.K0(alpha=rough), off), reflectance(mf.Beckmann(alpha=rough), off))
        for rough in (alpha, 5 * alpha, 25 * alpha)
    ]

    def draw(ax: Axes, scaled: bool) -> None:
        for (rough, k0, beckmann), (color, _) in zip(curves, SERIES, strict=False):
            scale = 4 * np.pi * rough**2 if scaled else 1.0
            ax.semilogx(off, scale * k0, color=color, label=rf"K0, $\alpha = {rough:g}$")
            last = "Beckmann" if rough == curves[-1][0] else None
            ax.semilogx(off, scale * beckmann, color=color, linestyle=(0, (4, 2)), label=last)
        ax.set(xlabel="angle from the mirror direction (rad)", xlim=(1e-8, 1.0))
        if not scaled:
            ax.set_yscale("log")
            ax.set_ylim(0.005 * curves[-1][2][0], None)  # room for the legend
        ax.set_ylabel("over the peak of Beckmann" if scaled else "BRDF (1/sr)")

    return FigureBlock(
        "k0-mirror",
        (
            panel("km-l", "BRDF of K0 and Beckmann, logarithmic", lambda ax: draw(ax, False), "lower left"),
            panel("km-s", "BRDF of K0 over the peak of Beckmann's", lambda ax: draw(ax, True), None),
        ),
        "However rough, K0 stays shiny: the BRDF of a mirror, lit along its normal, against the angle "
        "$\\delta$ from the mirror direction. Beckmann's with the same $\\alpha$ (dashed) levels off at "
        "$1/(4\\pi\\alpha^2)$. Over this peak, K0 rises in straight lines, by $2\\ln 10$ a decade and "
        "without end: it is $2K_0(2t)$ there, $t=\\tan(\\delta/2)/\\alpha$.",
    )


def _student_t_to_beckmann(alpha: float) -> FigureBlock:
    beckmann = mf.Beckmann(alpha=alpha)

    def densities(ax: Axes) -> None:
        for gamma, (color, dash) in zip((1.6, 2.0, 4.0, 10.0, 100.0), SERIES, strict=False):
            ndf = mf.StudentT(alpha=alpha, gamma=gamma)
            plot.density(ndf, ax, log=True, color=color, linestyle=dash, label=rf"$\gamma = {gamma:g}$")
        plot.density(beckmann, ax, log=True, label="Beckmann", **REFERENCE)
        ax.set_ylim(1e-7, 1e2)

    def distance(ax: Axes) -> None:
        gamma = np.geomspace(1.6, 1e6, 61)
        u = np.linspace(-0.999, 0.999, 201)
        gap = mf.student_t.sigma(u[:, None], alpha, gamma) - mf.beckmann.sigma(u, alpha)[:, None]
        ax.loglog(gamma, np.max(np.abs(gap), axis=0), color=plot.COLORS["student_t"])
        ax.set(xlabel=r"$\gamma$", ylabel=r"largest $|\sigma-\sigma_{\mathrm{Beckmann}}|$", xlim=(1, 1e6))

    return FigureBlock(
        "student-t-beckmann",
        (
            panel("sb-d", "Student-T density for growing gamma, and Beckmann", densities, "lower left"),
            panel("sb-e", "Largest difference of sigma against gamma, falling like 1/gamma", distance, None),
        ),
        f"Student-T becomes Beckmann as $\\gamma$ grows ($\\alpha={alpha:g}$). The largest difference of the "
        "projected areas over all directions falls like $1/\\gamma$, without a floor: the library keeps its "
        "digits up to $\\gamma=10^6$.",
    )


def _gtr_through_its_special_exponents(alpha: float) -> FigureBlock:
    special = ((1.0, "1"), (1.5, "3/2"), (2.0, "2"))

    def densities(ax: Axes) -> None:
        for gamma, (color, dash) in zip((0.5, 1.0, 1.5, 2.0, 3.0), SERIES, strict=False):
            ndf = mf.GTR(alpha=alpha, gamma=gamma)
            plot.density(ndf, ax, log=True, color=color, linestyle=dash, label=rf"$\gamma = {gamma:g}$")
        plot.density(mf.GGX(alpha=alpha), ax, log=True, label="GGX", **(REFERENCE | {"linewidth": 1.8}))

    def continuity(ax: Axes) -> None:
        step = np.geomspace(1e-15, 0.3, 120)
        for (gamma, words), (color, dash) in zip(special, SERIES, strict=False):
            there = mf.gtr.Lambda(0.3, alpha, gamma)
            change = np.abs(mf.gtr.Lambda(0.3, alpha, gamma + step) / there - 1.0)
            seen = change > 0
            ax.loglog(step[seen], change[seen], color=color, linestyle=dash, label=rf"$\gamma_0 = {words}$")
        ax.axhline(np.finfo(float).eps, color=INK, linewidth=0.8, linestyle=(0, (1, 2)))
        ax.set(xlabel=r"$\delta$", ylabel=r"$|\Lambda(\gamma_0+\delta)/\Lambda(\gamma_0)-1|$")

    return FigureBlock(
        "gtr-limits",
        (
            panel("gl-d", "GTR density for five exponents, and GGX", densities, "upper right"),
            panel("gl-c", "Relative change of Lambda beside gamma 1, 3/2 and 2", continuity, "upper left"),
        ),
        f"GTR through its special exponents ($\\alpha={alpha:g}$); with $\\gamma=2$ it is GGX. How much "
        "$\\Lambda(0.3)$ changes a step $\\delta$ away from $\\gamma_0$ are straight lines of slope "
        "one down to the rounding error (dotted), so nothing is lost where the general formula reads $0/0$.",
    )
