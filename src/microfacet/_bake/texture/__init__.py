"""Lookup textures of renderers: directional albedo, missing energy, split-sum scale and bias.

`axes.py` says where the texels lie, `rows.py` integrates them, `make.py` makes the whole, `table.py` is the
result, `files.py` writes it, and `snippets/` prints the lines of a shader that read it.
"""
