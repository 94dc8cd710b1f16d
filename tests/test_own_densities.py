"""Densities of one's own have what families have: visible normals, materials, and all that stands on them."""

from __future__ import annotations

import pathlib
from typing import Any

import mpmath
import numpy as np
import pytest

import microfacet as mf
from microfacet._densities.constructors import _lengths
from microfacet.testing import chi2
from own_cases import FUNCTIONS, NAMES, mean_excess, own, towards

each = pytest.mark.parametrize("name", NAMES)
TESTS = 2 * len(NAMES)


@each
@pytest.mark.parametrize("scheme", ["continuous", "mixture"])
def test_visible_normals_follow_their_density(name: str, scheme: str) -> None:
    alphas, degrees = (0.1, 0.5, 1.0), (30.0, 60.0, 80.0, 88.0, 95.0, 130.0)
    number = NAMES.index(name)
    at = degrees[(2 * number + (scheme == "mixture")) % len(degrees)]
    ndf, w = own(name).with_roughness(alphas[number % len(alphas)]), towards(at)
    dims = ndf.mixture_dims if scheme == "mixture" else ndf.visible_dims
    result = chi2(
        lambda xi: ndf.sample_visible(w, xi, scheme=scheme),
        lambda m: ndf.pdf_visible(m, w),
        n=100_000,
        dims=dims,
        seed=number,
        tests=TESTS,
    )
    assert result, (name, scheme, at, result)


@each
def test_white_furnace_of_all_orders(name: str) -> None:
    metal, w = mf.Conductor(own(name).with_roughness(0.5), scattering="multiple"), towards(70.0)
    value, error = metal.albedo(w, n=4000, rng=NAMES.index(name), with_error=True)
    assert abs(value - 1.0) <= 4.0 * error + 1e-9


@pytest.mark.parametrize("name", FUNCTIONS)
def test_Lambda_is_that_of_arbitrary_precision(name: str) -> None:
    ndf = own(name).with_roughness(0.5)
    for u in (0.2, 0.6):
        cotangent = mpmath.mpf(u) / mpmath.sqrt(1 - mpmath.mpf(u) ** 2) / mpmath.mpf(0.5)
        with mpmath.workdps(30):
            exact = mean_excess(name, cotangent) / cotangent
        found = ndf.Lambda([np.sqrt(1 - u * u), 0.0, u])
        assert found == pytest.approx(float(exact), rel=max(1e-12, 4 * ndf.error))


@each
def test_error_of_the_tables_is_stated(name: str) -> None:
    assert 0.0 < own(name).error < 1e-6
    assert f"error={own(name).error:.1e}" in repr(own(name))


def test_samples_give_back_their_density() -> None:
    """Of 1e5 normals of a family: sigma to a thousandth, the density to some percent, the tail's power."""
    exact = mf.StudentT(alpha=0.3, gamma=2.5)
    found = mf.RadialNDF.from_samples(exact.sample(np.random.default_rng(5).random((100_000, 2))))
    w = np.stack([towards(angle) for angle in (30.0, 60.0, 80.0, 95.0)])
    np.testing.assert_allclose(found.sigma(w), exact.sigma(w), rtol=2e-2)
    np.testing.assert_allclose(found.sigma(w[:3]), exact.sigma(w[:3]), rtol=2e-3)
    r = np.array([0.03, 0.1, 0.3, 0.6, 1.2])
    np.testing.assert_allclose(found.P22(r, 0.0), exact.P22(r, 0.0), rtol=0.1)
    assert found.P22(0.0, 0.0) < 1.5 * exact.P22(0.0, 0.0)


def test_what_samples_are() -> None:
    """Slopes, normals and a SlopeSample are the same; their mean is subtracted."""
    slopes = np.random.default_rng(2).normal(size=(2000, 2)) * 0.3 + [0.2, -0.1]
    lengths = _lengths(slopes)
    assert np.median(lengths) == pytest.approx(0.3 * np.sqrt(2 * np.log(2)), rel=0.05)
    np.testing.assert_allclose(_lengths(np.column_stack((-slopes, np.ones(2000)))), lengths)
    np.testing.assert_array_equal(_lengths(mf.SlopeSample(slopes, "here")), lengths)


def test_histogram_of_an_exact_law() -> None:
    edges = np.append(np.linspace(0.0, 3.0, 31), np.inf)
    counts = -1e6 * np.diff(np.exp(-(np.append(edges[:-1], 1e3) ** 2)))
    found, exact = mf.RadialNDF.from_histogram(edges, counts, alpha=0.4), mf.Beckmann(0.4)
    w = np.stack([towards(angle) for angle in (30.0, 60.0, 80.0)])
    np.testing.assert_allclose(found.sigma(w), exact.sigma(w), rtol=1e-3)


def test_of_a_fit_the_slopes_or_the_family() -> None:
    result = mf.fit(mf.sample_terrain(), "student_t", lag=8)[0]
    family, measured = (mf.RadialNDF.from_fit(result, measured=m) for m in (False, True))
    w = np.stack([towards(angle) for angle in (60.0, 80.0, 88.0)])
    np.testing.assert_allclose(family.sigma(w), result.ndf.sigma(w), rtol=1e-12)
    np.testing.assert_allclose(measured.sigma(w), result.ndf.sigma(w), rtol=0.02)


SLOPES = np.random.default_rng(1).normal(size=(300, 2))
SENTENCES: dict[str, tuple[Any, str]] = {
    "negative": (lambda: mf.RadialNDF(lambda r: 1.0 - r), "must be finite and not negative"),
    "not integrable": (lambda: mf.RadialNDF(lambda r: 1.0 / (1.0 + r * r)), "must be integrable"),
    "few samples": (lambda: mf.RadialNDF.from_samples(SLOPES[:100]), "200 slopes at least are needed"),
    "equal samples": (lambda: mf.RadialNDF.from_samples(np.zeros((300, 2))), "most of the slopes have one"),
    "shape": (lambda: mf.RadialNDF.from_samples(SLOPES.T), r"slopes \(N, 2\) or normals"),
    "nan": (lambda: mf.RadialNDF.from_samples(np.full((300, 2), np.nan)), "must be finite, got"),
    "below": (lambda: mf.RadialNDF.from_samples(-np.ones((300, 3))), "z > 0"),
    "text": (lambda: mf.RadialNDF.from_samples([["a", "b"]] * 300), "slopes"),
    "few counts": (lambda: mf.RadialNDF.from_histogram([0, 1, 2, 3, 4], [1, 2, 3, 4]), "200 counts at least"),
    "one bin": (lambda: mf.RadialNDF.from_histogram([0, 1, 2], [500, 400]), "4 bins"),
    "edges": (lambda: mf.RadialNDF.from_histogram([0, 2, 1], [500, 400]), "edges must increase"),
    "counts": (lambda: mf.RadialNDF.from_histogram([0, 1, 2], [500, -4]), "counts must not be negative"),
    "angles": (lambda: mf.RadialNDF.from_D([0.0, 2.0], [1.0, 1.0]), r"theta must increase in \[0, pi/2\]"),
    "D": (lambda: mf.RadialNDF.from_D(np.linspace(0, 1, 9), -np.ones(9)), "D must not be negative"),
    "values": (lambda: mf.RadialNDF.from_D(np.linspace(0, 1, 9), np.ones(8)), "as many values as angles"),
    "both": (lambda: mf.RadialNDF.from_D([0.1], [1.0], u=[0.9]), "either theta or u"),
    "hole": (
        lambda: mf.RadialNDF.from_D(np.linspace(0, 1, 19), np.where(np.arange(19) == 9, 0.0, 1.0)),
        "must be positive between its ends",
    ),
    "no fit": (lambda: mf.RadialNDF.from_fit(3), "one that fit returned"),
}


@pytest.mark.parametrize("case", SENTENCES)
def test_bad_input_is_one_sentence(case: str) -> None:
    call, message = SENTENCES[case]
    with pytest.raises(ValueError, match=message) as caught:
        call()
    assert str(caught.value).startswith("RadialNDF: ")
    assert "\n" not in str(caught.value)


def test_without_a_mean_slope_there_is_no_Lambda() -> None:
    ndf = mf.RadialNDF(lambda r: (1.0 + r * r) ** -1.4)
    assert np.isnan(ndf.Lambda([0.6, 0.0, 0.8]))
    assert ndf.D([0.0, 0.0, 1.0]) > 0.0


def test_bakes_and_compensation_tell_densities_apart() -> None:
    one, other = own("quartic"), own("heavy")
    table = mf.bake("energy", one, alpha=[0.2, 0.4], cos_theta=4)
    assert table.attrs["family"] == "density"
    metal = mf.Conductor(one.with_roughness(0.3), 0.2, 3.0)
    assert mf.KullaConty(metal, table).material is metal
    with pytest.raises(ValueError, match="the material of another density"):
        mf.KullaConty(mf.Conductor(other.with_roughness(0.3), 0.2, 3.0), table)
    lost = 1 - mf.Conductor(one.with_roughness(0.4)).albedo([np.sqrt(0.75), 0.0, 0.5])
    assert float(table.missing.sel(alpha=0.4, cos_theta=0.5)) == pytest.approx(lost, rel=1e-6)


def test_a_table_that_is_written_says_which_density(tmp_path: pathlib.Path) -> None:
    table = mf.bake("energy", own("quartic"), alpha=0.3, cos_theta=2, output=tmp_path / "own.zarr")
    assert len(table.attrs["density"]) == 64
    mf.bake("energy", own("heavy"), alpha=0.3, cos_theta=2, output=tmp_path / "own.zarr")  # takes its place


def test_textures() -> None:
    table = mf.lookup_texture("split_sum", own("quartic"), size=(4, 4), check=0)
    scale, bias = table.lookup(0.9, 0.5)
    assert 0.7 < scale + bias < 1.0
    assert "--density FILE" in table.command
    assert "density_" in table.snippet("c")


def test_maps_follow_a_density() -> None:
    """A mixture is synthesised and found again; a ring has no such map."""
    ndf = mf.RadialNDF(lambda r: (1 + r * r) ** -2.5, alpha_x=0.3, alpha_y=0.2, rotation=0.4)
    surface = mf.synthesize(ndf, (512, 512), seed=3)
    best = mf.fit(surface, "student_t")[0]
    assert best.params["gamma"] == pytest.approx(2.5, rel=0.15)
    assert "own density" in surface.source
    with pytest.raises(ValueError, match="no mixture of Beckmann surfaces"):
        mf.synthesize(own("ring"), (64, 64))


def test_plots() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    from matplotlib import pyplot as plt

    from microfacet import plot

    for draw in (plot.density, plot.joint, plot.marginal, plot.sigma, plot.Lambda, plot.histogram):
        _, ax = plt.subplots()
        draw(own("lobes").with_roughness(0.3), ax)
        assert len(ax.lines) == 1
    slopes = np.random.default_rng(1).normal(size=(500, 2))
    assert plot.slope_histogram(slopes, {"own": own("lobes")}, ax, azimuth=0.3).lines
    plt.close("all")


def test_exports_draw_visible_normals() -> None:
    text = mf.export("c", own("heavy").with_roughness(0.3), ["D", "sample_visible", "conductor"])
    assert "sample_visible" in text
    functions = mf.array_functions(own("heavy").with_roughness(0.3))
    w = towards(60.0)
    assert float(functions.sigma(w)) == pytest.approx(own("heavy").with_roughness(0.3).sigma(w), rel=1e-6)
