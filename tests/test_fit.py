"""Maximum-likelihood fits: parameters that are known, likelihoods that have a closed form, and symmetries."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import microfacet as mf

DATA = Path(__file__).parents[2] / "shared" / "data"
FAMILIES = {family.name: family for family in mf.families() if not family.singular}


def matrix(alpha_x, alpha_y, rotation):
    """The symmetric matrix that stretches standard slopes; unlike an angle it is unique and smooth."""
    c, s = math.cos(rotation), math.sin(rotation)
    turn = np.array([[c, -s], [s, c]])
    return turn @ np.diag([alpha_x, alpha_y]) @ turn.T


def draw(name, shape, n, seed, stretch=None, alpha=1.0):
    """n slopes: radius from the family's inverse survival, uniform azimuth, stretched."""
    rng = np.random.default_rng(seed)
    radius = FAMILIES[name].kernels.sample_slope(rng.random(n), alpha, *shape)
    azimuth = 2 * np.pi * rng.random(n)
    slopes = radius[:, np.newaxis] * np.column_stack((np.cos(azimuth), np.sin(azimuth)))
    return slopes if stretch is None else slopes @ stretch.T


def log_likelihood(name, vector, slopes):
    """From the frozen distribution; the vector holds the stretch (a11, a22, a12) or alpha, then the shape."""
    family = FAMILIES[name]
    if name == "gtr":
        params = {"alpha": vector[0]}
    else:
        (alpha_y, alpha_x), axes = np.linalg.eigh([[vector[0], vector[2]], [vector[2], vector[1]]])
        params = {"alpha_x": alpha_x, "alpha_y": alpha_y, "rotation": math.atan2(axes[1, 1], axes[0, 1])}
    tail = vector[1:] if name == "gtr" else vector[3:]
    params |= {parameter.name: value for parameter, value in zip(family.parameters[1:], tail, strict=True)}
    return float(np.sum(np.log(family.cls(**params).P22(*slopes.T))))


def general(slopes, name, **options):
    """The fit of one family with all the parameters that it can have."""
    symmetry = "anisotropic" if FAMILIES[name].anisotropic else "isotropic"
    (result,) = mf.fit(slopes, name, symmetry=symmetry, **options)
    return result


def fitted_vector(result):
    params = dict(result.params)
    if result.family == "gtr":
        return np.array(list(params.values()))
    a = matrix(params.pop("alpha_x"), params.pop("alpha_y"), params.pop("rotation"))
    return np.array([a[0, 0], a[1, 1], a[0, 1], *params.values()])


def standard_errors(name, vector, slopes):
    """From the observed information: minus the second differences of the log-likelihood."""
    step = 1e-3 * np.maximum(np.abs(vector), 0.1 * np.abs(vector[0]))
    unit = np.diag(step)

    def second(i, j):
        return sum(
            a * b * log_likelihood(name, vector + a * unit[i] + b * unit[j], slopes)
            for a in (-1, 1)
            for b in (-1, 1)
        ) / (4 * step[i] * step[j])

    information = -np.array([[second(i, j) for i in range(len(vector))] for j in range(len(vector))])
    return np.sqrt(np.diag(np.linalg.inv(information)))


STRETCHES = {
    "isotropic": (0.3, 0.3, 0.0),
    "along_axes": (0.1, 0.4, 0.0),
    "rotated": (0.12, 0.3, 0.6),
    "rotated_far": (0.5, 0.02, -1.3),
}
CASES = [
    ("beckmann", ()),
    ("ggx", ()),
    ("student_t", (1.8,)),
    ("student_t", (4.0,)),
    ("k0", ()),
    ("bessel_k", (0.6,)),
    ("bessel_k", (2.5,)),
]


@pytest.mark.parametrize("stretch", STRETCHES)
@pytest.mark.parametrize(("name", "shape"), CASES)
def test_recovers_the_parameters_of_stretched_slopes(name, shape, stretch):
    truth = matrix(*STRETCHES[stretch])
    slopes = draw(name, shape, 3000, seed=11, stretch=truth)
    result = general(slopes, name)
    found = fitted_vector(result)
    errors = standard_errors(name, found, slopes - result.mean_slope)
    expected = np.array([truth[0, 0], truth[1, 1], truth[0, 1], *shape])
    assert result.converged
    assert np.all(np.abs(found - expected) < 4 * errors), (found, expected, errors)


@pytest.mark.parametrize(("alpha", "gamma"), [(0.2, 1.0), (0.05, 2.0), (0.4, 3.5), (2.0, 2.0)])
def test_recovers_the_parameters_of_gtr(alpha, gamma):
    slopes = draw("gtr", (gamma,), 10000, seed=3, alpha=alpha)
    result = general(slopes, "gtr")
    found = fitted_vector(result)
    errors = standard_errors("gtr", found, slopes - result.mean_slope)
    assert result.converged
    assert np.all(np.abs(found - [alpha, gamma]) < 4 * errors), (found, errors)


def test_names_the_axes_by_the_nearest_coordinate_axis():
    slopes = draw("ggx", (), 5000, seed=1, stretch=matrix(0.1, 0.4, 0.2))
    params = general(slopes, "ggx").params
    assert params["alpha_x"] == pytest.approx(0.1, rel=0.1)
    assert params["alpha_y"] == pytest.approx(0.4, rel=0.1)
    assert params["rotation"] == pytest.approx(0.2, abs=0.05)


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("beckmann", ()),
        ("ggx", ()),
        ("gtr", (4.0,)),
        ("student_t", (3.5,)),
        ("k0", ()),
        ("bessel_k", (2.5,)),
    ],
)
def test_ranks_the_generating_family_first(name, shape):
    # ggx and k0 are members of student_t and bessel_k too: the criterion prefers fewer parameters.
    stretch = None if name == "gtr" else matrix(1.2, 0.8, 0.4)
    slopes = draw(name, shape, 5000, seed=5, stretch=stretch, alpha=0.5)
    results = mf.fit(slopes)
    assert results[0].family == name
    order = [(not one.tied, one.bic if one.tied else -one.held_out) for one in results]
    assert order == sorted(order)
    assert len(results) == sum(1 + family.anisotropic for family in FAMILIES.values())


def test_beckmann_has_a_closed_form():
    """Its maximum is A^2 = 2 E[slope slope^T], where the exponents of the density sum to n."""
    slopes = draw("student_t", (5.0,), 3000, seed=8, stretch=matrix(0.3, 0.1, 0.3))
    result = general(slopes, "beckmann")
    centred = slopes - result.mean_slope
    values = np.linalg.eigvalsh(2 * centred.T @ centred / len(centred))
    found = sorted([result.params["alpha_x"], result.params["alpha_y"]])
    assert found == pytest.approx(np.sqrt(values), rel=1e-6)
    closed = -len(slopes) * (1 + math.log(math.pi * math.sqrt(values.prod())))
    assert result.log_likelihood == pytest.approx(closed, rel=1e-9)


@pytest.mark.parametrize("outlier", [30.0, 3000.0])
def test_an_outlier_beyond_the_underflow_counts_in_full(outlier):
    slopes = draw("beckmann", (), 4000, seed=2, alpha=0.1)
    slopes[0] = (outlier, 0.0)  # exp(-r^2) underflows there even at the maximum, which is the closed form
    result = general(slopes, "beckmann")
    centred = slopes - result.mean_slope
    values = np.linalg.eigvalsh(2 * centred.T @ centred / len(centred))
    closed = -len(slopes) * (1 + math.log(math.pi * math.sqrt(values.prod())))
    assert outlier**2 / values.max() > 745
    assert result.log_likelihood == pytest.approx(closed, rel=1e-6)


@pytest.mark.parametrize("name", FAMILIES)
def test_the_reported_likelihood_is_that_of_the_distribution(name):
    slopes = draw("student_t", (2.5,), 2000, seed=4, stretch=matrix(0.2, 0.3, -0.5))
    result = general(slopes, name)
    direct = np.sum(np.log(result.ndf.P22(*(slopes - result.mean_slope).T)))
    assert result.log_likelihood == pytest.approx(direct, rel=1e-10)
    assert result.ndf == FAMILIES[name].cls(**result.params)
    assert result.n == 2000
    assert result.aic == pytest.approx(2 * len(result.params) - 2 * direct)
    assert result.bic == pytest.approx(math.log(2000) * len(result.params) - 2 * direct)
    assert result.lag is None


@pytest.mark.parametrize("name", sorted(FAMILIES.keys() - {"gtr"}))
def test_scaling_rotating_and_shifting_the_slopes(name):
    slopes = draw("student_t", (3.0,), 2000, seed=6, stretch=matrix(0.2, 0.3, 0.1))
    before = general(slopes, name)
    angle = 0.9
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    # A median does not turn with its slopes; without an offset of its own it does not matter.
    centred = slopes - before.mean_slope
    symmetric = np.concatenate((centred, -centred))
    symmetric_fit = general(symmetric, name)
    turned = general(symmetric @ turn.T, name)
    a, b = fitted_vector(symmetric_fit), fitted_vector(turned)
    expected = turn @ np.array([[a[0], a[2]], [a[2], a[1]]]) @ turn.T
    assert np.array([[b[0], b[2]], [b[2], b[1]]]) == pytest.approx(expected, rel=1e-3)
    assert b[3:] == pytest.approx(a[3:], rel=1e-3)
    assert turned.log_likelihood == pytest.approx(symmetric_fit.log_likelihood, rel=1e-7)

    scaled = general(1e-3 * slopes + np.array([0.25, -1.5]), name)
    assert fitted_vector(scaled)[:3] == pytest.approx(1e-3 * fitted_vector(before)[:3], rel=1e-3)
    assert fitted_vector(scaled)[3:] == pytest.approx(fitted_vector(before)[3:], rel=1e-3)
    assert scaled.log_likelihood == pytest.approx(before.log_likelihood + 2 * 2000 * math.log(1e3), rel=1e-7)
    shift = np.array([0.25, -1.5]) + 1e-3 * np.array(before.mean_slope)
    assert scaled.mean_slope == pytest.approx(shift, abs=1e-12)


@pytest.mark.parametrize(("name", "shape"), [("k0", ()), ("bessel_k", (0.7,))])
def test_quantised_slopes_and_a_density_that_is_infinite_at_zero(name, shape):
    slopes = draw(name, shape, 5000, seed=9, alpha=0.3)
    step = 0.02
    quantised = step * np.round(slopes / step)
    assert np.sum(np.all(quantised == 0, axis=1)) > 10  # at these the density is infinite
    exact, rounded = general(slopes, name), general(quantised, name)
    assert rounded.converged
    assert math.isfinite(rounded.log_likelihood)
    # Rounding costs no more than a few standard errors: the slopes at zero count as one cell.
    assert fitted_vector(rounded) == pytest.approx(fitted_vector(exact), rel=0.06, abs=0.01)
    assert rounded.log_likelihood == pytest.approx(exact.log_likelihood, rel=0.02)


def test_light_tailed_families_reach_their_limit_and_say_so():
    slopes = draw("beckmann", (), 5000, seed=12, alpha=0.2)
    result = general(slopes, "student_t")
    assert result.params["alpha_x"] == pytest.approx(0.2, rel=0.05)
    if result.params["gamma"] > 151:
        assert any("gamma is at the upper end" in note for note in result.notes)


def test_subsampling_is_stated_and_repeatable():
    slopes = draw("ggx", (), 3000, seed=13)
    first, second = (mf.fit(slopes, "ggx", max_slopes=1000)[0] for _ in range(2))
    assert first.params == second.params
    assert first.n == 1000
    assert first.notes == ("fitted to 1000 of 3000 slopes, drawn at random with seed 0",)
    assert mf.fit(slopes, "ggx", max_slopes=None)[0].notes == ()


def test_surfaces_are_fitted_at_their_lag_whether_level_or_not():
    terrain = mf.sample_terrain()
    result = general(terrain, "beckmann", max_slopes=5000)
    assert result.lag == 2
    levelled = general(terrain.level(), "beckmann", max_slopes=5000)
    assert levelled.params == pytest.approx(result.params, rel=1e-4)
    coarse = general(terrain, "beckmann", lag=8, max_slopes=5000)
    assert coarse.lag == 8
    assert coarse.params["alpha_x"] < result.params["alpha_x"]


GOOD = draw("ggx", (), 100, seed=14)


def with_value(value):
    slopes = GOOD.copy()
    slopes[7, 1] = value
    return slopes


@pytest.mark.parametrize(
    ("slopes", "options", "message"),
    [
        (GOOD[:19], {}, "at least 20"),
        (np.empty((0, 2)), {}, "at least 20"),
        (GOOD.T, {}, "Surface or real numbers of shape"),
        (GOOD.ravel(), {}, "shape"),
        (GOOD + 1j, {}, "real numbers"),
        (GOOD.astype(object), {}, "real numbers"),
        ([[1, 2], [3]], {}, "real numbers"),
        ("abc", {}, "real numbers"),
        (None, {}, "real numbers"),
        (with_value(math.nan), {}, "nan.* in row 7"),
        (with_value(-math.inf), {}, "-inf.* in row 7"),
        (with_value(1e200), {}, "in row 7"),
        (np.ones((50, 2)), {}, "constant"),
        (GOOD * [1, 0] + [0, 3], {}, r"second component is constant \(3\)"),
        (GOOD[:, :1] * [1, 2], {}, "one line"),
        (np.repeat([[0.0, 0.0], [0.1, 0.2], [0.2, 0.1]], [60, 20, 20], axis=0), {}, "more than half"),
        (GOOD, {"families": ["ggx", "phong"]}, "'phong'"),
        (GOOD, {"families": []}, "at least one family"),
        (GOOD, {"lag": 2}, "applies to a Surface"),
        (GOOD, {"max_slopes": 5}, "max_slopes"),
    ],
)
def test_bad_slopes_are_one_sentence(slopes, options, message):
    with pytest.raises(ValueError, match=message) as caught:
        mf.fit(slopes, **options)
    assert "\n" not in str(caught.value)


def test_a_flat_surface_is_one_sentence():
    y, x = np.mgrid[0:20.0, 0:20.0]
    with pytest.raises(ValueError, match="constant"):
        mf.fit(mf.Surface(2 * x - y, 1.0))


def test_many_equal_slopes_are_noted():
    slopes = draw("ggx", (), 500, seed=15)
    slopes[:100] = 0.0
    assert any("20% of the slopes equal the mean" in note for note in mf.fit(slopes, "ggx")[0].notes)


# The table of ../shared/data/README.md: alpha_max, alpha_min, gamma at lags 1, 2, 4, 8.
TABLE = {
    "SkiInfiniteFocus.x3p": "0.353/0.181 4.0   0.346/0.164 4.5   0.325/0.119 5.2   0.289/0.071 5.7",
    "di-3.di": "0.116/0.107 2.7   0.101/0.091 2.9   0.086/0.075 3.2   0.069/0.062 4.5",
    "di-4.di": "0.142/0.111 3.2   0.132/0.104 3.2   0.118/0.092 3.2   0.101/0.075 3.6",
}


@pytest.mark.parametrize("file", TABLE)
def test_measured_surfaces(file):
    pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    if not (DATA / file).exists():
        pytest.skip(f"../shared/data/{file} is not there")
    surface = mf.read_surface(DATA / file)
    numbers = np.reshape([float(number) for number in TABLE[file].replace("/", " ").split()], (4, 3))
    for lag, (large, small, gamma) in zip((1, 2, 4, 8), numbers, strict=True):
        chosen = ["ggx", "student_t"]
        student_t, ggx = mf.fit(surface, chosen, lag=lag, max_slopes=100_000, symmetry="anisotropic")
        assert (student_t.family, ggx.family) == ("student_t", "ggx")
        assert student_t.lag == lag
        assert ggx.bic - student_t.bic > 6  # of the map alone: between its regions both vary, and may tie
        alphas = sorted([student_t.params["alpha_x"], student_t.params["alpha_y"]])
        # Two draws of so many slopes differ by this much, and the table is rounded.
        assert alphas == pytest.approx([small, large], rel=0.03)
        assert student_t.params["gamma"] == pytest.approx(gamma, rel=0.06)
        errors = student_t.standard_errors
        assert abs(student_t.params["gamma"] - gamma) < 2 * errors["gamma"] + 0.05
        assert abs(alphas[1] - large) < 2 * max(errors["alpha_x"], errors["alpha_y"]) + 0.0005


@pytest.mark.parametrize("file", TABLE)
def test_halves_of_measured_surfaces_agree_or_are_said_not_to(file):
    """Each half fitted by itself: differences within 1.3 standard errors (root mean square), or a warning."""
    pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    if not (DATA / file).exists():
        pytest.skip(f"../shared/data/{file} is not there")
    surface = mf.read_surface(DATA / file)
    ny, nx = surface.heights.shape
    how = {"families": "student_t", "symmetry": "anisotropic"}
    deviations = []
    for parts in ((np.s_[:, : nx // 2], np.s_[:, nx // 2 :]), (np.s_[: ny // 2], np.s_[ny // 2 :])):
        a, b = (mf.fit(mf.Surface(surface.heights[part], surface.pixel_size), **how)[0] for part in parts)
        for name in a.params:
            error = math.hypot(a.standard_errors[name], b.standard_errors[name])
            deviations.append((a.params[name] - b.params[name]) / error)
    together = mf.fit(surface, **how)
    said = any("one population" in warning for warning in together.warnings)
    assert said or np.sqrt(np.mean(np.square(deviations))) < 1.3
    assert said == (file == "SkiInfiniteFocus.x3p")
