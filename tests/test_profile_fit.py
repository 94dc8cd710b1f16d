"""Fits of profiles: closed forms, other libraries, symmetries, and truth that is known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import integrate, optimize, stats

import microfacet as mf
from microfacet._fit.law import Law

FAMILIES = {family.name: family for family in mf.families() if not family.singular}
each_family = pytest.mark.parametrize("name", FAMILIES)


KNOWN = ["beckmann", "ggx", "student_t", "k0", "exponential"]


def shape_of(name, fraction=0):
    """One of the family's sets of shape parameters."""
    shapes = FAMILIES[name].shapes
    return shapes[len(shapes) // 2 + fraction]


def draw(name, shape, n, seed, alpha=0.3):
    """n independent slopes along a line: the first component of slopes in the plane."""
    rng = np.random.default_rng(seed)
    return FAMILIES[name].kernels.sample_slope(rng.random(n), alpha, *shape) * np.cos(
        2 * np.pi * rng.random(n)
    )


def with_slopes(slopes, **how):
    """A profile with these slopes at lag 1: every second height is the sum of every second slope."""
    heights = np.zeros(len(slopes) + 2)
    for start in (0, 1):
        own = slopes[start::2]
        heights[start::2][1 : len(own) + 1] = np.cumsum(2 * own)
    profile = mf.Profile(heights, 1.0, **how)
    np.testing.assert_allclose(profile.slopes(), slopes, rtol=1e-6, atol=1e-9)
    return profile


def log_likelihood(name, slopes, alpha, *shape):
    return float(np.sum(np.log(FAMILIES[name].kernels.P2(slopes, alpha, *shape))))


# The law along a line


@each_family
def test_the_law_along_a_line_integrates_its_density_and_inverts(name) -> None:
    law, shape = Law(FAMILIES[name].kernels, True), shape_of(name)
    for probability in (1e-3, 0.1, 0.5, 0.9, 0.999):
        radius = law.quantile(probability, 0.3, *shape)
        assert float(law.beyond(np.array(radius), 0.3, *shape)) == pytest.approx(1 - probability, rel=1e-9)
    low, high = (law.quantile(p, 0.3, *shape) for p in (0.3, 0.95))
    inside = integrate.quad(lambda t: 2 * float(law.density(np.array(t), 0.3, *shape)), low, high)[0]
    assert inside == pytest.approx(0.65, rel=1e-7)


def test_the_density_along_a_line_of_a_family_of_ones_own_is_that_of_the_library() -> None:
    family = mf.UserFamily(
        "own", lambda r, gamma: mf.student_t.P22(r, 0.0, 1.0, gamma), {"gamma": (1.5, math.inf, 3.0)}
    )
    slopes = np.r_[-np.geomspace(1e-7, 1e4, 300), 0.0, 0.3]
    theirs = mf.student_t.P2(slopes, 0.3, 2.2)
    np.testing.assert_allclose(family.kernels.P2(slopes, 0.3, 2.2), theirs, rtol=2e-8)


# The maximum


def test_beckmann_is_the_mean_square() -> None:
    """P2 is normal with variance alpha^2/2."""
    slopes = draw("beckmann", (), 3001, 1)
    fit = mf.fit(with_slopes(slopes), "beckmann")[0]
    centred = slopes - fit.mean_slope[0]
    assert fit.params["alpha"] == pytest.approx(math.sqrt(2 * np.mean(centred**2)), rel=1e-6)
    assert fit.log_likelihood == pytest.approx(
        log_likelihood("beckmann", centred, fit.params["alpha"]), rel=1e-9
    )
    assert fit.symmetry == "profile"
    assert fit.n == 3001
    assert fit.ndf == mf.Beckmann(alpha=fit.params["alpha"])


def test_ggx_and_student_t_are_scipys_t() -> None:
    """The marginal of Student-T is Student's t with 2 (gamma - 1) degrees of freedom, that of ggx with 2."""
    slopes = draw("student_t", (2.7,), 3000, 2)
    profile = with_slopes(slopes)
    ggx, student = (mf.fit(profile, name)[0] for name in ("ggx", "student_t"))
    centred = slopes - ggx.mean_slope[0]
    _, _, scale = stats.t.fit(centred, f0=2, floc=0)
    assert ggx.params["alpha"] == pytest.approx(math.sqrt(2) * scale, rel=1e-4)
    freedom, _, scale = stats.t.fit(centred, floc=0)
    assert student.params["gamma"] == pytest.approx(freedom / 2 + 1, rel=2e-3)
    assert student.log_likelihood == pytest.approx(
        float(np.sum(stats.t.logpdf(centred, freedom, 0, scale))), rel=1e-6
    )


@each_family
def test_nothing_is_likelier_than_the_fit(name) -> None:
    slopes = draw(name, shape_of(name), 1500, 3)
    fit = mf.fit(with_slopes(slopes), name)[0]
    centred, family = slopes - fit.mean_slope[0], FAMILIES[name]
    found = np.array(list(fit.params.values()))
    assert fit.converged
    assert fit.log_likelihood == pytest.approx(log_likelihood(name, centred, *found), rel=1e-7)

    def worse(logs):
        values = [math.exp(logs[0])]
        values += [
            p.lower + math.exp(x) if p.upper > 1e9 else x
            for p, x in zip(family.parameters[1:], logs[1:], strict=True)
        ]
        value = log_likelihood(name, centred, *values)
        return -value if math.isfinite(value) else 1e9

    start = [math.log(found[0])]
    start += [
        math.log(x - p.lower) if p.upper > 1e9 else x
        for p, x in zip(family.parameters[1:], found[1:], strict=True)
    ]
    theirs = optimize.minimize(worse, np.array(start) + 0.05, method="Nelder-Mead", options={"maxiter": 400})
    assert fit.log_likelihood >= -theirs.fun - 1e-4


# What must not matter


def test_direction_sign_tilt_and_units_do_not_matter() -> None:
    slopes = draw("student_t", (3.0,), 2000, 4)
    plain = mf.fit(with_slopes(slopes), "student_t")[0]
    trace = with_slopes(slopes).traces[0]
    x = np.arange(trace.size)
    for other in (
        mf.Profile(trace[::-1], 1.0),
        mf.Profile(-trace, 1.0),
        mf.Profile(trace + 0.7 * x, 1.0),
        mf.Profile(1e-6 * trace, 1e-6),
    ):
        fit = mf.fit(other, "student_t")[0]
        assert fit.params == pytest.approx(plain.params, rel=1e-6)
        assert fit.standard_errors == pytest.approx(plain.standard_errors, rel=0.2)
    steep = mf.fit(mf.Profile(trace, 0.5), "student_t")[0]
    assert steep.params["alpha"] == pytest.approx(2 * plain.params["alpha"], rel=1e-6)


def test_traces_missing_points_and_lags_give_the_slopes_that_they_give() -> None:
    slopes = draw("ggx", (), 3000, 5)
    trace = with_slopes(slopes).traces[0]
    trace = trace.copy()
    trace[1000] = math.nan
    one = mf.Profile(trace, 1.0)
    two = mf.Profile([trace[:1000], trace[1001:]], 1.0)
    fits = [mf.fit(profile, "ggx")[0] for profile in (one, two)]
    assert [fit.n for fit in fits] == [2998, 2997]
    assert fits[0].params["alpha"] == pytest.approx(fits[1].params["alpha"], rel=2e-3)
    assert mf.fit(one, "ggx", lag=3)[0].params == mf.fit(one.at_lag(3), "ggx")[0].params
    assert mf.fit(one, "ggx", lag=3)[0].lag == 3


# Truth


@each_family
@pytest.mark.parametrize("seed", [10])
def test_the_truth_of_independent_slopes_is_found(name, seed) -> None:
    shape = shape_of(name)
    fit = mf.fit(with_slopes(draw(name, shape, 6000, seed)), name)[0]
    truth = dict(zip([p.name for p in FAMILIES[name].parameters], (0.3, *shape), strict=True))
    deviations = [(fit.params[k] - truth[k]) / fit.standard_errors[k] for k in truth]
    assert max(map(abs, deviations)) < 4, (truth, fit.params, fit.standard_errors)
    assert fit.goodness.anderson_darling < 4


def test_errors_of_independent_slopes_are_those_of_the_information() -> None:
    """Beckmann: the variance of log alpha is 1/(2 n)."""
    errors = [
        mf.fit(with_slopes(draw("beckmann", (), 4000, seed)), "beckmann")[0].standard_errors["alpha"]
        for seed in range(12)
    ]
    assert 0.99 < np.median(errors) / (0.3 / math.sqrt(2 * 4000)) < 1.3  # dependence is looked for


@pytest.mark.parametrize(
    ("name", "shape"),
    [("beckmann", ()), ("ggx", ()), ("student_t", (3.0,)), ("bessel_k", (1.5,)), ("exponential", ())],
)
def test_the_truth_of_maps_cut_into_profiles_is_found(name, shape) -> None:
    """Neighbouring slopes of a line depend on each other, and its errors know."""
    family, deviations = FAMILIES[name], []
    truth = dict(zip([p.name for p in family.parameters], (0.3, *shape), strict=True))
    for seed in range(6):
        how = {} if name == "beckmann" else {"amplitude_length": 16e-6}
        surface = mf.synthesize(family.cls(**truth), (320, 1024), seed=seed, **how)
        profile = mf.Profile.from_surface(surface, row=slice(0, 320, 80))
        fit = mf.fit(profile, name)[0]
        assert fit.n_effective < 0.6 * fit.n
        deviations += [(fit.params[k] - truth[k]) / fit.standard_errors[k] for k in truth]
    assert max(map(abs, deviations)) < 4, deviations
    assert 0.3 < math.sqrt(np.mean(np.square(deviations))) < 1.7, deviations


def test_the_family_is_told_from_a_profile() -> None:
    surface = mf.synthesize(mf.GGX(alpha=0.3), (320, 2048), seed=8, amplitude_length=16e-6)
    results = mf.fit(mf.Profile.from_surface(surface, row=slice(0, 320, 40)), KNOWN)
    tied = {fit.family for fit in results if fit.tied}
    assert "ggx" in tied
    assert not tied & {"beckmann", "k0", "exponential"}
    assert any("a profile knows the slopes along its line alone" in note for note in results[0].notes)


def test_an_anisotropic_surface_has_the_roughness_along_the_line() -> None:
    """Along x the slopes have alpha_x for any family that is stretched."""
    surface = mf.synthesize(mf.Beckmann(alpha_x=0.1, alpha_y=0.4), (512, 512), seed=3)
    for where, alpha in (({"row": slice(0, 512, 64)}, 0.1), ({"column": slice(0, 512, 64)}, 0.4)):
        fit = mf.fit(mf.Profile.from_surface(surface, **where), "beckmann")[0]
        assert abs(fit.params["alpha"] - alpha) < 4 * fit.standard_errors["alpha"] < 0.3 * alpha


# Densities that are infinite at the centre


@pytest.mark.parametrize(("name", "shape"), [("bessel_k", (0.35,)), ("erfc", ())])
@pytest.mark.parametrize("n", [3000, 3001])
def test_a_pole_at_the_centre_is_no_maximum_of_the_likelihood(name, shape, n) -> None:
    """The median is a slope where their number is odd; the likelihood is finite all the same."""
    fit = mf.fit(with_slopes(draw(name, shape, n, 12)), name)[0]
    assert math.isfinite(fit.log_likelihood)
    truth = dict(zip([p.name for p in FAMILIES[name].parameters], (0.3, *shape), strict=True))
    for key, value in truth.items():
        assert abs(fit.params[key] - value) < 4 * fit.standard_errors[key]
    smooth = with_slopes(draw("beckmann", (), n, 13))
    results = {one.family: one for one in mf.fit(smooth, ["beckmann", name])}
    assert results["beckmann"].log_likelihood > results[name].log_likelihood - 3


def test_quantised_heights_say_so() -> None:
    surface = mf.synthesize(mf.Beckmann(alpha=0.05), (64, 4096), seed=5)
    profile = mf.Profile.from_surface(surface, row=0)
    coarse = mf.Profile(np.round(profile.traces[0] / 5e-8) * 5e-8, 1e-6)
    results = mf.fit(coarse, ["beckmann", "bessel_k", "k0"])
    assert any("of the slopes equal the mean slope" in note for note in results[0].notes)
    assert all(math.isfinite(fit.log_likelihood) for fit in results)


# Own densities, scales, input


def test_densities_of_ones_own() -> None:
    slopes = draw("student_t", (4.0,), 4000, 20)
    own = mf.RadialNDF(lambda r: mf.student_t.P22(r, 0.0, 1.0, 4.0))
    family = mf.UserFamily(
        "own", lambda r, gamma: mf.student_t.P22(r, 0.0, 1.0, gamma), {"gamma": (1.5, math.inf, 3.0)}
    )
    results = {fit.family: fit for fit in mf.fit(with_slopes(slopes), [own, family, "student_t"])}
    assert results["density"].params["alpha"] == pytest.approx(0.3, rel=0.05)
    assert results["own"].params["gamma"] == pytest.approx(results["student_t"].params["gamma"], rel=1e-2)
    assert results["own"].log_likelihood == pytest.approx(results["student_t"].log_likelihood, rel=1e-5)


def test_scales_of_noise_and_of_a_smooth_profile() -> None:
    noise = mf.Profile(np.random.default_rng(1).normal(size=3000), 10.0)
    scales = mf.fit_scales(noise, families="beckmann")
    assert scales.lags[:4] == (1, 2, 4, 8)
    assert scales.lengths[1] == 20.0
    assert set(scales.lags[:4]) <= set(scales.noise_lags)
    smooth = mf.Profile(np.sin(np.arange(3000) * 0.01) + np.sin(np.arange(3000) * 0.0233), 1.0)
    assert mf.fit_scales(smooth, [1, 2, 4], "beckmann").noise_lags == ()


def test_profiles_side_by_side() -> None:
    one, other = (with_slopes(draw("ggx", (), 3000, seed, alpha)) for seed, alpha in ((40, 0.3), (41, 0.4)))
    found = mf.compare([one, other], "ggx")
    assert found.symmetry == "profile"
    assert found.rankings[1][0].params["alpha"] == pytest.approx(0.4, rel=0.1)
    with pytest.raises(ValueError, match="profiles compare with profiles alone"):
        mf.compare([one, mf.sample_terrain()], "ggx")


def test_many_slopes_are_drawn() -> None:
    profile = with_slopes(draw("ggx", (), 6000, 30))
    fit = mf.fit(profile, "ggx", max_slopes=1000)[0]
    assert fit.n == 1000
    assert any("1000 of 6000 slopes, drawn at random" in note for note in fit.notes)
    assert abs(fit.params["alpha"] - 0.3) < 4 * fit.standard_errors["alpha"]


@pytest.mark.parametrize(
    ("profile", "options", "message"),
    [
        (np.arange(12.0) ** 2, {}, "10 slopes at lag 1, at least 20"),
        (np.arange(100.0), {}, "more than half of them are equal"),
        (1e7 * np.random.default_rng(0).normal(size=100), {}, "are the units of heights and positions right"),
        (
            np.random.default_rng(0).normal(size=100),
            {"symmetry": "isotropic"},
            "a profile knows one direction",
        ),
        (np.random.default_rng(0).normal(size=100), {"families": "dirac"}, "no density to fit"),
        (np.random.default_rng(0).normal(size=100), {"lag": 0}, "lag must be a whole number"),
        (np.random.default_rng(0).normal(size=100), {"lag": 90}, "0 slopes at lag 90"),
    ],
)
def test_what_cannot_be_fitted(profile, options, message) -> None:
    with pytest.raises(ValueError, match=message) as caught:
        mf.fit(mf.Profile(profile, 1.0), **options)
    assert "\n" not in str(caught.value)
