"""Fits at several lags, and fits to tables, of surfaces and densities that are known."""

from __future__ import annotations

import math

import numpy as np
import pytest

import fit_cases
import microfacet as mf
from shapes import one_shape

FAMILIES = fit_cases.FAMILIES
SHAPES = {
    name: tuple(own.values())
    for name, own in one_shape({"student_t": 3.2, "bessel_k": 1.4, "gtr": 1.7}).items()
}
each = pytest.mark.parametrize("name", FAMILIES)


def noise(size=160, seed=2):
    return np.random.default_rng(seed).normal(size=(size, size))


def test_white_noise_is_named():
    scales = mf.fit_scales(mf.Surface(1e-9 * noise(), 1e-7), families="beckmann", symmetry="isotropic")
    assert scales.lags == (1, 2, 4, 8)
    assert scales.exponents == pytest.approx([-1] * 3, abs=0.05)
    assert scales.noise_lags == scales.lags
    assert "dominated by noise" in scales.notes[0]
    # The difference of two independent heights has variance 2 s^2, over a baseline of 2 lag dx.
    for lag, (fit,) in zip(scales.lags, scales.results, strict=True):
        assert fit.params["alpha"] == pytest.approx(math.sqrt(2) * math.sqrt(2) * 1e-2 / (2 * lag), rel=0.03)
        assert fit.lag == lag


def test_a_surface_is_not_taken_for_noise():
    walk = mf.Surface(noise().cumsum(axis=0).cumsum(axis=1), 1.0)
    for surface in (mf.sample_terrain(), walk):
        scales = mf.fit_scales(surface, families="student_t")
        assert scales.noise_lags == ()
        assert scales.notes == ()
        assert all(-0.85 < exponent < 0.3 for exponent in scales.exponents)


def test_noise_on_a_surface_is_named_as_far_as_it_reaches():
    y, x = np.mgrid[0:256, 0:256]
    smooth = 40 * np.sin(x / 9.0) * np.cos(y / 11.0)
    scales = mf.fit_scales(mf.Surface(smooth + 20 * noise(256), 1.0), families="beckmann")
    assert scales.noise_lags[:2] == (1, 2)
    assert scales.noise_lags != scales.lags
    assert "from lag 1" in scales.notes[0]


def test_scales_are_those_of_single_fits_and_lengths_are_metres():
    terrain = mf.sample_terrain()
    scales = mf.fit_scales(terrain, lags=[8, 2], families=["ggx", "k0"])
    assert scales.lags == (2, 8)
    assert scales.results[1] == mf.fit(terrain, ["ggx", "k0"], lag=8)
    dx, dy = terrain.pixel_size
    assert scales.lengths == pytest.approx([2 * math.sqrt(dx * dy), 8 * math.sqrt(dx * dy)])


@pytest.mark.parametrize(
    ("surface", "lags", "message"),
    [
        (np.zeros((3, 2)), None, "must be a Surface"),
        (mf.Surface(noise(20), 1.0), [], "at least one lag"),
        (mf.Surface(noise(20), 1.0), [1, 10], "too small for slopes at lag 10"),
        (mf.Surface(noise(20), 1.0), [0], "lag"),
    ],
)
def test_bad_scales_are_one_sentence(surface, lags, message):
    with pytest.raises(ValueError, match=message):
        mf.fit_scales(surface, lags, families="beckmann")


@each
def test_a_histogram_with_the_family_s_own_probabilities_gives_its_parameters(name):
    """Counts that are exactly the bins' probabilities: the likelihood is largest at the truth."""
    alpha, shape, mean = 0.3, SHAPES[name], 0.05
    edges = np.linspace(-1.5, 1.5, 101)
    probabilities = np.diff(FAMILIES[name].kernels.slope_cdf(edges - mean, alpha, *shape))
    (result,) = mf.fit_table(histogram=(edges, 1e6 * probabilities), families=name)
    expected = [alpha, *shape, mean]
    assert list(result.params.values()) == pytest.approx(expected, rel=2e-3)
    assert list(result.params)[-1] == "mean"
    errors = np.array(list(result.standard_errors.values()))
    assert np.all((errors > 0) & (errors < 0.05))


def test_a_histogram_of_samples_is_fitted_within_its_errors_and_ranks_the_family_first():
    case = fit_cases.Case("gtr", (("alpha", 0.3), ("gamma", 2.0)))  # this is ggx
    slopes = case.slopes(200_000, 0)[:, 0]
    edges = np.concatenate(([-np.inf], np.linspace(-2, 2, 81), [np.inf]))
    found = mf.fit_table(
        histogram=(edges, np.histogram(slopes, edges)[0]), families=["beckmann", "k0", "ggx"]
    )
    assert found[0].family == "ggx"
    assert abs(found[0].params["alpha"] - 0.3) < 3 * found[0].standard_errors["alpha"] < 0.01
    assert abs(found[0].params["mean"]) < 3 * found[0].standard_errors["mean"]


@each
def test_a_table_of_d_gives_its_parameters_and_scale(name):
    alpha, shape = 0.25, SHAPES[name]
    theta = np.radians(np.arange(1.0, 75.0, 2.0))
    table = 4.2 * FAMILIES[name].kernels.D(np.cos(theta), alpha, *shape)
    (result,) = mf.fit_table(density=(theta, table), families=name)
    assert list(result.params.values()) == pytest.approx([alpha, *shape, 4.2], rel=1e-3)
    assert result.objective < 1e-4
    directions = np.column_stack((np.sin(theta), 0 * theta, np.cos(theta)))
    logs = np.log(table / (result.params["scale"] * result.ndf.D(directions)))
    assert np.sqrt(np.mean(logs**2)) == pytest.approx(result.objective, rel=0.1, abs=1e-12)


def test_errors_of_a_table_of_d_follow_its_scatter():
    rng, theta = np.random.default_rng(4), np.radians(np.linspace(1, 70, 40))
    exact = mf.ggx.D(np.cos(theta), 0.3)
    fits = [
        mf.fit_table(density=(theta, exact * np.exp(0.05 * rng.normal(size=40))), families="ggx")[0]
        for _ in range(40)
    ]
    spread = np.std([fit.params["alpha"] for fit in fits], ddof=1)
    assert np.mean([fit.standard_errors["alpha"] for fit in fits]) == pytest.approx(spread, rel=0.35)


@pytest.mark.parametrize(
    ("name", "shape", "square"),
    [
        ("beckmann", {}, 1.0),
        ("student_t", {"gamma": 3.0}, 2.0),  # (gamma - 1)/(gamma - 2)
        ("student_t", {"gamma": 2.2}, 6.0),
        ("k0", {}, 1.0),
        ("bessel_k", {"a": 2.5}, 2.5),
    ],
)
def test_mean_square_slopes_are_met(name, shape, square):
    """E[r^2] of Student-T is (gamma - 1)/(gamma - 2), of Bessel K a (mixtures of Beckmann with these
    means).
    """
    (result,) = mf.fit_table(mean_square_slopes=(0.02, 0.08), families=name, **shape)
    assert result.params["alpha_x"] == pytest.approx(math.sqrt(2 * 0.02 / square), rel=1e-6)
    assert result.params["alpha_y"] == pytest.approx(math.sqrt(2 * 0.08 / square), rel=1e-6)
    xi = (np.arange(400_000) + 0.5) / 400_000
    kernels = FAMILIES[name].kernels
    if shape.get("gamma") != 2.2:  # whose sum converges slowly
        mean = np.mean(kernels.sample_slope(xi, 1.0, *shape.values()) ** 2)
        assert mean == pytest.approx(square, rel=0.01)


@pytest.mark.parametrize(
    ("name", "options"), [("ggx", {}), ("gtr", {"gamma": 5.0}), ("student_t", {"gamma": 2.0})]
)
def test_an_infinite_mean_square_slope_is_said(name, options):
    with pytest.raises(ValueError, match=f"{name}: its mean square slope is infinite"):
        mf.fit_table(mean_square_slopes=0.02, families=name, **options)
    assert name not in [fit.family for fit in mf.fit_table(mean_square_slopes=0.02, **options)]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "exactly one"),
        ({"histogram": ([0, 1], [1]), "mean_square_slopes": 1.0}, "exactly one"),
        ({"histogram": ([0, 1, 2], [1, 2, 3])}, "edges are needed"),
        ({"histogram": ([0, 1, 1, 2], [1, 2, 3])}, "ascend"),
        ({"histogram": ([0, 1, 2, 3], [1, -2, 3])}, "not negative"),
        ({"histogram": ([0, 1, 2, 3], [1, 0, 0])}, "three bins"),
        ({"histogram": (["a", "b"], [1])}, "real numbers"),
        ({"density": ([0.1, 0.2], [1, 1])}, "at least 4"),
        ({"density": ([0.1, 0.2, 0.3, 1.6], [1, 1, 1, 1])}, "radians"),
        ({"density": ([0.1, 0.2, 0.3, 0.4], [1, 1, 1, 0])}, "positive"),
        (
            {"density": ([0.1, 0.2, 0.3, 0.4], [1, 1, 1, 1]), "gamma": 2.0},
            "gamma goes with",
        ),
        ({"mean_square_slopes": -1.0}, "positive"),
        ({"mean_square_slopes": 0.1, "families": "student_t"}, "give gamma"),
        ({"mean_square_slopes": 0.1, "families": "student_t", "gamma": 0.2}, "outside its interval"),
    ],
)
def test_bad_tables_are_one_sentence(options, message):
    with pytest.raises(ValueError, match=message) as caught:
        mf.fit_table(**options)
    assert "\n" not in str(caught.value)
