"""Measured surfaces: read a height map, prepare it, take its slopes.

`height_map` holds the data and `surface` what is done to them, with `form` (planes, polynomials, spheres) and
`filters`. `areal` describes the heights, with `material` and `features`; `spectral` (with `rings` and
`k_correlation`) and `correlation` (with `decay`) describe what is lateral. `read` turns files into surfaces.
`synthesis` makes maps of a family, by the laws of `mixing`.
"""

from __future__ import annotations

from microfacet._surface.areal import Roughness, roughness
from microfacet._surface.checks import SurfaceError
from microfacet._surface.correlation import Autocorrelation, autocorrelation
from microfacet._surface.k_correlation import KCorrelation
from microfacet._surface.material import MaterialRatio, material_ratio
from microfacet._surface.read.slopes import SlopeSample, read_normal_map, read_slopes
from microfacet._surface.read.surfaces import read_surface
from microfacet._surface.spectral import Spectrum, spectrum
from microfacet._surface.surface import Surface
from microfacet._surface.synthesis import synthesize
from microfacet._surface.terrain import sample_terrain

__all__ = [
    "Autocorrelation",
    "KCorrelation",
    "MaterialRatio",
    "Roughness",
    "SlopeSample",
    "Spectrum",
    "Surface",
    "SurfaceError",
    "autocorrelation",
    "material_ratio",
    "read_normal_map",
    "read_slopes",
    "read_surface",
    "roughness",
    "sample_terrain",
    "spectrum",
    "synthesize",
]
