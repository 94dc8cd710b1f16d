"""Figures that set families side by side: all six, K0 beside Beckmann, and the limits."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes

import microfacet as mf
from microfacet import plot
from microfacet._report.families.parameters import example
from microfacet._report.figure import INK, REFERENCE, SERIES, FigureBlock, panel

__all__ = ["comparison_figures", "overview"]


def overview(families: Collection[Any], parameters: Mapping[str, float] | None) -> FigureBlock:
    """All families at the same roughness."""
    shown = [(family.title, example(family, parameters).curves) for family in families]

    def density(ax: Axes) -> None:
        for title, ndf in shown:
            plot.density(ndf, ax, log=True, label=title)
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
