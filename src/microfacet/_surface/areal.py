"""Areal roughness parameters of ISO 25178-2 that describe heights and slopes."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import SurfaceError
from microfacet._surface.height_map import HeightMap

__all__ = ["Roughness", "roughness"]


class Roughness(NamedTuple):
    """Parameters of ISO 25178-2: `Sa`, `Sq`, `Sz`, `Sp`, `Sv` in metres, the others are pure numbers."""

    Sq: float
    Sa: float
    Ssk: float
    Sku: float
    Sp: float
    Sv: float
    Sz: float
    Sdq: float
    Sdr: float


def roughness(surface: HeightMap) -> Roughness:
    r"""Roughness parameters of a prepared surface (ISO 25178-2).

    Heights are taken from their mean over the valid pixels; nothing is levelled or filtered here, and
    nearly every parameter depends on it, so prepare the surface first and state the steps.

    .. math:: S_q^2 = \overline{z^2},\quad S_a = \overline{|z|},\quad S_{sk} = \overline{z^3}/S_q^3,\quad
              S_{ku} = \overline{z^4}/S_q^4,\quad S_z = S_p + S_v

    .. math:: S_{dq}^2 = \overline{z_x^2 + z_y^2},\quad S_{dr} = A/A_0 - 1

    The gradient of Sdq is that of `Surface.slopes` at lag 1. The area A of Sdr is that of four triangles in
    every quadrilateral of pixels, which meet in its middle at the mean height of its corners;
    quadrilaterals with a missing corner count neither in A nor in the projected area A_0.

    Parameters
    ----------
    surface : Surface
        Levelled and filtered as needed.

    Returns
    -------
    Roughness
        Named tuple: ``Sq`` root mean square height, ``Sa`` mean absolute height, ``Ssk`` skewness, ``Sku``
        kurtosis (3 for a normal distribution), ``Sp`` highest peak, ``Sv`` deepest pit (positive), ``Sz``
        their sum, ``Sdq`` root mean square gradient, ``Sdr`` developed interfacial area ratio (0.01 is one
        per cent). Lengths in metres.

    Raises
    ------
    SurfaceError
        If all heights are equal, or no valid pixels are neighbours.

    Notes
    -----
    ISO 25178-2:2021, Geometrical product specifications: Surface texture, Areal, Terms, definitions and
    surface texture parameters. Sdq and Sdr grow without bound for finer pixels on many surfaces: state the
    pixel size and the cut-off of the S-filter with them. Sdq is related to the roughness of a family of
    finite variance, for example alpha of a Beckmann surface is Sdq.

    Examples
    --------
    >>> import numpy as np
    >>> import microfacet as mf
    >>> x = np.arange(1000) * 1e-6
    >>> waves = mf.Surface(np.tile(2e-6 * np.sin(2 * np.pi * x / 100e-6), (10, 1)), pixel_size=1e-6)
    >>> result = mf.roughness(waves)
    >>> f"{result.Sq:.4g} {result.Sa:.4g} {result.Sku:.4g} {result.Sdq:.3g}"
    '1.414e-06 1.273e-06 1.5 0.0887'
    """
    heights = surface.heights[surface.mask]
    heights = heights - np.mean(heights)
    highest, lowest = float(np.max(heights)), float(np.min(heights))
    scale = max(highest, -lowest)
    if scale == 0:
        raise SurfaceError("all heights are equal, which leaves no roughness to describe")
    z = heights / scale  # so that no power over- or underflows
    variance = float(np.mean(z * z))
    slopes = surface.slopes(1)
    return Roughness(
        Sq=scale * math.sqrt(variance),
        Sa=scale * float(np.mean(np.abs(z))),
        Ssk=float(np.mean(z**3)) / variance**1.5,
        Sku=float(np.mean(z**4)) / variance**2,
        Sp=highest,
        Sv=-lowest,
        Sz=highest - lowest,
        Sdq=math.sqrt(float(np.mean(np.sum(slopes * slopes, axis=1)))),
        Sdr=_developed(surface.heights, *surface.pixel_size),
    )


def _developed(heights: NDArray[np.float64], dx: float, dy: float) -> float:
    """The area of the triangles over their projection, minus one, without cancellation for a flat map.

    A triangle over its projection is sqrt(1 + p^2 + q^2) with its own slopes: the one along its outer edge,
    which is a difference of corners, and the one towards the middle, where the height is the mean of four.
    """
    a, b, c, d = heights[:-1, :-1], heights[:-1, 1:], heights[1:, :-1], heights[1:, 1:]
    middle = (a + b + c + d) / 4
    total = np.zeros(middle.shape)
    with np.errstate(over="ignore"):
        for one, other, along, across in ((a, b, dx, dy), (c, d, dx, dy), (a, c, dy, dx), (b, d, dy, dx)):
            p = (other - one) / along
            q = (middle - (one + other) / 2) / (across / 2)
            square = p * p + q * q
            total += square / (np.sqrt(1 + square) + 1)  # sqrt(1 + x) - 1
    known = np.isfinite(total)
    if not known.any():
        raise SurfaceError("no four neighbouring pixels are valid, so the developed area is unknown")
    return float(np.mean(total[known]) / 4)
