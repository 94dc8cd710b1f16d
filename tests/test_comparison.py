"""Surfaces side by side: what is equal is found equal, what differs differs by what it should."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import microfacet as mf
from cli_runs import Run, assert_one_sentence
from microfacet._fit.comparison import _axis, _named_alike
from microfacet._fit.mean_squares import rms_height, rms_slope
from microfacet.cli import main


def surface(alpha: float, seed: int, gamma: float = 3.0, **options: Any) -> mf.Surface:
    return mf.synthesize(mf.StudentT(alpha=alpha, gamma=gamma), (256, 256), 1e-6, seed=seed, **options)


@pytest.fixture(scope="module")
def found() -> mf.Comparison:
    maps = [surface(0.2, 1), surface(0.2, 2), surface(0.6, 3)]
    return mf.compare(maps, ["student_t", "beckmann"], names=["one", "two", "rough"])


def by_name(differences: tuple[mf.Difference, ...]) -> dict[str, mf.Difference]:
    return {one.quantity: one for one in differences}


def test_all_are_compared_under_one_family(found: mf.Comparison) -> None:
    assert (found.family, found.symmetry) == ("student_t", "isotropic")
    assert all((fit.family, fit.symmetry) == ("student_t", "isotropic") for fit in found.fits)
    assert found.names == ("one", "two", "rough")
    for fit, ranking, quantities in zip(found.fits, found.rankings, found.quantities, strict=True):
        assert fit in ranking
        assert quantities["alpha"] == (fit.params["alpha"], fit.standard_errors["alpha"])


def test_differences_are_those_of_the_fits_with_the_errors_of_both(found: mf.Comparison) -> None:
    for other, differences in zip(found.quantities[1:], found.differences, strict=True):
        assert [one.quantity for one in differences] == ["Sq", "rms_slope", "alpha", "gamma"]
        for one in differences:
            (first, first_error), (second, second_error) = (
                found.quantities[0][one.quantity],
                other[one.quantity],
            )
            assert one.value == second - first
            assert one.error == pytest.approx(math.sqrt(first_error**2 + second_error**2))
            assert one.z == pytest.approx(one.value / one.error)


def test_what_is_equal_and_what_differs(found: mf.Comparison) -> None:
    same, rough = map(by_name, found.differences)
    assert all(one.p_value > 0.01 for one in same.values())
    assert rough["alpha"].value == pytest.approx(0.4, abs=3 * rough["alpha"].error)
    assert rough["alpha"].p_value < 1e-3
    assert rough["gamma"].p_value > 0.01


def test_root_mean_squares_are_those_of_the_roughness() -> None:
    one = surface(0.3, 4)
    holes = mf.Surface(one.heights, 1e-6, mask=np.random.default_rng(1).random((256, 256)) > 0.2)
    values = mf.roughness(holes)
    assert rms_height(holes).value == pytest.approx(values.Sq, rel=1e-12)
    assert rms_slope(holes).value == pytest.approx(values.Sdq, rel=1e-12)
    slopes = holes.slopes(3)
    assert rms_slope(holes.at_lag(3)).value == pytest.approx(math.sqrt(np.mean(np.sum(slopes**2, axis=1))))


def test_the_error_of_sq_is_that_of_independent_heights() -> None:
    """The mean square of n independent normal heights has the relative error sqrt(2/n), its root half."""
    errors = []
    for seed in range(10):
        heights = np.random.default_rng(seed).normal(size=(100, 130))
        errors.append(rms_height(mf.Surface(heights, 1.0)).error)
    assert np.mean(errors) == pytest.approx(1 / math.sqrt(2 * 13000), rel=0.1)


def test_errors_of_a_correlated_map_are_those_between_maps() -> None:
    """The scatter between 24 maps is known within 15 %."""
    maps = [mf.synthesize(mf.Beckmann(alpha=0.2), (160, 160), 1e-6, seed=seed) for seed in range(24)]
    measured = [rms_height(one) for one in maps]
    scatter = float(np.std([one.value for one in measured], ddof=1))
    assert np.mean([one.error for one in measured]) == pytest.approx(scatter, rel=0.5)


@pytest.mark.parametrize("angle", [0.76, 0.80])
def test_axes_are_named_alike(angle: float) -> None:
    """Just beyond 45 degrees a fit names the axes the other way round; the density is the same."""
    first = {"alpha_x": 0.3, "alpha_y": 0.1, "rotation": 0.77, "gamma": 3.0}
    turned = {"alpha_x": 0.1, "alpha_y": 0.3, "rotation": angle - math.pi / 2, "gamma": 3.0}
    named, errors = _named_alike(first, turned, {"alpha_x": 0.01, "alpha_y": 0.02, "rotation": 0.03})
    assert named == {"alpha_x": 0.3, "alpha_y": 0.1, "rotation": pytest.approx(angle), "gamma": 3.0}
    assert errors == {"alpha_x": 0.02, "alpha_y": 0.01, "rotation": 0.03}
    m = np.array([0.3, 0.2, math.sqrt(1 - 0.13)])
    assert mf.StudentT(**named).D(m) == pytest.approx(mf.StudentT(**turned).D(m), rel=1e-12)
    assert _named_alike(first, first, errors) == (first, errors)


@pytest.mark.parametrize(("angle", "expected"), [(3.0, 3.0 - math.pi), (-3.0, math.pi - 3.0), (0.5, 0.5)])
def test_an_axis_has_no_sign(angle: float, expected: float) -> None:
    assert _axis(angle) == pytest.approx(expected)


def test_lags_are_of_one_length() -> None:
    fine = mf.Surface(1e-7 * np.random.default_rng(1).normal(size=(80, 80)), 1e-6)
    coarse = mf.Surface(1e-7 * np.random.default_rng(2).normal(size=(80, 80)), 3e-6)
    found = mf.compare([fine, coarse], "beckmann")
    assert found.lag_lengths == pytest.approx((3e-6, 3e-6))
    assert [fit.lag for fit in found.fits] == [3, 1]
    assert "longest of their lags, 3e-06 m" in found.notes[0]
    assert mf.compare([fine, fine], "beckmann").notes == ()
    assert mf.compare([fine, coarse], "beckmann", length=6e-6).lag_lengths == pytest.approx((6e-6, 6e-6))
    odd = mf.compare([fine, mf.Surface(coarse.heights, 1.4e-6)], "beckmann")
    assert odd.lag_lengths == pytest.approx((1e-6, 1.4e-6))
    assert "from 1e-06 to 1.4e-06 m" in odd.notes[-1]


def test_slopes_without_positions() -> None:
    slopes = 0.1 * np.random.default_rng(1).normal(size=(2, 4000, 2))
    found = mf.compare(list(slopes), "beckmann", symmetry="isotropic")
    assert [one.quantity for one in found.differences[0]] == ["alpha"]
    assert found.lag_lengths == (None, None)
    assert found.names == ("surface 1", "surface 2")
    # alpha of n independent slopes has the relative error 1/(2 sqrt(n))
    expected = math.sqrt(2) * found.fits[0].params["alpha"] / (2 * math.sqrt(4000))
    assert found.differences[0][0].error == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize(
    ("count", "options", "message"),
    [
        (1, {}, "surfaces must be two or more to compare, got 1"),
        (2, {"names": ["a"]}, "names must be as many as surfaces, 2, got 1"),
        (2, {"length": 1e-6}, "length applies to surfaces"),
    ],
)
def test_bad_arguments_are_one_sentence(count: int, options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        mf.compare([np.ones((100, 2))] * count, "beckmann", **options)


@pytest.fixture
def run() -> Run:
    return lambda *arguments: CliRunner().invoke(main, ["compare", *map(str, arguments)])


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    found = []
    for alpha in (0.2, 0.6):
        found.append(tmp_path_factory.mktemp("maps") / f"{alpha}.npz")
        np.savez(found[-1], heights=surface(alpha, 5).heights, pixel_size=1e-6)
    return found


def test_the_command(run: Run, files: list[Path], tmp_path: Path) -> None:
    options = ["--family", "student_t", "--isotropic"]
    result = run(*files, *options, "-o", tmp_path / "table.csv")
    assert result.exit_code == 0, result.stderr
    heads = result.stdout.rpartition(str(tmp_path))[0]
    lines = {line.split("\t")[0]: line.split("\t") for line in heads.split("\n\n")[1].splitlines()}
    assert lines["alpha"][-1] == "differs"
    assert lines["gamma"][-1] == ""
    answer = json.loads(run(*files, *options, "--json").stdout)
    expected = mf.compare(
        [mf.read_surface(file).level() for file in files], "student_t", symmetry="isotropic"
    )
    for entry, one in zip(answer["differences"], expected.differences[0], strict=True):
        assert (entry["quantity"], entry["value"], entry["z"]) == (one.quantity, one.value, one.z)
    with (tmp_path / "table.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["quantity"] for row in rows] == 2 * ["Sq", "rms_slope", "alpha", "gamma"]
    assert rows[2]["difference"] == ""
    assert float(rows[6]["difference"]) == expected.differences[0][2].value


def test_the_command_wants_two_files_that_exist(run: Run, files: list[Path]) -> None:
    assert_one_sentence(run(files[0]), "two FILEs")
    assert_one_sentence(run(files[0], "missing.npz"), "missing.npz")
