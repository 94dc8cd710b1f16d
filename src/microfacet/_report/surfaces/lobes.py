"""What the fitted surfaces would reflect: the lobe of a mirror of each family."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes

import microfacet as mf
from microfacet import plot
from microfacet._report.figure import REFERENCE, FigureBlock, panel

__all__ = ["lobe_figure"]

_INCIDENCES = (30, 75)


def lobe_figure(results: Sequence[Any], titles: dict[str, str]) -> FigureBlock:
    """f |cos| in the plane of incidence, of every family at two angles."""

    def draw(degrees: int, ax: Axes) -> None:
        theta = np.radians(np.linspace(-89.5, 89.5, 359))
        wo = np.stack((np.sin(theta), np.zeros_like(theta), np.cos(theta)), axis=-1)
        incidence = np.radians(degrees)
        wi = np.array([-np.sin(incidence), 0.0, np.cos(incidence)])
        peak = 0.0
        for result in results:
            lobe = mf.Conductor(result.ndf).eval(wi, wo)
            peak = max(peak, float(np.median(np.sort(lobe)[-20:])))
            name = result.family
            look = {"color": plot.COLORS[name], "linestyle": plot.DASHES[name], "label": titles[name]}
            ax.plot(np.degrees(theta), lobe, **look)
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
