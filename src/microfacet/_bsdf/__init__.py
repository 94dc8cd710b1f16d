"""Materials of microfacets: what facets of a distribution do with light.

`fresnel.py` is one smooth interface. `arguments.py` checks what users give; `kernels.py` calls the compiled
core, which computes what facets scatter. `material.py` has the methods of all materials; `conductor.py`,
`dielectric.py` and `diffuse.py` are the materials. `albedo.py` integrates them with `quadrature.py`, over the
pieces of `panels.py`. `compensation.py` adds the energy that single scattering loses.
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
