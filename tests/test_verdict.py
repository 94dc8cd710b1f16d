"""Whether anything fits: the goodness test, halves, warnings, and where they are said."""

from __future__ import annotations

import copy
import html
import json
import math
import pickle

import numpy as np
import pytest
from click.testing import CliRunner
from scipy import stats

import fit_cases
import microfacet as mf
from microfacet._fit import blocks, pearson
from microfacet.cli import main

SIZE = 192
Y, X = np.mgrid[0:SIZE, 0:SIZE].astype(float)


def rough(seed, size=0.02):
    return size * np.random.default_rng(seed).normal(size=X.shape)


GRATINGS = {
    "sine": np.sin(0.3 * X) + rough(1, 1e-3),
    "blazed": 0.2 * (X % 20) + rough(2),
    "blazed and turned": 0.2 * ((X + 0.3 * Y) % 20) + rough(3),
    "terraces": np.round(
        mf.synthesize(
            mf.Beckmann(alpha=0.2), X.shape, 1.0, correlation_length=25.0, seed=1, pinned=True
        ).heights
    )
    + rough(4),
    "pyramids": 0.3 * np.minimum(np.abs(X % 24 - 12), np.abs(Y % 24 - 12)) + rough(5),
}


@pytest.mark.parametrize("name", GRATINGS)
def test_no_family_describes_regular_structures(name):
    results = mf.fit(mf.Surface(GRATINGS[name], 1.0), ["beckmann", "ggx", "student_t", "bessel_k", "gtr"])
    verdict = results.verdict
    assert not verdict.fits
    assert verdict.p_value < 1e-6
    assert verdict.deviation > 0.05
    assert verdict.sentence.startswith("no family describes these slopes")
    assert max(result.goodness.p_value for result in results) < 1e-6


@pytest.mark.parametrize("name", ["beckmann", "ggx", "student_t", "bessel_k", "gtr"])
def test_p_values_of_independent_slopes_are_uniform(name):
    """About the right family with fitted parameters, 80 samples of each."""
    case = next(case for case in fit_cases.cases() if case.family == name)
    found = [case.fit(case.slopes(2000, k)).goodness.p_value for k in range(80)]
    assert stats.kstest(found, "uniform").pvalue > mf.testing.sidak(0.01, 5)


@pytest.mark.parametrize("ndf", [mf.Beckmann(alpha=0.2), mf.GGX(alpha=0.2)], ids=repr)
def test_p_values_of_correlated_slopes_are_not_too_small(ndf):
    """Neighbours on a map depend on each other, of which the test has to know."""
    found = [
        mf.fit(mf.synthesize(ndf, (192, 192), seed=k), ndf.family, symmetry="isotropic")[0] for k in range(16)
    ]
    p_values = np.array([fit.goodness.p_value for fit in found])
    assert np.mean(p_values < 0.05) < 0.3
    assert np.mean(p_values > 0.5) > 0.2
    assert all(fit.n_effective < fit.n / 8 for fit in found)


def test_a_wrong_family_is_rejected_on_a_correlated_map():
    surface = mf.synthesize(mf.StudentT(alpha=0.2, gamma=2.5), (384, 384), seed=2)
    results = mf.fit(surface, ["student_t", "beckmann"], symmetry="isotropic")
    right, wrong = (result.goodness for result in results)
    assert results[0].family == "student_t"
    assert right.p_value > 0.01 > 1e-4 > wrong.p_value
    assert right.deviation < 0.03 < wrong.deviation


def test_a_million_slopes_reject_what_is_close_enough_and_both_is_said():
    case = fit_cases.Case("student_t", (*fit_cases.STRETCH.items(), ("gamma", 40.0)))
    results = mf.fit(case.slopes(1_000_000, 0), "beckmann")
    verdict = results.verdict
    assert not verdict.fits
    assert verdict.p_value < 1e-6
    assert verdict.deviation < 0.01
    assert "close enough" in verdict.sentence
    assert "%" in verdict.sentence


def test_slopes_whose_opposites_are_rarer_fit_no_family():
    """(p, q) has the law of a family in its squares: only the sides differ."""
    case = fit_cases.Case("beckmann", (("alpha_x", 0.3), ("alpha_y", 0.3), ("rotation", 0.0)))
    slopes = case.slopes(5000, 1)
    assert mf.fit(slopes, "beckmann").verdict.fits
    steep = np.hypot(*slopes.T) > 0.4
    slopes[steep] *= np.sign(np.cos(3 * np.arctan2(*slopes[steep].T)))[:, np.newaxis]
    verdict = mf.fit(slopes, "beckmann", symmetry="isotropic").verdict
    assert not verdict.fits
    assert "opposites" in verdict.sentence
    assert verdict.p_value < 1e-6


def test_the_law_of_a_sum_of_squares():
    """Equal variances: chi-squared; a covariance of ten waves of one number: F."""
    totals = np.array([1.0, 2.0, 0.5])
    known = pearson.probability(totals, pearson.Covariance(np.eye(3), math.inf))
    assert known == pytest.approx(stats.chi2.sf(5.25, 3))
    one = pearson.probability(np.array([2.0]), pearson.Covariance(np.eye(1), 10.0))
    assert one == pytest.approx(stats.f.sf(4.0, 1, 10))


def test_variances_of_totals_of_correlated_cells():
    """Moving averages over 3 x 3 cells: the variance of a total is 256 x 81 times that of a cell of noise,
    which sums over single cells miss by nine.
    """
    rng, estimates = np.random.default_rng(1), []
    for _ in range(200):
        noise = rng.normal(size=(18, 18))
        cells = sum(noise[i : i + 16, j : j + 16] for i in range(3) for j in range(3))
        cells = (cells - cells.mean()).ravel()
        (found,) = blocks.variances(cells, True)
        estimates.append(found.variance)
        assert found.error > math.sqrt(found.variance)
    assert np.mean(estimates) == pytest.approx(256 * 81, rel=0.25)
    assert np.var(cells) * 256 < 256 * 81 / 4


def ramp(seed):
    surface = mf.synthesize(mf.Beckmann(alpha=0.2), (192, 192), 1.0, seed=seed)
    return mf.Surface(surface.heights * (1 + X / SIZE), 1.0)


def test_a_map_whose_roughness_doubles_is_not_one_population():
    results = mf.fit(ramp(1), "beckmann", symmetry="isotropic")
    halves = results.halves
    assert halves.names == ("alpha",)
    left, right, lower, upper = (values[0] for values in halves.values)
    assert left < 0.27 < 0.32 < right
    assert lower == pytest.approx(upper, rel=0.1)
    # The roughness goes from 0.2 to 0.4: in regions its deviation is 0.2/sqrt(12) sqrt(15/16) of 0.3.
    assert halves.spread[0] == pytest.approx(0.2, abs=0.06)
    (said,) = [warning for warning in results.warnings if "not one population" in warning]
    assert "left half" in said
    assert "%" in said
    assert "\n" not in said


def test_halves_are_those_that_a_fit_of_each_gives():
    surface = mf.synthesize(mf.StudentT(alpha=0.2, gamma=3.0), (256, 256), 1.0, seed=4)
    results = mf.fit(surface, "student_t", symmetry="isotropic")
    for number, part in enumerate((np.s_[:, :128], np.s_[:, 128:], np.s_[:128], np.s_[128:])):
        (own,) = mf.fit(mf.Surface(surface.heights[part], 1.0), "student_t", symmetry="isotropic")
        found = dict(zip(results.halves.names, results.halves.values[number], strict=True))
        for name, value in own.params.items():
            assert found[name] == pytest.approx(value, abs=own.standard_errors[name]), name


def test_halves_of_one_population_agree():
    apart = [
        mf.fit(mf.synthesize(mf.Beckmann(alpha=0.2), (128, 128), seed=seed), "beckmann").halves.agree
        for seed in range(20)
    ]
    assert sum(apart) >= 15  # nine of ten, but for chance


def test_errors_of_an_inhomogeneous_map_hold_the_variance_between_regions():
    even = mf.synthesize(mf.Beckmann(alpha=0.3), (192, 192), 1.0, seed=1)
    errors = [
        mf.fit(surface, "beckmann", symmetry="isotropic")[0].standard_errors["alpha"]
        for surface in (even, ramp(1))
    ]
    assert errors[1] > 3 * errors[0]


def missing_cases():
    surface = mf.synthesize(mf.Beckmann(alpha=0.2), X.shape, 1.0, seed=5, pinned=True)
    random, steep, flat = (surface.heights.copy() for _ in range(3))
    gone = np.random.default_rng(1).random(X.shape) < 0.2
    random[gone] = math.nan
    size = np.hypot(*np.gradient(surface.heights))
    steep[size > np.quantile(size, 0.9)] = math.nan
    flat[size < np.quantile(size, 0.1)] = math.nan
    return random, steep, flat


def test_missing_data_that_is_not_random_is_warned_of():
    random, steep, flat = (
        mf.fit(mf.Surface(heights, 1.0), "beckmann").warnings for heights in missing_cases()
    )
    assert not any("missing" in warning for warning in random)
    assert any("not at random" in warning and "too small" in warning for warning in steep)
    assert any("not at random" in warning and "too large" in warning for warning in flat)


def test_a_normal_map_with_steep_pixels_missing_is_warned_of():
    heights = mf.synthesize(mf.Beckmann(alpha=0.2), X.shape, 1.0, seed=5, pinned=True).heights
    q, p = np.gradient(heights)
    grid = np.hypot(p, q) < 0.25
    sample = mf.SlopeSample(np.column_stack((p[grid], q[grid])), "normals", grid=grid)
    assert any("not at random" in warning for warning in mf.fit(sample, "beckmann").warnings)


@pytest.mark.parametrize(("factor", "said"), [(1e3, "typical slope"), (1e-9, "flatter than any")])
def test_implausible_roughness_is_warned_of(factor, said):
    surface = mf.synthesize(mf.Beckmann(alpha=0.2), (128, 128), 1e-6, seed=5)
    results = mf.fit(mf.Surface(factor * surface.heights, 1e-6), "beckmann")
    assert any(said in warning and "units" in warning for warning in results.warnings)
    assert not any("units" in warning for warning in mf.fit(surface, "beckmann").warnings)


def test_heights_in_metres_of_a_nanometre_file_are_asked_about():
    surface = mf.synthesize(mf.Beckmann(alpha=0.2), (64, 64), 1e-6, seed=5)
    with pytest.raises(ValueError, match="same unit"):
        mf.fit(mf.Surface(1e9 * surface.heights, 1e-6), "beckmann")


def test_quantised_heights_are_warned_of_with_their_step():
    heights = mf.synthesize(mf.Beckmann(alpha=0.2), X.shape, 1.0, seed=5, pinned=True).heights
    coarse = mf.fit(mf.Surface(np.round(heights / 0.2) * 0.2, 1.0), "beckmann").warnings
    fine = mf.fit(mf.Surface(np.round(heights / 0.01) * 0.01, 1.0), "beckmann").warnings
    (said,) = [warning for warning in coarse if "steps" in warning]
    assert "steps of 0.1 " in said  # over two pixels
    assert "heights of 0.2 m" in said
    assert not any("steps" in warning for warning in fine)


def test_normals_of_eight_bits_are_warned_of_where_the_roughness_is_near_their_step():
    rng = np.random.default_rng(3)
    warnings = []
    for alpha in (0.03, 0.3):
        slopes = alpha / math.sqrt(2) * rng.normal(size=(128 * 128, 2))
        length = np.sqrt(1 + np.sum(slopes**2, axis=1, keepdims=True))
        normals = np.round(127.5 * np.hstack((slopes, np.ones_like(length))) / length + 127.5) / 127.5 - 1
        values = normals[:, :2] / normals[:, 2:]
        sample = mf.SlopeSample(values, "normals", grid=np.ones((128, 128), bool))
        warnings.append(mf.fit(sample, "beckmann").warnings)
    assert any("steps of 0.0078" in warning for warning in warnings[0])
    assert not any("steps" in warning for warning in warnings[1])


def test_slopes_beyond_the_instrument_are_warned_of():
    surface = mf.synthesize(mf.GGX(alpha=0.2), (192, 192), 1.0, seed=5, pinned=True)
    slopes = surface.slopes()
    share = np.mean(np.hypot(*slopes.T) > 0.5)
    said = [w for w in mf.fit(surface, "ggx", max_slope=0.5).warnings if "instrument" in w]
    assert any(f"{100 * share:.2g} % of the slopes are steeper than 0.5" in warning for warning in said)
    measured = slopes[np.hypot(*slopes.T) < 0.5]
    (cut,) = mf.fit(measured, "ggx", max_slope=0.5).warnings
    assert "the tail of the surface is not known" in cut
    assert not any("instrument" in w for w in mf.fit(surface, "ggx", max_slope=1e4).warnings)
    with pytest.raises(ValueError, match="max_slope must be positive"):
        mf.fit(surface, "ggx", max_slope=0.0)


def test_a_normal_map_is_a_field_with_blocks_and_lags():
    """As many independent slopes as of the heights, and at a lag what differences of heights are."""
    surface = mf.synthesize(mf.Beckmann(alpha=0.2), (128, 160), 1.0, seed=7)
    slopes, grid = surface.slopes(), np.ones((126, 158), bool)
    sample = mf.SlopeSample(slopes, "normals", grid=grid)
    one, other = mf.fit(sample, "beckmann")[0], mf.fit(surface, "beckmann")[0]
    assert one.n_effective == other.n_effective
    assert one.standard_errors == other.standard_errors
    assert mf.fit(slopes, "beckmann")[0].n_effective == len(slopes)
    lagged = mf.fit(sample, "beckmann", lag=4)[0]
    assert lagged.lag == 4
    smooth = mf.fit(surface, "beckmann", lag=4)[0]
    assert lagged.params["alpha"] == pytest.approx(smooth.params["alpha"], rel=0.1)
    assert lagged.params["alpha"] < one.params["alpha"] / 1.3


def test_lags_of_slopes_without_positions_are_refused():
    slopes = fit_cases.cases()[0].slopes(500, 0)
    with pytest.raises(ValueError, match="lag applies to"):
        mf.fit(slopes, "beckmann", lag=2)
    with pytest.raises(mf.SurfaceError, match="have no lag"):
        mf.SlopeSample(slopes, "table").at_lag(2)
    with pytest.raises(mf.SurfaceError, match="True for as many pixels"):
        mf.SlopeSample(slopes, "normals", grid=np.ones((2, 2), bool))


def test_results_are_a_list_that_keeps_what_it_says():
    results = mf.fit(ramp(2), ["beckmann", "ggx"])
    for again in (copy.copy(results), copy.deepcopy(results), pickle.loads(pickle.dumps(results))):
        assert again == results
        assert (again.verdict, again.warnings, again.halves) == (
            results.verdict,
            results.warnings,
            results.halves,
        )
    assert isinstance(results, list)
    assert isinstance(results, mf.FitResults)


def test_the_command_says_verdict_and_warnings_in_terminal_json_and_page(tmp_path):
    path, page = tmp_path / "ramp.npz", tmp_path / "ramp.html"
    np.savez(path, heights=ramp(1).heights, pixel_size=1.0)
    options = ["fit", str(path), "--family", "beckmann", "--max-slope", "0.3", "--no-scales"]
    printed = CliRunner().invoke(main, options)
    assert printed.exit_code == 0, printed.stderr
    assert "Verdict: " in printed.stdout
    assert "Warning: the surface is not one population" in printed.stdout
    assert "steeper than 0.3" in printed.stdout
    result = CliRunner().invoke(main, [*options, "--json", "--report", str(page)])
    record = json.loads(result.stdout)
    assert record["verdict"].keys() == {"fits", "family", "p_value", "deviation", "sentence"}
    assert record["verdict"]["sentence"] in printed.stdout
    assert len(record["warnings"]) == 2
    assert record["halves"]["names"]
    assert record["ranking"][0]["goodness"]["p_value"] == pytest.approx(record["verdict"]["p_value"] / 2)
    text = html.unescape(page.read_text("utf-8"))
    assert record["verdict"]["sentence"][1:] in text
    assert "not one population" in text
