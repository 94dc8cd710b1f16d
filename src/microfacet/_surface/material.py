"""The material ratio curve of ISO 25178-2: how much of the surface lies above a height, and what follows."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import SurfaceError, short
from microfacet._surface.height_map import HeightMap
from microfacet._threads import WORTH_THREADS, blocks, in_threads
from microfacet._value import Value

__all__ = ["Core", "MaterialRatio", "material_ratio", "sorted_heights"]

_CORE = 0.4  # the width of the core in material ratio
_CHUNK = 1 << 20  # heights at a time

Heights = NDArray[np.float64]


class Core(NamedTuple):
    """What the straight line through the core of a material ratio curve gives: `Sk`, `Spk`, `Svk` in metres,
    the ratios `Smrk1` and `Smrk2` as shares of the area."""

    Sk: float
    Spk: float
    Svk: float
    Smrk1: float
    Smrk2: float


class MaterialRatio(Value):
    """The heights of a map from the highest to the lowest, against the share of the area that lies above.

    The curve is exact: between the k-th and the next of N sorted heights it is the straight line from
    ratio (k - 1)/(N - 1) to k/(N - 1). Made by `material_ratio`.
    """

    __slots__ = ("_sorted",)

    _sorted: Heights

    def __init__(self, ascending: Heights) -> None:
        self._keep(_sorted=ascending)

    def __repr__(self) -> str:
        z = self._sorted
        return f"MaterialRatio({z.size} heights from {z[0]:.6g} to {z[-1]:.6g} m)"

    def height(self, ratio: float) -> float:
        """The height above which this share of the area lies: Smc of ISO 25178-2, in metres.

        Parameters
        ----------
        ratio : float
            In [0, 1].

        Returns
        -------
        float
            From the mean of all heights.

        Examples
        --------
        >>> import numpy as np
        >>> import microfacet as mf
        >>> ramp = mf.Surface(np.tile(np.arange(11.0), (5, 1)), pixel_size=1.0)
        >>> round(mf.material_ratio(ramp).height(0.5), 12)
        0.0
        """
        return self._at(self._checked(ratio) * (self._sorted.size - 1))

    def ratio(self, height: float) -> float:
        """The share of the area that lies above a height: Smr(c) of ISO 25178-2.

        Parameters
        ----------
        height : float
            In metres, from the mean of all heights.

        Returns
        -------
        float
            In [0, 1].

        Examples
        --------
        >>> import numpy as np
        >>> import microfacet as mf
        >>> surface = mf.synthesize(mf.Beckmann(alpha=0.2), (256, 256), pixel_size=1e-6)
        >>> share = mf.material_ratio(surface).ratio(mf.roughness(surface).Sq)
        >>> print(f"{share:.1f}")  # a normal distribution has 16 % above one standard deviation
        0.2
        """
        z, count = self._sorted, self._sorted.size
        above = count - int(np.searchsorted(z, height, side="left"))
        if above == 0:
            return 0.0
        if above == count:
            return 1.0
        upper, lower = float(z[count - above]), float(z[count - above - 1])
        return (above - 1 + (upper - height) / (upper - lower)) / (count - 1)

    def difference(self, p: float = 0.025, q: float = 0.5) -> float:
        """The height between two ratios: Sdc(p, q) of ISO 25178-2, by default the extreme peak height Sxp."""
        return self.height(p) - self.height(q)

    def material(self, ratio: float) -> float:
        """The volume of material above the height of this ratio, per area: Vm(p), in metres (m^3/m^2)."""
        return self._integral(self._checked(ratio)) - ratio * self.height(ratio)

    def void(self, ratio: float) -> float:
        """The volume of voids below the height of this ratio, per area: Vv(p), in metres (m^3/m^2)."""
        below = self._integral(1.0) - self._integral(self._checked(ratio))
        return (1 - ratio) * self.height(ratio) - below

    def core(self) -> Core:
        """The core: least squares in the 40 % of the curve that rise least, drawn out to ratios 0 and 1."""
        upper, lower = self._line()
        first, second = self.ratio(upper), self.ratio(lower)
        peaks = self._integral(first) - first * upper
        pits = (1 - second) * lower - (self._integral(1.0) - self._integral(second))
        return Core(
            Sk=upper - lower,
            Spk=2 * peaks / first if first > 0 else 0.0,
            Svk=2 * pits / (1 - second) if second < 1 else 0.0,
            Smrk1=first,
            Smrk2=second,
        )

    def _line(self) -> tuple[float, float]:
        """The heights at ratios 0 and 1 of the line through the core."""
        z, last = self._sorted[::-1], self._sorted.size - 1
        width = _CORE * last
        whole = math.floor(width)
        part = width - whole
        starts = math.floor((1 - _CORE) * last) + 1
        least, begin = math.inf, 0
        for first in range(0, starts, _CHUNK):
            stop = min(first + _CHUNK, starts)
            ends = z[first + whole : stop + whole]
            beyond = z[np.minimum(np.arange(first, stop) + whole + 1, last)] if part else ends
            fall = z[first:stop] - ((1 - part) * ends + part * beyond)
            k = int(np.argmin(fall))
            if fall[k] < least:  # of several alike the first, as the standard has it
                least, begin = float(fall[k]), first + k
        moment = total = 0.0
        for first in range(0, whole + 1, _CHUNK):
            block = z[begin + first : begin + min(first + _CHUNK, whole + 1)]
            moment += float(np.dot(np.arange(first, first + block.size) - whole / 2, block))
            total += float(np.sum(block))
        count = whole + 1
        slope = 12 * moment / (count * (count * count - 1.0))  # metres per place in the order
        middle = total / count
        return middle - slope * (begin + whole / 2), middle + slope * (last - begin - whole / 2)

    def _at(self, place: float) -> float:
        """The height at a place in the order from the highest, 0, to the lowest, N - 1."""
        z = self._sorted
        k = min(math.floor(place), z.size - 2)
        upper, lower = float(z[z.size - 1 - k]), float(z[z.size - 2 - k])
        return upper + (place - k) * (lower - upper)

    def _integral(self, ratio: float) -> float:
        """The integral of the height over ratios from 0 to this one."""
        z = self._sorted
        place = ratio * (z.size - 1)
        k = min(math.floor(place), z.size - 2)
        top, here = float(z[-1]), float(z[z.size - 1 - k])
        whole = float(np.sum(z[z.size - 1 - k :])) - (top + here) / 2
        return (whole + (place - k) * (here + self._at(place)) / 2) / (z.size - 1)

    @staticmethod
    def _checked(ratio: Any) -> float:
        if isinstance(ratio, bool) or not isinstance(ratio, float | int | np.number) or not 0 <= ratio <= 1:
            raise SurfaceError(f"a material ratio must lie in [0, 1], got {short(ratio)}")
        return float(ratio)


def material_ratio(surface: HeightMap) -> MaterialRatio:
    r"""The material ratio curve (Abbott curve) of a prepared surface.

    .. math:: S_{mr}(c) = \frac{A(z \ge c)}{A},\quad S_{mc} = S_{mr}^{-1},\quad
              V_m(p) = \int_0^p S_{mc}(q) - S_{mc}(p)\,dq,\quad V_v(p) = \int_p^1 S_{mc}(p) - S_{mc}(q)\,dq

    Parameters
    ----------
    surface : Surface
        Levelled and filtered as needed; missing pixels do not count.

    Returns
    -------
    MaterialRatio
        Heights at ratios and ratios at heights, volumes, and the core.

    Notes
    -----
    ISO 25178-2:2021, Geometrical product specifications: Surface texture, Areal, Terms, definitions and
    surface texture parameters. `roughness` has the parameters at the usual ratios.

    Examples
    --------
    >>> import numpy as np
    >>> import microfacet as mf
    >>> ramp = mf.Surface(np.tile(np.linspace(0.0, 1.0, 1001), (5, 1)), pixel_size=1.0)
    >>> curve = mf.material_ratio(ramp)
    >>> print(f"{curve.ratio(0.25):.2f} {curve.material(0.1):.4f} {curve.core().Sk:.2f}")
    0.25 0.0050 1.00
    """
    return MaterialRatio(sorted_heights(surface))


def sorted_heights(surface: HeightMap) -> Heights:
    """The valid heights from their mean, ascending."""
    heights = surface.heights[surface.mask]
    heights -= np.mean(heights)
    if heights.size > WORTH_THREADS:
        in_threads(lambda part: heights[part].sort(), blocks(heights.size))
        heights.sort(kind="stable")  # merges what is sorted
    else:
        heights.sort()
    return heights
