"""Families of one's own: what fits ask of a family, they answer as the library's do."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from microfacet._densities.standard import Standard
from microfacet._user_family import family_of


def heavy(r: Any, g: float) -> Any:
    """Student-T's density, but for its scale and factor."""
    return (1.0 + r * r / (g - 1.0)) ** -g


TAIL = mf.UserFamily("tail", heavy, {"g": (1.5, 1e300, 3.0)})


def slopes_of(ndf: Any, n: int) -> np.ndarray:
    m = ndf.sample(np.random.default_rng(4).random((n, 2)))
    return -m[:, :2] / m[:, 2:]


def test_a_family_of_one_s_own_is_fitted_like_the_library_s() -> None:
    """The same density under another name: the same parameters, errors, likelihood and goodness."""
    slopes = slopes_of(mf.StudentT(alpha_x=0.3, alpha_y=0.2, rotation=0.3, gamma=2.5), 6000)
    found = mf.fit(slopes, [TAIL, "student_t"], symmetry="anisotropic")
    one, other = sorted(found, key=lambda result: result.family)
    assert (one.family, other.family) == ("student_t", "tail")
    for name in ("alpha_x", "alpha_y", "rotation"):
        assert other.params[name] == pytest.approx(one.params[name], rel=1e-4)
        assert other.standard_errors[name] == pytest.approx(one.standard_errors[name], rel=1e-2)
    assert other.params["g"] == pytest.approx(one.params["gamma"], rel=1e-4)
    assert other.held_out == pytest.approx(one.held_out, abs=1e-7)
    assert other.goodness.anderson_darling == pytest.approx(one.goodness.anderson_darling, rel=1e-3)
    assert isinstance(other.ndf, mf.RadialNDF)
    w = np.array([0.6, 0.0, 0.8])
    assert other.ndf.sigma(w) == pytest.approx(one.ndf.sigma(w), rel=1e-6)


def test_two_parameters() -> None:
    """Beckmann's lobe and a wider one: its share and its width, found within their errors."""

    def lobes(r: Any, share: float, wider: float) -> Any:
        return (1 - share) * np.exp(-(r**2)) + share / wider**2 * np.exp(-((r / wider) ** 2))

    rng = np.random.default_rng(9)
    width = np.where(rng.random(12_000) < 0.3, 0.6, 0.2)
    slopes = rng.normal(size=(12_000, 2)) * width[:, np.newaxis] / np.sqrt(2)
    family = mf.UserFamily("lobes", lobes, {"share": (0.0, 1.0, 0.5), "wider": (1.0, 20.0, 2.0)})
    found = mf.fit(slopes, [family, "beckmann"])[0]
    assert (found.family, found.symmetry, found.converged) == ("lobes", "isotropic", True)
    for name, true in {"alpha": 0.2, "share": 0.3, "wider": 3.0}.items():
        assert abs(found.params[name] - true) < 4 * found.standard_errors[name] < 0.5 * true
    theta = np.radians(np.arange(0.0, 80.0, 2.0))
    D = lobes(np.tan(theta) / 0.2, 0.3, 3.0) / np.cos(theta) ** 4
    table = mf.fit_table(density=(theta, D), families=family)[0]
    assert (table.params["share"], table.params["wider"]) == pytest.approx((0.3, 3.0), rel=1e-3)


def test_of_a_density_the_roughness_is_fitted() -> None:
    slopes = slopes_of(mf.GGX(alpha_x=0.3, alpha_y=0.2), 4000)
    own = mf.RadialNDF(lambda r: (1.0 + r * r) ** -2.0)
    found = mf.fit(slopes, [own, "ggx", "beckmann"])
    results = {(result.family, result.symmetry): result for result in found}
    for symmetry in ("isotropic", "anisotropic"):
        ours, ggx = results["density", symmetry], results["ggx", symmetry]
        assert ours.params == pytest.approx(ggx.params, rel=1e-6)
        assert not results["beckmann", symmetry].tied
        assert ours.ndf.norm == own.norm  # the tables that there are


def test_tables_of_data() -> None:
    theta = np.radians(np.arange(0, 80, 5))
    own = mf.RadialNDF(lambda r: (1.0 + r * r) ** -2.0)
    found = mf.fit_table(density=(theta, 7 * mf.ggx.D(np.cos(theta), 0.2)), families=[own, "beckmann"])
    assert found[0].family == "density"
    assert found[0].params == pytest.approx({"alpha": 0.2, "scale": 7.0}, rel=1e-6)
    slopes = slopes_of(mf.Beckmann(alpha=0.3), 4000)[:, 0]
    counts, edges = np.histogram(slopes, 24)
    gauss = mf.UserFamily("gauss", lambda r: np.exp(-(r**2)))
    one, other = mf.fit_table(histogram=(edges, counts), families=[gauss, "beckmann"])
    assert one.params == pytest.approx(other.params, rel=1e-4)
    square = mf.fit_table(mean_square_slopes=0.02, families=[gauss, "beckmann"])
    assert square[0].params == pytest.approx(square[1].params, rel=1e-6)


def test_lags_of_a_surface() -> None:
    surface = mf.Surface(np.random.default_rng(1).normal(size=(128, 128)), 10.0)
    gauss = mf.UserFamily("gauss", lambda r: np.exp(-(r**2)))
    ours, theirs = (mf.fit_scales(surface, [1, 2], family) for family in (gauss, "beckmann"))
    assert ours.typical_slopes == pytest.approx(theirs.typical_slopes, rel=1e-5)


@pytest.mark.parametrize("density", ["beckmann", "ggx"])
def test_quadrature_gives_probabilities(density: str) -> None:
    kernels = getattr(mf, density)
    standard = Standard(lambda r: 3.0 * kernels.P22(r, 0.0, 1.0))
    assert standard.norm == pytest.approx(3.0, rel=1e-12)
    r, xi, p = np.geomspace(1e-4, 5.0, 30), np.linspace(0.001, 0.999, 30), np.linspace(-3.0, 3.0, 31)
    np.testing.assert_allclose(standard.survival(r), kernels.survival(r, 1.0), rtol=1e-6)
    np.testing.assert_allclose(standard.quantile(xi), kernels.sample_slope(xi, 1.0), rtol=1e-7)
    np.testing.assert_allclose(standard.slope_cdf(p), kernels.slope_cdf(p, 1.0), rtol=1e-5)


def test_a_family_travels() -> None:
    assert pickle.loads(pickle.dumps(TAIL)) == TAIL
    own = family_of(mf.RadialNDF(lambda r: np.exp(-(r**2)), alpha=0.3), "mine")
    again = pickle.loads(pickle.dumps(own))
    assert again == own
    assert again.roughness == {"alpha": 0.3}
    assert again.kernels.sigma(0.5, 0.3) == own.kernels.sigma(0.5, 0.3)
    assert repr(TAIL) == "<UserFamily tail: alpha, g>"


SENTENCES: dict[str, tuple[Any, str]] = {
    "name": (lambda: mf.UserFamily("my family", heavy), "name must be a word"),
    "taken": (lambda: mf.UserFamily("ggx", heavy), "ggx is a family of the library"),
    "no callable": (lambda: mf.UserFamily("mine", 3), "P22 must be callable"),
    "interval": (lambda: mf.UserFamily("mine", heavy, {"g": (1, 2)}), r"must be \(lower, upper, start\)"),
    "start": (lambda: mf.UserFamily("mine", heavy, {"g": (1, 2, 3)}), "a start inside"),
    "no end": (lambda: mf.UserFamily("mine", heavy, {"g": (-np.inf, 2, 1)}), "a finite lower end"),
    "alpha": (
        lambda: mf.UserFamily("mine", heavy, {"alpha": (0, 2, 1)}),
        "cannot be the name of a parameter",
    ),
    "unknown": (lambda: mf.fit(np.eye(40)[:, :2], ["mine"]), "families must be among"),
    "twice": (
        lambda: mf.fit(np.random.default_rng(1).normal(size=(40, 2)), [TAIL, mf.UserFamily("tail", np.exp)]),
        "two have the name tail",
    ),
    "heavy": (
        lambda: mf.fit(
            np.random.default_rng(1).normal(size=(400, 2)),
            mf.UserFamily("flat", lambda r: 1 / (1 + r * r)),
        ),
        "flat: P22 must be integrable over the plane",
    ),
    "bake": (lambda: mf.bake("energy", TAIL, alpha=0.3), "tail has free parameters"),
}


@pytest.mark.parametrize("case", SENTENCES)
def test_bad_input_is_one_sentence(case: str) -> None:
    call, message = SENTENCES[case]
    with pytest.raises(ValueError, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)
