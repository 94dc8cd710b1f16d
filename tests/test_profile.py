"""Profiles: slopes, preparation and parameters against closed forms and other libraries."""

from __future__ import annotations

import copy
import math
import pickle
import warnings

import numpy as np
import pytest
from scipy import ndimage

import microfacet as mf
from surface_file_cases import refused

RNG = np.random.default_rng(7)
X = np.arange(4000) * 0.5e-6


def sine(wavelength, amplitude=1e-6, x=X):
    return amplitude * np.sin(2 * np.pi * x / wavelength + 0.3)


# Slopes


@pytest.mark.parametrize("lag", [1, 2, 7])
def test_slopes_of_a_parabola_are_its_derivative(lag) -> None:
    profile = mf.Profile(0.5 * np.arange(40.0) ** 2, spacing=1.0, lag=lag)
    np.testing.assert_allclose(profile.slopes(), np.arange(40.0)[lag:-lag], rtol=1e-14)
    assert profile.lag_length == lag


def test_missing_points_cost_the_slopes_that_need_them_and_traces_do_not_mix() -> None:
    first, second = np.arange(10.0), 2 * np.arange(14.0)
    first[4] = math.nan
    profile = mf.Profile([first, second, [7.0, 7.0, 7.5]], spacing=2.0)
    slopes = profile.slopes(2)
    np.testing.assert_allclose(slopes, [0.5] * 4 + [1.0] * 10)  # the third trace is shorter than the baseline
    assert profile.points == 27
    assert profile.valid_fraction == 26 / 27
    assert profile.length == 26.0


def test_a_slope_along_a_row_is_the_first_slope_of_the_map() -> None:
    surface = mf.synthesize(mf.Beckmann(alpha=0.2), (64, 96), (1e-6, 2e-6), seed=2)
    grid = surface.slopes().reshape(62, 94, 2)
    np.testing.assert_array_equal(mf.Profile.from_surface(surface, row=11).slopes(), grid[10, :, 0])
    columns = mf.Profile.from_surface(surface, column=[3, -3])
    assert columns.spacing == 2e-6
    np.testing.assert_array_equal(columns.slopes(), np.concatenate((grid[:, 2, 1], grid[:, -3 + 1, 1])))
    assert columns.steps[-1] == "cut along 2 columns: 3, 93"
    assert columns.steps[0] == surface.steps[0]


def test_slopes_need_neighbours() -> None:
    profile = mf.Profile(np.arange(9.0), spacing=1.0)
    refused(lambda: profile.slopes(5), "no point has both of its neighbours at lag 5")
    refused(lambda: profile.slopes(0), "lag must be a whole number")
    refused(lambda: profile.at_lag(length=0.1), "less than half the spacing")
    assert profile.at_lag(length=2.2).lag == 2


# Input


@pytest.mark.parametrize(
    ("traces", "spacing", "message"),
    [
        ([], 1.0, "a profile is one trace of heights"),
        ("abc", 1.0, "a profile is one trace of heights"),
        (np.zeros((3, 4, 5)), 1.0, "got shape"),
        ([1.0, 2.0], 1.0, "at least 3 real numbers"),
        ([[1.0, 2.0, 3.0], [[1.0], [2.0]]], 1.0, "at least 3 real numbers"),
        (["a", "b", "c"], 1.0, "at least 3 real numbers"),
        (np.arange(8.0), 1.0, "8 valid points of 8, at least 9"),
        (np.full(20, np.nan), 1.0, "0 valid points of 20"),
        (np.full(20, 1e31), 1.0, r"\[-1e30, 1e30\]"),
        (np.arange(20.0), 0.0, "spacing must be a positive"),
        (np.arange(20.0), 1e-40, "spacing must lie"),
    ],
)
def test_what_is_no_profile_is_refused(traces, spacing, message) -> None:
    refused(lambda: mf.Profile(traces, spacing), message)


def test_a_profile_is_a_value() -> None:
    heights = RNG.normal(size=50)
    heights[3] = math.inf
    profile = mf.Profile(heights, 1e-6)
    assert profile == mf.Profile(np.ma.masked_invalid(heights), 1e-6)
    assert profile == pickle.loads(pickle.dumps(profile)) == copy.deepcopy(profile)
    assert hash(profile) == hash(copy.copy(profile))
    assert profile != mf.Profile(heights, 2e-6)
    with pytest.raises(ValueError, match="read-only"):
        profile.traces[0][0] = 1.0
    heights[0] = 99.0
    assert profile.traces[0][0] != 99.0


@pytest.mark.parametrize(
    ("where", "message"),
    [
        ({}, "give either row or column"),
        ({"row": 1, "column": 1}, "give either row or column"),
        ({"row": 64}, "row must name some of the 64 rows"),
        ({"row": slice(70, 80)}, "row must name some"),
        ({"column": []}, "column must name some"),
        ({"row": 1.5}, "row must name some"),
    ],
)
def test_cuts_that_are_none(where, message) -> None:
    surface = mf.Surface(RNG.normal(size=(64, 70)), 1e-6)
    refused(lambda: mf.Profile.from_surface(surface, **where), message)


# Preparation


def test_levelling_takes_polynomials_off_and_leaves_the_rest() -> None:
    x = np.linspace(-1, 1, 4000)
    ramp = mf.Profile([3 + 0.2 * x, 5 - 0.7 * x], 0.5e-6).level()
    assert max(abs(trace).max() for trace in ramp.traces) < 1e-14
    bent = 1 + x - 2 * x**2 + x**4
    bent[100:200] = math.nan
    level = mf.Profile(bent, 0.5e-6).level(4).traces[0]
    assert np.nanmax(abs(level)) < 1e-13
    assert np.isnan(level).sum() == 100
    wave = sine(20e-6)
    np.testing.assert_allclose(mf.Profile(wave + x, 0.5e-6).level().traces[0], wave, atol=2e-8)
    refused(
        lambda: mf.Profile([np.arange(20.0), [1.0, 2.0, 1.0]], 1.0).level(3), "3 valid points is too short"
    )


@pytest.mark.parametrize("radius", [5e-3, -0.2])
def test_a_circle_is_found(radius) -> None:
    x = (np.arange(2001) - 700) * 1e-6
    ball = math.copysign(1, radius) * np.sqrt(radius**2 - x**2) + 0.05 * (x * 0 + 1)
    straight = mf.Profile(ball, 1e-6).remove_form("circle")
    assert abs(straight.traces[0]).max() < 1e-12
    assert straight.steps == (f"form removed: least-squares circle of radius {radius:.4g} m",)
    refused(lambda: mf.Profile(np.arange(20.0), 1.0).remove_form("circle"), "no curvature")
    refused(lambda: mf.Profile(np.arange(20.0), 1.0).remove_form("sphere"), "form must be circle or")
    assert mf.Profile(x**2, 1e-6).remove_form(2).roughness().Rq < 1e-18


def test_spikes_go_and_slopes_stay() -> None:
    heights = sine(40e-6) + 5e-8 * RNG.normal(size=4000)
    heights[[100, 2000]] += 1e-5
    masked = mf.Profile([heights, sine(30e-6)], 0.5e-6).mask_outliers()
    assert list(np.flatnonzero(np.isnan(masked.traces[0]))) == [100, 2000]
    assert masked.steps[0].startswith("2 outliers of 8000 points masked")
    steps = np.repeat([0.0, 1e-6, 0.0, 2e-6], 100)  # a grating, mostly flat
    assert mf.Profile(steps, 1e-6).mask_outliers().valid_fraction == 1
    steps[50] = math.nan
    steps[250] = 1e-4
    assert np.flatnonzero(np.isnan(mf.Profile(steps, 1e-6).mask_outliers().traces[0])).tolist() == [50, 250]


@pytest.mark.parametrize("wavelength", [4e-6, 8e-6, 20e-6])
def test_filters_transmit_what_the_standard_says(wavelength) -> None:
    """ISO 16610-21: a wave of length w passes a cut-off c with the amplitude 2^-(c/w)^2."""
    profile = mf.Profile(sine(wavelength), 0.5e-6)
    inner = slice(200, -200)
    share = 2 ** -((8e-6 / wavelength) ** 2)
    low = profile.filtered(short=8e-6).traces[0][inner]
    high = profile.filtered(long=8e-6).traces[0][inner]
    np.testing.assert_allclose(low, share * sine(wavelength)[inner], atol=2e-10)
    np.testing.assert_allclose(high, (1 - share) * sine(wavelength)[inner], atol=2e-10)
    assert profile.filtered(long=8e-6).cutoff == 8e-6
    assert profile.filtered(short=8e-6).cutoff is None


def test_the_filter_is_scipys_away_from_ends_and_holes() -> None:
    heights = RNG.normal(size=3000)
    sigma = math.sqrt(math.log(2) / 2) / math.pi * 25
    theirs = ndimage.gaussian_filter1d(heights, sigma, truncate=8)
    holes = heights.copy()
    holes[1500] = math.nan
    ours = mf.Profile(holes, 1.0).filtered(short=25.0).traces[0]
    np.testing.assert_allclose(ours[100:1400], theirs[100:1400], atol=1e-8)
    assert np.isnan(ours[1500])
    level = mf.Profile([[5.0] * 40, [5.0] * 20 + [math.nan] * 3], 1.0).filtered(short=25.0)
    np.testing.assert_allclose(np.concatenate(level.traces)[:-3], 5.0)  # nothing leaks in from the ends
    refused(lambda: mf.Profile(heights, 1.0).filtered(short=1.0), "less than two spacings")
    refused(lambda: mf.Profile(heights, 1.0).filtered(5.0, 4.0), "must be shorter than the L-filter")


# Parameters


def test_parameters_of_a_sine() -> None:
    values = mf.Profile(sine(50e-6, 2e-6), 0.5e-6).roughness()
    assert values.Rq == pytest.approx(2e-6 / math.sqrt(2), rel=1e-12)
    assert values.Ra == pytest.approx(2e-6 * 2 / math.pi, rel=1e-3)
    assert values.Rku == pytest.approx(1.5, rel=1e-12)
    assert values.Rsk == pytest.approx(0, abs=1e-12)
    assert values.Rz == values.Rt == pytest.approx(4e-6, rel=1e-3)
    k = 2 * math.pi / 50e-6
    assert values.Rdq == pytest.approx(2e-6 * k / math.sqrt(2), rel=1e-3)
    # by differences over two spacings the slope of a wave is smaller by sin(k dx)/(k dx)
    assert values.rms_slope == pytest.approx(2e-6 * math.sin(k * 0.5e-6) / 0.5e-6 / math.sqrt(2), rel=1e-3)
    assert values.Rdr == pytest.approx(np.mean(np.sqrt(1 + (np.diff(sine(50e-6, 2e-6)) / 0.5e-6) ** 2)) - 1)


def test_the_derivative_of_the_standard_is_exact_for_polynomials_of_degree_six() -> None:
    x = np.arange(30) * 0.1
    coefficients = RNG.normal(size=7)
    derivative = np.polyval(np.polyder(coefficients), x[3:-3])
    values = mf.Profile(np.polyval(coefficients, x), 0.1).roughness()
    assert values.Rdq == pytest.approx(math.sqrt(np.mean(derivative**2)), rel=1e-12)


def test_sections_are_the_cut_off() -> None:
    """Rp, Rv and Rz are means over section lengths, Rt is the range of all."""
    heights = np.tile([0.0, 1.0, 0.0, -1.0], 100)
    heights[[1, 201]] = 5.0
    heights[303] = -3.0
    heights = heights - heights.mean()
    profile = mf.Profile(heights, 1.0)
    whole, sections = profile.roughness(), profile.roughness(section_length=80.0)
    peaks = [heights[k : k + 80].max() for k in range(0, 400, 80)]
    pits = [-heights[k : k + 80].min() for k in range(0, 400, 80)]
    assert sections.Rp == pytest.approx(np.mean(peaks))
    assert sections.Rv == pytest.approx(np.mean(pits))
    assert sections.Rz == pytest.approx(sections.Rp + sections.Rv)
    assert whole.Rz == whole.Rt == sections.Rt == pytest.approx(8.0)
    filtered = profile.filtered(long=80.0)
    assert filtered.roughness() == filtered.roughness(section_length=80.0)


def test_parameters_of_several_traces_are_means() -> None:
    profile = mf.Profile([sine(50e-6), sine(25e-6, 3e-6), sine(25e-6, 3e-6)[:2000]], 0.5e-6)
    each = [profile.roughness(trace=k) for k in range(3)]
    np.testing.assert_allclose(profile.roughness(), np.mean(each, axis=0), rtol=1e-12)
    assert each[0] == mf.Profile(sine(50e-6), 0.5e-6).roughness()
    refused(lambda: profile.roughness(trace=3), r"trace must be a whole number in \[0, 3\)")
    refused(lambda: mf.Profile(np.ones(20), 1.0).roughness(), "all heights of a trace are equal")


def test_parameters_agree_with_surface_topography() -> None:
    library = pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    heights = np.cumsum(RNG.normal(size=2000)) * 1e-9
    scan = library.UniformLineScan(heights, 2000 * 1e-7, unit="m")
    values = mf.Profile(heights, 1e-7).roughness()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # it calls them functions of statistics now
        assert values.Rq == pytest.approx(float(scan.rms_height_from_profile()), rel=1e-9)
    assert values.Rdq > values.rms_slope
    assert values.Rdr == pytest.approx(np.mean(np.hypot(1, np.diff(heights) / 1e-7)) - 1, rel=1e-9)


def test_the_spectrum_agrees_with_surface_topography() -> None:
    """Its spectra are two-sided and by wave number: half of ours times 1/(2 pi) of the step of frequency."""
    library = pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    surface = mf.synthesize(mf.Beckmann(alpha=0.2), (64, 4096), seed=1)
    heights = surface.heights[0]
    scan = library.UniformLineScan(heights, 4096e-6, unit="m")
    q, theirs = scan.power_spectrum_from_profile(window="hann", reliable=False, resampling_method=None)
    ours = mf.Profile(heights, 1e-6).psd(4096e-6)
    np.testing.assert_allclose(ours.frequencies[:-1], q[1:2048] / (2 * math.pi), rtol=1e-9)
    # the mean is taken off before the window, which the longest waves see
    np.testing.assert_allclose(ours.psd[20:500], 2 * theirs[21:501], rtol=0.02)


def test_a_surface_and_its_rows_have_the_same_roughness() -> None:
    """Of an isotropic map the mean square slope along the rows is half of that of the gradient."""
    surface = mf.synthesize(mf.Beckmann(alpha=0.3), (512, 512), seed=3)
    rows = mf.Profile.from_surface(surface, row=slice(None))
    assert len(rows) == 512
    slope = math.sqrt(np.mean([rows.roughness(trace=k).rms_slope ** 2 for k in range(512)]))
    assert slope == pytest.approx(mf.roughness(surface).Sdq / math.sqrt(2), rel=0.03)
    assert slope == pytest.approx(0.3 / math.sqrt(2), rel=0.03)


# Spectrum


def test_the_spectrum_integrates_to_the_variance() -> None:
    noise = RNG.normal(size=40_000)
    found = mf.Profile(noise, 2e-6).psd()
    total = np.sum(found.psd) * (found.frequencies[1] - found.frequencies[0])
    assert total == pytest.approx(np.var(noise), rel=0.01)
    assert np.median(found.psd) == pytest.approx(2 * 2e-6 * np.var(noise), rel=0.15)  # white: 2 dx variance
    assert found.segments == 7
    assert found.frequencies[-1] == pytest.approx(1 / (2 * 2e-6))


def test_the_spectrum_leaves_stretches_with_missing_points_out() -> None:
    heights = RNG.normal(size=4000)
    parts = [heights[:1500], heights[1501:]]
    holes = heights.copy()
    holes[1500] = math.nan
    one = mf.Profile(holes, 1.0).psd(500.0)
    two = mf.Profile(parts, 1.0).psd(500.0)
    np.testing.assert_allclose(one.psd, two.psd)
    assert one.segments == two.segments == 5 + 8
    refused(lambda: mf.Profile(holes, 1.0).psd(3000.0), "segments of 8 to 2499 points")


def test_the_spectrum_falls_as_the_filter_says() -> None:
    heights = RNG.normal(size=100_000)
    plain, smooth = (mf.Profile(heights, 1.0), mf.Profile(heights, 1.0).filtered(short=10.0))
    ratio = smooth.psd(200.0).psd / plain.psd(200.0).psd
    frequency = plain.psd(200.0).frequencies
    low = frequency < 0.15
    expected = 4.0 ** -((10.0 * frequency) ** 2)
    np.testing.assert_allclose(ratio[low], expected[low], rtol=0.15)
