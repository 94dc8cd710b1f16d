"""What can be exported: the functions by name, what each means, and which parameters it takes."""

from __future__ import annotations

import inspect
import math
from collections.abc import Iterable
from importlib import import_module

from microfacet._docs import QUANTITIES
from microfacet._sampling import Sampling

__all__ = [
    "FRESNEL",
    "FUNCTIONS",
    "GROUPS",
    "OPTICS",
    "expanded",
    "is_of_material",
    "meaning",
    "own_parameters",
    "takes_channels",
]

_OF_DISTRIBUTIONS = (
    *("D", "P22", "P2", "slope_cdf", "survival", "sigma", "Lambda", "G1", "G2", "D_visible"),
    *("sample", "pdf", "sample_visible", "pdf_visible"),
)
_PARTS = ("eval", "pdf", "sample")
_REFLECTANCES = {"conductor": ("eta", "k"), "schlick": ("f0",)}
# What materials take besides the parameters of their distribution.
_MATERIALS = {"conductor": _REFLECTANCES["conductor"], "dielectric": ("eta",)}

#: Names that stand for several functions.
GROUPS = {name: tuple(f"{name}_{part}" for part in _PARTS) for name in _MATERIALS}
#: How a conductor's facets reflect: by the indices of its metal, or by Schlick's approximation.
FRESNEL = tuple(_REFLECTANCES)
#: What describes materials, and the closed intervals in which it makes sense: indices relative to the medium
#: above, and the reflectance at normal incidence.
OPTICS = {"eta": (0.0, math.inf), "k": (0.0, math.inf), "f0": (0.0, 1.0)}
#: All functions.
FUNCTIONS = (*_OF_DISTRIBUTIONS, *(name for names in GROUPS.values() for name in names))


def expanded(names: Iterable[str]) -> tuple[str, ...]:
    """The functions that these names stand for, each once; ValueError lists what there is."""
    found: dict[str, None] = {}
    for name in names:
        if name not in FUNCTIONS and name not in GROUPS:
            listed = ", ".join((*_OF_DISTRIBUTIONS, *GROUPS, *sum(GROUPS.values(), ())))
            raise ValueError(f"functions must be of {listed}, got {name!r}")
        found.update(dict.fromkeys(GROUPS.get(name, (name,))))
    if not found:
        raise ValueError("functions must name at least one function, got none")
    return tuple(found)


def own_parameters(function: str, fresnel: str) -> tuple[str, ...]:
    """The names of what a material takes, of `OPTICS`; none for the rest."""
    material = function.partition("_")[0]
    if function in _OF_DISTRIBUTIONS:
        return ()
    return _REFLECTANCES[fresnel] if material in FRESNEL else _MATERIALS[material]


def is_of_material(function: str) -> bool:
    """Whether it is a material's, rather than a distribution's."""
    return function not in _OF_DISTRIBUTIONS


def takes_channels(function: str) -> bool:
    """Whether it is computed for several wavelengths at once."""
    return function not in _OF_DISTRIBUTIONS and function.partition("_")[0] in FRESNEL


def meaning(function: str) -> str:
    """One sentence or two, from the documentation of the same function in Python."""
    material, _, part = function.partition("_")
    if function in _OF_DISTRIBUTIONS:
        method = getattr(Sampling, function, None)
        return _summary(method) if method else QUANTITIES[function].summary
    bsdf = import_module("microfacet._bsdf")
    return _summary(getattr(getattr(bsdf, material.capitalize()), part))


def _summary(thing: object) -> str:
    first = (inspect.getdoc(thing) or "").split("\n\n")[0]
    return " ".join(first.replace("`", "").replace(" (..., 3)", "").split())
