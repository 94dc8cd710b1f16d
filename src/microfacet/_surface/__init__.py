"""Measured surfaces: read a height map, level it, take its slopes.

`surface.py` holds the data and what is done to it. The readers turn files into it and treat every file as
hostile: `read.py` decides who reads, `numpy_files.py` parses ``.npy`` and ``.npz``, `x3p.py` parses
``.x3p``, and `library.py` asks SurfaceTopography, in a process of its own (`library_child.py`), for the rest.
"""

from __future__ import annotations

from microfacet._surface.read import read_surface
from microfacet._surface.surface import Surface, SurfaceError
from microfacet._surface.terrain import sample_terrain

__all__ = ["Surface", "SurfaceError", "read_surface", "sample_terrain"]
