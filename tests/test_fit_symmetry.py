"""Isotropic and anisotropic fits: identities between them, and what is asked for is what is fitted."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import microfacet as mf
from microfacet.cli import main

FAMILIES = {family.name: family for family in mf.families() if not family.singular}
STRETCHED = sorted(name for name, family in FAMILIES.items() if family.anisotropic)
ISOTROPIC_BY_NATURE = sorted(FAMILIES.keys() - set(STRETCHED))
SLOPES = np.random.default_rng(1).standard_t(5, size=(1000, 2)) * [0.1, 0.2]


def turned(slopes: np.ndarray, angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return slopes @ np.array([[c, s], [-s, c]])


@pytest.mark.parametrize("name", STRETCHED)
def test_slopes_without_direction_have_the_same_maximum_in_both(name: str) -> None:
    """Slopes, their mirror images and the same turned by a quarter: no axes, so that both roughnesses are
    one, and the likelihood is the same.
    """
    slopes = np.concatenate([turned(sign * SLOPES, angle) for angle in (0.0, np.pi / 2) for sign in (1, -1)])
    results = {result.symmetry: result for result in mf.fit(slopes, name)}
    isotropic, anisotropic = results["isotropic"], results["anisotropic"]
    alpha = isotropic.params["alpha"]
    assert anisotropic.roughness == pytest.approx((alpha, alpha), rel=1e-4)
    assert anisotropic.log_likelihood == pytest.approx(isotropic.log_likelihood, abs=1e-3)
    own = [parameter.name for parameter in FAMILIES[name].parameters[1:]]
    for parameter in own:
        assert anisotropic.params[parameter] == pytest.approx(isotropic.params[parameter], rel=1e-3)
        errors = (result.standard_errors[parameter] for result in (isotropic, anisotropic))
        assert next(errors) == pytest.approx(next(errors), rel=0.01, nan_ok=True)
    assert len(anisotropic.params) == len(isotropic.params) + 2
    assert (isotropic.roughness, isotropic.ndf.alpha_x) == ((alpha, alpha), alpha)
    assert mf.fit(slopes, name)[0].symmetry == "isotropic", "of two equal ones the simpler is first"


@pytest.mark.parametrize("name", FAMILIES)
def test_an_isotropic_fit_does_not_see_directions(name: str) -> None:
    centred = np.concatenate((SLOPES, -SLOPES))
    fits = [mf.fit(turned(centred, angle), name, symmetry="isotropic") for angle in (0.0, 0.7)]
    (before,), (after,) = fits
    assert after.params == pytest.approx(before.params, rel=1e-4)
    assert after.standard_errors == pytest.approx(before.standard_errors, rel=1e-3, nan_ok=True)
    assert after.log_likelihood == pytest.approx(before.log_likelihood, rel=1e-8)
    (general,) = mf.fit(centred, name, symmetry="anisotropic" if name in STRETCHED else None)
    assert general.log_likelihood >= before.log_likelihood - 1e-6


def test_isotropic_beckmann_has_a_closed_form() -> None:
    """alpha^2 = E[r^2], with the error of a mean."""
    (result,) = mf.fit(SLOPES, "beckmann", symmetry="isotropic")
    squares = np.sum((SLOPES - result.mean_slope) ** 2, axis=1)
    assert result.params == {"alpha": pytest.approx(math.sqrt(np.mean(squares)), rel=1e-7)}
    error = np.std(squares) / math.sqrt(len(squares)) / (2 * result.params["alpha"])
    assert result.standard_errors == {"alpha": pytest.approx(error, rel=1e-4)}
    assert result.log_likelihood == pytest.approx(
        -len(squares) * (1 + math.log(math.pi * np.mean(squares))), rel=1e-9
    )
    assert result.bic == pytest.approx(math.log(len(squares)) - 2 * result.log_likelihood)


def test_what_is_asked_for_is_fitted() -> None:
    both = [(name, own) for name in STRETCHED for own in ("anisotropic", "isotropic")]
    both += [(name, "isotropic") for name in ISOTROPIC_BY_NATURE]
    for symmetry in (None, "isotropic", "anisotropic"):
        found = [(one.family, one.symmetry) for one in mf.fit(SLOPES[:200], symmetry=symmetry)]
        assert sorted(found) == sorted(pair for pair in both if symmetry in (None, pair[1]))
    surface = mf.Surface(np.random.default_rng(1).normal(size=(64, 64)), 1.0)
    scales = mf.fit_scales(surface, [1, 2], "ggx", symmetry="isotropic")
    assert [[one.symmetry for one in at] for at in scales.results] == [["isotropic"]] * 2
    for name in ISOTROPIC_BY_NATURE:
        with pytest.raises(ValueError, match=f"symmetry: {name} can only be isotropic, got 'anisotropic'"):
            mf.fit(SLOPES, ["ggx", name], symmetry="anisotropic")
    with pytest.raises(
        ValueError, match='symmetry must be "isotropic", "anisotropic" or None, got \'round\''
    ):
        mf.fit(SLOPES, symmetry="round")


def test_densities_of_one_s_own_have_both() -> None:
    own = mf.UserFamily("own", lambda r: (1 + r * r) ** -2.5)
    for candidate in (own, mf.RadialNDF(lambda r: (1 + r * r) ** -2.5)):
        first, second = mf.fit(SLOPES, candidate)
        assert (first.symmetry, second.symmetry) == ("anisotropic", "isotropic")
        (x, y), (alpha, _) = first.roughness, second.roughness
        assert y == pytest.approx(2 * x, rel=0.1)
        assert x < alpha < y


def test_a_radial_density_of_either_fit() -> None:
    w = np.array([math.sin(1.4) * 0.8, math.sin(1.4) * 0.6, math.cos(1.4)])
    for result in mf.fit(SLOPES, "k0"):
        own = mf.RadialNDF.from_fit(result, measured=False)
        assert own.Lambda(w) == pytest.approx(result.ndf.Lambda(w), rel=1e-6)
        measured = mf.RadialNDF.from_fit(result)
        assert measured.alpha_x == pytest.approx(result.ndf.alpha_x)


def run(*arguments: Any) -> Any:
    return CliRunner().invoke(main, [*map(str, arguments)])


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "slopes.csv"
    np.savetxt(path, SLOPES, delimiter=",")
    return path


def test_the_command_fits_one_or_both(file: Path) -> None:
    for options, expected in (
        ([], ["anisotropic", "isotropic"]),
        (["--isotropic"], ["isotropic"]),
        (["--anisotropic"], ["anisotropic"]),
    ):
        found = run("fit", file, "--slopes", "table", "--family", "student_t", "--json", *options)
        answer = json.loads(found.stdout)
        assert [entry["symmetry"] for entry in answer["ranking"]] == expected
        assert ("alpha" in answer["ranking"][0]["params"]) == (options == ["--isotropic"])
        assert list(answer["prediction"][0]["G1"]) == ["student_t"]
    refused = run("fit", file, "--slopes", "table", "--family", "gtr", "--anisotropic")
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "gtr can only be isotropic" in refused.stderr


def test_tables_and_page_say_which_one_it_is(file: Path) -> None:
    page = file.with_suffix(".html")
    found = run("fit", file, "--slopes", "table", "--family", "ggx", "--family", "k0", "--report", page)
    rows = [line.split("\t") for line in found.stdout.split("\n\n")[0].splitlines()]
    assert rows[0][2] == "symmetry"
    assert sorted(row[2] for row in rows[1:]) == ["anisotropic"] * 2 + ["isotropic"] * 2
    text = page.read_text("utf-8")
    assert text.count("<td>isotropic</td>") == text.count("<td>anisotropic</td>") == 2
    assert "(anisotropic) comes nearest to the slopes" in text  # which are neither's


def test_a_family_has_one_symmetry_at_all_lags(tmp_path: Path) -> None:
    """Two axes where they rank first at any lag, so that parameters against the lag are of one kind."""
    surface = mf.synthesize(mf.GGX(alpha_x=0.3, alpha_y=0.1), (128, 128), seed=2)
    path = tmp_path / "map.npz"
    np.savez(path, heights=surface.heights, pixel_size=1.0)
    scales = json.loads(run("fit", path, "--family", "ggx", "--family", "gtr", "--json").stdout)["scales"]
    assert scales["symmetry"] == {"ggx": "anisotropic", "gtr": "isotropic"}
    assert all(set(params) == {"alpha_x", "alpha_y", "rotation"} for params in scales["params"]["ggx"])
