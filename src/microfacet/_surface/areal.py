"""Areal roughness parameters of ISO 25178-2: of heights, material ratio, features, and slopes."""

from __future__ import annotations

import math
from threading import Lock
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import SurfaceError
from microfacet._surface.features import ten_points
from microfacet._surface.height_map import HeightMap
from microfacet._surface.material import MaterialRatio, sorted_heights
from microfacet._threads import in_threads

__all__ = ["Roughness", "roughness"]

_BLOCK = 1 << 16  # pixels of the rows that are worked on at a time: they stay in the cache
_PEAKS, _PITS = 0.1, 0.8  # the material ratios that part peaks from core and core from pits in volumes

Map = NDArray[np.float64]


class Roughness(NamedTuple):
    """Parameters of ISO 25178-2, as `roughness` documents them: lengths in metres, ratios as shares."""

    Sq: float
    Sa: float
    Ssk: float
    Sku: float
    Sp: float
    Sv: float
    Sz: float
    Sdq: float
    Sdr: float
    Sdq_adjacent: float
    Sdr_adjacent: float
    Sk: float
    Spk: float
    Svk: float
    Smrk1: float
    Smrk2: float
    Vmp: float
    Vmc: float
    Vvc: float
    Vvv: float
    Smr: float
    Sxp: float
    S5p: float
    S5v: float
    S10z: float


def roughness(surface: HeightMap) -> Roughness:
    r"""Roughness parameters of a prepared surface (ISO 25178-2).

    Heights are taken from their mean over the valid pixels; nothing is levelled or filtered here, and
    nearly every parameter depends on it, so prepare the surface first and state the steps.

    .. math:: S_q^2 = \overline{z^2},\quad S_a = \overline{|z|},\quad S_{sk} = \overline{z^3}/S_q^3,\quad
              S_{ku} = \overline{z^4}/S_q^4,\quad S_z = S_p + S_v

    .. math:: S_{dq}^2 = \overline{z_x^2 + z_y^2},\quad S_{dr} = A/A_0 - 1

    Two stencils give Sdq and Sdr, and finer ones give larger values. The gradient of ``Sdq`` is that of
    `Surface.slopes` at lag 1, a difference over two pixels; the area A of ``Sdr`` is that of four triangles
    in every quadrilateral of pixels, which meet in its middle at the mean height of its corners.
    ``Sdq_adjacent`` is from the differences of adjacent pixels, and ``Sdr_adjacent`` from the mean of the two
    ways to cut a quadrilateral into two triangles. That is the standard's way, and what others report.
    Quadrilaterals with a missing corner count neither in A nor in the projected area A_0.

    Of the material ratio curve (`material_ratio`) come the core ``Sk``, ``Spk``, ``Svk``, ``Smrk1``,
    ``Smrk2``, the volumes ``Vmp = Vm(0.1)``, ``Vmc = Vm(0.8) - Vm(0.1)``, ``Vvv = Vv(0.8)``,
    ``Vvc = Vv(0.1) - Vv(0.8)``, ``Sxp = Smc(0.025) - Smc(0.5)``, and ``Smr``, the share of the area above the
    mean plane.

    Parameters
    ----------
    surface : Surface
        Levelled and filtered as needed.

    Returns
    -------
    Roughness
        Named tuple. Lengths in metres: ``Sq`` root mean square height, ``Sa`` mean absolute height, ``Sp``
        highest peak, ``Sv`` deepest pit (positive), ``Sz`` their sum, ``Sk``, ``Spk``, ``Svk`` heights of
        core, peaks and pits, ``Sxp`` extreme peak height, ``S5p``, ``S5v``, ``S10z`` five-point peak height,
        five-point pit depth and their sum, of hills and dales that Wolf's pruning leaves at 5 % of Sz and
        that do not touch the edge (nan where there is none). Volumes per area in metres: ``Vmp`` and
        ``Vmc`` of material in peaks and core, ``Vvc`` and ``Vvv`` of voids in core and pits. Pure numbers:
        ``Ssk`` skewness, ``Sku`` kurtosis (3 for a normal distribution), ``Sdq`` root mean square gradient,
        ``Sdr`` developed interfacial area ratio, ``Smrk1``, ``Smrk2``, ``Smr`` (0.01 is one per cent).

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
    heights = sorted_heights(surface)
    lowest, highest = float(heights[0]), float(heights[-1])
    if highest == lowest:
        raise SurfaceError("all heights are equal, which leaves no roughness to describe")
    curve = MaterialRatio(heights)
    core = curve.core()
    peaks, pits = curve.material(_PEAKS), curve.void(_PITS)
    sq, sa, ssk, sku = _moments(heights)
    values = {
        "Sq": sq,
        "Sa": sa,
        "Ssk": ssk,
        "Sku": sku,
        "Sp": highest,
        "Sv": -lowest,
        "Sz": highest - lowest,
        **core._asdict(),
        "Vmp": peaks,
        "Vmc": curve.material(_PITS) - peaks,
        "Vvc": curve.void(_PEAKS) - pits,
        "Vvv": pits,
        "Smr": curve.ratio(0.0),
        "Sxp": curve.difference(),
    }
    del curve, heights  # as large as the map
    return Roughness(**values, **_gradients(surface), **ten_points(surface)._asdict())


def _moments(heights: Map) -> tuple[float, float, float, float]:
    """Sq, Sa, Ssk and Sku of heights from their mean, a part of them at a time."""
    scale = max(float(heights[-1]), -float(heights[0]))  # so that no power over- or underflows
    sums = np.zeros(4)
    for first in range(0, heights.size, _BLOCK):
        z = heights[first : first + _BLOCK] / scale
        square = z * z
        sums += [np.sum(np.abs(z)), np.sum(square), np.sum(square * z), np.sum(square * square)]
    absolute, second, third, fourth = (float(value) for value in sums / heights.size)
    return scale * math.sqrt(second), scale * absolute, third / second**1.5, fourth / second**2


def _gradients(surface: HeightMap) -> dict[str, float]:
    """Sdq and Sdr by both stencils."""
    dx, dy = surface.pixel_size
    means = _Means("central", "along", "across", "developed", "corners")

    def add(first: int) -> None:
        stop = first + step
        h = surface.heights[first : stop + 1]
        with np.errstate(over="ignore", invalid="ignore"):
            means.add("along", np.square(np.diff(surface.heights[first:stop], axis=1) / dx))
            if h.shape[0] < 2:  # the last row begins no quadrilateral
                return
            means.add("across", np.square(np.diff(h, axis=0) / dy))
            means.add("developed", _around_the_middle(h, dx, dy))
            means.add("corners", _at_the_corners(h, dx, dy))
            h = surface.heights[first : stop + 2]
            if h.shape[0] > 2:
                p = (h[1:-1, 2:] - h[1:-1, :-2]) / (2 * dx)
                q = (h[2:, 1:-1] - h[:-2, 1:-1]) / (2 * dy)
                means.add("central", p * p + q * q)

    ny, nx = surface.heights.shape
    step = max(1, _BLOCK // nx)
    in_threads(add, range(0, ny, step))
    if not means.count["central"]:
        raise SurfaceError("no pixel has its four neighbours at lag 1")
    if not means.count["developed"]:
        raise SurfaceError("no four neighbouring pixels are valid, so the developed area is unknown")
    return {
        "Sdq": math.sqrt(means["central"]),
        "Sdr": means["developed"],
        "Sdq_adjacent": math.sqrt(means["along"] + means["across"]),
        "Sdr_adjacent": means["corners"],
    }


class _Means:
    """Means by name of all values that are known, added a part at a time, from several threads.

    The sums are exact before they are rounded once, so that the order of the parts leaves no trace.
    """

    def __init__(self, *names: str) -> None:
        self.sums: dict[str, list[float]] = {name: [] for name in names}
        self.count = dict.fromkeys(names, 0)
        self.lock = Lock()

    def add(self, name: str, values: Map) -> None:
        known = np.isfinite(values)
        total, count = float(np.sum(values, where=known)), int(np.count_nonzero(known))
        with self.lock:
            self.sums[name].append(total)
            self.count[name] += count

    def __getitem__(self, name: str) -> float:
        return math.fsum(self.sums[name]) / self.count[name]


def _around_the_middle(heights: Map, dx: float, dy: float) -> Map:
    """The area of the triangles over their projection, minus one, without cancellation for a flat map.

    A triangle over its projection is sqrt(1 + p^2 + q^2) with its own slopes: the one along its outer edge,
    which is a difference of corners, and the one towards the middle, where the height is the mean of four.
    """
    a, b, c, d = heights[:-1, :-1], heights[:-1, 1:], heights[1:, :-1], heights[1:, 1:]
    middle = (a + b + c + d) / 4
    total = np.zeros(middle.shape)
    for one, other, along, across in ((a, b, dx, dy), (c, d, dx, dy), (a, c, dy, dx), (b, d, dy, dx)):
        p = (other - one) / along
        q = (middle - (one + other) / 2) / (across / 2)
        total += _stretch(p * p + q * q)
    return total / 4


def _at_the_corners(heights: Map, dx: float, dy: float) -> Map:
    """The same for the mean of both ways to cut a quadrilateral in two: a triangle at each corner.

    Its slopes are those of the two edges that meet there.
    """
    along = (np.diff(heights, axis=1) / dx) ** 2
    across = (np.diff(heights, axis=0) / dy) ** 2
    pairs = [(p, q) for p in (along[:-1], along[1:]) for q in (across[:, :-1], across[:, 1:])]
    return np.asarray(sum(_stretch(p + q) for p, q in pairs) / 4)


def _stretch(square: Map) -> Map:
    """sqrt(1 + x) - 1"""
    return np.asarray(square / (np.sqrt(1 + square) + 1))
