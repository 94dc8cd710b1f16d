"""What a file is, is seen from its content; what an image or an instrument says of its pixels is heeded."""

from __future__ import annotations

import gzip
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

import microfacet as mf
from hostile_cases import DATA, HEIGHTS, INDEX, archive, npy, x3p
from microfacet._surface.read import complete, kinds, library
from microfacet._surface.read.raw import RawMap
from surface_file_cases import LEVELS, refused, write_image

SHARED = Path(__file__).parents[2] / "shared"


def npz_bytes(folder):
    np.savez(folder / "a.npz", heights=HEIGHTS, pixel_size=1e-6)
    return (folder / "a.npz").read_bytes()


@pytest.mark.parametrize("name", ["map.dat", "map.x3p", "map", "map.txt", "map.zygo"])
def test_names_do_not_decide(tmp_path, name):
    csv = b"".join(b",".join(b"%f" % value for value in row) + b"\n" for row in HEIGHTS)
    for content, factor in ((npy(HEIGHTS), 1), (npz_bytes(tmp_path), 1), (x3p(INDEX, DATA), 1e-6), (csv, 1)):
        if content is csv and name.endswith("x3p"):
            continue  # where the content says little, the name counts
        for packed in (False, True):
            file = tmp_path / (name + ".gz" * packed)
            file.write_bytes(gzip.compress(content) if packed else content)
            surface = mf.read_surface(file, pixel_size=1e-6)
            assert surface.heights == pytest.approx(factor * HEIGHTS, abs=1e-6)
            assert surface.source == file.name


def test_damaged_and_overlarge_packed_files(tmp_path, monkeypatch):
    packed = gzip.compress(npy(HEIGHTS))
    (tmp_path / "a.gz").write_bytes(packed[:-12])
    refused(lambda: mf.read_surface(tmp_path / "a.gz", pixel_size=1.0), "packed file is damaged")
    (tmp_path / "a.gz").write_bytes(gzip.compress(b""))
    refused(lambda: mf.read_surface(tmp_path / "a.gz", pixel_size=1.0), "packed file is empty")
    monkeypatch.setattr(kinds, "_SMALL", 1000)
    (tmp_path / "a.gz").write_bytes(gzip.compress(bytes(2**24)))
    refused(lambda: mf.read_surface(tmp_path / "a.gz", pixel_size=1.0), "unpacks to more than")


# Instruments


def measured(monkeypatch, **stated):
    raw = RawMap(1e-9 * HEIGHTS, "file of an instrument", unit="m", size_unit="m", microscope=True, **stated)
    monkeypatch.setattr(library, "read", lambda *_: raw)


@pytest.mark.parametrize("size", [0.3, 1e-14, 0.01])
def test_pixels_that_no_instrument_has_are_questioned(tmp_path, monkeypatch, size):
    (tmp_path / "map.opd").write_bytes(b"\1\2\3")
    measured(monkeypatch, size=(size, size))
    refused(
        lambda: mf.read_surface(tmp_path / "map.opd"), "which no microscope or profiler has: give pixel_size"
    )
    surface = mf.read_surface(tmp_path / "map.opd", pixel_size=3e-7)
    assert surface.pixel_size == (3e-7, 3e-7)
    assert "which the caller replaced by 3e-07 x 3e-07 m" in surface.warnings[0]
    assert mf.read_surface(tmp_path / "map.opd", pixel_size=size).warnings == ()  # confirmed


def test_channels_of_a_microscope_that_hold_no_heights():
    file = SHARED / "data" / "di-4.di"
    if not file.exists():
        pytest.skip("../shared/data/di-4.di is not there")
    pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    assert [one.is_height for one in library.channels(file)] == [True, False, False]
    refused(lambda: mf.read_surface(file, channel="Phase"), "'Phase' is not a height map: it holds ")
    surface = mf.read_surface(file, channel="AmplitudeError")  # a length, and no height
    assert surface.warnings[0] == "channel 'AmplitudeError' holds no heights, by its name"
    assert mf.read_surface(file).warnings == ()


def bcr(heights, unit="nm", height_unit="nm", pixel=100):
    """A file of an instrument: a heading of text, and the heights in 32 bits."""
    ny, nx = heights.shape
    heading = (
        f"fileformat = bcrf\nheadersize = 2048\nxpixels = {nx}\nypixels = {ny}\nintelmode = 1\n"
        f"xlength = {pixel * nx}\nylength = {pixel * ny}\nxunit = {unit}\nyunit = {unit}\n"
        f"zunit = {height_unit}\nbit2nm = 1.0\nvoidpixels = 0\n"
    )
    return heading.encode().ljust(2048) + heights.astype("<f4").tobytes()


@pytest.mark.parametrize("name", ["scan.dat", "scan.bcrf", "scan.txt", "scan.csv.gz", "scan"])
def test_data_behind_a_heading_of_text_are_no_text(tmp_path, name):
    pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    content = bcr(HEIGHTS)
    (tmp_path / name).write_bytes(gzip.compress(content) if name.endswith("gz") else content)
    surface = mf.read_surface(tmp_path / name)
    assert surface.heights == pytest.approx(1e-9 * HEIGHTS.astype("f4"), rel=1e-12)
    assert surface.pixel_size == pytest.approx((1e-7, 1e-7))
    assert surface.unit == "nm"


def test_an_instrument_in_metres_is_questioned_and_in_volts_refused(tmp_path):
    pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    file = tmp_path / "scan.dat"
    file.write_bytes(bcr(HEIGHTS, "m", "m", 0.3))
    refused(lambda: mf.read_surface(file), "a pixel of 0.3 x 0.3 m, which no microscope or profiler has")
    assert mf.read_surface(file, pixel_size=3e-7).pixel_size == (3e-7, 3e-7)
    file.write_bytes(bcr(HEIGHTS, "nm", "V"))
    refused(lambda: mf.read_surface(file), "no height map|not a height map")


@pytest.mark.parametrize("name", ["scan.sdf", "scan.dat", "scan.txt"])
def test_text_of_a_format_of_the_library(tmp_path, name):
    """ISO 25178-71, which is no plain table: it has a scale of its heights."""
    pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    heading = (
        "aISO-1.0\nManufacID = X\nCreateDate = 010120260000\nModDate = 010120260000\nNumPoints = 7\n"
        "NumProfiles = 6\nXscale = 5e-7\nYscale = 5e-7\nZscale = 2e-6\nZresolution = -1\nCompression = 0\n"
        "DataType = 7\nCheckType = 0\n*\n"
    )
    rows = "\n".join(" ".join(map(repr, row)) for row in HEIGHTS.tolist())
    (tmp_path / name).write_text(heading + rows + "\n*\n*\n")
    surface = mf.read_surface(tmp_path / name)
    assert surface.heights == pytest.approx(2e-6 * HEIGHTS, rel=1e-9)
    assert surface.pixel_size == pytest.approx((5e-7, 5e-7))


@pytest.mark.parametrize("name", ["scan.dat", "scan.zygo", "scan"])
def test_an_instrument_file_is_known_under_any_name(tmp_path, name):
    """A Bruker file begins with a long text; the library's own text readers would not see the data."""
    file = SHARED / "data" / "di-3.di"
    if not file.exists():
        pytest.skip("../shared/data/di-3.di is not there")
    pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    shutil.copy(file, tmp_path / name)
    assert np.array_equal(mf.read_surface(tmp_path / name).heights, mf.read_surface(file).heights)


# x3p


def test_x3p_in_a_folder(tmp_path):
    members = {"scan/main.xml": INDEX, "scan/bindata/data.bin": DATA}
    (tmp_path / "map.x3p").write_bytes(archive(members))
    assert mf.read_surface(tmp_path / "map.x3p").heights == pytest.approx(1e-6 * HEIGHTS, rel=1e-15)


def test_x3p_with_points_as_text(tmp_path):
    links = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink>"
    data = [f"<Datum>{value!r}</Datum>" for value in HEIGHTS.ravel().tolist()]
    data[4] = "<Datum/>"
    expected = 1e-6 * HEIGHTS
    expected[0, 4] = np.nan
    texts = {"z": data, "x;y;z": [text.replace("<Datum>", "<Datum>0;0;") for text in data]}
    for points in texts.values():
        index = INDEX.replace(links, "<DataList>" + "\n  ".join(points) + "</DataList>")
        (tmp_path / "map.x3p").write_bytes(archive({"main.xml": index}))
        surface = mf.read_surface(tmp_path / "map.x3p")
        np.testing.assert_allclose(surface.heights, expected, rtol=1e-15)
        assert surface.steps == ("points read as text",)
    for bad, message in (
        (data[:-1], "holds 41 points, its matrix of 7 x 6 asks for more"),
        ([*data, data[0]], "more than the 42 points"),
        (["<Datum>1;2</Datum>", *data[1:]], "which is not x;y;z"),
        (["<Datum>high</Datum>", *data[1:]], "which is not x;y;z"),
        (["<Datum>" + "1" * 300 + "</Datum>", *data[1:]], "a point of more than 200 characters"),
    ):
        index = INDEX.replace(links, "<DataList>" + "".join(bad) + "</DataList>")
        (tmp_path / "map.x3p").write_bytes(archive({"main.xml": index}))
        refused(lambda: mf.read_surface(tmp_path / "map.x3p"), message)


@pytest.mark.parametrize(
    ("inside", "message"),
    [
        ("<!--" + "x" * 2**21 + "-->", "a tag or a comment of more than"),
        ("<a>" * 60 + "</a>" * 60, "nested deeper"),
        (f"<{'a' * 300}/>", "tags of over 100"),
    ],
)
def test_hostile_indices(tmp_path, inside, message):
    (tmp_path / "map.x3p").write_bytes(x3p(INDEX.replace("<Record1>", "<Record1>" + inside), DATA))
    refused(lambda: mf.read_surface(tmp_path / "map.x3p"), message)


def test_an_x3p_of_a_line_is_a_profile(tmp_path):
    (tmp_path / "map.x3p").write_bytes(x3p(INDEX.replace("<SizeY>6", "<SizeY>1"), DATA[:56]))
    refused(lambda: mf.read_surface(tmp_path / "map.x3p"), "this is a profile")


# Images


def test_grey_levels_of_8_bits_come_with_a_warning_that_gives_the_step(tmp_path):
    write_image(tmp_path / "map.png", LEVELS.astype("u1"))
    surface = mf.read_surface(tmp_path / "map.png", pixel_size=(2e-6, 1e-6), height_scale=8e-9)
    assert surface.heights == pytest.approx(8e-9 * np.flipud(LEVELS.astype("u1")), rel=1e-15)
    steps = "heights come in steps of 8e-09 m, which are slopes of 0.002 at a lag of 1 pixel"
    assert surface.warnings == (f"the image has 8 bits: {steps}",)
    write_image(tmp_path / "fine.png", LEVELS)
    assert mf.read_surface(tmp_path / "fine.png", pixel_size=1e-6, height_scale=1e-9).warnings == ()


def test_jpeg_holds_normals_with_a_warning_and_no_heights(tmp_path):
    normals = np.full((16, 16, 3), (128, 128, 255), np.uint8)
    normals[4:8, 4:8] = (150, 110, 240)
    write_image(tmp_path / "n.jpg", normals)
    sample = mf.read_normal_map(tmp_path / "n.jpg")
    assert len(sample) == 256
    assert "JPEG, whose compression changes normals" in sample.warnings[0]
    refused(lambda: mf.read_surface(tmp_path / "n.jpg", pixel_size=1.0, height_scale=1.0), "holds no heights")
    write_image(tmp_path / "n.png", normals)
    assert mf.read_normal_map(tmp_path / "n.png").warnings == ()


def test_alpha_marks_missing_pixels(tmp_path):
    alpha = np.full(LEVELS.shape, 65535, np.uint16)
    alpha[2, 3] = 0
    write_image(tmp_path / "map.png", np.stack((LEVELS, alpha), axis=-1), ("Y", "A"))
    surface = mf.read_surface(tmp_path / "map.png", pixel_size=1e-6, height_scale=1e-9)
    assert np.array_equal(surface.mask, np.flipud(alpha > 0))
    assert surface.heights[surface.mask] == pytest.approx(1e-9 * np.flipud(LEVELS)[surface.mask], rel=1e-12)


def geotiff(file, pixels, *tags):
    tifffile = pytest.importorskip("tifffile", reason="the extra 'surface' is not installed")
    pytest.importorskip("OpenImageIO", reason="the extra 'surface' is not installed")
    keys = (1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3076, 0, 1, 9001)
    tifffile.imwrite(file, pixels, extratags=[(34735, "H", len(keys), keys, True), *tags])


SCALE = (33550, "d", 3, (30.0, 25.0, 0.0), True)
FLOATS = np.random.default_rng(2).normal(size=(6, 8)).astype("f4")


@pytest.mark.parametrize(
    "mark", ["1e20", "1e+20", "-3.4028234663852886e+38", "-3.40282346639e+38", "-0.1", "-9999"]
)
def test_nodata_is_compared_in_the_type_of_the_raster(tmp_path, mark):
    pixels = FLOATS.copy()
    pixels[1, 2] = np.float32(mark)
    geotiff(tmp_path / "dem.tif", pixels, SCALE, (42113, "s", 0, mark, True))
    surface = mf.read_surface(tmp_path / "dem.tif")
    assert np.count_nonzero(~surface.mask) == 1
    assert not surface.mask[4, 2]


def test_nodata_that_no_pixel_can_hold_marks_none(tmp_path):
    geotiff(tmp_path / "dem.tif", LEVELS, SCALE, (42113, "s", 0, "-9999", True))
    assert mf.read_surface(tmp_path / "dem.tif").mask.all()


def test_matrices_of_geotiff(tmp_path):
    cos, sin = np.cos(0.3), np.sin(0.3)
    for turn in (np.eye(2), [[cos, -sin], [sin, cos]]):
        matrix = np.zeros((4, 4))
        matrix[:2, :2] = turn @ np.diag((30.0, -25.0))
        matrix[3, 3] = 1
        geotiff(tmp_path / "dem.tif", FLOATS, (34264, "d", 16, tuple(matrix.ravel()), True))
        assert mf.read_surface(tmp_path / "dem.tif").pixel_size == pytest.approx((30.0, 25.0))
    matrix[0, 1] += 20
    geotiff(tmp_path / "dem.tif", FLOATS, (34264, "d", 16, tuple(matrix.ravel()), True))
    refused(lambda: mf.read_surface(tmp_path / "dem.tif"), "not perpendicular")


def test_scales_and_units_of_heights_of_geotiff(tmp_path):
    metadata = '<GDALMetadata><Item name="SCALE" sample="0" role="scale">0.01</Item>\n'
    metadata += '<Item name="OFFSET" sample="0" role="offset">-10</Item></GDALMetadata>'
    geotiff(tmp_path / "dem.tif", LEVELS, SCALE, (42112, "s", 0, metadata, True))
    assert mf.read_surface(tmp_path / "dem.tif").heights == pytest.approx(0.01 * np.flipud(LEVELS) - 10.0)
    tifffile = pytest.importorskip("tifffile")
    keys = (1, 1, 0, 2, 1024, 0, 1, 1, 4099, 0, 1, 9002)
    tifffile.imwrite(tmp_path / "feet.tif", FLOATS, extratags=[(34735, "H", len(keys), keys, True), SCALE])
    refused(lambda: mf.read_surface(tmp_path / "feet.tif"), "the heights are not in metres")


def test_pages_of_a_tiff_are_named(tmp_path):
    tifffile = pytest.importorskip("tifffile", reason="the extra 'surface' is not installed")
    pytest.importorskip("OpenImageIO", reason="the extra 'surface' is not installed")
    file = tmp_path / "stack.tif"
    with tifffile.TiffWriter(file) as writer:
        writer.write(FLOATS, metadata=None)
        writer.write(FLOATS[::2, ::2].copy(), subfiletype=1, metadata=None)  # an overview is no page
        writer.write(2 * FLOATS, metadata=None)
    options = {"pixel_size": 1e-6, "unit": "um"}
    refused(
        lambda: mf.read_surface(file, **options),
        r"several images, name .* page 0 \(8 x 6 pixels\), page 2 \(8 x 6 pixels\)$",
    )
    for channel, factor in ((0, 1), ("page 0", 1), (2, 2), ("page 2", 2)):
        surface = mf.read_surface(file, channel=channel, **options)
        assert surface.heights == pytest.approx(1e-6 * factor * np.flipud(FLOATS).astype(float))
    refused(lambda: mf.read_surface(file, channel=1, **options), "no channel 1")


def test_without_a_microscope_the_size_may_be_anything(tmp_path):
    np.savez(tmp_path / "dem.npz", heights=HEIGHTS, pixel_size=30.0)
    assert mf.read_surface(tmp_path / "dem.npz").pixel_size == (30.0, 30.0)
    assert complete.Options.checked(None, None, None) == complete.Options()


def test_readers_of_ours_need_no_library(tmp_path, monkeypatch):
    for name in ("SurfaceTopography", "OpenImageIO", "tifffile"):
        monkeypatch.setitem(sys.modules, name, None)
    (tmp_path / "map.x3p").write_bytes(x3p(INDEX, DATA))
    assert mf.read_surface(tmp_path / "map.x3p").heights.shape == (6, 7)
