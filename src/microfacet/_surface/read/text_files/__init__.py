"""Height maps and tables as text.

`encoding` gives lines, `layout` finds where the numbers begin and what separates them, `numbers` reads a
cell, `headers` what a heading states, `tables` puts them together; `maps` says what a table is, with `points`
for lists of x, y, z. `esri` reads grids whose format is fixed, word by word (`words`).

Memory is bounded: no line is read beyond a limit, and no more numbers than a map may have.
"""

from __future__ import annotations

from microfacet._surface.read.text_files.encoding import is_text, lines
from microfacet._surface.read.text_files.esri import is_esri, read_esri
from microfacet._surface.read.text_files.layout import NoTable
from microfacet._surface.read.text_files.maps import channels, read_map
from microfacet._surface.read.text_files.points import even_step
from microfacet._surface.read.text_files.tables import Table, read_table

__all__ = [
    "SUFFIXES",
    "NoTable",
    "Table",
    "channels",
    "even_step",
    "is_esri",
    "is_text",
    "lines",
    "read_esri",
    "read_map",
    "read_table",
]

#: Endings of names that promise text.
SUFFIXES = (".asc", ".txt", ".csv", ".tsv", ".dat", ".xyz", ".prn")
