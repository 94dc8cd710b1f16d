"""What the commands do: `cli.py` declares arguments and calls these modules.

`program.py` holds what all commands share, `parameters.py` matches values to a family, `evaluate.py` calls a
ufunc, `draw.py` writes sampled normals, `tables.py` and `records.py` say results to people and to machines.
Nothing here is imported with the package.
"""
