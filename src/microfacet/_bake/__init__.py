"""Tables of materials: albedos, missing energy, f itself, over grids of angles and parameters.

`recipe.py` is what a table is, `cell.py` the part of it with one roughness, `journal.py` keeps the parts that
are done, `run.py` computes the others and writes the whole. `texture/` makes images for renderers of the same
integrals.
"""

from __future__ import annotations

from microfacet._bake.run import bake
from microfacet._bake.texture.make import lookup_texture
from microfacet._bake.texture.table import LookupTexture

__all__ = ["LookupTexture", "bake", "lookup_texture"]
