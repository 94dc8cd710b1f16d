"""`microfacet fit` of profiles: recognised, prepared, printed, as JSON and as a page."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

import microfacet as mf
from cli_runs import assert_one_sentence
from microfacet.cli import main
from profile_file_cases import lines

CASES = Path(__file__).parents[2] / "shared" / "cases" / "surfaces"
FAMILIES = ("--family", "beckmann", "--family", "ggx")
Run = Callable[..., Result]


@pytest.fixture
def run() -> Run:
    def call(*arguments: object) -> Result:
        return CliRunner().invoke(main, ["fit", *map(str, arguments)])

    return call


@pytest.fixture(scope="module")
def profile() -> mf.Profile:
    surface = mf.synthesize(mf.Beckmann(alpha=0.2), (192, 1024), 0.5e-6, seed=4)
    return mf.Profile.from_surface(surface, row=[0, 64, 128])


@pytest.fixture
def trace(tmp_path: Path, profile: mf.Profile) -> Path:
    file = tmp_path / "trace.csv"
    x = 0.5 * np.arange(1024)
    file.write_text(lines(x, 1e6 * profile.traces[0] + 0.02 * x, head="x [um],z [um]\n", form="{:.9g}"))
    return file


def test_a_profile_needs_no_option(run: Run, trace: Path) -> None:
    result = run(trace, *FAMILIES, "--json")
    assert result.exit_code == 0, result.stderr
    answer = json.loads(result.stdout)
    expected = mf.fit(mf.read_profile(trace).level(), ["beckmann", "ggx"])
    assert [entry["family"] for entry in answer["ranking"]] == ["beckmann", "ggx"]
    assert answer["ranking"][0]["params"] == expected[0].params
    assert answer["ranking"][0]["symmetry"] == "profile"
    assert answer["ranking"][0]["params"]["alpha"] == pytest.approx(0.2, rel=0.1)
    assert answer["extent"] == {
        "pixel_size": [pytest.approx(5e-7), None],
        "shape": [1, 1024],
        "valid_fraction": 1,
    }
    assert answer["steps"] == ["levelled: least-squares line subtracted from each trace"]
    assert answer["lag_length"] == pytest.approx(5e-7)
    roughness = mf.read_profile(trace).level().roughness()
    assert answer["roughness"] == pytest.approx(roughness._asdict())
    assert answer["profile"]["roughness_of_traces"] == [answer["roughness"]]
    spectrum = answer["profile"]["psd"]
    step = spectrum["frequencies"][1] - spectrum["frequencies"][0]
    assert math.sqrt(sum(spectrum["psd"]) * step) == pytest.approx(roughness.Rq, rel=0.3)
    assert {row["azimuth"] for row in answer["prediction"]} == {0}
    assert answer["scales"]["lags"][:3] == [1, 2, 4]
    assert answer["verdict"]["fits"] is True


def test_tables_of_a_profile(run: Run, trace: Path) -> None:
    result = run(trace, *FAMILIES, "--no-scales")
    assert result.exit_code == 0, result.stderr
    assert "a profile knows the slopes along its line alone" in result.stderr
    assert "profile\talpha 0." in result.stdout
    assert "\tm\troot mean square height" in result.stdout


def test_every_step_of_the_preparation(run: Run, trace: Path) -> None:
    result = run(
        trace, *FAMILIES, "--no-scales", "--json", "--outliers", "9", "--level", "2", "--form", "3",
        "--s-filter", "2e-6", "--l-filter", "1e-4", "--lag", "2",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    answer = json.loads(result.stdout)
    prepared = mf.read_profile(trace).mask_outliers(9).level(2).remove_form(3).filtered(2e-6, 1e-4).at_lag(2)
    assert answer["steps"] == list(prepared.steps)
    assert answer["roughness"] == pytest.approx(prepared.roughness()._asdict())
    assert answer["profile"]["cutoff"] == 1e-4
    assert answer["lag"] == 2


def test_a_page_of_a_profile(run: Run, tmp_path: Path, profile: mf.Profile) -> None:
    file = tmp_path / "traces.csv"
    x = 0.5 * np.arange(1024)
    columns = [1e6 * trace for trace in profile.traces]
    file.write_text(lines(x, *columns, head="x [um],z1 [um],z2 [um],z3 [um]\n", form="{:.9g}"))
    page = tmp_path / "page.html"
    result = run(file, *FAMILIES, "--no-scales", "--report", page)
    assert result.exit_code == 0, result.stderr
    text = page.read_text(encoding="utf-8")
    for part in (
        'id="fig-traces"',
        'id="fig-slopes"',
        'id="fig-quantiles"',
        'id="fig-spectrum"',
        "Measured profile",
        "density of the slope along the line",
        "ISO 21920-2",
        "means over the traces",
        "3 of 3\u202f072 points",
    ):
        assert part in text, part
    assert "ISO 25178" not in text
    assert 'id="fig-directions"' not in text


def test_several_files_and_a_table(run: Run, trace: Path, tmp_path: Path) -> None:
    heights = tmp_path / "map.npz"
    np.savez(heights, heights=mf.synthesize(mf.Beckmann(alpha=0.2), (64, 64)).heights, pixel_size=1e-6)
    table = tmp_path / "table.csv"
    result = run(trace, heights, *FAMILIES, "--no-scales", "--output", table)
    assert result.exit_code == 0, result.stderr
    with table.open(encoding="utf-8") as stream:
        first, second = csv.DictReader(stream)
    assert (first["symmetry"], first["columns"], first["rows"]) == ("profile", "1024", "1")
    assert float(first["Rq"]) > 0
    assert first["Sq"] == second["Rq"] == ""
    assert float(second["Sq"]) > 0


def test_what_is_ambiguous_needs_the_option(run: Run, tmp_path: Path, profile: mf.Profile) -> None:
    file = tmp_path / "bare.txt"
    x = 0.5 * np.arange(1024)
    file.write_text(lines(x, 1e6 * profile.traces[0], 1e6 * profile.traces[1], form="{:.9g}"))
    assert run(file, *FAMILIES).exit_code == 2
    result = run(file, *FAMILIES, "--profile", "--unit", "um", "--no-scales", "--json")
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["extent"]["shape"] == [2, 1024]


def test_uneven_positions_are_resampled_on_demand(run: Run, tmp_path: Path) -> None:
    x = np.cumsum(np.random.default_rng(0).uniform(0.4, 0.6, 2000))
    file = tmp_path / "uneven.csv"
    file.write_text(lines(x, np.sin(x) + np.sin(0.37 * x), head="x [um],z [um]\n", form="{:.6f}"))
    assert_one_sentence(run(file, *FAMILIES), "the positions are uneven", "--resample")
    result = run(file, *FAMILIES, "--no-scales", "--json", "--resample", "5e-7")
    assert result.exit_code == 0, result.stderr
    assert "heights interpolated linearly every 5e-07 m" in json.loads(result.stdout)["steps"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--scale", "1e-9"), "--scale is for images, and this file holds a profile"),
        (("--level", "three-point"), "--level of a profile must be line, none or a degree"),
        (("--form", "sphere"), "form must be circle or the degree"),
        (("--isotropic",), "a profile knows one direction"),
        (("--unit", "nm"), "states the unit um, not nm"),
        (("--channel", "2"), "text has no channels"),
        (("--lag", "2000"), "0 slopes at lag 2000"),
        (("--slopes", "table", "--profile"), "exclude each other"),
    ],
)
def test_options_that_do_not_go_with_a_profile(run: Run, trace: Path, options, message) -> None:
    assert_one_sentence(run(trace, *FAMILIES, *options), message)


def test_options_of_profiles_do_not_go_with_maps(run: Run, tmp_path: Path) -> None:
    file = tmp_path / "map.npz"
    np.savez(file, heights=np.random.default_rng(0).normal(size=(40, 40)), pixel_size=1.0)
    assert_one_sentence(run(file, "--resample", "1"), "--resample is for profiles, and this file holds a map")


@pytest.mark.skipif(not CASES.is_dir(), reason="the cases are not part of the project")
def test_the_two_files_of_one_profile(run: Run) -> None:
    one = run(CASES / "profile_xz.csv", *FAMILIES, "--no-scales", "--json")
    assert one.exit_code == 0, one.stderr
    bare = run(CASES / "profile_z.txt", *FAMILIES, "--no-scales", "--json", "--pixel-size", "5e-7")
    assert_one_sentence(bare, "the text does not state the unit of its heights", "--unit")
    other = run(
        CASES / "profile_z.txt", *FAMILIES, "--no-scales", "--json", "--pixel-size", "5e-7", "--unit", "um"
    )
    answers = [json.loads(result.stdout) for result in (one, other)]
    assert answers[0]["ranking"][0]["params"] == pytest.approx(answers[1]["ranking"][0]["params"])
    assert answers[0]["roughness"] == pytest.approx(answers[1]["roughness"])
