"""Materials of microfacets: what facets of a distribution do with light.

`fresnel.py` is one smooth interface, `kernels.py` what the compiled core is given (shapes, seeds),
`material.py` what all materials offer, `conductor.py`, `dielectric.py` and `diffuse.py` the materials. What
they scatter the core computes; `albedo.py` sums it up (`quadrature.py`, over the regions of `panels.py`), and
`compensation.py` adds what is missing of single scattering.
"""

from __future__ import annotations

from microfacet._bsdf.compensation import KullaConty, Turquin
from microfacet._bsdf.conductor import Conductor
from microfacet._bsdf.dielectric import Dielectric
from microfacet._bsdf.diffuse import Diffuse
from microfacet._bsdf.fresnel import fresnel_average, fresnel_conductor, fresnel_dielectric
from microfacet._bsdf.material import Material

__all__ = [
    "Conductor",
    "Dielectric",
    "Diffuse",
    "KullaConty",
    "Material",
    "Turquin",
    "fresnel_average",
    "fresnel_conductor",
    "fresnel_dielectric",
]
