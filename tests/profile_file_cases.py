"""Texts that hold one profile, as instruments and people write it, for tests of files.

The truth is always `HEIGHTS` micrometres, 0.5 micrometres apart.
"""

from __future__ import annotations

import numpy as np

POINTS = 60
SPACING = 0.5  # micrometres
HEIGHTS = np.round(2 * np.sin(0.37 * np.arange(POINTS)) + 0.01 * np.arange(POINTS), 4)
X = SPACING * np.arange(POINTS)


def lines(*columns, form="{:.4f}", mark=",", head=""):
    """A table as text."""
    rows = (mark.join(form.format(value) for value in row) for row in zip(*columns, strict=True))
    return head + "\n".join(rows) + "\n"


def with_gap():
    kept = np.r_[0:20, 23:POINTS]
    return lines(X[kept], HEIGHTS[kept], head="x [um],z [um]\n")


#: Text by what is odd about it; read without an option.
TEXTS = {
    "comma": lines(X, HEIGHTS, head="x [um],z [um]\n"),
    "two units": lines(X * 1e-3, HEIGHTS * 1e3, head="x (mm), z (nm)\n", form="{:.5f}"),
    "micro signs": lines(X, HEIGHTS, head="Position [µm];Höhe [\u03bcm]\n", mark=";"),
    "slash": lines(X, HEIGHTS, head="x/um z/um\n", mark=" "),
    "underscore": lines(X, HEIGHTS, head="x_um\tz_um\n", mark="\t"),
    "unit row": lines(X * 1e-3, HEIGHTS, head="Distance;Height\n[mm];[µm]\n", mark=";", form="{:.5f}"),
    "hfm": lines(
        X * 1e-3, HEIGHTS, np.ones(POINTS), head="X;Y;valid\n[mm];[µm];[1/0]\n", mark=";", form="{:.5f}"
    ),
    "dektak": lines(
        X,
        HEIGHTS,
        mark=",",
        head="Sclen,1000\nStylus,Radius: 12.5 um\nSpeed,0.5\n\nScan Data\n\nLateral um,Raw Micrometer,\n",
    ),
    "words": lines(X, HEIGHTS, head="Lateral micrometers, Total Profile micron\n"),
    "decimal commas, semicolon": lines(X, HEIGHTS, head="x [um];z [um]\n", mark=";").replace(".", ","),
    "decimal commas, tab": lines(X, HEIGHTS, head="x [um]\tz [um]\n", mark="\t").replace(".", ","),
    "trailing separator": lines(X, HEIGHTS, head="x [um],z [um]\n").replace("\n", ",\n"),
    "comment": lines(X, HEIGHTS, head="# x [um]  z [um]\n", mark=" "),
    "key and value": lines(X, HEIGHTS, head="# Lateral units: µm\n# Value units: um\n", mark="\t"),
    "one unit": lines(X, HEIGHTS, head="# unit: um\n"),
    "line feeds of Windows": lines(X, HEIGHTS, head="x [um],z [um]\n").replace("\n", "\r\n"),
    "blank lines": lines(X, HEIGHTS, head="x [um],z [um]\n").replace("\n", "\n\n"),
    "heights first": lines(HEIGHTS, X, head="z [um],x [um]\n"),
    "falling": lines(X[::-1], HEIGHTS[::-1], head="x [um],z [um]\n"),
    "from a place": lines(X + 1234.5, HEIGHTS, head="x [um],z [um]\n"),
    "coarse positions": lines(X, HEIGHTS, head="x [mm],z [um]\n").replace("x", "x"),
    "one column": lines(HEIGHTS, head="# spacing: 0.5 um\n# z [um]\n"),
    "one column with a step": lines(HEIGHTS, head="Profile [um]\nStep = 0.0005 mm\n").replace("mm\n", "mm\n"),
    "quoted": lines(X, HEIGHTS, head='"x [um]","z [um]"\n'),
    "exponents": lines(X * 1e-6, HEIGHTS * 1e-6, head="x [m] z [m]\n", mark=" ", form="{:.9e}"),
}
TEXTS["coarse positions"] = lines(np.round(X * 1e-3, 4), HEIGHTS, head="x [mm],z [um]\n", form="{:.4f}")

#: Texts of three traces, of 60, 60 and 40 points: the same heights times 1, 2 and 3.
_SHORT = np.where(np.arange(POINTS) < 40, 3 * HEIGHTS, np.nan)
SEVERAL = {
    "columns": lines(X, HEIGHTS, 2 * HEIGHTS, _SHORT, head="x [um],z1 [um],z2 [um],z3 [um]\n").replace(
        "nan", ""
    ),
    "profiles": lines(
        X,
        HEIGHTS,
        2 * HEIGHTS,
        _SHORT,
        head="x [um];Profile 1 [um];Profile 2 [um];Profile 3 [um]\n",
        mark=";",
    ),
    "pairs": lines(X, HEIGHTS, X, 2 * HEIGHTS, X, _SHORT, head="x [um],z [um],x [um],z [um],x [um],z [um]\n"),
    "empty lines": "x [um],z [um]\n"
    + "\n".join(lines(X[:n], k * HEIGHTS[:n]) for k, n in ((1, 60), (2, 60), (3, 40))),
    "headings": "".join(
        lines(X[:n], k * HEIGHTS[:n], head=f"# trace {k}\n# x [um], z [um]\n")
        for k, n in ((1, 60), (2, 60), (3, 40))
    ),
    "begins anew": "x [um],z [um]\n"
    + "".join(lines(X[:n], k * HEIGHTS[:n]) for k, n in ((1, 60), (2, 60), (3, 40))),
    "numbered": "trace,x [um],z [um]\n"
    + "".join(lines(np.full(n, k), X[:n], k * HEIGHTS[:n]) for k, n in ((1, 60), (2, 60), (3, 40))),
    "heights alone": lines(HEIGHTS, 2 * HEIGHTS, _SHORT, head="# spacing: 0.5 um\nz1 [um],z2 [um],z3 [um]\n"),
}
