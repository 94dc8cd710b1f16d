"""`microfacet fit`: tables, JSON, the page, many files, and errors of one sentence."""

from __future__ import annotations

import importlib.util
import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

import microfacet as mf
from microfacet.cli import cluster, fits, main, printing
from microfacet.cli.printing import finite

DATA = Path(__file__).parents[2] / "shared" / "data"
Run = Callable[..., Result]


@pytest.fixture
def run() -> Run:
    def call(*arguments: str) -> Result:
        return CliRunner().invoke(main, ["fit", *map(str, arguments)])

    return call


def rough(seed: int = 8, shape: tuple[int, int] = (60, 70)) -> Any:
    rng = np.random.default_rng(seed)
    heights = rng.normal(size=shape).cumsum(axis=0).cumsum(axis=1)
    return heights - heights.mean(axis=0)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "map.npz"
    np.savez(path, heights=1e-7 * rough(), pixel_size=2e-6)
    return path


def test_json_ranks_the_families_with_all_that_is_asked_for(run: Run, file: Path) -> None:
    result = run(file, "--family", "ggx", "--family", "student_t", "--lag", "3", "--json")
    assert result.exit_code == 0, result.stderr
    answer = json.loads(result.stdout)
    expected = mf.fit(mf.read_surface(file).level(), families=["ggx", "student_t"], lag=3)
    assert [entry["family"] for entry in answer["ranking"]] == [fit.family for fit in expected]
    assert len(expected) == 4
    for entry, fit in zip(answer["ranking"], expected, strict=True):
        assert entry["symmetry"] == fit.symmetry
        assert entry["params"] == fit.params
        assert entry["standard_errors"] == pytest.approx(fit.standard_errors, nan_ok=True)
        for name in ("log_likelihood_per_sample", "held_out", "aic", "bic", "tied"):
            assert entry[name] == getattr(fit, name)
    assert (answer["lag"], answer["lag_length"]) == (3, pytest.approx(6e-6))
    assert answer["n"] == expected[0].n
    assert answer["n_effective"] == expected[0].n_effective
    assert answer["scales"]["lags"] == [1, 2]
    assert set(answer["scales"]["params"]) == {"ggx", "student_t"}
    prepared = mf.read_surface(file).level()
    assert answer["roughness"] == pytest.approx(finite(mf.roughness(prepared)._asdict()))
    assert (
        answer["roughness_units"].keys() == answer["roughness"].keys() > answer["roughness_stencils"].keys()
    )
    spectrum, autocorrelation = mf.spectrum(prepared), mf.autocorrelation(prepared)
    assert answer["spectrum"]["psd"] == pytest.approx(spectrum.psd.tolist(), rel=1e-5)
    assert answer["spectrum"]["abc"]["C"] == pytest.approx(spectrum.abc.C, rel=1e-5)
    assert answer["autocorrelation"]["Sal"] == pytest.approx(autocorrelation.Sal, rel=1e-5)
    assert any("levelled" in step for step in answer["steps"])
    first = answer["prediction"][0]
    w = np.radians([first["theta"], first["azimuth"]])
    direction = [math.sin(w[0]) * math.cos(w[1]), math.sin(w[0]) * math.sin(w[1]), math.cos(w[0])]
    for fit in {one.family: one for one in reversed(expected)}.values():  # the symmetry that ranks first
        assert first["G1"][fit.family] == pytest.approx(float(fit.ndf.G1(direction)))


def test_tables(run: Run, file: Path) -> None:
    result = run(file, "--family", "ggx", "--family", "beckmann", "--angle", "70")
    assert result.exit_code == 0, result.stderr
    ranking, _, prediction, scales, roughness = (part.splitlines() for part in result.stdout.split("\n\n"))
    assert [line.split("\t")[0] for line in ranking] == ["rank", "1", "2", "3", "4"]
    assert "+-" in ranking[1]
    assert [line.split("\t")[0] for line in prediction] == ["theta", "70", "70"]
    assert [line.split("\t")[0] for line in scales] == ["lag", "1", "2"]
    assert roughness[0] == "parameter\tvalue\tunit\twhat it is"
    values = dict(line.split("\t")[:2] for line in roughness[1:])
    expected = mf.roughness(mf.read_surface(file).level())
    assert float(values["Sk"]) == pytest.approx(expected.Sk, rel=1e-3)
    assert float(values["Sdq"]) < float(values["Sdq_adjacent"])  # each with its stencil
    assert {"Sal", "Str", "Std", "ABC A", "ABC B", "ABC C"} <= values.keys()
    assert re.search(r"\d+ slopes at lag 1, worth \d+ independent ones", result.stderr)


def test_the_terrain_needs_no_file(run: Run) -> None:
    answer = json.loads(run("--terrain", "--lag", "4", "--family", "ggx", "--no-scales", "--json").stdout)
    expected = mf.fit(mf.sample_terrain().level(), "ggx", lag=4)[0]
    assert (answer["lag"], answer["ranking"][0]["params"]) == (4, expected.params)
    assert "jacksboro" in answer["source"]


def test_scales_can_be_left_out(run: Run, file: Path) -> None:
    answer = json.loads(run(file, "--family", "ggx", "--no-scales", "--json").stdout)
    assert answer["scales"] is None


def test_noise_is_named(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "noise.npy"
    np.save(path, np.random.default_rng(1).normal(size=(80, 80)))
    result = run(path, "--pixel-size", "10", "--family", "beckmann")
    assert result.exit_code == 0
    assert "dominated by noise" in result.stderr
    assert "\tnoise" in result.stdout
    answer = json.loads(run(path, "--pixel-size", "10", "--family", "beckmann", "--json").stdout)
    assert any("dominated by noise" in note for note in answer["notes"])


def test_a_file_that_states_no_pixel_size(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "map.npy"
    np.save(path, rough())
    result = run(path)
    assert result.exit_code == 2
    assert result.stderr.count("\n") == 1
    assert "pixel" in result.stderr


def test_slopes_without_positions(run: Run, tmp_path: Path) -> None:
    slopes = np.random.default_rng(3).normal(size=(4000, 2)) * [0.1, 0.2]
    path = tmp_path / "slopes.csv"
    np.savetxt(path, slopes, delimiter=",")
    result = run(path, "--slopes", "table", "--family", "beckmann", "--json")
    assert result.exit_code == 0, result.stderr
    answer = json.loads(result.stdout)
    assert answer["ranking"][0]["params"] == pytest.approx(mf.fit(slopes, "beckmann")[0].params)
    assert answer["n_effective"] == answer["n"] == 4000
    assert answer["roughness"] is answer["scales"] is answer["lag"] is None
    assert answer["spectrum"] is answer["autocorrelation"] is None


def page_of(run: Run, source: Path, *options: str) -> str:
    target = source.with_suffix(".html")
    result = run(source, *options, "--report", target)
    assert result.exit_code == 0, result.stderr
    assert result.stdout.splitlines()[-1] == str(target)
    return target.read_text("utf-8")


def test_the_page_is_whole_and_needs_nothing_else(run: Run, file: Path) -> None:
    page = page_of(run, file, "--family", "student_t", "--family", "k0")
    assert page.startswith("<!DOCTYPE html>")
    assert page.rstrip().endswith("</html>")
    assert not re.findall(r'(?:src|href)="(?!#|data:)[^"]*"', page)
    figures = ("surface-map", "slopes", "quantiles", "directions", "scales", "spectrum", "autocorrelation")
    for name in figures:
        assert page.count(f'id="fig-{name}"') == 1
    identifiers = re.findall(r'\bid="([^"]+)"', page)
    assert len(identifiers) == len(set(identifiers))
    assert "levelled: least-squares plane subtracted" in page
    assert "How to make this page" in page
    assert "Sdq adjacent" in page
    assert "S10z" in page
    assert [entry.name for entry in sorted(file.parent.iterdir())] == ["map.html", "map.npz"]


def test_the_page_of_slopes_has_no_map(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "slopes <1>.csv"
    np.savetxt(path, np.random.default_rng(3).normal(size=(2000, 2)), delimiter=",")
    page = page_of(run, path, "--slopes", "table", "--family", "beckmann")
    assert 'id="fig-surface-map"' not in page
    assert 'id="fig-scales"' not in page
    assert "slopes &lt;1&gt;.csv" in page


def test_the_page_names_noise(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "noise.npz"
    np.savez(path, heights=np.random.default_rng(1).normal(size=(64, 64)), pixel_size=10.0)
    assert "Dominated by noise" in page_of(run, path, "--family", "beckmann")


def test_a_page_that_fails_leaves_the_old_one(run: Run, file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = file.with_suffix(".html")
    target.write_text("old")

    def fail(*_: object, **__: object) -> str:
        raise ValueError("on the way")

    monkeypatch.setattr("microfacet._report.surfaces.set_page", fail)
    assert run(file, "--family", "beckmann", "--report", target).exit_code == 2
    assert target.read_text() == "old"
    assert len(list(file.parent.iterdir())) == 2


@pytest.mark.parametrize("dask", [[], ["--dask", "none"]])
def test_many_files_without_dask(
    run: Run, file: Path, tmp_path: Path, dask: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name == "distributed" else find(name)
    )
    monkeypatch.setattr(cluster, "WORTH_A_CLUSTER", 0)
    monkeypatch.setattr(cluster, "processors", lambda: 4)
    broken = tmp_path / "broken.npz"
    broken.write_bytes(b"no zip")
    options = ["--family", "beckmann", "--no-scales", *dask]
    result = run(file, broken, *options)
    assert result.exit_code == 2, "a file could not be read"
    heading, good, bad = result.stdout.splitlines()
    assert heading.startswith("file\tlag\tn\teffective")
    assert "beckmann" in good
    assert "broken.npz" in bad
    assert (".[dask]" in result.stderr) == (not dask)
    answer = json.loads(run(file, broken, *options, "--json").stdout)
    assert answer["files"][0]["ranking"][0]["family"] == "beckmann"
    assert "broken.npz" in answer["files"][1]["error"]
    assert run(file, file, *options).exit_code == 0
    if not dask:
        wanted = run(file, "--dask", "tcp://127.0.0.1:1", *options)
        assert wanted.exit_code == 2
        assert ".[dask]" in wanted.stderr


def test_many_files_on_a_cluster(run: Run, file: Path) -> None:
    """On a scheduler at an address, here with its worker in this process; the numbers are those without
    it.
    """
    distributed = pytest.importorskip("distributed", reason="the extra 'dask' is not installed")
    options = ["--family", "beckmann", "--no-scales", "--json"]
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None, protocol="tcp"
    ) as cluster:
        found = run(file, file, "--dask", cluster.scheduler_address, *options)
    assert found.exit_code == 0, found.stderr
    alone = json.loads(run(file, *options).stdout)
    for entry in json.loads(found.stdout)["files"]:
        assert {**entry, "file": None} == {**alone, "file": None}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([], "FILE"),
        (["missing.npz"], "missing.npz"),
        (["{file}", "--family", "phong"], "phong"),
        (["{file}", "--angle", "90"], "90"),
        (["{file}", "--terrain"], "or --terrain"),
        (["--terrain", "--form", "2"], "--form goes with a FILE"),
        (["{file}", "{file}", "--report", "page.html"], "one file"),
        (["{file}", "--report", "nowhere/page.html"], "existing folder"),
        (["{file}", "--max-slopes", "5"], "max-slopes"),
    ],
)
def test_bad_options_are_one_sentence(run: Run, file: Path, options: list[str], message: str) -> None:
    result = run(*(option.format(file=file) for option in options))
    assert result.exit_code == 2
    assert result.stdout == ""
    assert message in result.stderr
    assert result.stderr.count("\n") == 1
    assert len(list(file.parent.iterdir())) == 1


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.10647, 0.00472, "0.1065+-0.0047"),
        (4.0618, 0.185, "4.06+-0.18"),
        (151.2, 30.0, "151+-30"),
        (1.5, math.nan, "1.5"),
        (0.25, 0.0, "0.25"),
        (5.7068e-7, 3.589e-8, "5.71+-0.36e-7"),
        (-6.2e-9, 4.94e-8, "-0.6+-4.9e-8"),
    ],
)
def test_numbers_have_the_digits_that_their_errors_leave(value: float, error: float, text: str) -> None:
    assert printing.value(value, error) == text


def test_a_job_travels_and_its_result_too(file: Path) -> None:
    import pickle

    job = pickle.loads(pickle.dumps(fits.Job(str(file), families=("ggx",), scales=False)))
    outcome = fits.attempt(job)
    assert isinstance(outcome, fits.Fitted)
    assert outcome.measured is None
    assert pickle.loads(pickle.dumps(outcome)).results == outcome.results


@pytest.mark.parametrize("name", ["di-3.di", "SkiInfiniteFocus.x3p"])
def test_the_page_of_a_measured_surface(run: Run, name: str, tmp_path: Path) -> None:
    pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    if not (DATA / name).exists():
        pytest.skip(f"../shared/data/{name} is not there")
    page = tmp_path / "page.html"
    chosen = ["--family", "student_t", "--family", "ggx", "--max-slopes", "100000", "--no-scales"]
    result = run(DATA / name, *chosen, "--report", page)
    assert result.exit_code == 0, result.stderr
    text = page.read_text("utf-8")
    assert re.search(r"<strong>Student-T</strong> \((an)?isotropic\) (describes|comes nearest)", text)
    assert "No family describes these slopes" in text or "escribes the slopes" in text  # the verdict
