"""Tables of BRDFs: energy, reciprocity, directions, indices of refraction, ABg and the lateral scales."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from brdf_cases import GOLD, GROUND, NM, ROUGH, TABLES
from microfacet._optics import grid
from microfacet._optics.abg import fit_abg


def fine(reference: str, step: float) -> dict[str, Any]:
    """A grid whose cells' middles are the nodes."""
    most = 90 if reference == "normal" else 180
    return {
        "polar": np.arange(step / 2, most, step),
        "azimuth": np.arange(0, 360, 2 * step),
        "reference": reference,
    }


def integral(table: mf.BrdfTable, values: Any, step: float) -> Any:
    """Over the directions of the table, with the cosine."""
    cosine = np.maximum(table.directions()[1][..., 2], 0.0)
    solid = np.sin(np.radians(table.polar)) * np.radians(step) * np.radians(2 * step)
    return np.sum(values * cosine * solid, axis=(-1, -2))


@pytest.mark.parametrize("reference", ["normal", "specular"])
@pytest.mark.parametrize(
    ("ndf", "index"), [(ROUGH, GOLD), (GROUND, 1.5), (GROUND, np.inf), (mf.GTR(alpha=0.3, gamma=2.0), 1 + 3j)]
)
def test_the_table_holds_the_energy_of_all_orders(ndf: Any, index: Any, reference: str) -> None:
    table = mf.brdf_table(ndf, NM, index, theta_i=[0, 50], phi_i=[20], n=64, **fine(reference, 2.0), rng=1)
    np.testing.assert_allclose(integral(table, table.single, 2.0), table.albedo_single, rtol=5e-3)
    found = integral(table, table.values, 2.0)
    tolerance = 4 * table.albedo_error + 0.01 * table.albedo
    assert np.all(np.abs(found - table.albedo) < tolerance), (found, table.albedo)
    assert np.all(table.albedo >= table.albedo_single - 4 * table.albedo_error)
    assert np.all(table.values >= table.single)


def test_a_white_surface_loses_nothing() -> None:
    table = mf.brdf_table(mf.GGX(alpha=1.0), theta_i=[0, 60], polar=0, azimuth=0, n=16)
    np.testing.assert_allclose(table.albedo, 1.0, atol=1e-12)
    assert np.all(table.albedo_single < 0.7)


def test_first_order_is_that_of_the_material() -> None:
    table = mf.brdf_table(GROUND, NM, GOLD, theta_i=[10, 70], phi_i=[0, 35], scattering="single")
    wi, wo = table.directions()
    metal = mf.Conductor(GROUND, np.real(GOLD), np.imag(GOLD))
    for place in np.ndindex(table.values.shape[1:]):
        if place[2] % 5 or place[3] % 4:
            continue
        expected = metal.eval(wi[place[:2]], wo[place]) / wo[place][2]
        np.testing.assert_allclose(table.values[(slice(None), *place)], expected, rtol=1e-12)
    np.testing.assert_array_equal(table.values, table.single)
    np.testing.assert_array_equal(table.albedo, table.albedo_single)
    assert not table.errors.any()


def test_light_and_scattered_light_may_be_exchanged() -> None:
    angles = {"theta_i": [20, 60], "polar": [20, 60], "azimuth": [180.0], "n": 2**15}
    values = mf.brdf_table(ROUGH, 500e-9, GOLD[0], **angles)
    there, back = values.values[0, 0, 0, 0, 1], values.values[0, 1, 0, 0, 0]
    error = math.hypot(values.errors[0, 0, 0, 0, 1], values.errors[0, 1, 0, 0, 0])
    assert abs(there - back) < 4 * error < 0.02 * there
    assert values.single[0, 0, 0, 0, 1] == pytest.approx(values.single[0, 1, 0, 0, 0], rel=1e-12)


def test_errors_are_the_scatter_between_seeds() -> None:
    angles = {"theta_i": [60], "polar": [20, 70], "azimuth": [0.0, 180.0], "n": 64}
    tables = [mf.brdf_table(mf.GGX(alpha=0.8), **angles, rng=seed) for seed in range(40)]
    scatter = np.std([table.values for table in tables], axis=0, ddof=1)
    stated = np.sqrt(np.mean([table.errors**2 for table in tables], axis=0))
    np.testing.assert_allclose(stated, scatter, rtol=0.35)


def test_what_passes_a_dielectric() -> None:
    grid_of = {"polar": np.arange(0.5, 90, 1.0), "azimuth": np.arange(0, 360, 2.0), "theta_i": [0, 50]}
    passed = mf.brdf_table(ROUGH, 500e-9, 1.5, scatter="BTDF", n=64, **grid_of)
    wo = passed.directions()[1]
    assert np.all(wo[..., 2] < 0)
    solid = np.sin(np.radians(passed.polar)) * np.radians(1.0) * np.radians(2.0)
    found = np.sum(passed.single * np.abs(wo[..., 2]) * solid, axis=(-1, -2))
    np.testing.assert_allclose(found, passed.albedo_single, rtol=5e-3)
    reflected = mf.brdf_table(ROUGH, 500e-9, 1.5, theta_i=[0, 50], polar=0, azimuth=0, n=16)
    np.testing.assert_allclose(passed.albedo + reflected.albedo, 1.0, atol=4e-3)


# Directions


@pytest.mark.parametrize(("theta", "phi"), [(0.0, 0.0), (0.0, 70.0), (40.0, 0.0), (65.0, 130.0)])
def test_angles_about_the_specular_direction(theta: float, phi: float) -> None:
    wi = grid.from_normal(theta, phi)
    s = grid.specular(wi)
    radial, azimuth = np.array([0.0, 10.0, 25.0]), np.array([0.0, 90.0, 180.0, 300.0])
    wo = grid.from_specular(wi, phi, radial, azimuth[:, np.newaxis])
    np.testing.assert_allclose(np.linalg.norm(wo, axis=-1), 1.0, rtol=1e-14)
    np.testing.assert_allclose(wo @ s, np.broadcast_to(np.cos(np.radians(radial)), (4, 3)), atol=1e-14)
    # Azimuth 0 leads towards the normal, and on towards the light; 90 and 270 mirror each other.
    towards = grid.from_normal(theta - 10, phi + 180)
    np.testing.assert_allclose(wo[0, 1], towards, atol=1e-14)
    np.testing.assert_allclose(wo[2, 1], grid.from_normal(theta + 10, phi + 180), atol=1e-14)


def test_the_specular_direction_is_the_first_of_its_own_grid() -> None:
    about_normal = mf.brdf_table(GROUND, theta_i=[30], phi_i=[50], polar=[30], azimuth=[230], n=16)
    about_mirror = mf.brdf_table(
        GROUND, theta_i=[30], phi_i=[50], polar=[0], azimuth=[0], reference="specular", n=16
    )
    assert about_mirror.single.item() == pytest.approx(about_normal.single.item(), rel=1e-12)


@pytest.mark.parametrize(
    ("ndf", "phi_i", "symmetric"),
    [
        (ROUGH, 10.0, True),
        (GROUND, 10.0, False),
        (GROUND, math.degrees(0.3), True),
        (mf.GTR(0.3, 2.0), 5.0, True),
    ],
)
def test_symmetry(ndf: Any, phi_i: float, symmetric: bool) -> None:
    table = mf.brdf_table(ndf, theta_i=[40], phi_i=phi_i, reference="specular", polar=[0, 20], n=16)
    assert (table.azimuth[-1] == 180) == symmetric
    whole = mf.brdf_table(
        ndf, theta_i=[40], phi_i=phi_i, reference="specular", polar=[20], azimuth=[70, 290], n=16
    ).single.ravel()
    assert (whole[0] == pytest.approx(whole[1], rel=1e-9)) == symmetric


def test_infinite_values_become_means_and_say_so() -> None:
    angles = {"theta_i": [40], "reference": "specular", "polar": [0, 5], "azimuth": [0], "n": 16}
    table = mf.brdf_table(mf.K0(alpha=0.3), **angles)
    assert np.isfinite(table.values).all()
    assert table.values[0, 0, 0, 0, 0] > table.values[0, 0, 0, 0, 1]
    assert table.notes[0].startswith("1 values in the mirror direction are infinite")
    smooth = mf.brdf_table(mf.GGX(alpha=0.3), **angles)
    assert smooth.notes == ()


# Refractive indices


@pytest.mark.parametrize("name", TABLES)
def test_tables_of_indices(name: str, tmp_path: Path) -> None:
    path = tmp_path / "gold.csv"
    path.write_text(TABLES[name], encoding="utf-8")
    where, index = mf.read_refractive_index(path)
    np.testing.assert_allclose(where, NM)
    np.testing.assert_allclose(index, GOLD)
    table = mf.brdf_table(ROUGH, [550e-9, 600e-9], path, theta_i=0, polar=0, azimuth=0, n=16)
    np.testing.assert_allclose(table.index, [0.61 + 2.385j, GOLD[1]])
    by_arrays = mf.brdf_table(ROUGH, 550e-9, (NM, GOLD), theta_i=0, polar=0, azimuth=0, n=16)
    np.testing.assert_allclose(by_arrays.index, [0.61 + 2.385j])


def test_the_sign_of_absorption_is_a_convention() -> None:
    ways = [
        mf.brdf_table(ROUGH, 5e-7, index, theta_i=0, polar=0, azimuth=0, n=16) for index in (2 + 3j, 2 - 3j)
    ]
    assert ways[0] == ways[1]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no numbers"),
        ("500,0.97,1.87\n", "first line must name the columns"),
        ("wavelength,n\n500,1\n", "with its unit"),
        ("wavelength_ft,n\n500,1\n", "with its unit"),
        ("wavelength_nm,k\n500,1\n", "no column n"),
        ("wavelength_nm,n\n500,1,2\n", "2 numbers a line"),
        ("wavelength_nm,n\n500,-1\n", "n in"),
        ("wavelength_nm,n\n500,nan\n", "n in"),
        ("wavelength_m,n\n500,1.5\n", "wavelengths must lie"),
        ("wl,n\n0.5,1\nwl,k\n0.6,1\n", "different wavelengths"),
    ],
)
def test_bad_tables_of_indices_are_one_sentence(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=words):
        mf.read_refractive_index(path)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"wavelengths": 550}, "wavelengths must lie"),
        ({"wavelengths": []}, "wavelengths must be"),
        ({"wavelengths": [5e-7, 5e-7]}, "differ"),
        ({"index": -1.5}, "n in"),
        ({"index": [1.5, 1.6]}, "index must be one number or one for each of 1"),
        ({"index": (NM, GOLD), "wavelengths": 700e-9}, "known from 5e-07 to 6e-07 m, not at 7e-07"),
        ({"index": "nowhere.csv"}, "nowhere.csv"),
        ({"theta_i": 90}, r"theta_i must lie in \[0, 90\) degrees, got 90"),
        ({"theta_i": [30, 10]}, "theta_i must ascend"),
        ({"polar": 91}, "polar must lie"),
        ({"azimuth": -1}, "azimuth must lie"),
        ({"reference": "sun"}, "reference must be normal or specular"),
        ({"scatter": "BTDF"}, "a BTDF needs k = 0"),
        ({"scatter": "BTDF", "reference": "specular"}, "reference must be normal for a BTDF"),
        ({"n": 3}, r"n must be a whole number in \[16"),
    ],
)
def test_bad_arguments_are_one_sentence(options: dict[str, Any], words: str) -> None:
    with pytest.raises((ValueError, OSError), match=words):
        mf.brdf_table(ROUGH, **options)


# ABg and the lateral scales


def test_abg_returns_what_an_abg_model_was_made_from() -> None:
    x = np.linspace(0, 1.5, 200)
    for truth in ((0.01, 1e-3, 1.8), (1.0, 0.1, 3.0), (1e-4, 1e-6, 2.4)):
        a, b, g = truth
        *found, residual = fit_abg(x, a / (b + x**g))
        assert found == pytest.approx(truth, rel=1e-4)
        assert residual < 1e-6


def test_abg_follows_a_power_law_and_says_that_it_does_not_follow_beckmann() -> None:
    angles = {"theta_i": [0], "reference": "specular", "polar": np.linspace(0, 20, 41), "n": 64}
    close = mf.brdf_table(mf.GGX(alpha=0.02), **angles).abg()[0]
    far = mf.brdf_table(mf.Beckmann(alpha=0.05), **angles).abg()[0]
    assert close.residual < 0.05 < 0.2 < far.residual
    assert 3.3 < close.g < 4  # GGX falls as the fourth power of the slope, far out


def test_the_grating_equation() -> None:
    band = mf.spatial_bandwidth(500e-9, 30.0, scatter_angle=10.0)
    theta = math.radians(30)
    assert math.sin(theta) - 500e-9 / band.shortest == pytest.approx(-1.0)  # backwards along the surface
    assert math.degrees(math.asin(math.sin(theta) - 500e-9 / band.longest)) == pytest.approx(20.0)
    assert mf.spatial_bandwidth(500e-9).shortest == pytest.approx(500e-9)
    assert band.specular_fraction is band.phase_variance is None
    smooth = mf.spatial_bandwidth(633e-9, Sq=1e-9)
    assert 1 - smooth.specular_fraction == pytest.approx((4 * math.pi * 1e-9 / 633e-9) ** 2, rel=1e-3)


@pytest.mark.parametrize(
    ("Sq", "baseline", "words"),
    [
        (None, None, []),
        (None, 1e-7, ["finer than light of 500 nm resolves"]),
        (None, 1e-6, []),
        (None, 2e-5, ["40 times the shortest period"]),
        (5e-9, None, ["stays specular by diffraction"]),
        (1e-6, None, []),
    ],
)
def test_remarks_on_scales(Sq: float | None, baseline: float | None, words: list[str]) -> None:
    first, *others = mf.spatial_bandwidth(500e-9, Sq=Sq).remarks(baseline)
    assert "S-filter of 5e-07 m" in first
    assert len(others) == len(words)
    assert all(word in line for word, line in zip(words, others, strict=True))


@pytest.mark.parametrize(
    "arguments", [(0.0,), (math.nan,), (5e-7, 90.0), (5e-7, -1.0), (5e-7, 0.0, 0.0), (5e-7, 0.0, 1.0, -1.0)]
)
def test_bad_bands_are_one_sentence(arguments: tuple[float, ...]) -> None:
    names = ("wavelength", "theta_i", "scatter_angle", "Sq")
    with pytest.raises(ValueError, match="must"):
        mf.spatial_bandwidth(**dict(zip(names, arguments, strict=False)))
