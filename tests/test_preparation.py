"""Levelling, form, outliers, filters, axes and roughness parameters of surfaces whose answer is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

import microfacet as mf


def grid(ny, nx, dx, dy):
    y, x = np.mgrid[0:ny, 0:nx]
    return x * dx, y * dy


@pytest.mark.parametrize("degree", [1, 2, 3, 7])
def test_a_polynomial_is_removed_exactly_whatever_is_masked(degree):
    rng = np.random.default_rng(degree)
    x, y = grid(31, 42, 2 / 41, 2 / 30)
    x, y = x - 1, y - 1
    shape = sum(rng.normal() * x**i * y**j for i in range(degree + 1) for j in range(degree + 1 - i))
    valid = rng.random(x.shape) < 0.6
    surface = mf.Surface(1e3 + shape, 1e-6, mask=valid)
    left = surface.level(degree=degree)
    assert np.abs(left.heights[valid]).max() < 1e-10  # of heights around 1000
    assert np.array_equal(left.mask, valid)
    name = "plane" if degree == 1 else f"polynomial of degree {degree}"
    assert left.steps == (f"levelled: least-squares {name} subtracted",)
    if degree > 1:
        assert surface.remove_form(degree).steps == (f"form removed: least-squares {name}",)


def test_a_polynomial_of_high_degree_satisfies_the_normal_equations():
    rng = np.random.default_rng(3)
    heights, valid = rng.normal(size=(40, 50)), rng.random((40, 50)) < 0.8
    left = np.where(valid, mf.Surface(heights, 1.0, mask=valid).level(degree=9).heights, 0.0)
    x, y = np.linspace(-1, 1, 50)[np.newaxis, :], np.linspace(-1, 1, 40)[:, np.newaxis]
    for i in range(10):
        for j in range(10 - i):
            assert abs(np.mean(left * x**i * y**j)) < 1e-13


def test_three_points_lie_on_the_plane_that_is_subtracted():
    rng = np.random.default_rng(1)
    x, y = grid(30, 40, 1e-6, 3e-6)
    tilted = mf.Surface(0.3 * x - 0.2 * y + 1e-5, (1e-6, 3e-6))
    points = [(0, 0), (39, 2), (5, 29)]
    levelled = tilted.level("three-point", points=points)
    assert np.abs(levelled.heights).max() < 1e-19
    rough = mf.Surface(tilted.heights + 1e-6 * rng.normal(size=x.shape), (1e-6, 3e-6))
    levelled = rough.level("three-point", points=[(10, 10), (30, 10), (20, 25)])
    for column, row in ((10, 10), (30, 10), (20, 25)):
        assert abs(levelled.heights[row - 2 : row + 3, column - 2 : column + 3].mean()) < 1e-19
    assert "(10, 10), (30, 10), (20, 25)" in levelled.steps[0]


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("radius", [2e-4, 5e-2])
def test_a_sphere_is_removed_and_its_radius_found(sign, radius):
    x, y = grid(60, 80, 2e-6, 2e-6)
    cap = sign * np.sqrt(radius**2 - (x - 9e-5) ** 2 - (y - 4e-5) ** 2)
    noise = 1e-9 * np.random.default_rng(0).normal(size=x.shape)
    left = mf.Surface(cap + noise, 2e-6).remove_form("sphere")
    assert np.std(left.heights) == pytest.approx(1e-9, rel=0.05)
    assert float(left.steps[0].split()[-2]) == pytest.approx(sign * radius, rel=2e-3)


@pytest.mark.parametrize("degrees", [0.0, 37.0, 90.0, 150.0])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_cylinder_is_removed_with_its_radius_and_axis(degrees, sign):
    x, y = grid(70, 90, 2e-6, 2e-6)
    angle = math.radians(degrees)
    along, across = (
        x * math.cos(angle) + y * math.sin(angle),
        y * math.cos(angle) - x * math.sin(angle) - 1e-5,
    )
    heights = sign * np.sqrt(4e-4**2 - across**2) + 0.02 * along
    noise = 1e-9 * np.random.default_rng(0).normal(size=x.shape)
    left = mf.Surface(heights + noise, 2e-6).remove_form("cylinder")
    assert np.std(left.heights) == pytest.approx(1e-9, rel=0.05)
    words = left.steps[0].replace(",", "").split()
    assert float(words[6]) == pytest.approx(sign * 4e-4, rel=2e-3)
    assert math.cos(2 * (math.radians(float(words[10])) - angle)) > 1 - 1e-6


def test_spikes_are_masked_and_nothing_else():
    rng = np.random.default_rng(2)
    x, y = grid(60, 70, 1.0, 1.0)
    heights = 5 * x + 0.1 * x * y + 0.01 * rng.normal(size=x.shape)  # form and tilt do not matter
    valid = rng.random(x.shape) < 0.9
    spikes = rng.permutation(np.flatnonzero(valid))[:25]
    heights.flat[spikes] += 20 * rng.choice([-1, 1], 25)
    cleaned = mf.Surface(heights, 1.0, mask=valid).mask_outliers(12.0)
    expected = valid.copy()
    expected.flat[spikes] = False
    assert np.array_equal(cleaned.mask, expected)
    assert cleaned.steps[0].startswith(f"25 outliers of {valid.sum()} pixels masked: beyond 12 ")


def test_a_spike_on_a_quantised_map_is_an_outlier_though_the_deviation_is_zero():
    heights = np.repeat(np.arange(20.0), 20).reshape(20, 20)
    heights[8, 8] = 100.0
    assert not mf.Surface(heights, 1.0).mask_outliers().mask[8, 8]


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("waves", [0.5, 1.0, 2.0, 4.0])
def test_the_gaussian_filter_transmits_half_at_the_cut_off(axis, waves):
    """ISO 16610-61: the amplitude of a wave of length w is multiplied by 2^-(cutoff/w)^2."""
    size, cutoff = (2e-6, 3e-6), 60e-6
    x, y = grid(200, 200, *size)
    wave = np.sin(2 * math.pi * (y if axis == 0 else x) * waves / cutoff)
    low = mf.Surface(wave, size).filtered(short=cutoff).heights
    high = mf.Surface(wave, size).filtered(long=cutoff).heights
    inner = (slice(60, -60), slice(60, -60))  # away from the edges
    gain = np.sum(low[inner] * wave[inner]) / np.sum(wave[inner] ** 2)
    assert gain == pytest.approx(2.0 ** -(waves**2), abs=1e-6)
    assert low + high == pytest.approx(wave, abs=1e-12)


def test_nothing_leaks_into_a_filter_from_missing_pixels_or_beyond_the_edge():
    rng = np.random.default_rng(4)
    valid = rng.random((50, 60)) < 0.5
    constant = mf.Surface(np.full((50, 60), 7.5), 1.0, mask=valid)
    assert constant.filtered(short=9.0).heights[valid] == pytest.approx(7.5, abs=1e-12)
    heights = rng.normal(size=(50, 60))
    one = mf.Surface(heights, 1.0, mask=valid).filtered(short=9.0)
    other = mf.Surface(np.where(valid, heights, 1e9), 1.0, mask=valid).filtered(short=9.0)
    assert np.array_equal(one.heights, other.heights, equal_nan=True)
    assert np.array_equal(one.mask, valid)


@pytest.mark.parametrize("cutoff", [8.0, 300.0])  # within the map, and far beyond it
def test_the_filter_is_the_weighted_mean_of_the_standard(cutoff):
    rng = np.random.default_rng(5)
    heights, valid = rng.normal(size=(9, 11)), rng.random((9, 11)) < 0.7
    x, y = grid(9, 11, 2.0, 3.0)
    alpha2 = math.log(2) / math.pi
    low = mf.Surface(heights, (2.0, 3.0), mask=valid).filtered(short=cutoff).heights
    for row, column in np.argwhere(valid):
        r2 = (x - x[row, column]) ** 2 + (y - y[row, column]) ** 2
        weight = valid * np.exp(-math.pi * r2 / (alpha2 * cutoff**2))
        # both truncate, at least 6 standard deviations out
        assert low[row, column] == pytest.approx(np.sum(weight * heights) / np.sum(weight), abs=1e-7)


def test_lags_in_metres():
    surface = mf.Surface(np.zeros((20, 20)) + np.arange(20), 2e-6)
    assert surface.at_lag(length=7e-6).lag == 4  # 3.5 pixels: to even
    assert surface.at_lag(3).lag_length == pytest.approx(6e-6)
    assert surface.at_lag(length=6.1e-6).steps == ("slopes over a lag of 3 pixels for 6.1e-06 m",)
    assert surface.at_lag(3).steps == ()


@pytest.mark.parametrize("degrees", [-60.0, 0.0, 25.0, 90.0])
def test_principal_axes_follow_the_grooves(degrees):
    rng = np.random.default_rng(6)
    x, y = grid(128, 128, 1.0, 1.0)
    angle = math.radians(degrees)
    along = x * math.cos(angle) + y * math.sin(angle)
    across = y * math.cos(angle) - x * math.sin(angle)
    heights = sum(
        rng.normal() * np.sin(k * along + rng.uniform(0, 6)) + 0.2 * rng.normal() * np.sin(k * across)
        for k in np.linspace(0.1, 0.4, 12)
    )
    surface = mf.Surface(heights, 1.0)
    axes = surface.principal_axes()
    assert math.cos(2 * (axes.angle - angle)) > 0.99
    assert -math.pi / 2 < axes.angle <= math.pi / 2
    assert axes.along > 3 * axes.across
    turned = surface.slopes(principal=True)
    covariance = np.cov(turned.T)
    assert abs(covariance[0, 1]) < 1e-12
    assert np.sqrt(np.diag(covariance)) == pytest.approx([axes.along, axes.across])
    assert np.hypot(*turned.T) == pytest.approx(np.hypot(*surface.slopes().T))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda s: s.level("curved"), "kind must be"),
        (lambda s: s.level("polynomial"), "degree"),
        (lambda s: s.level("three-point", degree=2, points=[(0, 0), (1, 0), (0, 1)]), "degree"),
        (lambda s: s.level(degree=13), r"degree must be a whole number in \[1, 12\]"),
        (lambda s: s.level(degree=True), "degree"),
        (lambda s: s.level(degree=2.0), "degree"),
        (lambda s: s.level("three-point"), "needs points"),
        (lambda s: s.level("three-point", points=[(0, 0), (1, 1)]), "needs points"),
        (lambda s: s.level("three-point", points=[(2, 2), (5, 5), (7, 7)]), "one line"),
        (lambda s: s.level("three-point", points=[(0, 0), (50, 0), (0, 9)]), "on the map of 12 x 10"),
        (lambda s: s.level("plane", points=[(0, 0), (5, 0), (0, 5)]), "points"),
        (lambda s: s.remove_form("cube"), "sphere"),
        (lambda s: s.remove_form(1), r"\[2, 12\]"),
        (lambda s: s.mask_outliers(0.0), "threshold"),
        (lambda s: s.mask_outliers(math.nan), "threshold"),
        (lambda s: s.mask_outliers("many"), "threshold"),
        (lambda s: s.filtered(short=1e-6), "less than two pixels"),
        (lambda s: s.filtered(long=-1.0), "cut-off of the L-filter must be"),
        (lambda s: s.filtered(short=1.0, long=0.5), "shorter"),
        (lambda s: s.filtered(short=math.inf), "cut-off"),
        (lambda s: s.at_lag(), "either"),
        (lambda s: s.at_lag(1, length=1.0), "either"),
        (lambda s: s.at_lag(0), "lag"),
        (lambda s: s.at_lag(length=1e-9), "half a pixel"),
        (lambda s: s.at_lag(length=math.inf), "lag length"),
        (lambda s: mf.roughness(mf.Surface(np.zeros((5, 5)), 1.0)), "all heights are equal"),
    ],
)
def test_bad_arguments_are_one_sentence(call, message):
    surface = mf.Surface(np.random.default_rng(0).normal(size=(10, 12)), 1e-6)
    with pytest.raises(mf.SurfaceError, match=message) as caught:
        call(surface)
    assert "\n" not in str(caught.value)


def test_a_flat_map_has_no_sphere():
    with pytest.raises(mf.SurfaceError, match="no curvature"):
        mf.Surface(np.zeros((9, 9)), 1.0).remove_form("sphere")


# Roughness parameters


def test_roughness_of_a_tilted_plane():
    x, y = grid(20, 33, 2e-6, 3e-6)
    plane = mf.Surface(0.3 * x - 0.4 * y, (2e-6, 3e-6))
    found = mf.roughness(plane)
    assert found.Sdq == pytest.approx(0.5, rel=1e-12)
    assert found.Sdr == pytest.approx(math.sqrt(1.25) - 1, rel=1e-12)
    assert found.Sz == pytest.approx(np.ptp(plane.heights), rel=1e-12)
    assert found.Sp == pytest.approx(found.Sv, rel=1e-12)
    assert found.Ssk == pytest.approx(0.0, abs=1e-12)


def test_roughness_of_a_nearly_flat_plane_does_not_cancel():
    x, _ = grid(20, 20, 1.0, 1.0)
    assert mf.roughness(mf.Surface(1e-9 * x, 1.0)).Sdr == pytest.approx(5e-19, rel=1e-9)


def test_roughness_of_a_sine():
    """Whole periods of A sin(k x): Sq = A/sqrt 2, Sa = 2 A/pi, Sku = 3/2; slopes A k cos(k x)."""
    amplitude, periods, n = 2.0, 5, 4000
    k = 2 * math.pi * periods / n
    x, _ = grid(8, n, 1.0, 1.0)
    found = mf.roughness(mf.Surface(amplitude * np.sin(k * x + 0.5), 1.0))
    assert found.Sq == pytest.approx(amplitude / math.sqrt(2), rel=1e-12)
    assert found.Sa == pytest.approx(2 * amplitude / math.pi, rel=1e-5)
    assert found.Ssk == pytest.approx(0.0, abs=1e-12)
    assert found.Sku == pytest.approx(1.5, rel=1e-12)
    assert found.Sz == pytest.approx(2 * amplitude, rel=1e-5)
    slope = amplitude * k
    assert found.Sdq == pytest.approx(slope / math.sqrt(2), rel=1e-3)
    angle = np.linspace(0, math.pi, 2001)
    length = np.trapezoid(np.sqrt(1 + (slope * np.cos(angle)) ** 2), angle) / math.pi
    assert found.Sdr == pytest.approx(length - 1, rel=2e-3)


def test_roughness_excludes_what_is_masked():
    rng = np.random.default_rng(7)
    heights = rng.normal(size=(30, 30))
    valid = np.ones((30, 30), dtype=bool)
    valid[:, 20:] = False
    masked = mf.roughness(mf.Surface(np.where(valid, heights, 1e6), 1.0, mask=valid))
    cropped = mf.roughness(mf.Surface(heights[:, :20], 1.0))
    assert masked == pytest.approx(cropped, rel=1e-12)


def test_sdq_of_a_beckmann_surface_is_its_alpha():
    x, y = grid(256, 256, 1.0, 1.0)
    rng = np.random.default_rng(8)
    waves = [(rng.normal(), rng.normal(), rng.uniform(0, 2 * math.pi)) for _ in range(200)]
    heights = sum(np.cos(0.1 * (a * x + b * y) + phase) for a, b, phase in waves)
    found = mf.roughness(mf.Surface(heights, 1.0))
    variance = sum(0.01 * (a * a + b * b) / 2 for a, b, _ in waves)
    assert found.Sdq == pytest.approx(math.sqrt(variance), rel=0.05)
