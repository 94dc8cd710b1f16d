"""ISO 25178-2 of surfaces whose parameters are known by mathematics, and beside another library."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import integrate, optimize, special

import microfacet as mf
from lateral_cases import MAPS, NOT_SQUARE, by_surfalize, measured, normal_heights
from microfacet._surface import features
from microfacet._surface.parameters import PARAMETERS


def ramp() -> mf.Surface:
    """Heights from -1 to 1, all of them different."""
    return mf.Surface(np.linspace(-1.0, 1.0, 10_000).reshape(100, 100), 1.0)


# Material ratio


def test_a_ramp_is_all_core():
    """Its material ratio curve is a straight line from 1 to -1."""
    found = mf.roughness(ramp())
    assert found.Sk == pytest.approx(2, rel=2e-3)
    assert (found.Spk, found.Svk) == pytest.approx((0, 0), abs=2e-3)
    assert (found.Smrk1, found.Smrk2) == pytest.approx((0, 1), abs=1e-3)
    volumes = (0.1**2, 0.8**2 - 0.1**2, 0.9**2 - 0.2**2, 0.2**2)
    assert (found.Vmp, found.Vmc, found.Vvc, found.Vvv) == pytest.approx(volumes, rel=3e-3)
    assert found.Smr == pytest.approx(0.5, abs=1e-3)
    assert found.Sxp == pytest.approx(2 * (0.5 - 0.025), rel=2e-3)


def test_normal_heights_have_the_core_of_the_normal_distribution():
    """Of the curve -ndtri(p), whose flattest 40 % lie about the middle."""
    line = integrate.quad(lambda p: -special.ndtri(p) * (p - 0.5), 0.3, 0.7)[0] * 12 / 0.4**3
    upper = -line / 2
    first = float(special.ndtr(-upper))
    peaks = integrate.quad(lambda p: -special.ndtri(p) - upper, 0, first)[0]
    found = mf.roughness(mf.Surface(normal_heights(), 1.0))
    assert found.Sk == pytest.approx(-line, rel=1e-3)
    assert (found.Smrk1, found.Smrk2) == pytest.approx((first, 1 - first), abs=2e-4)
    assert (found.Spk, found.Svk) == pytest.approx((2 * peaks / first,) * 2, rel=1e-3)


def test_normal_heights_have_the_volumes_of_the_normal_distribution():
    def above(height):  # the mean of (z - height)+
        return math.exp(-height * height / 2) / math.sqrt(2 * math.pi) - height * special.ndtr(-height)

    tenth, fifth = -special.ndtri(0.1), special.ndtri(0.2)
    expected = {
        "Vmp": above(tenth),
        "Vmc": above(fifth) - above(tenth),
        "Vvc": above(-tenth) - above(-fifth),
        "Vvv": above(-fifth),
        "Sxp": -special.ndtri(0.025),
    }
    found = mf.roughness(mf.Surface(normal_heights(), 1.0))._asdict()
    assert {name: found[name] for name in expected} == pytest.approx(expected, rel=2e-3)


def test_a_map_upside_down_swaps_peaks_and_pits():
    surface = mf.synthesize(mf.StudentT(alpha=0.3, gamma=3.0), (256, 256))
    here, there = mf.roughness(surface), mf.roughness(mf.Surface(-surface.heights, surface.pixel_size))
    for one, other in (("S5p", "S5v"), ("Sp", "Sv")):
        assert getattr(here, one) == pytest.approx(getattr(there, other), rel=1e-9)
    # the core begins at a whole pixel of the order, and ends between two
    assert (here.Sk, here.Spk, here.Svk) == pytest.approx((there.Sk, there.Svk, there.Spk), rel=1e-3)
    for same in ("Sq", "Sa", "Sdq", "Sdr", "Sdq_adjacent", "Sdr_adjacent"):
        assert getattr(here, same) == pytest.approx(getattr(there, same), rel=1e-9)


def test_ratios_and_heights_invert_each_other():
    curve = mf.material_ratio(mf.sample_terrain().level())
    for ratio in (0.001, 0.2, 0.5, 0.987):
        assert curve.ratio(curve.height(ratio)) == pytest.approx(ratio, abs=1e-5)
    assert (curve.ratio(1e9), curve.ratio(-1e9)) == (0, 1)
    assert curve.material(1.0) == pytest.approx(-curve.height(1.0), rel=1e-5)  # all that is above the lowest
    assert curve.void(0.0) == pytest.approx(curve.height(0.0), rel=1e-5)


def test_a_ratio_beyond_one_is_refused():
    with pytest.raises(mf.SurfaceError, match=r"material ratio must lie in \[0, 1\], got 2.5"):
        mf.material_ratio(ramp()).height(2.5)


def test_plateaus_do_no_harm():
    heights = np.zeros((20, 20))
    heights[:2] = 1.0
    found = mf.roughness(mf.Surface(heights, 1.0))
    assert found.Sk == pytest.approx(0, abs=1e-12)
    assert all(
        math.isfinite(value) for name, value in found._asdict().items() if name not in ("S5p", "S5v", "S10z")
    )


# Stencils


def test_each_stencil_sees_a_wave_as_its_differences_do():
    """A wave of n pixels loses sinc(2/n) to central differences and sinc(1/n) to those of adjacent pixels."""
    n, height = 8, 1e-3
    x = np.arange(800) + 0.5
    found = mf.roughness(mf.Surface(np.tile(height * np.sin(2 * np.pi * x / n), (4, 1)), 1.0))
    slope = height * 2 * np.pi / n / math.sqrt(2)
    assert found.Sdq == pytest.approx(slope * np.sinc(2 / n), rel=1e-3)
    assert found.Sdq_adjacent == pytest.approx(slope * np.sinc(1 / n), rel=3e-3)
    assert found.Sdr_adjacent == pytest.approx(found.Sdq_adjacent**2 / 2, rel=3e-3)


@pytest.mark.parametrize("slopes", [(0.75, 0.0), (0.3, -0.4)])
def test_a_tilted_plane_has_one_slope_whatever_the_stencil(slopes):
    y, x = np.mgrid[0:20, 0:30] * np.array([2.0, 0.5])[:, np.newaxis, np.newaxis]
    found = mf.roughness(mf.Surface(slopes[0] * x + slopes[1] * y, (0.5, 2.0)))
    steep = math.hypot(*slopes)
    assert found.Sdq == pytest.approx(steep) == found.Sdq_adjacent
    assert found.Sdr == pytest.approx(math.sqrt(1 + steep**2) - 1) == found.Sdr_adjacent


def test_missing_pixels_count_in_no_difference():
    heights = np.tile(np.arange(30.0) * 0.5, (30, 1))
    mask = np.random.default_rng(1).random(heights.shape) < 0.8
    found = mf.roughness(mf.Surface(heights, 1.0, mask=mask))
    assert (found.Sdq, found.Sdq_adjacent) == pytest.approx((0.5, 0.5))


# Hills and dales


def cones(tops: np.ndarray, apart: int = 13) -> np.ndarray:
    """The highest of cones of slope 1 with summits on a lattice: each is a hill, those around are open."""
    rows, columns = tops.shape
    y, x = np.mgrid[: rows * apart, : columns * apart]
    summits = [
        tops[i, j] - np.hypot(y - (i + 0.5) * apart, x - (j + 0.5) * apart)
        for i in range(rows)
        for j in range(columns)
    ]
    return np.max(summits, axis=0)


def test_five_point_height_is_the_mean_of_the_five_highest_hills_within_the_map():
    tops = np.random.default_rng(1).uniform(0, 4, size=(5, 5))
    tops[0, 2] = 5.0  # at the edge, where it does not count
    surface = mf.Surface(cones(tops, 12), 1.0)  # of an even number, so that summits are pixels
    highest = np.sort(tops[1:-1, 1:-1].ravel())[-5:]
    assert mf.roughness(surface).S5p == pytest.approx(highest.mean() - surface.heights.mean())


def test_a_hill_that_is_hardly_one_does_not_count():
    """A bump of a third of the threshold on the flank of a cone goes, one of four times that stays."""
    heights = cones(np.full((3, 3), 5.0))
    valid = np.ones_like(heights, dtype=bool)
    for bump, remains in ((0.3, 1), (4.0, 2)):
        bumped = heights.copy()
        bumped[19, 23] = heights[19, 22] + bump
        assert features._significant(bumped, valid, 1.0, 1.0).size == remains


def test_a_map_without_hills_within_has_no_ten_point_height():
    found = mf.roughness(ramp())
    assert math.isnan(found.S5p)
    assert math.isnan(found.S10z)


def test_pruning_leaves_the_peaks_of_that_persistence():
    """The peaks that pruning leaves are those from which every way to a higher one leads down that far."""
    heights = np.random.default_rng(4).normal(size=(30, 30)).round(1)  # with ties
    threshold, valid = 1.5, np.ones((30, 30), dtype=bool)
    labels, count = features._basins(heights, valid, 1.0)
    graph = features._neighbours(labels, count, heights, 1.0)
    parent = features._joined(graph, threshold)
    left = sorted(graph.peaks[parent == np.arange(count)])
    order = np.argsort(-heights.ravel(), kind="stable")  # flood from above, joining what meets
    owner, expected = {}, []

    def root(k):
        while owner[k] != k:
            k = owner[k]
        return k

    flat = heights.ravel()
    born = {}
    for k in order.tolist():
        i, j = divmod(k, 30)
        owner[k], born[k] = k, flat[k]
        for a in range(max(i - 1, 0), min(i + 2, 30)):
            for b in range(max(j - 1, 0), min(j + 2, 30)):
                if a * 30 + b in owner:
                    one, two = sorted((root(k), root(a * 30 + b)), key=lambda r: born[r])
                    if one != two:
                        owner[one] = two
                        if born[one] - flat[k] >= threshold:
                            expected.append(born[one])
    expected.append(flat.max())
    assert left == pytest.approx(sorted(expected))


# Beside surfalize, which has the standard's definitions


@pytest.mark.filterwarnings(NOT_SQUARE)
@pytest.mark.parametrize("name", MAPS)
def test_parameters_are_those_of_surfalize(name):
    surface = measured(name)
    dx, dy = surface.pixel_size
    other = by_surfalize(surface.heights * 1e6, dx * 1e6, dy * 1e6)
    found = mf.roughness(surface)
    for parameter in ("Sq", "Sa", "Sz", "Sp", "Sv", "S5p", "S5v", "S10z"):
        assert getattr(found, parameter) == pytest.approx(getattr(other, parameter)() * 1e-6, rel=1e-9)
    assert (found.Ssk, found.Sku) == pytest.approx((other.Ssk(), other.Sku()), rel=1e-9)
    assert found.Sdq_adjacent == pytest.approx(other.Sdq(), rel=1e-9)
    assert found.Sdr_adjacent == pytest.approx(other.Sdr() / 100, rel=1e-9)
    # surfalize takes the curve at ten thousand ratios, and areas up to the nearest of them
    curve = {
        "Sk": 2e-4,
        "Spk": 5e-3,
        "Svk": 2e-3,
        "Sxp": 2e-4,
        "Vmp": 2e-3,
        "Vmc": 2e-3,
        "Vvc": 2e-3,
        "Vvv": 2e-3,
    }
    for parameter, near in curve.items():
        assert getattr(found, parameter) == pytest.approx(getattr(other, parameter)() * 1e-6, rel=near)
    assert found.Smrk1 == pytest.approx(other.Smrk1() / 100, abs=1e-4)
    assert found.Smrk2 == pytest.approx(other.Smrk2() / 100, abs=1e-4)
    assert 1.05 < found.Sdq_adjacent / found.Sdq < 1.25  # each says which it is


# Names, memory


def test_every_parameter_has_a_unit_and_a_meaning():
    assert PARAMETERS.keys() == {*mf.Roughness._fields, "Sal", "Str", "Std"}


def test_lengths_scale_with_the_unit_and_numbers_do_not():
    surface = mf.sample_terrain().level()
    here = mf.roughness(surface)
    there = mf.roughness(mf.Surface(surface.heights * 1e-6, [1e-6 * size for size in surface.pixel_size]))
    for name, value in here._asdict().items():
        factor = 1e-6 if PARAMETERS[name].unit == "m" else 1.0
        assert getattr(there, name) == pytest.approx(value * factor, rel=1e-9, nan_ok=True)


def test_results_do_not_depend_on_the_number_of_threads(monkeypatch):
    surface = mf.synthesize(mf.Beckmann(alpha=0.3), (800, 800))
    found = []
    for count in ("1", "3"):
        monkeypatch.setenv("MICROFACET_THREADS", count)
        found.append(mf.roughness(surface))
    assert found[0] == found[1]


def test_the_flattest_forty_per_cent_are_found_wherever_they_lie():
    """A plateau with steep flanks, given by its material ratio curve."""

    def height(p):
        return np.where(p < 0.2, 1 + (0.2 - p) * 20, np.where(p < 0.7, 1 - (p - 0.2), 0.5 - (p - 0.7) * 9))

    ratios = np.linspace(0, 1, 160_000)
    surface = mf.Surface(np.random.default_rng(0).permutation(height(ratios)).reshape(400, 400), 1.0)
    found = mf.roughness(surface)
    upper = 1.2  # the line of slope -1 through the plateau, at ratio 0
    first = optimize.brentq(lambda p: float(height(p)) - upper, 0, 0.5)
    assert found.Sk == pytest.approx(1.0, rel=1e-3)
    assert found.Smrk1 == pytest.approx(first, abs=1e-3)
    peaks = integrate.quad(lambda p: float(height(p)) - upper, 0, first)[0]
    assert found.Spk == pytest.approx(2 * peaks / first, rel=3e-3)
