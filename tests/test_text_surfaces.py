"""Height maps as tables of text, in all the ways in which people and instruments write them."""

from __future__ import annotations

import contextlib
import gzip

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import microfacet as mf
from surface_file_cases import our_own_readers, refused

HEIGHTS = np.round(np.random.default_rng(7).normal(size=(12, 15)), 6)


def cells(heights=HEIGHTS, comma=False):
    return [[f"{value:.6f}".replace(".", "," if comma else ".") for value in row] for row in heights]


def table(mark, rows, end="\n"):
    return "".join(mark.join(row) + end for row in rows)


def write(folder, text, encoding="utf-8", name="map.txt"):
    file = folder / name
    file.write_bytes(text.encode(encoding))
    return file


def read(file, **options):
    return mf.read_surface(file, **({"pixel_size": 1e-6, "unit": "um"} | options))


def check(surface, heights=HEIGHTS, factor=1e-6):
    assert np.array_equal(surface.mask, np.isfinite(heights))
    assert surface.heights[surface.mask] == pytest.approx(factor * heights[np.isfinite(heights)], rel=1e-12)


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "latin-1"]
)
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_encodings_and_ends_of_lines(tmp_path, encoding, end):
    heading = "# Width: 30 \xb5m" + end + "# Height: 24 \xb5m" + end + "# Value units: nm" + end
    surface = mf.read_surface(write(tmp_path, heading + table("\t", cells(), end), encoding))
    check(surface, factor=1e-9)
    assert surface.pixel_size == pytest.approx((2e-6, 2e-6))
    assert surface.unit == "nm"
    assert surface.warnings == ()


@pytest.mark.parametrize("mark", ["\t", ";", "|", ",", " ", "   ", ", ", " ; "])
@pytest.mark.parametrize("trailing", [False, True])
def test_separators(tmp_path, mark, trailing):
    check(read(write(tmp_path, table(mark, cells(), (mark if trailing else "") + "\n"))))


@pytest.mark.parametrize("mark", ["\t", ";", "|", " ", "; "])
def test_decimal_commas_where_the_separator_allows_them(tmp_path, mark):
    surface = read(write(tmp_path, table(mark, cells(comma=True))))
    check(surface)
    assert surface.steps[0] == "commas taken for decimal marks"


@pytest.mark.parametrize("size", ["15 12", "12 15", "15\t12"])
def test_a_line_that_states_the_size(tmp_path, size):
    check(read(write(tmp_path, "a title\n" + size + "\n" + table(" ", cells()))))
    refused(lambda: read(write(tmp_path, "15 11\n" + table(" ", cells()))), "15 and 11, is neither a row nor")
    refused(lambda: read(write(tmp_path, "1.5 12\n" + table(" ", cells()))), "line 2 holds 15 cells")


@pytest.mark.parametrize("word", ["nan", "BAD", ""])
def test_first_rows_without_a_number_are_rows(tmp_path, word):
    heights = HEIGHTS.copy()
    heights[:2] = np.nan
    rows = [[word] * 15] * 2 + cells()[2:]
    check(read(write(tmp_path, "a,title\n" + table(",", rows))), heights)


def test_points_and_commas_in_one_table_are_refused(tmp_path):
    rows = cells(comma=True)
    rows[5][3] = "1.5"
    check(read(write(tmp_path, table(";", rows))), np.where(HEIGHTS[5, 3] == HEIGHTS, 1.5, HEIGHTS))
    rows[5][3] = "1.234,5"  # a thousand, or one?
    refused(lambda: read(write(tmp_path, table(";", rows))), r"line 6 holds '1\.234,5', which is neither")


WORDS = (
    "nan", "NaN", "-nan", "N/A", "#N/A", "BAD", "bad", "Bad", "***", "---", "-", "--", "\u2014", "null",
    "None", "NoData", "inf", "1.#QNAN", "-1.#IND", "1.#INF", "#VALUE!", "invalid", "missing", "?",
)  # fmt: skip


@pytest.mark.parametrize("word", [*WORDS, "", '"BAD"'])
@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_words_for_bad_pixels(tmp_path, word, mark):
    """In the first row and inside, at both ends of a line."""
    bad = np.zeros(HEIGHTS.shape, bool)
    bad[[0, 3, 7], [2, 0, 14]] = True
    rows = [[word if bad[i, j] else cell for j, cell in enumerate(row)] for i, row in enumerate(cells())]
    surface = read(write(tmp_path, table(mark, rows)))
    check(surface, np.where(bad, np.nan, HEIGHTS))
    if word.lower() not in ("nan", "-nan", "inf"):  # which are numbers to every library
        assert surface.steps[0] == "3 cells that hold no number taken for missing"


@pytest.mark.parametrize(
    "heading",
    [
        ",".join(f"c{i}" for i in range(15)),
        "Topography of the ground plate",
        "# a comment\n% another\n// a third\n\n! a fourth",
        "Operator: X. Y.\nDate: 2026-12-01\nWidth: 640 px\nObjective; 50x",
    ],
)
def test_headings_without_sizes_are_left_out(tmp_path, heading):
    check(read(write(tmp_path, heading + "\n" + table(",", cells()))))


HEADINGS = {
    "gwyddion": ("# Channel: z\n# Width: 30 um\n# Height: 36 um\n# Value units: nm\n", (2e-6, 3e-6), 1e-9),
    "other units": ("Width = 30 um\nHeight = 0.036 mm\nz unit = nm\n", (2e-6, 3e-6), 1e-9),
    "brackets": ("Width (um);30\nHeight (um);36\nUnits;um\n", (2e-6, 3e-6), 1e-6),
    "pixel size": ("Pixel size: 0.5 um\nz-unit: nm\n", (5e-7, 5e-7), 1e-9),
    "two sizes": ("Pixel size: 0.5 x 0.25 um\nz-unit: nm\n", (5e-7, 2.5e-7), 1e-9),
    "dx and dy": ("dx [nm] = 20\ndy [nm] = 30\nunits: nm\n", (2e-8, 3e-8), 1e-9),
    "step": ("X step: 2e-3 mm\nY step: 3e-3 mm\nValue units: \u212b\n", (2e-6, 3e-6), 1e-10),
    "sentences": ("% pixel size 0.5 x 0.25 um\n% heights are in nm\n", (5e-7, 2.5e-7), 1e-9),
    "title": ("Topography [nm]\ndx 20 nm\n", (2e-8, 2e-8), 1e-9),
    "keyence": ('"XY calibration","1.389","um"\n"Unit","nm"\n', (1.389e-6, 1.389e-6), 1e-9),
    "words": ("x step = 2 microns\ny step = 3 micrometres\nHeight unit = nanometers\n", (2e-6, 3e-6), 1e-9),
    "mojibake": ("# Width: 30 \xc2\xb5m\n# Height: 36 \xc2\xb5m\n# Value units: m\n", (2e-6, 3e-6), 1.0),
    "comma": ("Breite: 30,0 \xb5m\nH\xf6he: 36,0 \xb5m\nEinheiten: nm\n", (2e-6, 3e-6), 1e-9),
}  # fmt: skip


@pytest.mark.parametrize("case", HEADINGS)
def test_sizes_and_units_in_headings(tmp_path, case):
    heading, size, factor = HEADINGS[case]
    surface = mf.read_surface(write(tmp_path, heading + table("\t", cells())))
    assert surface.pixel_size == pytest.approx(size)
    check(surface, factor=factor)
    assert surface.warnings == ()
    agreeing = mf.read_surface(tmp_path / "map.txt", pixel_size=size, unit=surface.unit)
    assert agreeing.pixel_size == pytest.approx(size)
    refused(lambda: mf.read_surface(tmp_path / "map.txt", pixel_size=1e-3), "states a pixel of .*not 0.001 x")
    refused(lambda: mf.read_surface(tmp_path / "map.txt", unit="km"), "states the unit .*, not km")


def test_a_size_without_a_unit_is_not_guessed(tmp_path):
    file = write(tmp_path, "dx: 0.5\nz unit: nm\n" + table(",", cells()))
    refused(lambda: mf.read_surface(file), "a pixel size without their unit, give pixel_size")
    check(mf.read_surface(file, pixel_size=5e-7), factor=1e-9)
    file = write(tmp_path, "dx: 0.5\n" + table(",", cells()))
    refused(lambda: mf.read_surface(file), "does not state its unit of length, give unit=")
    assert mf.read_surface(file, unit="um").pixel_size == pytest.approx((5e-7, 5e-7))
    file = write(tmp_path, "Width: 640\nHeight: 480\n" + table(",", cells()))
    refused(lambda: mf.read_surface(file), "does not state the pixel size")  # these may count pixels


def test_a_text_without_a_unit_says_that_metres_were_taken(tmp_path):
    surface = mf.read_surface(write(tmp_path, table(",", cells())), pixel_size=1.0)
    assert surface.warnings == (
        "the file states no unit, so its heights are taken for m (unit= says otherwise)",
    )
    assert read(tmp_path / "map.txt").warnings == ()
    refused(lambda: mf.read_surface(tmp_path / "map.txt"), "give pixel_size")


@pytest.mark.parametrize("unit", ["V", "deg", "m/s", "counts", "a.u."])
def test_what_is_no_height_is_refused_by_its_unit(tmp_path, unit):
    heading = f"# Channel: Phase\n# Width: 30 um\n# Height: 36 um\n# Value units: {unit}\n"
    refused(lambda: mf.read_surface(write(tmp_path, heading + table("\t", cells()))), "not a known length")


def test_several_channels_in_one_text(tmp_path):
    text = ""
    for name, unit, factor in (("Phase", "deg", 1), ("Height", "nm", 2), ("Error", "nm", 3)):
        heading = f"# Channel: {name}\n# Width: 30 um\n# Height: 36 um\n# Value units: {unit}\n"
        text += heading + table("\t", cells(factor * HEIGHTS)) + "\n"
    file = write(tmp_path, text)
    check(mf.read_surface(file), 2 * HEIGHTS, 1e-9)  # the first that is a length
    check(mf.read_surface(file, channel="Error"), 3 * HEIGHTS, 1e-9)
    check(mf.read_surface(file, channel=2), 3 * HEIGHTS, 1e-9)
    refused(lambda: mf.read_surface(file, channel="Phase"), "the unit 'deg', which is not a known length")
    refused(
        lambda: mf.read_surface(file, channel="Depth"), "no channel 'Depth', the text has 'Phase', 'Height'"
    )


@pytest.mark.parametrize("corner", ["0", "", "y\\x"])
def test_positions_above_and_beside_the_heights(tmp_path, corner):
    rows = [[corner, *(f"{0.5 * i:.1f}" for i in range(15))]]
    rows += [[f"{2 * i}", *row] for i, row in enumerate(cells())]
    surface = mf.read_surface(write(tmp_path, table(";", rows)), unit="um")
    check(surface)
    assert surface.pixel_size == pytest.approx((5e-7, 2e-6))
    refused(lambda: mf.read_surface(tmp_path / "map.txt"), "does not state its unit")


def test_an_even_slope_has_no_positions(tmp_path):
    y, x = np.mgrid[0:12, 0:15]
    check(read(write(tmp_path, table(",", cells(x + 2.0 * y)))), x + 2.0 * y)


PROFILES = {
    "one column": "".join(f"{z}\n" for z in HEIGHTS[0]),
    "x and z": "x [um],z [um]\n" + "".join(f"{i * 0.5},{z}\n" for i, z in enumerate(HEIGHTS[0])),
    "x, z": "".join(f"{i * i} {z}\n" for i, z in enumerate(HEIGHTS[0])),
    "two columns": "".join(f"{i * 0.5} {z}\n" for i, z in enumerate(HEIGHTS[0])),
    "several": "x;z1;z2\n" + "".join(f"{i};{HEIGHTS[0, i]};{HEIGHTS[1, i]}\n" for i in range(15)),
    "several without names": "".join(f"{i};{HEIGHTS[0, i]};{HEIGHTS[1, i]}\n" for i in range(15)),
    "many without names": "".join(f"{i};" + ";".join(map(str, HEIGHTS[:9, i])) + "\n" for i in range(15)),
    "a row": " ".join(map(str, HEIGHTS[0])) + "\n",
}


@pytest.mark.parametrize("case", PROFILES)
def test_profiles_are_not_taken_for_maps(tmp_path, case):
    file = write(tmp_path, PROFILES[case])
    refused(lambda: read(file), r"this is a profile .*mf\.read_profile.*microfacet fit --profile")


def test_two_columns_are_no_map(tmp_path):
    text = "".join(f"{p} {q}\n" for p, q in zip(HEIGHTS[0], HEIGHTS[1], strict=True))
    refused(
        lambda: read(write(tmp_path, text)), r"two columns are no map: slopes .*--slopes.* mf\.read_profile"
    )


@pytest.mark.parametrize("heading", ["p,q", "q,p", "i,p,q", "slope_x,slope_y", "dz/dx,dz/dy"])
def test_slopes_are_not_taken_for_maps(tmp_path, heading):
    count = heading.count(",") + 1
    text = heading + "\n" + table(",", [row[:count] for row in cells()])
    refused(lambda: read(write(tmp_path, text)), r"table of slopes.*read_slopes \(--slopes table\)")


def test_a_mark_of_missing_data_that_nobody_declares_is_questioned(tmp_path):
    heights = HEIGHTS.copy()
    heights[2:4, 5] = -9999
    surface = read(write(tmp_path, table(",", cells(heights))))
    assert "2 pixels hold -9999, far from all other heights" in surface.warnings[0]
    heights[2, 5] = HEIGHTS[2, 5]
    assert "1 pixel holds -9999" in read(write(tmp_path, table(",", cells(heights)))).warnings[0]
    heights[heights == -9999] = -5000  # a spike may be one
    assert read(write(tmp_path, table(",", cells(heights)))).warnings == ()
    heights[2:4, 5] = HEIGHTS.max()  # a plateau is none
    assert read(write(tmp_path, table(",", cells(heights)))).warnings == ()


def test_packed_text(tmp_path):
    (tmp_path / "map.csv.gz").write_bytes(gzip.compress(table(",", cells()).encode()))
    surface = read(tmp_path / "map.csv.gz")
    check(surface)
    assert surface.source == "map.csv.gz"


@settings(max_examples=200)
@given(
    text=st.text(alphabet='0123456789.,;:+-eE \t\n#=xyzXYZnmu\xb5[]()/dDWidthHeight"', max_size=300),
    encoding=st.sampled_from(["utf-8", "utf-16", "latin-1"]),
)
def test_any_heading_is_read_or_refused(tmp_path, text, encoding):
    file = write(tmp_path, text + "\n" + table(",", cells()[:4]), encoding)
    for options in ({}, {"pixel_size": 1e-6, "unit": "nm"}):
        with contextlib.suppress(mf.SurfaceError), our_own_readers():
            surface = mf.read_surface(file, **options)
            assert np.isfinite(surface.heights[surface.mask]).all()
    with contextlib.suppress(mf.SurfaceError):
        assert np.isfinite(mf.read_slopes(file).values).all()
