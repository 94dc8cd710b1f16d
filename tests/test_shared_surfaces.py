"""Files that people have sent: each gives the right numbers, or one sentence that is true."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import microfacet as mf
from surface_file_cases import refused

CASES = Path(__file__).parents[2] / "shared" / "cases" / "surfaces"
GIVEN = {"pixel_size": (5e-7, 1e-6), "unit": "um"}


def case(name):
    if not (CASES / name).exists():
        pytest.skip(f"../shared/cases/surfaces/{name} is not there")
    if name.endswith((".tif", ".png")):
        pytest.importorskip("OpenImageIO", reason="the extra 'surface' is not installed")
    return CASES / name


def points():
    return np.loadtxt(case("points_xyz.txt"))[:, 2].reshape(64, 48)


def numbers(name, **options):
    """The numbers of a table, by NumPy's own reader."""
    with case(name).open(encoding="latin-1") as stream:
        lines = [line.rstrip().rstrip(",").replace("BAD", "nan") for line in stream]
    return np.loadtxt([line for line in lines if line and line[0] in "-0123456789n"], **options)


@pytest.mark.parametrize("name", ["bad_word.csv", "header_row.csv", "trailing.csv"])
def test_tables(name):
    expected = numbers(name, delimiter=",")
    surface = mf.read_surface(case(name), **GIVEN)
    np.testing.assert_allclose(surface.heights, 1e-6 * expected, rtol=1e-12)
    assert surface.heights.shape == (64, 48)
    assert surface.pixel_size == GIVEN["pixel_size"]
    assert np.count_nonzero(~surface.mask) == (26 if name == "bad_word.csv" else 0)
    assert surface.warnings == ()
    refused(lambda: mf.read_surface(case(name)), "give pixel_size")


def test_points():
    surface = mf.read_surface(case("points_xyz.txt"), unit="um")
    np.testing.assert_allclose(surface.heights, 1e-6 * points(), rtol=1e-12)
    assert surface.pixel_size == pytest.approx((1e-6, 1e-6))
    refused(lambda: mf.read_surface(case("points_xyz.txt")), "does not state its unit")


@pytest.mark.parametrize(
    ("name", "size", "factor"), [("gwyddion_nm.txt", 1.25e-6 / 64, 1e-9), ("gwyddion_latin-1.txt", 1e-6, 1.0)]
)
def test_exports_of_gwyddion(name, size, factor):
    surface = mf.read_surface(case(name))
    np.testing.assert_allclose(surface.heights, factor * numbers(name), rtol=1e-12)
    assert surface.pixel_size == pytest.approx((size, size))
    refused(lambda: mf.read_surface(case(name), unit="um"), "states the unit n?m, not um")
    refused(lambda: mf.read_surface(case(name), pixel_size=1e-3), "states a pixel of .*, not 0.001 x 0.001 m")


@pytest.mark.parametrize("name", ["esri_no_nodata_line.asc", "geo_matrix.tif", "geo_nodata_1e20.tif"])
def test_grids_with_missing_data(name):
    with case("esri_no_nodata_line.asc").open() as stream:
        expected = np.flipud(np.loadtxt(stream.readlines()[5:]))
    case(name)
    expected[expected == -9999] = np.nan
    surface = mf.read_surface(CASES / name)
    assert surface.pixel_size == pytest.approx((30.0, 30.0))
    assert np.count_nonzero(~surface.mask) == 20
    np.testing.assert_allclose(surface.heights, expected, rtol=1e-6)


def test_a_grid_of_surfer():
    surface = mf.read_surface(case("surfer.grd"))
    with case("surfer.grd").open() as stream:
        expected = np.loadtxt(stream.readlines()[5:])
    np.testing.assert_allclose(surface.heights, expected, rtol=1e-12)
    assert surface.pixel_size == pytest.approx((30.0, 30.0))


def test_pages():
    refused(lambda: mf.read_surface(case("stack_f32.tif"), **GIVEN), r"page 0 \(48 x 64 pixels\), page 1")
    pages = [mf.read_surface(case("stack_f32.tif"), channel=page, **GIVEN).heights for page in (0, "page 1")]
    np.testing.assert_allclose(pages[0], 1e-6 * np.flipud(points()), rtol=1e-5, atol=1e-12)
    assert pages[1].shape == (64, 48)


def test_grey_levels_of_8_bits():
    refused(lambda: mf.read_surface(case("h8.png"), **GIVEN), "give height_scale")
    surface = mf.read_surface(case("h8.png"), pixel_size=1e-6, height_scale=1e-9)
    assert np.ptp(surface.heights) == pytest.approx(255e-9)
    assert "the image has 8 bits: heights come in steps of 1e-09 m" in surface.warnings[0]


@pytest.mark.parametrize("name", ["slopes3.csv", "slopes_qp.csv"])
def test_slopes_go_by_name(name):
    expected = np.loadtxt(case("slopes3.csv"), delimiter=",", skiprows=1)[:, 1:]
    sample = mf.read_slopes(case(name))
    assert np.array_equal(sample.values, expected)
    assert sample.steps == (("columns left out: i",) if name == "slopes3.csv" else ())
    refused(lambda: mf.read_surface(case(name), **GIVEN), "table of slopes.*mf.read_slopes")


@pytest.mark.parametrize("name", ["profile_xz.csv", "profile_z.txt"])
def test_profiles_are_named(name):
    for options in ({}, GIVEN):
        refused(
            lambda options=options: mf.read_surface(case(name), **options), "this is a profile.*read_profile"
        )
    refused(lambda: mf.read_slopes(case("profile_z.txt")), "slopes are two columns, and the table has 1")


@pytest.mark.parametrize("name", ["ggx03_iid_slopes.npz", "beckmann001_slopes.npz"])
def test_arrays_of_slopes_are_no_map(name):
    refused(lambda: mf.read_surface(case(name), **GIVEN), "table of slopes.*mf.read_slopes")
    assert mf.read_slopes(case(name)).values.shape == (20000, 2)
