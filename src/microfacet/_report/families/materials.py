"""Figures of materials: lobes, albedo, what one order of scattering leaves out, and a white furnace."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.stats import qmc

import microfacet as mf
from microfacet import plot
from microfacet._report.families.parameters import Example
from microfacet._report.families.sampling import towards
from microfacet._report.figure import SERIES, FigureBlock, inline_svg, name_panel, panel

__all__ = ["furnace_picture", "material_figures", "shares_of_orders", "single_albedo"]

Array = NDArray[np.float64]

INCIDENCES = (0.0, 30.0, 60.0, 80.0)  # degrees
ALPHAS = np.geomspace(0.05, 3.0, 12)
_ANGLES = np.linspace(0.0, 89.0, 24)
_FLOOR = 1e-3  # per steradian, in the middle of polar plots
_LOBE_WALKS = 1500
_SHARE_WALKS = 6000
_PIXELS = 64
_SAMPLES = 400  # of a pixel


def material_figures(family: Any, example: Example) -> Iterator[FigureBlock]:
    """The figures of a white metal with one family's surface."""
    yield _lobes(family, example.curves)
    yield _albedo(family, example)
    yield _furnace(family, example)


def _lobes(family: Any, ndf: Any) -> FigureBlock:
    angles = np.arange(-89.0, 90.0, 2.0)
    one, every = mf.Conductor(ndf), mf.Conductor(ndf, scattering="multiple")
    drawn = [
        [one.eval(towards(-degrees), towards(angles)) for degrees in INCIDENCES],
        [every.eval(towards(-degrees), towards(angles), n=_LOBE_WALKS, rng=1) for degrees in INCIDENCES],
    ]
    decades = np.log10(max(float(lobe.max()) for lobes in drawn for lobe in lobes) / _FLOOR)

    def polar(name: str, lobes: list[Array], words: str) -> str:
        figure = Figure(figsize=(5.4, 3.6))
        ax: Any = figure.add_axes((0.05, -0.03, 0.9, 1.1), projection="polar")
        for lobe, degrees, (color, dash) in zip(lobes, INCIDENCES, SERIES, strict=False):
            radius = np.log10(np.maximum(lobe, _FLOOR) / _FLOOR)
            ax.plot(np.radians(angles), radius, color=color, linestyle=dash, label=f"{degrees:g}°")
        ax.set_theta_zero_location("N")
        ax.set_theta_direction(-1)
        ticks = np.arange(1.0, decades + 0.1)
        ax.set(thetamin=-90.0, thetamax=90.0, ylim=(0.0, decades + 0.1), rticks=ticks)
        ax.set_yticklabels([f"{_FLOOR * 10.0**tick:g}" for tick in ticks])
        figure.legend(loc="lower center", ncols=len(INCIDENCES), bbox_to_anchor=(0.5, 0.0))
        name_panel(figure, words)
        return inline_svg(
            figure, name, f"{family.title}: lobes of a white metal, {words}, from four directions"
        )

    return FigureBlock(
        f"{family.name}-lobes",
        (
            polar(f"{family.name}-l1", drawn[0], "one order"),
            polar(f"{family.name}-lm", drawn[1], "all orders"),
        ),
        "Lobes $f|\\cos\\theta_o|$ of a metal that absorbs nothing, in the plane of incidence on a "
        f"logarithmic scale from {_FLOOR:g} per steradian, lit at four angles on the negative side "
        f"({plot.label(ndf.parameters)}): one order of scattering in closed form, and all orders by "
        f"{_LOBE_WALKS} walks for each direction.",
    )


def single_albedo(ndf: Any, degrees: float, points: Array) -> float:
    """What one order of scattering of a white metal sends out."""
    weight = mf.Conductor(ndf).sample(towards(degrees), points[:, : ndf.visible_dims])[1]
    return float(np.mean(weight))


def shares_of_orders(ndf: Any, degrees: float) -> Array:
    """Of the light that leaves a white metal, the part that met one facet, two, three, and more."""
    metal = mf.Conductor(ndf, scattering="multiple")
    _, _, facets = metal.walk(np.broadcast_to(towards(degrees), (_SHARE_WALKS, 3)), rng=1)
    return np.bincount(np.minimum(facets, 4), minlength=5)[1:] / _SHARE_WALKS


def _albedo(family: Any, example: Example) -> FigureBlock:
    points = qmc.Sobol(3, rng=np.random.default_rng(1)).random_base2(12)
    curves = [[single_albedo(ndf, degrees, points) for degrees in _ANGLES] for ndf in example.roughness]
    given = plot.short_parameters(example.curves.parameters)
    shares = np.array([shares_of_orders(family.cls(**given | {"alpha": alpha}), 60.0) for alpha in ALPHAS])

    def against_angle(ax: Axes) -> None:
        for ndf, curve, (color, dash) in zip(example.roughness, curves, SERIES, strict=False):
            alpha = plot.short_parameters(ndf.parameters)["alpha"]
            ax.plot(_ANGLES, curve, color=color, linestyle=dash, label=rf"$\alpha = {alpha:g}$")
        ax.set(xlabel="angle of incidence (degrees)", ylabel="albedo", xlim=(0, 90), ylim=(0.0, 1.05))

    def orders(ax: Axes) -> None:
        for share, words, (color, dash) in zip(
            shares.T, ("one facet", "two", "three", "more"), SERIES, strict=False
        ):
            ax.semilogx(ALPHAS, share, color=color, linestyle=dash, label=words)
        ax.set(xlabel=r"roughness $\alpha$", ylabel="share of the light", ylim=(-0.02, 1.05))

    name, title = family.name, family.title
    lost = 1.0 - min(min(curve) for curve in curves)
    return FigureBlock(
        f"{name}-albedo",
        (
            panel(
                f"{name}-aa", f"{title}: albedo of one order against the angle", against_angle, "lower left"
            ),
            panel(f"{name}-ao", f"{title}: share of light by the facets it met", orders, "center left"),
        ),
        "Against the angle, the albedo: what one order of scattering sends out of a metal that absorbs "
        f"nothing; the rest, up to {100.0 * lost:.0f} % here, meets further facets and belongs to higher "
        "orders. Against roughness, of light from 60°, the share that met one facet, two, three, and more: "
        "all orders together are all of the light.",
    )


def _proposals(ndf: Any, wi: Array, rng: np.random.Generator) -> Array:
    """Directions with the density that a conductor with multiple scattering states."""
    lobe = mf.Conductor(ndf).sample(wi, rng.random((len(wi), ndf.visible_dims)))[0]
    s, phi = np.sqrt(rng.random(len(wi))), 2.0 * np.pi * rng.random(len(wi))
    cosine = np.stack([s * np.cos(phi), s * np.sin(phi), np.sqrt(1.0 - s * s)], axis=-1)
    return np.where(rng.random((len(wi), 1)) < 0.75, lobe, cosine)


def furnace_picture(ndf: Any, scattering: str, pixels: int, samples: int) -> Array:
    """A sphere of white metal under constant light, estimated through `eval`; nan beside the sphere."""
    x = (np.arange(pixels) + 0.5) / pixels * 2.1 - 1.05
    r2 = x**2 + x[:, np.newaxis] ** 2
    seen = r2 < 1.0
    r = np.sqrt(r2[seen])
    wi = np.stack([r, np.zeros_like(r), np.sqrt(1.0 - r * r)], axis=-1)
    rng = np.random.default_rng(1)
    metal, density = mf.Conductor(ndf, scattering=scattering), mf.Conductor(ndf, scattering="multiple")
    options: dict[str, Any] = {"rng": rng} if scattering == "multiple" else {}
    light = np.zeros(len(wi))
    for _ in range(samples):
        wo = _proposals(ndf, wi, rng)
        light += metal.eval(wi, wo, **options) / density.pdf(wi, wo)
    picture = np.full(r2.shape, np.nan)
    picture[seen] = light / samples
    return picture


def _furnace(family: Any, example: Example) -> FigureBlock:
    rough = example.roughness[-1]

    def image(name: str, scattering: str, words: str) -> tuple[str, float]:
        picture = furnace_picture(rough, scattering, _PIXELS, _SAMPLES)
        figure = Figure(figsize=(5.4, 3.6))
        ax = figure.add_axes((0.2, 0.02, 0.6, 0.96))
        ax.imshow(np.nan_to_num(picture, nan=1.0), cmap="gray", vmin=0.0, vmax=1.25, interpolation="nearest")
        ax.set_axis_off()
        name_panel(figure, words)
        described = f"{family.title}: a sphere of white metal in constant light, {words}"
        return inline_svg(figure, name, described), float(np.nanmean(picture))

    one, dark = image(f"{family.name}-f1", "single", "one order")
    every, white = image(f"{family.name}-fm", "multiple", "all orders")
    return FigureBlock(
        f"{family.name}-furnace",
        (one, every),
        f"A white furnace: a sphere of a metal that absorbs nothing ({plot.label(rough.parameters)}) under "
        f"light of 1 from everywhere. With one order of scattering its mean is {dark:.3f}; with all orders "
        f"it is {white:.3f}, and only the noise of {_SAMPLES} samples per pixel remains.",
    )
