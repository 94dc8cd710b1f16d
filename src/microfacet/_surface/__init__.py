"""Measured surfaces: read a height map, prepare it, take its slopes.

`height_map.py` holds the data and `surface.py` what is done to them, with `form.py` (planes, polynomials,
spheres) and `filters.py`; `areal.py` describes the result. The readers turn files into surfaces and treat
every file as hostile: `read.py` decides who reads, `numpy_files.py` parses ``.npy`` and ``.npz``, `x3p.py`
parses ``.x3p``, `text_files.py` grids of numbers. Libraries read the rest in a process of its own
(`process.py`, `child.py`): `images.py` through OpenImageIO, `library.py` through SurfaceTopography.
`slope_files.py` reads slopes that need no heights. `synthesis.py` makes maps of a family, by the laws of
`mixing.py`.
"""

from __future__ import annotations

from microfacet._surface.areal import Roughness, roughness
from microfacet._surface.checks import SurfaceError
from microfacet._surface.read import read_surface
from microfacet._surface.slope_files import SlopeSample, read_normal_map, read_slopes
from microfacet._surface.surface import Surface
from microfacet._surface.synthesis import synthesize
from microfacet._surface.terrain import sample_terrain

__all__ = [
    "Roughness",
    "SlopeSample",
    "Surface",
    "SurfaceError",
    "read_normal_map",
    "read_slopes",
    "read_surface",
    "roughness",
    "sample_terrain",
    "synthesize",
]
