"""Files of surfaces and slopes. Every file is taken for hostile.

`surfaces` decides who reads a height map: `numpy_files` parses ``.npy`` and ``.npz``, `x3p` parses ``.x3p``,
`text_files` grids of numbers. Libraries read the rest in a process of its own (`process`, `child`): `images`
through OpenImageIO, `library` through SurfaceTopography. `slopes` reads slopes that need no heights.
"""
