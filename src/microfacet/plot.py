"""Figures of distributions: the curves one wants to see, drawn the same everywhere.

Every function takes a frozen distribution (``mf.GGX(alpha=0.3)``), draws one quantity into ``ax`` (the
current axes when omitted), passes further keywords to matplotlib, and returns the axes, so that calls
chain in a notebook:

>>> import matplotlib; matplotlib.use("agg")
>>> import microfacet as mf
>>> from microfacet import plot
>>> ax = plot.density(mf.Beckmann(alpha=0.3))
>>> ax = plot.density(mf.GGX(alpha=0.3), ax, log=True)
>>> len(ax.lines)
2

This module needs matplotlib: the extra ``plot``, ``pip install ".[plot]"`` in a checkout.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._family import families
from microfacet._family.looks import look, symbol
from microfacet._optional import needed

with needed("microfacet.plot needs"):
    from matplotlib import pyplot as plt
    from matplotlib.axes import Axes

if TYPE_CHECKING:
    from microfacet._frozen import Distribution

__all__ = [
    "COLORS",
    "DASHES",
    "Lambda",
    "density",
    "histogram",
    "joint",
    "label",
    "marginal",
    "short_parameters",
    "sigma",
    "slope_histogram",
    "style",
]

Array = NDArray[np.float64]

_LOOKS = {family.name: look(number) for number, family in enumerate(families())}
#: One colour and one dash pattern per family; each reads on white and on near-black, and the dashes tell the
#: families apart without colour.
COLORS = {name: color for name, (color, _) in _LOOKS.items()}
DASHES: dict[str, Any] = {name: dashes for name, (_, dashes) in _LOOKS.items()}


def style(family: str) -> tuple[str, Any]:
    """The colour and the dashes of a family, or of densities of one's own of that name.

    >>> style("ggx")
    ('#d9662b', '-')
    """
    number = len(COLORS) + zlib.crc32(family.encode()) % 12
    return (COLORS[family], DASHES[family]) if family in COLORS else look(number)


def short_parameters(parameters: Mapping[str, float]) -> dict[str, float]:
    """Parameters with one alpha where both are equal, as one would write them.

    >>> short_parameters({"alpha_x": 0.5, "alpha_y": 0.5, "rotation": 0.0, "gamma": 2.0})
    {'alpha': 0.5, 'gamma': 2.0}
    """
    stretched = {name: parameters[name] for name in ("alpha_x", "alpha_y", "rotation") if name in parameters}
    if not stretched or stretched["alpha_x"] != stretched["alpha_y"]:
        return dict(parameters)
    shape = {name: value for name, value in parameters.items() if name not in stretched}
    return {"alpha": stretched["alpha_x"], **shape}


brief = short_parameters  # its name in 0.2


def label(parameters: Mapping[str, float]) -> str:
    r"""Parameters as mathtext, for a legend.

    >>> label({"alpha": 0.5, "gamma": 2.0})
    '$\\alpha = 0.5,\\ \\gamma = 2$'
    """
    terms = (f"{symbol(name)} = {value:.4g}" for name, value in short_parameters(parameters).items())
    return "$" + r",\ ".join(terms) + "$"


def density(
    ndf: Distribution, ax: Axes | None = None, *, log: bool = False, azimuth: float = 0.0, **line: Any
) -> Axes:
    """Draw D(m) against the angle between m and the macronormal, in degrees.

    Parameters
    ----------
    ndf : distribution
    ax : matplotlib Axes, optional
    log : bool
        Logarithmic ordinate. Eight decades below the largest finite value are shown.
    azimuth : float
        Azimuth of m in radians; matters for an anisotropic distribution.
    **line
        Passed to `matplotlib.axes.Axes.plot`.
    """
    theta = 90.0 * np.linspace(0.0, 1.0, 402)[:-1] ** 2  # dense at the peak; D may be infinite at grazing
    values = np.asarray(ndf.D(_directions(np.cos(np.radians(theta)), azimuth)), dtype=float)
    ax = _draw(ax, ndf, theta, values, line)
    ax.set(xlabel=r"$\theta$ (degrees)", ylabel="$D$", xlim=(0, 90), xticks=range(0, 91, 15))
    return _logarithmic(ax, values, 8) if log else ax


def joint(
    ndf: Distribution, ax: Axes | None = None, *, extent: float | None = None, log: bool = False, **line: Any
) -> Axes:
    """Draw the joint slope density P22(p, 0) against p in [-extent, extent] (4 alpha by default)."""
    p = _slopes(ndf, extent)
    values = np.asarray(ndf.P22(p, 0.0), dtype=float)
    ax = _draw(ax, ndf, p, values, line)
    ax.set(xlabel="slope $p$", ylabel=r"$P_{22}(p, 0)$", xlim=(p[0], p[-1]))
    return _logarithmic(ax, values, 6) if log else _peak_cut(ax, p, values)


def marginal(
    ndf: Distribution, ax: Axes | None = None, *, extent: float | None = None, log: bool = False, **line: Any
) -> Axes:
    """Draw the marginal slope density P2(p) along x against p in [-extent, extent]."""
    p = _slopes(ndf, extent)
    values = np.asarray(ndf.P2(p), dtype=float)
    ax = _draw(ax, ndf, p, values, line)
    ax.set(xlabel="slope $p$", ylabel="$P_2(p)$", xlim=(p[0], p[-1]))
    return _logarithmic(ax, values, 6) if log else _peak_cut(ax, p, values)


def sigma(
    ndf: Distribution, ax: Axes | None = None, *, azimuth: float = 0.0, log: bool = False, **line: Any
) -> Axes:
    """Draw the projected area sigma(u) against u = cos(theta) in [-1, 1]."""
    u = np.cos(np.linspace(np.pi, 0.0, 400))
    values = np.asarray(ndf.sigma(_directions(u, azimuth)), dtype=float)
    ax = _draw(ax, ndf, u, values, line)
    ax.set(xlabel=r"$u = \cos\theta$", ylabel=r"$\sigma(u)$", xlim=(-1, 1))
    return _logarithmic(ax, values, 8) if log else ax


def Lambda(ndf: Distribution, ax: Axes | None = None, *, azimuth: float = 0.0, **line: Any) -> Axes:
    """Draw Smith's Lambda(u) against u = cos(theta) in (0, 1), on a logarithmic ordinate."""
    u = np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, 402)[1:-1] ** 2)  # dense at the horizon
    values = np.asarray(ndf.Lambda(_directions(u, azimuth)), dtype=float)
    ax = _draw(ax, ndf, u, values, line)
    ax.set(xlabel=r"$u = \cos\theta$", ylabel=r"$\Lambda(u)$", xlim=(0, 1))
    away = values[u > 0.01]  # Lambda is infinite at the horizon, which should not set the scale
    return _logarithmic(ax, away if away.any() else values, 8)


def histogram(
    ndf: Distribution,
    ax: Axes | None = None,
    *,
    n: int = 200_000,
    bins: int = 64,
    seed: int = 1,
    **line: Any,
) -> Axes:
    """Draw the histogram of u = m_z over `n` sampled normals under the density it must follow.

    The curve is 2 pi u D(u), with D averaged over the azimuth where the distribution is anisotropic.
    """
    ax = plt.gca() if ax is None else ax
    u = np.asarray(ndf.sample(np.random.default_rng(seed).random((n, 2))))[..., 2]
    counts, edges = np.histogram(u, bins=bins, range=(0.0, 1.0))
    ax.stairs(counts / (n / bins), edges, fill=True, color=style(ndf.family)[0], alpha=0.3, label="samples")
    centre = np.linspace(0.0, 1.0, 801)[1:-1]
    azimuths = np.linspace(
        0.0, np.pi, 1 if "alpha" in short_parameters(ndf.parameters) else 64, endpoint=False
    )
    mean = np.mean([np.asarray(ndf.D(_directions(centre, azimuth))) for azimuth in azimuths], axis=0)
    line.setdefault("label", r"$2\pi u D(u)$")
    _draw(ax, ndf, centre, 2.0 * np.pi * centre * mean, line | {"linestyle": "-"})
    ax.set(xlabel=r"$u = \cos\theta$", ylabel="density", xlim=(0, 1), ylim=(0, None))
    return ax


def slope_histogram(
    slopes: ArrayLike,
    fitted: Mapping[str, Distribution] | None = None,
    ax: Axes | None = None,
    *,
    azimuth: float = 0.0,
    log: bool = False,
    bins: int = 120,
    **line: Any,
) -> Axes:
    """Draw the histogram of measured slopes (N, 2) along an azimuth, and the P2 of fitted distributions.

    Parameters
    ----------
    slopes : array_like, shape (N, 2)
    fitted : mapping of label to distribution, optional
        Each is turned so that `azimuth` becomes its x axis, along which P2 is the marginal.
    azimuth : float
        Direction in the plane, in radians from x, on which the slopes are projected.
    log : bool
        Logarithmic ordinate, which is where families differ.
    """
    ax = plt.gca() if ax is None else ax
    pq = np.asarray(slopes, dtype=float)
    p = pq @ np.array([np.cos(azimuth), np.sin(azimuth)])
    extent = float(np.quantile(np.abs(p), 0.9995 if log else 0.99))
    counts, edges = np.histogram(p, bins=bins, range=(-extent, extent))
    heights = counts / (p.size * np.diff(edges))
    ax.stairs(
        heights,
        edges,
        fill=True,
        color=plt.rcParams["text.color"],
        alpha=0.2,
        label="measured",
        baseline=1e-300 if log else 0,
    )
    grid = np.linspace(-extent, extent, 401)
    for name, ndf in (fitted or {}).items():
        _draw(ax, ndf, grid, np.asarray(turned(ndf, azimuth).P2(grid), dtype=float), {"label": name} | line)
    ax.set(xlabel="slope", ylabel="density", xlim=(-extent, extent))
    if log:
        ax.set_yscale("log")
        ax.set_ylim(0.5 * float(heights[heights > 0].min()), 2.0 * float(heights.max()))
    return ax


def turned(ndf: Distribution, azimuth: float) -> Distribution:
    """The same distribution seen in a frame whose x axis points along `azimuth`."""
    parameters = dict(ndf.parameters)
    if "alpha_x" not in parameters:  # isotropic
        return ndf
    parameters["rotation"] = parameters.get("rotation", 0.0) - azimuth
    make: Any = getattr(ndf, "with_roughness", type(ndf))
    rotated: Distribution = make(**parameters)
    return rotated


def _directions(u: Array, azimuth: float) -> Array:
    s = np.sqrt((1.0 - u) * (1.0 + u))
    return np.stack([s * np.cos(azimuth), s * np.sin(azimuth), u], axis=-1)


def _slopes(ndf: Distribution, extent: float | None) -> Array:
    parameters = short_parameters(ndf.parameters)
    reach = extent or 4.0 * parameters.get("alpha", parameters.get("alpha_x", 1.0))
    half = reach * np.linspace(0.0, 1.0, 201) ** 2  # dense at 0, where K0 and Bessel K peak
    return np.concatenate([-half[:0:-1], half])


def _draw(ax: Axes | None, ndf: Distribution, x: Array, y: Array, line: Mapping[str, Any]) -> Axes:
    ax = plt.gca() if ax is None else ax
    color, dashes = style(ndf.family)
    drawn = {"color": color, "linestyle": dashes, "label": label(ndf.parameters)}
    finite = np.isfinite(y)
    ax.plot(x[finite], y[finite], **(drawn | dict(line)))
    return ax


def _logarithmic(ax: Axes, values: Array, decades: int) -> Axes:
    """Logarithmic ordinate over at most `decades` below the largest value drawn so far."""
    seen = values[np.isfinite(values) & (values > 0)]
    if not seen.size:
        return ax  # nothing that a logarithm could show
    fresh = ax.get_yscale() != "log"
    ax.set_yscale("log")
    top = float(seen.max()) if fresh else max(float(seen.max()), ax.get_ylim()[1] / 2.0)
    bottom = max(float(seen.min()), top * 10.0**-decades)
    ax.set_ylim(bottom if fresh else min(bottom, ax.get_ylim()[0]), 2.0 * top)
    return ax


def _peak_cut(ax: Axes, p: Array, values: Array) -> Axes:
    """Ordinate from 0. A singular peak is cut at thrice the density beside it, or it would hide the rest."""
    beside = float(values[np.abs(p) > 0.03 * p[-1]].max())
    top = min(1.05 * float(values[np.isfinite(values)].max()), 3.0 * beside)
    if top > 0.0:
        ax.set_ylim(0.0, top if len(ax.lines) < 2 else max(top, ax.get_ylim()[1]))
    return ax
