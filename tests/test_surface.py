"""Height maps: geometry of slopes, levelling, and reading files that mean well."""

from __future__ import annotations

import math
import sys
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import microfacet as mf
from microfacet._surface.read import library, library_child

DATA = Path(__file__).parents[2] / "shared" / "data"


def grid(ny, nx, dx, dy):
    y, x = np.mgrid[0:ny, 0:nx]
    return x * dx, y * dy


@pytest.mark.parametrize("lag", [1, 2, 3])
def test_central_differences_are_exact_for_quadratics(lag):
    x, y = grid(9, 12, 2e-6, 3e-6)
    a, b, c = 2e4, -5e3, 1e4
    surface = mf.Surface(a * x**2 + b * x * y + c * y**2 + 0.3 * x, (2e-6, 3e-6))
    inner = slice(lag, -lag)
    expected = np.stack((2 * a * x + b * y + 0.3, b * x + 2 * c * y), axis=-1)[inner, inner].reshape(-1, 2)
    assert surface.slopes(lag) == pytest.approx(expected, abs=1e-12)


def test_x_runs_along_columns_and_y_up_the_rows():
    x, y = grid(5, 7, 1.0, 1.0)
    assert mf.Surface(3 * x, 1.0).slopes() == pytest.approx(np.tile([3.0, 0.0], (15, 1)))
    assert mf.Surface(2 * y, 1.0).slopes() == pytest.approx(np.tile([0.0, 2.0], (15, 1)))
    assert mf.Surface(2 * y, (1.0, 4.0)).slopes() == pytest.approx(np.tile([0.0, 0.5], (15, 1)))


@pytest.mark.parametrize("how", ["mask", "nan", "inf", "masked array"])
def test_a_missing_pixel_takes_the_slopes_of_its_neighbours_only(how):
    rng = np.random.default_rng(0)
    heights = rng.normal(size=(9, 10))
    whole = mf.Surface(heights, 1.0).slopes().reshape(7, 8, 2)
    missing = np.zeros(heights.shape, dtype=bool)
    missing[4, 5] = True
    if how == "mask":
        damaged = mf.Surface(np.where(missing, 1e9, heights), 1.0, mask=~missing)
    elif how == "masked array":
        damaged = mf.Surface(np.ma.array(np.where(missing, 1e9, heights), mask=missing), 1.0)
    else:
        damaged = mf.Surface(np.where(missing, float(how), heights), 1.0)
    kept = np.ones((7, 8), dtype=bool)
    for row, column in ((4, 4), (4, 6), (3, 5), (5, 5)):
        kept[row - 1, column - 1] = False
    assert damaged.slopes() == pytest.approx(whole[kept])
    assert np.array_equal(damaged.mask, ~missing)
    assert np.isnan(damaged.heights[4, 5])


def test_levelling_leaves_nothing_of_a_plane_and_ignores_masked_pixels():
    rng = np.random.default_rng(1)
    x, y = grid(20, 30, 1e-6, 2e-6)
    rough, valid = 1e-7 * rng.normal(size=x.shape), rng.random(x.shape) < 0.7
    tilted = np.where(valid, rough + 0.2 * x - 0.7 * y + 5e-3, -99.0)
    surface = mf.Surface(tilted, (1e-6, 2e-6), mask=valid).level()
    residual = np.where(valid, surface.heights, 0.0)
    for basis in (np.ones_like(x), x / x.max(), y / y.max()):  # the normal equations of least squares
        assert abs(np.sum(residual * basis)) < 1e-15
    assert surface.steps == ("levelled: least-squares plane subtracted",)
    again = surface.level()
    assert again.heights[valid] == pytest.approx(surface.heights[valid], abs=1e-17)
    assert len(again.steps) == 2


def test_a_surface_keeps_its_own_read_only_arrays():
    heights = np.random.default_rng(2).normal(size=(4, 4))
    surface = mf.Surface(heights, 1.0)
    before = surface.heights.copy()
    heights[:] = 0
    assert np.array_equal(surface.heights, before)
    with pytest.raises(ValueError, match="read-only"):
        surface.heights[0, 0] = 1.0


@pytest.mark.parametrize(
    ("heights", "options", "message"),
    [
        (np.zeros(9), {}, "2-D"),
        (np.zeros((3, 3, 3)), {}, "2-D"),
        (np.zeros((2, 50)), {}, "at least 3 x 3"),
        (np.zeros((3, 0)), {}, "at least 3 x 3"),
        (np.zeros((4, 4), dtype=complex), {}, "real"),
        (np.zeros((4, 4), dtype=object), {}, "real"),
        (np.full((4, 4), "1"), {}, "real"),
        ([[1.0, 2.0], [3.0]], {}, "real"),
        (np.full((4, 4), np.nan), {}, "0 valid pixels of 16"),
        (np.zeros((4, 4)), {"mask": np.zeros((4, 4), dtype=bool)}, "0 valid pixels"),
        (np.zeros((4, 4)), {"mask": np.ones((4, 5), dtype=bool)}, "mask"),
        (np.zeros((4, 4)), {"mask": np.ones((4, 4))}, "mask"),
        (np.zeros((4, 4)), {"pixel_size": 0.0}, "pixel_size"),
        (np.zeros((4, 4)), {"pixel_size": -1.0}, "pixel_size"),
        (np.zeros((4, 4)), {"pixel_size": (1.0, math.nan)}, "pixel_size"),
        (np.zeros((4, 4)), {"pixel_size": (1.0, math.inf)}, "pixel_size"),
        (np.zeros((4, 4)), {"pixel_size": (1.0, 2.0, 3.0)}, "pixel_size"),
        (np.zeros((4, 4)), {"pixel_size": 1j}, "pixel_size"),
        (np.zeros((4, 4)), {"pixel_size": "wide"}, "pixel_size"),
        (np.zeros((4, 4)), {"lag": 0}, "lag"),
        (np.zeros((4, 4)), {"lag": 1.5}, "lag"),
    ],
)
def test_bad_surfaces_are_one_sentence(heights, options, message):
    with pytest.raises(mf.SurfaceError, match=message) as caught:
        mf.Surface(heights, **({"pixel_size": 1.0} | options))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("lag", [0, -1, 1.0, True, "2", 3, 10**30])
def test_bad_lags(lag):
    with pytest.raises(mf.SurfaceError, match="lag"):
        mf.Surface(np.zeros((6, 9)), 1.0).slopes(lag)


def test_no_pixel_with_four_neighbours():
    heights = np.full((6, 6), np.nan)
    heights[::2] = 1.0
    with pytest.raises(mf.SurfaceError, match="neighbours"):
        mf.Surface(heights, 1.0).slopes()


HEIGHTS = np.random.default_rng(3).integers(-50, 50, size=(6, 8))


@pytest.mark.parametrize("dtype", ["<f8", ">f8", "<f4", ">i2", "i1", "f2", "<i8", "g"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_npy_of_any_real_type(tmp_path, dtype, order):
    np.save(tmp_path / "map.npy", np.asarray(HEIGHTS, dtype=dtype, order=order))
    surface = mf.read_surface(tmp_path / "map.npy", pixel_size=(2e-6, 3e-6))
    assert surface.heights.dtype == np.float64
    assert np.array_equal(surface.heights, HEIGHTS)
    assert surface.pixel_size == (2e-6, 3e-6)
    assert surface.source == "map.npy"
    assert surface.unit == "m"


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_npz_with_all_its_keys(tmp_path, save):
    mask = HEIGHTS > -40
    save(tmp_path / "map.npz", heights=HEIGHTS, dx=20.0, dy=np.float32(25.0), mask=mask, unit="nm")
    surface = mf.read_surface(str(tmp_path / "map.npz"))
    assert surface.heights[mask] == pytest.approx(HEIGHTS[mask] * 1e-9, rel=1e-15)
    assert np.array_equal(surface.mask, mask)
    assert surface.pixel_size == pytest.approx((2e-8, 2.5e-8), rel=1e-15)
    assert surface.unit == "nm"
    assert surface.steps == ()
    with pytest.raises(mf.SurfaceError, match="states the unit nm, not um"):
        mf.read_surface(tmp_path / "map.npz", unit="um")


def test_npz_channels_units_and_pixel_sizes_from_the_caller(tmp_path):
    file = tmp_path / "map.NPZ"
    with file.open("wb") as stream:
        np.savez(stream, topography=HEIGHTS, pixel_size=[1.0, 2.0])
    surface = mf.read_surface(file, channel="topography", unit="um")
    assert surface.pixel_size == pytest.approx((1e-6, 2e-6))
    assert surface.heights == pytest.approx(HEIGHTS * 1e-6)
    surface = mf.read_surface(file, pixel_size=5.0)  # the only array that can be the heights
    assert surface.pixel_size == (5.0, 5.0)
    assert surface.steps == ("pixel size given by the caller",)


def test_terrain_is_in_metres_and_says_so():
    from matplotlib import cbook

    terrain = mf.sample_terrain()
    with np.load(cbook.get_sample_data("jacksboro_fault_dem.npz", asfileobj=False)) as file:
        assert np.array_equal(terrain.heights[::-1], file["elevation"])  # the file begins in the north
        degrees = float(file["dx"])
    # A degree at 36.59 N on the WGS 84 ellipsoid: 89 503 m along the parallel, 110 961 m along the meridian.
    assert terrain.pixel_size == pytest.approx((89503 * degrees, 110961 * degrees), rel=0.004)
    assert terrain.mask.all()
    assert terrain.lag == 2
    assert "degrees" in terrain.steps[0]
    assert "lag of 2" in terrain.steps[1]
    # Whole metres over a baseline of 4 pixels.
    steps = terrain.slopes()[:, 0] * 4 * terrain.pixel_size[0]
    assert steps == pytest.approx(np.round(steps), abs=1e-9)
    assert len(terrain.slopes()) == 340 * 399


def shared(name):
    pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    if not (DATA / name).exists():
        pytest.skip(f"../shared/data/{name} is not there")
    return DATA / name


def test_x3p_heights_units_and_orientation():
    file = shared("SkiInfiniteFocus.x3p")
    surface = mf.read_surface(file)
    other = library.read(file, None, ("x3p",))  # SurfaceTopography agrees
    np.testing.assert_array_equal(surface.heights, other.heights)
    assert surface.pixel_size == pytest.approx(other.size, rel=1e-12)
    with zipfile.ZipFile(file) as archive:  # the standard: metres, float32, x fastest
        raw = np.frombuffer(archive.read("bindata/data.bin"), dtype="<f4").reshape(940, 1197)
        increments = ElementTree.fromstring(archive.read("main.xml")).iter("Increment")
        dx, dy = (float(increment.text) for increment in list(increments)[:2])
    assert surface.pixel_size == pytest.approx((dx, dy), rel=1e-12)
    assert np.array_equal(surface.mask, np.isfinite(raw))
    assert np.array_equal(surface.heights[surface.mask], raw[surface.mask].astype(float))
    assert 0.002 < 1 - surface.mask.mean() < 0.006
    assert surface.steps == ()


def test_a_bruker_channel_by_name():
    file = shared("di-3.di")
    surface = mf.read_surface(file, channel="Height")
    assert surface.heights.shape == (256, 256)
    assert surface.pixel_size == pytest.approx((10e-6 / 256, 10e-6 / 256))
    assert surface.unit == "nm"
    assert surface.steps == ("read channel 'Height' with SurfaceTopography",)


def test_channels_are_chosen_by_index_or_name_and_must_be_maps_of_heights():
    phase = SimpleNamespace(index=0, name="Phase", dim=2, unit=("um", "deg"))
    line = SimpleNamespace(index=1, name="Line", dim=1, unit="nm")
    heights = SimpleNamespace(index=2, name="Heights", dim=2, unit="nm")
    reader = SimpleNamespace(channels=[phase, line, heights], default_channel=phase)
    for wanted in (None, 2, "Heights"):
        assert library_child.select(reader, wanted) is heights
    for wanted, message in (
        ("Depth", r"no channel 'Depth', the file has 0 \(Phase\), 1 \(Line\), 2 \(Heights\)"),
        (7, "no channel 7"),
        ("Phase", "'Phase' is not a height map"),
        (1, "1 is not a height map"),
    ):
        with pytest.raises(library_child.Unusable, match=message):
            library_child.select(reader, wanted)
    reader.channels.pop()
    with pytest.raises(library_child.Unusable, match="no height map"):
        library_child.select(reader, None)


def test_without_the_library_one_sentence_says_what_to_install(tmp_path, monkeypatch):
    (tmp_path / "map.opd").write_bytes(b"PK")
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    with pytest.raises(mf.SurfaceError, match=r'SurfaceTopography.*pip install "\.\[surface\]"'):
        mf.read_surface(tmp_path / "map.opd")
