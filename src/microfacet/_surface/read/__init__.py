"""Files of surfaces and slopes. Every file is taken for hostile.

`kinds` says what a file is, by its content. `surfaces` has a reader for each kind, which gives a `raw` map:
what the file states and no more; `complete` adds what the caller says, and `describe` lists what there is.
`numpy_files` parses ``.npy`` and ``.npz``, `x3p` (with `x3p_index`) ``.x3p``, `surfer` Surfer grids,
`text_files` every kind of text. Libraries read the rest in a process of its own (`process`, `child`):
`images` through OpenImageIO, `library` through SurfaceTopography. `slopes` reads slopes that need no heights,
by `slope_tables`.
"""
