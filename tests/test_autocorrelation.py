"""Autocorrelations that are known by mathematics, and beside two other libraries."""

from __future__ import annotations

import math

import numpy as np
import pytest

import microfacet as mf
from lateral_cases import MAPS, NOT_SQUARE, by_surfalize, measured, with_spectrum
from microfacet._surface.correlation import _correlated

FALL = math.sqrt(math.log(5))  # where exp(-r^2) is 0.2


def anisotropic(along: float, across: float, angle: float, shape=(400, 500), seed=0) -> mf.Surface:
    """Correlation exp(-(u/along)^2 - (v/across)^2) of pixels, u at this angle."""
    c, s = math.cos(angle), math.sin(angle)

    def density(fx, fy):
        u, v = c * fx + s * fy, -s * fx + c * fy
        return np.exp(-((math.pi * along * u) ** 2) - (math.pi * across * v) ** 2)

    return mf.Surface(with_spectrum(density, shape, (1.0, 1.0), seed), 1.0)


def test_an_isotropic_gaussian_correlation_falls_where_it_should():
    found = [
        mf.autocorrelation(mf.Surface(anisotropic(7, 7, 0, seed=seed).heights, 1e-6), periodic=True)
        for seed in range(4)
    ]
    middle = np.mean([(one.Sal + one.longest) / 2 for one in found])
    assert middle / 7e-6 == pytest.approx(FALL, rel=0.02)
    assert all(0.85 < one.Str <= 1 for one in found)
    near = found[0].lengths < 10e-6
    assert found[0].values[near] == pytest.approx(np.exp(-((found[0].lengths[near] / 7e-6) ** 2)), abs=0.05)


@pytest.mark.parametrize("degrees", [0.0, 30.0, 135.0])
def test_an_anisotropic_correlation_has_its_lengths_and_directions(degrees):
    found = mf.autocorrelation(anisotropic(4, 16, math.radians(degrees), seed=2))
    assert found.Sal == pytest.approx(4 * FALL, rel=0.05)
    assert found.Str == pytest.approx(0.25, rel=0.15)
    for angle, expected in ((found.fastest, degrees), (found.slowest, degrees + 90), (found.Std, degrees)):
        assert abs((math.degrees(angle) - expected + 90) % 180 - 90) < 8


def test_pixels_that_are_not_square_change_no_length():
    surface = anisotropic(12, 12, 0.0, seed=3)
    thinned = mf.Surface(surface.heights[:, ::2], (2.0, 1.0))
    found, whole = mf.autocorrelation(thinned), mf.autocorrelation(surface)
    assert found.Sal == pytest.approx(whole.Sal, rel=0.02)
    assert found.Str == pytest.approx(whole.Str, rel=0.02)


def test_a_tilt_does_not_count():
    surface = anisotropic(6, 6, 0.0, seed=1)
    y, x = np.mgrid[0:400, 0:500]
    tilted = mf.autocorrelation(mf.Surface(surface.heights + 0.3 * x - 5.0 * y, 1.0))
    assert tilted.Sal == pytest.approx(mf.autocorrelation(surface).Sal, rel=1e-9)


def test_missing_pixels_are_left_out_without_a_bias():
    surface = anisotropic(5, 10, 0.4, seed=4)
    mask = np.random.default_rng(1).random(surface.heights.shape) < 0.6
    mask[100:200, 100:250] = False
    whole = mf.autocorrelation(surface)
    holed = mf.autocorrelation(mf.Surface(surface.heights, 1.0, mask=mask))
    assert holed.Sal == pytest.approx(whole.Sal, rel=0.03)
    assert holed.Str == pytest.approx(whole.Str, rel=0.1)


def test_every_shift_is_the_mean_of_its_pairs():
    rng = np.random.default_rng(5)
    heights, mask = rng.normal(size=(17, 20)), rng.random((17, 20)) < 0.8
    surface = mf.Surface(heights, 1.0, mask=mask)
    found = _correlated(surface, False)
    z = surface.level().heights
    z = z - np.nanmean(z)
    for up, right in ((0, 0), (1, 3), (-4, 2), (-8, 10), (7, 0)):
        a = z[max(-up, 0) : 17 - max(up, 0), : 20 - right]
        b = z[max(up, 0) : 17 - max(-up, 0), right:]
        expected = np.nanmean(a * b) / np.nanmean(z * z)
        assert found[17 // 2 + up, right] == pytest.approx(expected, rel=1e-9)


def test_grooves_without_an_end_leave_str_unknown_and_say_so():
    y, x = np.mgrid[0:200, 0:300] * 1.0
    found = mf.autocorrelation(mf.Surface(np.sin(0.5 * x + 0.2 * y), 1.0))
    assert math.isnan(found.Str)
    assert "Str is unknown but below" in found.notes[0]
    assert abs(math.degrees(found.slowest - found.fastest)) == pytest.approx(90, abs=3)
    wide = mf.autocorrelation(mf.Surface(np.cos(x / 100), 1.0))
    assert wide.notes


def test_a_map_that_is_small_beside_its_correlation_says_so():
    found = mf.autocorrelation(anisotropic(16, 16, 0.0, (100, 100), seed=6))
    assert "times as wide as its autocorrelation is long" in found.notes[0]


def test_input_without_autocorrelation():
    with pytest.raises(mf.SurfaceError, match=r"threshold must lie in \(0, 1\), got 1.5"):
        mf.autocorrelation(mf.sample_terrain(), threshold=1.5)
    with pytest.raises(mf.SurfaceError, match="at least 16 x 16 pixels"):
        mf.autocorrelation(mf.Surface(np.random.default_rng(1).normal(size=(10, 10)), 1.0))
    with pytest.raises(mf.SurfaceError, match="the map is flat"):
        mf.autocorrelation(mf.Surface(np.ones((20, 20)) * 3.0, 1.0))


def test_the_picture_shows_both_halves():
    found = mf.autocorrelation(anisotropic(5, 10, 0.4, seed=4))
    assert found.picture == pytest.approx(found.picture[::-1, ::-1])
    rows, columns = found.picture.shape
    assert found.picture[rows // 2, columns // 2] == pytest.approx(1)


# Beside other libraries


@pytest.mark.filterwarnings(NOT_SQUARE)
@pytest.mark.parametrize("name", ["synthetic", *MAPS])
def test_sal_and_str_are_those_of_surfalize(name):
    surface = anisotropic(4, 12, 0.5).level() if name == "synthetic" else measured(name)
    dx, dy = surface.pixel_size
    unit = 1e6 if name != "synthetic" else 1.0
    other = by_surfalize(surface.heights[::-1] * unit, dx * unit, dy * unit)  # its rows run down
    found = mf.autocorrelation(surface)
    assert found.Sal * unit == pytest.approx(other.Sal(), rel=5e-3)
    if math.isnan(found.Str):  # it looks at shifts beyond half of the map, where few pairs are left
        assert other.Str() < found.Sal / (0.5 * min(surface.heights.shape) * min(dx, dy)) * 1.01
    else:
        assert found.Str == pytest.approx(other.Str(), rel=2e-2)


@pytest.mark.parametrize("masked", [False, True])
def test_shifts_are_those_of_surface_topography(masked):
    """It gives half the mean squared difference, Sq^2 (1 - rho) of a periodic map without holes."""
    library = pytest.importorskip("SurfaceTopography")
    surface = anisotropic(4, 8, 0.5, (60, 80))
    heights = surface.heights - surface.heights.mean()
    if not masked:
        other = library.Topography(heights.T, physical_sizes=(80.0, 60.0), periodic=True)
        *_, picture = other.autocorrelation_from_area(return_map=True)
        expected = 1 - picture.T / np.mean(heights**2)
        found = _correlated(surface, True)
        assert found[30:60, :40] == pytest.approx(expected[:30, :40], abs=1e-12)
        return
    mask = np.random.default_rng(1).random(heights.shape) < 0.9
    holed = np.ma.masked_array(heights.T, mask=~mask.T)
    other = library.Topography(holed, physical_sizes=(80.0, 60.0))
    *_, picture = other.autocorrelation_from_area(return_map=True)
    levelled = mf.Surface(heights, 1.0, mask=mask)
    found = _correlated(levelled, False)
    expected = 1 - np.ma.getdata(picture).T / np.mean(heights[mask] ** 2)
    assert found[30:40, :10] == pytest.approx(
        expected[:10, :10], abs=0.1
    )  # levelled, and other normalisation
