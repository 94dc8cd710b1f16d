"""ESRI, GRASS and Surfer grids: headers in any order, marks of missing data, damaged files."""

from __future__ import annotations

import contextlib
import itertools
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import microfacet as mf
from surface_file_cases import our_own_readers, refused

HEIGHTS = np.round(np.random.default_rng(3).normal(100, 3, size=(5, 6)), 3)
BODY = "\n".join(" ".join(f"{value:.3f}" for value in row) for row in HEIGHTS) + "\n"
ESRI = ("ncols 6", "nrows 5", "xllcorner 500000", "yllcorner 4100000", "cellsize 30", "NODATA_value -1")


def write(folder, text, name="dem.asc"):
    file = folder / name
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return file


def check(surface, heights, size=(30.0, 30.0)):
    """`heights` with the southernmost row first."""
    assert surface.pixel_size == pytest.approx(size)
    known = np.isfinite(heights)
    assert np.array_equal(surface.mask, known)
    assert surface.heights[known] == pytest.approx(heights[known], rel=1e-6)


@pytest.mark.parametrize("order", list(itertools.islice(itertools.permutations(range(6)), 0, 720, 37)))
def test_esri_headers_in_any_order(tmp_path, order):
    header = "\n".join(ESRI[i] for i in order)
    check(mf.read_surface(write(tmp_path, header + "\n" + BODY)), np.flipud(HEIGHTS))
    assert mf.read_surface(tmp_path / "dem.asc").warnings == ()


@pytest.mark.parametrize(
    "line", ["", "NODATA_value -9999\n", "nodata_value\t-9999.000\n", "NODATA_VALUE -9999\n"]
)
def test_missing_data_of_esri_grids(tmp_path, line):
    """The default of the format where the header names none."""
    heights = HEIGHTS.copy()
    heights[1, 2] = -9999
    body = BODY.replace(f"{HEIGHTS[1, 2]:.3f}", "-9999")
    surface = mf.read_surface(write(tmp_path, "\n".join(ESRI[:5]) + "\n" + line + body))
    check(surface, np.flipud(np.where(heights == -9999, np.nan, heights)))
    assert any("default of the format" in step for step in surface.steps) == (line == "")


def test_esri_grids_with_commas_words_and_broken_lines(tmp_path):
    body = BODY.replace(f"{HEIGHTS[0, 0]:.3f}", "nan").replace(" ", "\n").replace(".", ",")
    surface = mf.read_surface(write(tmp_path, "\r\n".join(ESRI).replace("30", "30,5") + "\r\n" + body))
    heights = HEIGHTS.copy()
    heights[0, 0] = np.nan
    check(surface, np.flipud(heights), (30.5, 30.5))


def test_a_stated_cell_is_replaced_with_a_warning(tmp_path):
    surface = mf.read_surface(write(tmp_path, "\n".join(ESRI) + "\n" + BODY), pixel_size=10.0)
    assert surface.pixel_size == (10.0, 10.0)
    assert surface.warnings == (
        "the file states a pixel of 30 x 30 m, which the caller replaced by 10 x 10 m",
    )


GRASS = "north: 4100150\nsouth: 4100000\neast: 500180\nwest: 500000\nrows: 5\ncols: 6\n"


@pytest.mark.parametrize("extra", ["", "null: *\n", "type: float\nnull: -1\n", "multiplier: 2\n"])
def test_grass_grids(tmp_path, extra):
    mark = "-1" if "-1" in extra else "*"
    body = BODY.replace(f"{HEIGHTS[1, 2]:.3f}", mark)
    heights = HEIGHTS.copy()
    heights[1, 2] = np.nan
    surface = mf.read_surface(write(tmp_path, GRASS + extra + body, "dem.txt"))
    check(surface, np.flipud(heights) * (2 if "multiplier" in extra else 1))


def test_grass_grids_in_degrees_are_refused(tmp_path):
    header = "north: 45:00:05N\nsouth: 45N\neast: 7:00:06E\nwest: 7E\nrows: 5\ncols: 6\n"
    refused(lambda: mf.read_surface(write(tmp_path, header + BODY)), "degrees")
    assert mf.read_surface(tmp_path / "dem.asc", pixel_size=(20.0, 31.0)).pixel_size == (20.0, 31.0)


# Surfer: nodes at both ends, the first row in the south.

BLANK = 1.70141e38
ENDS = (0.0, 150.0, 1000.0, 1120.0, HEIGHTS.min(), HEIGHTS.max())


def surfer(version, heights=HEIGHTS):
    ny, nx = heights.shape
    filled = np.where(np.isnan(heights), 1.70141e38 if version == "text" else 1.70141e38 * 1.0001, heights)
    if version == "text":
        ends = "\n".join(f"{ENDS[i]} {ENDS[i + 1]}" for i in (0, 2, 4))
        body = "\n\n".join(" ".join("1.70141e+038" if v > 1e30 else f"{v}" for v in row) for row in filled)
        return f"DSAA\n{nx} {ny}\n{ends}\n{body}\n".encode()
    if version == "6":
        return b"DSBB" + struct.pack("<hh6d", nx, ny, *ENDS) + filled.astype("<f4").tobytes()
    header = b"DSRB" + struct.pack("<ii", 4, 1)
    grid = struct.pack("<ii8d", ny, nx, ENDS[0], ENDS[2], 30.0, 30.0, ENDS[4], ENDS[5], 0.0, BLANK)
    other = b"FLTI" + struct.pack("<i", 8) + bytes(8)
    data = filled.astype("<f8").tobytes()
    return (
        header
        + other
        + b"GRID"
        + struct.pack("<i", 72)
        + grid
        + b"DATA"
        + struct.pack("<i", len(data))
        + data
    )


@pytest.mark.parametrize("version", ["text", "6", "7"])
@pytest.mark.parametrize("name", ["dem.grd", "dem.asc", "dem"])
def test_surfer_grids(tmp_path, version, name):
    heights = HEIGHTS.copy()
    heights[1, 2] = np.nan
    surface = mf.read_surface(write(tmp_path, surfer(version, heights), name))
    check(surface, heights)
    assert "no unit, so its heights are taken for m" in surface.warnings[0]
    assert mf.read_surface(tmp_path / name, unit="um").pixel_size == pytest.approx((3e-5, 3e-5))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"DSAA\n6 5\n", "ends within its header"),
        (b"DSAA\n6000000 500000\n0 1\n0 1\n0 1\n1 2 3\n", "exceeds the limit"),
        (b"DSAA\n600 500\n0 1\n0 1\n0 1\n1 2 3\n", "cannot hold them"),
        (b"DSAA\nsix 5\n0 1\n0 1\n0 1\n1 2 3\n", "which are no numbers"),
        (b"DSBB" + struct.pack("<hh6d", 30000, 30000, *ENDS), "exceeds the limit"),
        (b"DSBB" + struct.pack("<hh6d", 300, 300, *ENDS), "cannot hold them"),
        (b"DSBB" + struct.pack("<hh6d", -3, 300, *ENDS), "positive whole number"),
        (b"DSRB" + struct.pack("<ii", -4, 1), "negative size"),
        (b"DSRB" + struct.pack("<ii", 4, 1) + (b"NONE" + struct.pack("<i", 0)) * 200, "holds no grid"),
        (surfer("7")[:-9], "ends after|cannot hold"),
        (surfer("text").replace(b"0.0 150.0", b"0.0 0.0"), "pixel_size must lie in"),
    ],
)
def test_bad_surfer_grids(tmp_path, content, message):
    refused(lambda: mf.read_surface(write(tmp_path, content, "dem.grd")), message)


FILES = {
    "text": surfer("text"),
    "6": surfer("6"),
    "7": surfer("7"),
    "grass": (GRASS + BODY).encode(),
    "esri": ("\n".join(ESRI) + "\n" + BODY).encode(),
}


@settings(max_examples=80)
@given(data=st.data())
@pytest.mark.parametrize("kind", FILES)
def test_damaged_grids_are_read_or_refused(tmp_path, kind, data):
    content = bytearray(FILES[kind])
    place = st.integers(0, len(content) - 1)
    for position, value in data.draw(st.lists(st.tuples(place, st.integers(0, 255)), max_size=6)):
        content[position] = value
    content = content[: data.draw(st.one_of(st.just(len(content)), place))]
    file = write(tmp_path, bytes(content), "dem.asc")
    with contextlib.suppress(mf.SurfaceError), our_own_readers():
        surface = mf.read_surface(file)
        assert np.isfinite(surface.heights[surface.mask]).all()
