"""Standard errors, effective numbers of slopes and held-out likelihoods against what is known of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import ndimage, stats

import fit_cases
import microfacet as mf
from microfacet._fit import blocks
from microfacet.testing import sidak

CASES = fit_cases.cases()
ALL_CASES = [*CASES, *fit_cases.isotropic_cases()]
REPETITIONS = 20


@pytest.mark.parametrize("case", ALL_CASES, ids=str)
def test_intervals_cover_the_truth(case):
    """20 repetitions at fixed seeds; `make fit-coverage` runs 200 (docs/fitting_tests.md)."""
    deviations = [case.deviations(case.slopes(5000, repetition)) for repetition in range(REPETITIONS)]
    for name, _ in case.parameters:
        covered = sum(abs(deviation[name]) < stats.norm.ppf(0.975) for deviation in deviations)
        assert fit_cases.coverage_p_value(covered, REPETITIONS) > sidak(0.01, 3 * len(ALL_CASES)), name


@pytest.mark.parametrize("case", {case.family: case for case in CASES}.values(), ids=str)
def test_a_million_slopes_give_every_parameter_within_three_standard_errors(case):
    deviations = case.deviations(case.slopes(1_000_000, 0))
    assert max(map(abs, deviations.values())) < 3, deviations


def test_beckmann_errors_have_a_closed_form():
    """Along the axes alpha is a standard deviation times sqrt 2, whose error is alpha sqrt((kurtosis -
    1)/(4 n)).
    """
    slopes = np.random.default_rng(3).standard_t(7, size=(40_000, 2)) * [0.2, 0.1]
    (result,) = mf.fit(slopes, "beckmann", symmetry="anisotropic")
    kurtosis = np.mean((slopes - slopes.mean(axis=0)) ** 4, axis=0) / np.var(slopes, axis=0) ** 2
    for name, k in zip(("alpha_x", "alpha_y"), kurtosis, strict=True):
        expected = result.params[name] * math.sqrt((k - 1) / (4 * len(slopes)))
        assert result.standard_errors[name] == pytest.approx(expected, rel=0.01)


def test_the_error_of_the_mean_slope():
    """That of a median of normal deviates is sqrt(pi/2) times that of their mean (Laplace)."""
    slopes = np.random.default_rng(5).normal(size=(100_000, 2)) * [0.3, 0.1]
    errors = mf.fit(slopes, "beckmann")[0].mean_slope_errors
    assert errors == pytest.approx(np.array([0.3, 0.1]) * math.sqrt(math.pi / 2 / 100_000), rel=0.05)


def test_every_slope_of_a_map_is_in_the_cell_where_it_lies():
    """On z = (x^2 + y^2)/2 the slopes are the positions."""
    y, x = np.mgrid[0:50, 0:70].astype(float)
    heights = (x**2 + y**2) / 2
    heights[np.random.default_rng(6).random(heights.shape) < 0.1] = math.nan
    surface, lag = mf.Surface(heights, 1.0), 3
    columns, rows = np.round(surface.slopes(lag)).astype(int).T - lag
    expected = blocks.CELLS * (rows * blocks.CELLS // 44) + columns * blocks.CELLS // 64
    np.testing.assert_array_equal(blocks.cells_of_map(surface.mask, lag), expected)


def correlated_map(seed, length=3.0, size=192):
    """A periodic Gaussian field: its slopes are normal (Beckmann), correlated over `length` pixels."""
    noise = np.random.default_rng(seed).normal(size=(size, size))
    heights = ndimage.gaussian_filter(noise, length, mode="wrap")
    return mf.Surface(heights * (0.2 * 2 * math.sqrt(math.pi) * length**2 / math.sqrt(0.5)), 1.0)


def test_errors_of_correlated_slopes_are_those_of_repeated_maps():
    """Over 40 maps the spread of alpha is what each map says of its error, many times that of as many
    slopes.
    """
    fits = [mf.fit(correlated_map(seed), "beckmann", symmetry="anisotropic")[0] for seed in range(40)]
    alphas = np.array([[fit.params["alpha_x"], fit.params["alpha_y"]] for fit in fits])
    errors = np.array([[fit.standard_errors["alpha_x"], fit.standard_errors["alpha_y"]] for fit in fits])
    ratio = np.mean(errors**2) / np.mean(np.var(alphas, axis=0, ddof=1))
    # The variance of 2 x 40 values has a relative error of 16 %, three of which are allowed.
    assert 0.5 < ratio < 1.5
    assert all(fit.n_effective < fit.n / 10 for fit in fits)
    independent = fits[0].params["alpha_x"] / math.sqrt(4 * fits[0].n / 2)
    assert np.mean(errors) > 3 * independent


def test_the_criteria_count_effective_slopes():
    for source in (correlated_map(1), CASES[0].slopes(3000, 0)):
        for fit in mf.fit(source, ["beckmann", "student_t"]):
            k, n, each = len(fit.params), fit.n_effective, fit.log_likelihood_per_sample
            assert fit.aic == pytest.approx(2 * k - 2 * n * each)
            assert fit.bic == pytest.approx(k * math.log(n) - 2 * n * each)
            assert each == pytest.approx(fit.log_likelihood / fit.n)
            assert n <= fit.n
    assert n == fit.n, "slopes without positions are taken for independent"


def test_held_out_is_the_likelihood_of_slopes_the_fit_has_not_seen():
    slopes = CASES[0].slopes(3000, 4)
    (result,) = mf.fit(slopes, "beckmann", symmetry="anisotropic")
    centred, total = slopes - result.mean_slope, 0.0
    folds = np.arange(3000) % blocks.GROUPS % blocks.FOLDS
    for fold in range(blocks.FOLDS):
        rest = centred[folds != fold]
        inverse = np.linalg.inv(2 * rest.T @ rest / len(rest))
        left = centred[folds == fold]
        squares = np.einsum("ij,jk,ik->i", left, inverse, left)
        total += np.sum(-squares - math.log(math.pi) + 0.5 * math.log(np.linalg.det(inverse)))
    assert result.held_out == pytest.approx(total / 3000, abs=1e-6)
    assert result.held_out < result.log_likelihood_per_sample


@pytest.mark.parametrize(("family", "shape"), [("student_t", 6.0), ("bessel_k", 3.0)])
def test_identifies_families_that_differ(family, shape):
    """Each right with at least 99 %: of 30 repetitions none may fail (a rate of 5 % would, four times
    of five).
    """
    name = fit_cases.FAMILIES[family].parameters[1].name
    case = fit_cases.Case(family, (*fit_cases.STRETCH.items(), (name, shape)))
    for repetition in range(20):
        slopes, rivals = case.slopes(20_000, repetition), ["student_t", "bessel_k"]
        assert mf.fit(slopes, rivals, symmetry="anisotropic")[0].family == family


def test_families_that_describe_the_slopes_equally_are_tied_and_the_simpler_one_is_first():
    case = fit_cases.Case("ggx", tuple(fit_cases.STRETCH.items()))
    first, second, *_ = mf.fit(case.slopes(20_000, 1), ["student_t", "ggx"])
    assert (first.family, second.family) == ("ggx", "student_t")
    assert first.tied
    assert second.tied
    assert first.held_out_error == 0
    assert second.held_out_error > 0


@pytest.mark.parametrize("name", ["student_t", "bessel_k"])
def test_a_shape_at_the_end_of_its_range_has_no_error(name):
    """Tails lighter than those of any family, on a disc: the shape goes to its end, Beckmann's limit."""
    rng = np.random.default_rng(4)
    radius, azimuth = np.sqrt(rng.random(4000)), 2 * np.pi * rng.random(4000)
    slopes = 0.3 * radius[:, np.newaxis] * np.column_stack((np.cos(azimuth), np.sin(azimuth)))
    (result,) = mf.fit(slopes, name, symmetry="anisotropic")
    shape = fit_cases.FAMILIES[name].parameters[1].name
    assert any(f"{shape} is at the upper end" in note for note in result.notes)
    assert math.isnan(result.standard_errors[shape])
    assert 0 < result.standard_errors["alpha_x"] < 0.02 * result.params["alpha_x"]


def test_goodness_tells_the_right_family_from_a_wrong_one():
    case = fit_cases.Case("student_t", (*fit_cases.STRETCH.items(), ("gamma", 2.5)))
    slopes = case.slopes(20_000, 3)
    fits = [mf.fit(slopes, name, symmetry="anisotropic")[0] for name in ("student_t", "beckmann")]
    right, wrong = (fit.goodness for fit in fits)
    assert right.anderson_darling < 2.5 < 100 < wrong.anderson_darling
    assert max(right.sectors) < 4
    assert len(right.sectors) == 8
    assert right.observed == pytest.approx(right.expected, rel=0.25)
    assert wrong.observed[-1] > 2 * wrong.expected[-1], "the tail that Beckmann does not have"
    assert right.probabilities == wrong.probabilities


def test_anderson_darling_agrees_with_scipy():
    """For normal slopes, r^2 is exponential; SciPy's statistic with the same scale fitted."""
    slopes = np.random.default_rng(7).normal(size=(2000, 2))
    symmetric = np.concatenate((slopes, -slopes))
    (result,) = mf.fit(symmetric, "beckmann", symmetry="anisotropic")
    a = np.linalg.cholesky(np.linalg.inv(2 * symmetric.T @ symmetric / len(symmetric)))
    squares = np.sort(np.sum((symmetric @ a) ** 2, axis=1))
    cdf = -np.expm1(-squares)
    i = np.arange(1, len(cdf) + 1)
    expected = -len(cdf) - np.mean((2 * i - 1) * (np.log(cdf) + np.log1p(-cdf[::-1])))
    assert result.goodness.anderson_darling == pytest.approx(expected, rel=1e-4)


def test_threads_and_order_do_not_change_a_bit(monkeypatch):
    slopes = CASES[4].slopes(150_000, 0)
    before = mf.fit(slopes, "student_t")[0]
    monkeypatch.setattr("os.cpu_count", lambda: 1)
    assert mf.fit(slopes, "student_t")[0] == before
