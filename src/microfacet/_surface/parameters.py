"""The parameters of ISO 25178-2 in words: what each is, and in which unit it stands."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["PARAMETERS", "Parameter"]


class Parameter(NamedTuple):
    """A unit, "1" for pure numbers and "rad" for angles, and a phrase."""

    unit: str
    meaning: str


_LENGTHS = {
    "Sq": "root mean square height",
    "Sa": "mean absolute height",
    "Sp": "highest peak above the mean plane",
    "Sv": "deepest pit below the mean plane",
    "Sz": "highest peak to deepest pit",
    "Sk": "height of the core",
    "Spk": "reduced height of the peaks above the core",
    "Svk": "reduced depth of the pits below the core",
    "Vmp": "material volume of the peaks, m^3/m^2, ratio 0 to 10 %",
    "Vmc": "material volume of the core, m^3/m^2, ratio 10 to 80 %",
    "Vvc": "void volume of the core, m^3/m^2, ratio 10 to 80 %",
    "Vvv": "void volume of the pits, m^3/m^2, ratio 80 to 100 %",
    "Sxp": "height between the material ratios 2.5 and 50 %",
    "S5p": "five-point peak height, pruned at 5 % of Sz",
    "S5v": "five-point pit depth, pruned at 5 % of Sz",
    "S10z": "ten-point height, S5p + S5v",
    "Sal": "autocorrelation length: the shortest fall to 0.2",
}
_NUMBERS = {
    "Ssk": "skewness of the heights",
    "Sku": "kurtosis of the heights, 3 if normal",
    "Sdq": "root mean square gradient, central differences over two pixels (as the slopes that are fitted)",
    "Sdr": "developed area ratio, four triangles around the middle of each quadrilateral of pixels",
    "Sdq_adjacent": "root mean square gradient, differences of adjacent pixels (the standard's)",
    "Sdr_adjacent": "developed area ratio, triangles at the corners of quadrilaterals (the standard's)",
    "Smrk1": "material ratio between peaks and core",
    "Smrk2": "material ratio between core and pits",
    "Smr": "material ratio of the mean plane",
    "Str": "texture aspect ratio, 1 if isotropic",
}

#: Unit and meaning of every parameter, by name.
PARAMETERS = {
    **{name: Parameter("m", meaning) for name, meaning in _LENGTHS.items()},
    **{name: Parameter("1", meaning) for name, meaning in _NUMBERS.items()},
    "Std": Parameter("rad", "texture direction: across the grooves, from +x counter-clockwise"),
}
