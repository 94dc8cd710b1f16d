"""Power spectral densities of maps whose spectrum is known, and beside another library."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from click.testing import CliRunner

import microfacet as mf
from lateral_cases import MAPS, measured, with_spectrum
from microfacet._surface.filling import filled
from microfacet.cli import main

A, B, C = 1e-24, 2e-5, 3.0


def abc(fx, fy):
    return A / (1 + B**2 * (fx**2 + fy**2)) ** ((C + 1) / 2)


# Parseval, units, truth


@pytest.mark.parametrize("pixel_size", [(1e-6, 1e-6), (2e-6, 0.5e-6)])
def test_the_integral_of_a_periodic_density_is_the_mean_square_height(pixel_size):
    heights = np.random.default_rng(1).normal(size=(96, 131)) * 1e-7
    surface = mf.Surface(heights, pixel_size)
    found = mf.spectrum(surface, window=None)
    assert found.mean_square == pytest.approx(mf.roughness(surface).Sq ** 2, rel=1e-12)
    # White heights have the density sigma^2 dx dy at every frequency, and the same in every direction.
    level = np.sum(found.psd * found.modes) / np.sum(found.modes)
    assert level == pytest.approx(found.mean_square * pixel_size[0] * pixel_size[1], rel=0.05)
    assert np.all(np.abs(found.psd - level) < 5 * level / np.sqrt(found.modes))


@pytest.mark.parametrize("window", ["hann", "blackman", "boxcar"])
def test_the_integral_of_a_windowed_density_is_the_weighted_mean_square_height(window):
    heights = np.random.default_rng(2).normal(size=(64, 80))
    found = mf.spectrum(mf.Surface(heights, 1.0), window=window)
    assert found.mean_square == pytest.approx(1.0, rel=0.1)
    assert np.average(found.psd, weights=found.modes) == pytest.approx(found.mean_square, rel=0.05)


def test_rings_and_directions_hold_the_same_power():
    found = mf.spectrum(mf.Surface(with_spectrum(abc, (256, 256)), 1e-6), window=None)
    rings = np.sum(2 * found.modes * found.psd) / (256e-6) ** 2
    directions = np.sum(found.angular) * math.pi / found.angular.size
    assert rings == pytest.approx(directions, rel=1e-9)
    assert rings == pytest.approx(found.mean_square, rel=0.01)  # but for the corners beyond the last ring
    by_sector = np.nanmean(found.directional[:, -10:], axis=0)
    assert by_sector == pytest.approx(found.psd[-10:], rel=0.05)


def test_synthetic_maps_have_the_spectrum_of_their_correlation():
    """exp(-(r/l)^2) has the density Sq^2 pi l^2 exp(-(pi l f)^2)."""
    length, scores = 6e-6, []
    for seed in range(4):
        surface = mf.synthesize(mf.Beckmann(alpha=0.2), (256, 256), correlation_length=length, seed=seed)
        found = mf.spectrum(surface, window=None)
        truth = math.pi * length**2 * np.exp(-((math.pi * length * found.frequencies) ** 2))
        use = (found.modes > 20) & (truth > 0.05 * truth[0])  # further down rings are too wide for one value
        ratio = found.psd[use] / (truth[use] * found.mean_square)
        assert np.all(np.abs(ratio - 1) < 5 / np.sqrt(found.modes[use]) + 0.05)
        scores.append(np.sum(found.modes[use] * ratio) / np.sum(found.modes[use]))
    assert np.mean(scores) == pytest.approx(1.0, abs=0.05)


def test_a_wave_stands_at_its_frequency_with_half_its_squared_amplitude():
    x = np.arange(256)
    surface = mf.Surface(np.tile(3e-6 * np.sin(2 * np.pi * x / 16), (256, 1)), 1e-6)
    found = mf.spectrum(surface, window=None)
    peak = np.argmax(found.psd * found.modes)
    assert found.frequencies[peak] == pytest.approx(1 / 16e-6, rel=0.1)
    assert found.mean_square == pytest.approx((3e-6) ** 2 / 2)
    assert found.psd[peak] * 2 * found.modes[peak] / 256e-6**2 == pytest.approx(found.mean_square, rel=1e-6)


def test_a_window_keeps_the_edges_of_a_map_out_of_its_spectrum():
    """Of a cut-out of a steep spectrum: without a window the jump at the edge stands at all frequencies."""

    def steep(fx, fy):
        return A / (1 + B**2 * (fx**2 + fy**2)) ** 3.5

    surface = mf.Surface(with_spectrum(steep, (512, 512))[:256, :256], 1e-6)
    windowed, bare = (mf.spectrum(surface, window=window) for window in ("hann", "boxcar"))
    high = windowed.frequencies > 1e5
    truth = steep(windowed.frequencies[high], 0)
    assert windowed.psd[high] == pytest.approx(truth, rel=0.2)
    assert np.median(bare.psd[high] / truth) > 2


# Direction


@pytest.mark.parametrize("degrees", [0.0, 17.0, 45.0, 90.0, 120.6])
def test_the_texture_direction_is_across_the_grooves(degrees):
    y, x = np.mgrid[0:300, 0:200] * 1.0
    across = x * math.cos(math.radians(degrees)) + y * math.sin(math.radians(degrees))
    surface = mf.Surface(np.sin(2 * np.pi * across / 13.7), 1.0)
    found = math.degrees(mf.spectrum(surface).Std)
    assert abs((found - degrees + 90) % 180 - 90) < 0.7


def test_pixels_that_are_not_square_turn_no_direction():
    y, x = np.mgrid[0:256, 0:256] * np.array([2.0, 1.0])[:, np.newaxis, np.newaxis]
    found = mf.spectrum(mf.Surface(np.sin(2 * np.pi * (x + y) / 30), (1.0, 2.0)))
    assert math.degrees(found.Std) == pytest.approx(45, abs=0.7)


def test_white_heights_have_no_direction():
    shares = []
    for seed in range(6):
        heights = np.random.default_rng(seed).normal(size=(200, 200))
        found = mf.spectrum(mf.Surface(heights, 1.0), window=None)
        shares.append(found.angular / found.angular.mean())
    assert np.std(np.mean(shares, axis=0)) < 0.03  # along the axes of the grid neither


# The ABC model


def test_the_abc_model_is_found_again_within_its_errors():
    scores = []
    for seed in range(25):
        heights = with_spectrum(abc, (256, 256), seed=seed)[:180, :200]
        found = mf.spectrum(mf.Surface(heights, 1e-6)).abc
        truth = {"A": A, "B": B, "C": C}
        scores.append([(getattr(found, name) - truth[name]) / found.errors[name] for name in "ABC"])
        assert found.notes == ()
        assert found.misfit < 0.5
    assert np.all(np.abs(np.mean(scores, axis=0)) < 4 / math.sqrt(25))
    assert np.all((np.std(scores, axis=0) > 0.6) & (np.std(scores, axis=0) < 1.5))
    assert np.mean(np.abs(scores) < 1.96) > 0.85


def test_the_model_is_a_density_with_its_root_mean_square_height():
    model = mf.KCorrelation(A, B, C, {}, 0.0, 1e3, 5e5, ())
    f = np.geomspace(1, 1e9, 20_001)
    square = np.trapezoid(2 * math.pi * f * model.psd(f), f)
    assert model.Sq == pytest.approx(math.sqrt(square), rel=1e-4)
    assert mf.KCorrelation(A, B, 0.9, {}, 0.0, 1e3, 5e5, ()).Sq == math.inf


def test_what_the_abc_model_does_not_describe_is_said():
    gaussian = mf.spectrum(mf.synthesize(mf.Beckmann(alpha=0.2), (256, 256)), window=None).abc
    assert "falls faster than any power" in gaussian.notes[0]
    assert math.isnan(gaussian.errors["C"])
    fractal = with_spectrum(lambda fx, fy: 1e-6 / (1 + fx**2 + fy**2) ** 1.6, (256, 256))
    found = mf.spectrum(mf.Surface(fractal, 1e-6), window=None).abc
    assert "undetermined" in found.notes[0]
    assert math.isnan(found.errors["A"])
    assert abs(found.C - 2.2) < 4 * found.errors["C"] < 0.4  # which is what such a map does determine
    x = np.arange(256) * np.ones((256, 1))
    noise = np.random.default_rng(0).normal(size=x.shape)
    grating = mf.Surface(np.sign(np.sin(x * 0.4)) + 0.01 * noise, 1e-6)
    assert "misses the spectrum by a factor" in mf.spectrum(grating).abc.notes[-1]


# Missing pixels


def test_holes_are_filled_smoothly():
    y, x = np.mgrid[0:60, 0:70] / 60.0
    smooth = x**2 - y**2 + x  # harmonic: what Laplace's equation fills in exactly
    mask = np.random.default_rng(3).random(x.shape) < 0.8
    mask[20:24, 30:34] = False
    found = filled(smooth, mask)
    assert np.array_equal(found[mask], smooth[mask])
    assert np.abs(found - smooth)[1:-1, 1:-1].max() < 0.01  # of a range of 3


@pytest.mark.parametrize("kind", ["scattered", "blob"])
def test_missing_pixels_leave_the_density_at_long_wavelengths(kind):
    heights = with_spectrum(abc, (256, 256), seed=3)
    mask = np.random.default_rng(1).random(heights.shape) < 0.8
    if kind == "blob":
        mask[:] = True
        mask[100:160, 20:200] = False
    whole = mf.spectrum(mf.Surface(heights, 1e-6))
    holed = mf.spectrum(mf.Surface(heights, 1e-6, mask=mask))
    assert holed.filled == pytest.approx(1 - mask.mean())
    assert f"{100 * holed.filled:.3g} % of the pixels are missing" in holed.notes[0]
    long = (whole.frequencies < 1 / 8e-6) & (whole.modes > 100)
    assert holed.psd[long] == pytest.approx(whole.psd[long], rel=0.35)
    assert np.mean(np.log(holed.psd[long] / whole.psd[long])) == pytest.approx(0, abs=0.1)
    assert abs(holed.abc.C - C) < 0.6


# Beside SurfaceTopography, whose wave vectors are 2 pi f


@pytest.mark.parametrize("name", ["synthetic", *MAPS])
def test_the_radial_average_is_that_of_surface_topography(name):
    library = pytest.importorskip("SurfaceTopography")
    surface = mf.Surface(with_spectrum(abc, (120, 160)), 1e-6) if name == "synthetic" else measured(name)
    surface = mf.Surface(surface.heights - surface.heights.mean(), surface.pixel_size)
    found = mf.spectrum(surface, window=None)
    ny, nx = surface.heights.shape
    sizes = nx * surface.pixel_size[0], ny * surface.pixel_size[1]
    other = library.Topography(surface.heights.T, physical_sizes=sizes, periodic=True)
    high = 0.5 / max(surface.pixel_size)
    edges = np.geomspace(min(1 / size for size in sizes) * (1 - 1e-9), high * (1 + 1e-9), 2)
    count = math.ceil(20 * math.log10(edges[1] / edges[0]))
    edges = 2 * math.pi * np.geomspace(edges[0], edges[1], count + 1)
    _, theirs = other.power_spectrum_from_area(collocation=edges, window="None", reliable=False)
    theirs = np.ma.filled(theirs, math.nan)
    assert found.psd == pytest.approx(theirs[np.isfinite(theirs)], rel=1e-9)


# Input


def test_input_that_has_no_spectrum():
    small = mf.Surface(np.random.default_rng(1).normal(size=(12, 40)), 1.0)
    with pytest.raises(mf.SurfaceError, match="at least 16 x 16 pixels, got 40 x 12"):
        mf.spectrum(small)
    y, x = np.mgrid[0:20, 0:30] * 1.0
    with pytest.raises(mf.SurfaceError, match="the map is flat"):
        mf.spectrum(mf.Surface(0.3 * x + 0.1 * y, 1.0))
    with pytest.raises(mf.SurfaceError, match="window must be None or the name"):
        mf.spectrum(mf.sample_terrain(), window="nonesuch")


def test_heights_and_pixels_of_any_size():
    surface = mf.sample_terrain().level()
    here = mf.spectrum(surface)
    there = mf.spectrum(mf.Surface(surface.heights * 1e-100, [1e-10 * size for size in surface.pixel_size]))
    assert there.psd / here.psd == pytest.approx(np.full(here.psd.size, 1e-220), rel=1e-6, abs=0)
    assert there.Std == pytest.approx(here.Std)
    assert abs(there.abc.C - here.abc.C) < 1e-3


# The command


def test_the_command_prints_the_density_and_its_parameters(tmp_path):
    path = tmp_path / "map.npz"
    surface = mf.Surface(with_spectrum(abc, (128, 128)), 1e-6)
    np.savez(path, heights=surface.heights, pixel_size=1e-6)
    result = CliRunner().invoke(main, ["spectrum", str(path)])
    assert result.exit_code == 0, result.stderr
    parameters, density = (part.splitlines() for part in result.stdout.split("\n\n"))
    found = mf.spectrum(surface.level())
    assert len(density) == 1 + found.psd.size
    assert float(density[-1].split("\t")[2]) == pytest.approx(found.psd[-1], rel=1e-3)
    assert parameters[1].startswith("Sal\t")
    answer = json.loads(CliRunner().invoke(main, ["spectrum", str(path), "--json"]).stdout)
    assert answer["spectrum"]["psd"] == pytest.approx(found.psd.tolist(), rel=1e-5)
    assert len(answer["spectrum"]["angular"]) == 180
    assert answer["spectrum"]["window"] == "hann"
    periodic = CliRunner().invoke(
        main, ["spectrum", str(path), "--window", "none", "--level", "none", "--json"]
    )
    assert json.loads(periodic.stdout)["spectrum"]["window"] is None


@pytest.mark.parametrize("options", [["--window", "kaiser"], ["--threshold", "2"], ["--slopes", "opengl"]])
def test_the_command_says_what_is_wrong(tmp_path, options):
    path = tmp_path / "map.npz"
    np.savez(path, heights=np.random.default_rng(1).normal(size=(40, 40)), pixel_size=1.0)
    result = CliRunner().invoke(main, ["spectrum", str(path), *options])
    assert result.exit_code == 2
    assert result.stderr.count("\n") <= 3
    assert "Traceback" not in result.stderr
