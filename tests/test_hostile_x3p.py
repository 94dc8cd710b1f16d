"""Hostile .x3p files are refused in one sentence; what is valid in them is read."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import microfacet as mf
from hostile_cases import DATA, HEIGHTS, INDEX, archive, check_refused, x3p, x3p_index
from surface_file_cases import our_own_readers

LAUGHS = '<!DOCTYPE a [<!ENTITY a "ha">' + "".join(
    f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefghi", "bcdefghij", strict=True)
)
X3P = {
    "no archive": (b"hello, world\n" * 50, "not a zip file"),
    "empty archive": (archive({}), "no member 'main.xml'"),
    "no XML": (x3p("hello", DATA), "cannot be read .ExpatError"),
    "other XML": (x3p("<a/>", DATA), "SizeX must be a positive whole number, got 'None'"),
    "a billion laughs": (x3p(f"{LAUGHS}]><a>&j;</a>", DATA), "declares a document type"),
    "huge XML": (x3p("<a>" + " " * 2**21 + "</a>", DATA), "more than 1048576 characters besides its points"),
    "cut": (x3p(INDEX, DATA[:-8]), "has 328 bytes, the size of the map asks for 336"),
    "too long": (x3p(INDEX, DATA + b"\0"), "has 337 bytes"),
    "claims 1e12": (x3p(x3p_index(10**6, 10**6), b""), "exceeds the limit"),
    "negative size": (x3p(x3p_index(-7, 6), DATA), "got '-7'"),
    "layers": (x3p(INDEX.replace("SizeZ>1", "SizeZ>2"), DATA), "holds 2 layers"),
    "no type": (x3p(INDEX.replace("<DataType>D", "<DataType>Q"), DATA), "one of I, L, F, D, got 'Q'"),
    "no increment": (x3p(INDEX.replace("1e-6", "fast"), DATA), "must be a number, got 'fast'"),
    "nan increment": (x3p(INDEX.replace("1e-6", "nan", 1), DATA), "pixel_size must lie in"),
    "scattered": (x3p(INDEX.replace("<AxisType>I", "<AxisType>A"), DATA), "not equally spaced"),
    "no link": (x3p(INDEX.replace("PointDataLink", "Link"), DATA), "names no member that holds its points"),
    "a path": (x3p(INDEX.replace("bindata/data.bin", "../../etc/passwd"), DATA), "no member"),
}


@pytest.mark.parametrize("case", X3P)
def test_x3p(tmp_path, case):
    content, message = X3P[case]
    (tmp_path / "map.x3p").write_bytes(content)
    check_refused(tmp_path / "map.x3p", message)


@settings(max_examples=80)
@given(data=st.data())
def test_damaged_x3p_are_read_or_refused(tmp_path, data):
    """Characters of the index changed, or bytes of the archive; checksums of the zip file catch most."""
    index, archived = list(INDEX), data.draw(st.booleans())
    for position, value in data.draw(
        st.lists(st.tuples(st.integers(0, len(index) - 1), st.characters(codec="latin-1")), max_size=4)
    ):
        index[position] = value if not archived else index[position]
    content = bytearray(x3p("".join(index).encode("latin-1"), DATA))
    if archived:
        place = st.integers(0, len(content) - 1)
        for position, value in data.draw(st.lists(st.tuples(place, st.integers(0, 255)), max_size=6)):
            content[position] = value
        content = content[: data.draw(st.one_of(st.just(len(content)), place))]
    (tmp_path / "map.x3p").write_bytes(bytes(content))
    with contextlib.suppress(mf.SurfaceError), our_own_readers():
        surface = mf.read_surface(tmp_path / "map.x3p")
        assert np.isfinite(surface.heights[surface.mask]).all()


@pytest.mark.parametrize(("code", "dtype"), [("I", "<i2"), ("L", "<i4"), ("F", "<f4"), ("D", "<f8")])
def test_types_and_mask_of_x3p(tmp_path, code, dtype):
    heights = np.arange(42, dtype=dtype).reshape(6, 7)
    valid = heights % 5 != 3
    index = x3p_index(7, 6).replace(
        "<AxisType>A</AxisType><DataType>D", f"<AxisType>A</AxisType><DataType>{code}"
    )
    index = index.replace("</DataLink>", "<ValidPointsLink>bindata/valid.bin</ValidPointsLink></DataLink>")
    mask = np.packbits(valid.ravel(), bitorder="little").tobytes()
    members = {"main.xml": index, "bindata/data.bin": heights.tobytes(), "bindata/valid.bin": mask}
    (tmp_path / "map.x3p").write_bytes(archive(members))
    surface = mf.read_surface(tmp_path / "map.x3p")
    assert np.array_equal(surface.mask, valid)
    assert surface.heights[valid] == pytest.approx(1e-6 * heights[valid].astype(float), rel=1e-15)


def test_a_valid_x3p_of_our_own(tmp_path):
    """So that the refusals above are for the reason that they state."""
    (tmp_path / "map.x3p").write_bytes(x3p(INDEX, DATA))
    surface = mf.read_surface(tmp_path / "map.x3p")
    assert surface.heights == pytest.approx(1e-6 * HEIGHTS, rel=1e-15)  # the increment of CZ
    assert surface.pixel_size == pytest.approx((1e-6, 1e-6))
