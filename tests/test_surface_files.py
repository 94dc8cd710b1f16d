"""Height images, text grids, tables of slopes, normal maps: files that mean well, files that do not."""

from __future__ import annotations

import contextlib
import sys
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import microfacet as mf
from microfacet._surface.read import library
from microfacet._surface.read.raw import RawMap
from surface_file_cases import LEVELS, RNG, our_own_readers, png, refused, write_image

HEIGHTS = RNG.normal(size=(6, 8)).astype(np.float32)


def write_geotiff(file, heights, model=1, unit=9001, size=(30.0, 25.0), nodata=None):
    tifffile = pytest.importorskip("tifffile", reason="the extra 'surface' is not installed")
    pytest.importorskip("OpenImageIO", reason="the extra 'surface' is not installed")
    keys = (1, 1, 0, 3, 1024, 0, 1, model, 1025, 0, 1, 1, 3076, 0, 1, unit)
    tags = [
        (33550, "d", 3, (*size, 0.0), True),
        (33922, "d", 6, (0.0, 0.0, 0.0, 5e5, 4e6, 0.0), True),
        (34735, "H", len(keys), keys, True),
    ]
    if nodata is not None:
        tags.append((42113, "s", 0, str(nodata), True))
    tifffile.imwrite(file, heights, extratags=tags)


# Images


@pytest.mark.parametrize(("suffix", "kind"), [("png", "u2"), ("tif", "i2"), ("tiff", "u4")])
def test_grey_levels_are_heights_with_a_stated_scale(tmp_path, suffix, kind):
    pixels = LEVELS.astype(kind)
    write_image(tmp_path / f"map.{suffix}", pixels)
    surface = mf.read_surface(tmp_path / f"map.{suffix}", pixel_size=2e-6, height_scale=5e-10)
    assert surface.heights == pytest.approx(5e-10 * np.flipud(pixels), rel=1e-15)
    assert surface.pixel_size == (2e-6, 2e-6)
    assert surface.steps == (
        "rows turned so that y runs up the image",
        "heights of 5e-10 m per grey level, as given by the caller",
        "pixel size given by the caller",
    )


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"pixel_size": 2e-6}, "give height_scale"),
        ({"height_scale": 1e-9}, "give pixel_size"),
        ({"pixel_size": 1e-6, "height_scale": -1.0}, "height_scale must be"),
        ({"pixel_size": 1e-6, "unit": "nm"}, "give height_scale"),
        ({"pixel_size": 1e-6, "unit": "nm", "height_scale": 1.0}, "without a unit"),
    ],
)
def test_grey_levels_alone_are_no_lengths(tmp_path, options, message):
    write_image(tmp_path / "map.tif", LEVELS)
    refused(lambda: mf.read_surface(tmp_path / "map.tif", **options), message)


@pytest.mark.parametrize("suffix", ["exr", "tif"])
def test_floating_point_images_have_a_unit(tmp_path, suffix):
    write_image(tmp_path / f"map.{suffix}", np.where(HEIGHTS > 1, np.nan, HEIGHTS))
    surface = mf.read_surface(tmp_path / f"map.{suffix}", pixel_size=2e-6, unit="um")
    valid = np.flipud(HEIGHTS <= 1)
    assert np.array_equal(surface.mask, valid)
    assert surface.heights[valid] == pytest.approx(1e-6 * np.flipud(HEIGHTS)[valid].astype(float), rel=1e-15)
    refused(
        lambda: mf.read_surface(tmp_path / f"map.{suffix}", pixel_size=2e-6), "give unit= .* or height_sc"
    )


def test_a_channel_of_an_exr_by_name(tmp_path):
    file = tmp_path / "map.exr"
    write_image(file, np.stack((HEIGHTS, 2 * HEIGHTS), axis=-1), ("albedo", "depth"))
    surface = mf.read_surface(file, channel="depth", pixel_size=1.0, unit="m")
    assert surface.heights == pytest.approx(2.0 * np.flipud(HEIGHTS))
    refused(lambda: mf.read_surface(file, pixel_size=1.0, unit="m"), r"name the one of the heights: .*albedo")
    refused(lambda: mf.read_surface(file, channel="z", pixel_size=1.0, unit="m"), "no channel 'z'")


def test_geotiff_states_metres_north_and_missing_pixels(tmp_path):
    heights = np.round(100 * HEIGHTS).astype(np.int16)
    heights[2, 3] = -9999
    write_geotiff(tmp_path / "dem.tif", heights, nodata=-9999)
    surface = mf.read_surface(tmp_path / "dem.tif")
    assert surface.pixel_size == (30.0, 25.0)
    assert not surface.mask[3, 3]
    assert np.count_nonzero(~surface.mask) == 1
    assert np.array_equal(surface.heights[surface.mask], np.flipud(heights)[surface.mask])


def test_geotiff_in_degrees_or_feet_needs_a_pixel_size(tmp_path):
    write_geotiff(tmp_path / "degrees.tif", HEIGHTS, model=2, size=(8e-4, 8e-4))
    refused(lambda: mf.read_surface(tmp_path / "degrees.tif"), "degrees, give pixel_size")
    surface = mf.read_surface(tmp_path / "degrees.tif", pixel_size=(74.0, 92.0))
    assert surface.pixel_size == (74.0, 92.0)
    write_geotiff(tmp_path / "feet.tif", HEIGHTS, unit=9002)
    refused(lambda: mf.read_surface(tmp_path / "feet.tif"), "not in metres, give pixel_size")


def test_the_tiff_of_a_microscope_goes_to_the_library_that_knows_it(tmp_path, monkeypatch):
    tifffile = pytest.importorskip("tifffile", reason="the extra 'surface' is not installed")
    pytest.importorskip("OpenImageIO", reason="the extra 'surface' is not installed")
    picture = np.zeros((4, 4, 3), np.uint8)  # what such files show to a viewer of images
    tifffile.imwrite(tmp_path / "afm.tiff", picture, extratags=[(50434, "B", 4, b"\0\1\2\3", True)])
    steps = ("read channel 'Height' with SurfaceTopography",)
    found = RawMap(HEIGHTS.astype(float), "", (1.0, 1.0), "nm", "nm", steps=steps)
    monkeypatch.setattr(library, "read", lambda *_, **__: found)
    surface = mf.read_surface(tmp_path / "afm.tiff")
    assert surface.pixel_size == pytest.approx((1e-9, 1e-9))
    assert surface.steps == steps


IMAGES = {
    "no image": (b"hello, world\n" * 9, "no image that can be read"),
    "no pixels": (png(8, 8), "damaged|cannot be read|no image"),
    "bomb": (png(60000, 60000, data=zlib.compress(bytes(10**6))), "exceeds the limit|no image"),
    "constant": (png(8, 8, data=zlib.compress(bytes(136))), "all heights are equal"),
    "1 bit": (png(8, 8, bits=1, data=zlib.compress(bytes(16))), "bits|all heights are equal"),
    "colour": (png(4, 4, colour=2, data=zlib.compress(bytes(100))), "3 channels, name the one"),
}


@pytest.mark.parametrize("case", IMAGES)
def test_bad_images(tmp_path, case):
    pytest.importorskip("OpenImageIO", reason="the extra 'surface' is not installed")
    content, message = IMAGES[case]
    (tmp_path / "map.png").write_bytes(content)
    refused(lambda: mf.read_surface(tmp_path / "map.png", pixel_size=1.0, height_scale=1.0), message)


def test_a_scale_is_for_images(tmp_path):
    np.save(tmp_path / "map.npy", HEIGHTS)
    refused(lambda: mf.read_surface(tmp_path / "map.npy", pixel_size=1.0, height_scale=1.0), "for images")


# Text


def esri(heights, header="", cell="cellsize 2.5\n"):
    ny, nx = np.shape(heights)
    body = "\n".join(" ".join(repr(float(value)) for value in row) for row in heights)
    return f"ncols {nx}\nNROWS {ny}\n{cell}{header}{body}\n"


def test_esri_grids_start_in_the_north(tmp_path):
    heights = HEIGHTS.astype(float).copy()
    heights[0, 1] = -9999
    text = esri(heights, "xllcorner 5e5\nyllcorner 4e6\nNODATA_value -9999\n")
    (tmp_path / "dem.asc").write_text(text)
    surface = mf.read_surface(tmp_path / "dem.asc")
    assert surface.pixel_size == (2.5, 2.5)
    assert not surface.mask[-1, 1]
    assert np.array_equal(surface.heights[surface.mask], np.flipud(heights)[surface.mask])
    (tmp_path / "dem.txt").write_text(esri(HEIGHTS, cell="dx 2\ndy 3\n").replace("\n", "\r\n"))
    assert mf.read_surface(tmp_path / "dem.txt", unit="um").pixel_size == pytest.approx((2e-6, 3e-6))


def test_esri_grids_in_degrees_are_refused(tmp_path):
    file = tmp_path / "dem.asc"
    file.write_text(esri(HEIGHTS, "xllcorner -84.4\nyllcorner 36.5\n", "cellsize 0.000833\n"))
    refused(lambda: mf.read_surface(file), "degrees")
    assert mf.read_surface(file, pixel_size=80.0).pixel_size == (80.0, 80.0)


@pytest.mark.parametrize(("mark", "suffix"), [(",", "csv"), (";", "csv"), ("\t", "tsv"), ("  ", "txt")])
def test_plain_tables(tmp_path, mark, suffix):
    heights = np.where(HEIGHTS > 1.5, np.nan, HEIGHTS)
    lines = [mark.join(repr(float(value)) for value in row) for row in heights]
    file = tmp_path / f"map.{suffix}"
    file.write_text("\ufeff# heights\n\n" + "\n".join(lines) + "\n", encoding="utf-8")
    surface = mf.read_surface(file, pixel_size=1e-6, unit="nm")
    assert np.array_equal(surface.mask, np.isfinite(heights))
    assert surface.heights[surface.mask] == pytest.approx(1e-9 * heights[surface.mask].astype(float))


TEXTS = {
    "empty lines": ("\n\n\n", "holds no numbers"),
    "text": ("height,of,hills\nof,gold\n", "not a table of numbers"),
    "text below numbers": ("1,2,3\n1,two,3\n", "line 2 holds 'two'.* not a table of numbers"),
    "ragged": ("1 2 3\n1 2\n1 2 3\n", "not a table of numbers"),
    "one line": ("1 2 3 4\n", "this is a profile .*mf.read_profile"),
    "one column": ("1\n2\n3\n4\n", "this is a profile .*fit --profile"),
    "binary": ("1 2 3\n\0\0\0\n", "not a height map|SurfaceTopography"),
    "long line": ("1 " * 2**20 + "1 1\n", "a line is longer"),
    "all nan": ("nan nan nan\n" * 3, "not a table of numbers"),
    "constant": ("1 1 1\n" * 3, "all heights are equal"),
    "ESRI claims 1e12": ("ncols 1000000\nnrows 1000000\ncellsize 1\n1 2\n", "exceeds the limit"),
    "ESRI claims what is not there": ("ncols 900\nnrows 900\ncellsize 1\n1 2\n", "cannot hold them"),
    "ESRI too few": (esri(np.ones((4, 4)))[:-16], "ends after 12 of 16"),
    "ESRI too many": (esri(np.ones((4, 4))) + "1\n", "more than the 16 numbers"),
    "ESRI without rows": ("ncols 4\ncellsize 1\n1 2 3 4\n", "must state nrows"),
    "ESRI negative": ("ncols -4\nnrows 4\ncellsize 1\n1 2 3 4\n", "must state ncols"),
    "ESRI without size": (esri(np.eye(4), cell=""), "no cellsize"),
    "ESRI text for a number": (esri(np.eye(4)).replace("2.5", "wide"), "'wide', which is not a number"),
    "ESRI text for heights": (esri(np.eye(4)).replace("0.0", "low"), "not a number"),
    "ESRI endless word": ("ncols 3\nnrows 3\ncellsize 1\n" + "1" * 2**21, "not a number"),
    "ESRI zero size": (esri(np.eye(4), cell="cellsize 0\n"), "pixel_size must lie in"),
}


@pytest.mark.parametrize("case", TEXTS)
def test_bad_texts(tmp_path, case):
    text, message = TEXTS[case]
    (tmp_path / "map.asc").write_text(text)
    size = None if case.startswith("ESRI") else 1.0
    refused(lambda: mf.read_surface(tmp_path / "map.asc", pixel_size=size), message)


def test_a_plain_table_needs_a_pixel_size(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)  # which no table of numbers should wait for
    (tmp_path / "map.csv").write_text("1,2,3\n3,2,1\n1,3,2\n")
    refused(lambda: mf.read_surface(tmp_path / "map.csv"), "give pixel_size")


@settings(max_examples=60)
@given(data=st.data())
@pytest.mark.parametrize("kind", ["esri", "plain", "slopes"])
def test_damaged_texts_are_read_or_refused(tmp_path, kind, data):
    valid = {
        "esri": esri(HEIGHTS, "NODATA_value -9999\n").encode(),
        "plain": b"# map\n1,2,3\n4.5,nan,1e-3\n-7,8,9\n1,1,2\n",
        "slopes": b"p,q\n0.1,0.2\n-0.3,1e-2\n0.5,nan\n",
    }[kind]
    content = bytearray(valid)
    place = st.integers(0, len(valid) - 1)
    for position, value in data.draw(st.lists(st.tuples(place, st.integers(0, 255)), max_size=8)):
        content[position] = value
    content = content[: data.draw(st.one_of(st.just(len(valid)), place))]
    file = tmp_path / "map.csv"
    file.write_bytes(bytes(content))
    with contextlib.suppress(mf.SurfaceError), our_own_readers():
        if kind == "slopes":
            assert np.isfinite(mf.read_slopes(file).values).all()
        else:
            surface = mf.read_surface(file, pixel_size=1e-6)
            assert np.isfinite(surface.heights[surface.mask]).all()


@settings(max_examples=100)
@given(text=st.text(alphabet="0123456789.,;+-eE \t\n#naif", max_size=200), esri=st.booleans())
def test_any_text_is_read_or_refused(tmp_path, text, esri):
    header = "ncols 3\nnrows 3\ncellsize 1\n" if esri else ""
    (tmp_path / "map.txt").write_text(header + text, encoding="utf-8")
    with contextlib.suppress(mf.SurfaceError), our_own_readers():
        mf.read_surface(tmp_path / "map.txt", pixel_size=1.0)
    with contextlib.suppress(mf.SurfaceError):
        mf.read_slopes(tmp_path / "map.txt")
