"""What those need who design with a surface: its BRDF as a table in files that optics programs read.

`index.py` turns what a user says of the refractive index into numbers, `grid.py` angles into directions.
`brdf.py` computes the table, `save.py` chooses among the writers: `records.py` has the general formats,
`programs.py` those of optics programs. `abg.py` fits the ABg model, `bandwidth.py` says which lateral scales
matter at a wavelength.
"""

from __future__ import annotations

from microfacet._optics.abg import AbgFit
from microfacet._optics.bandwidth import SpatialBandwidth, spatial_bandwidth
from microfacet._optics.brdf import BrdfTable, brdf_table
from microfacet._optics.index import read_refractive_index

__all__ = [
    "AbgFit",
    "BrdfTable",
    "SpatialBandwidth",
    "brdf_table",
    "read_refractive_index",
    "spatial_bandwidth",
]
