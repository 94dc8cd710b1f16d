"""--density FILE wherever a family may stand on the command line."""

from __future__ import annotations

import json
import pathlib

import numpy as np
import pytest

import microfacet as mf
from cli_runs import Run, assert_one_sentence

DOCUMENT = {
    "kind": "microfacet density",
    "version": 1,
    "alpha": 0.3,
    "D": {"theta": [0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4], "values": [9, 7, 5, 3, 2, 1, 0.5, 0.2]},
}


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("densities") / "own.json"
    path.write_text(json.dumps(DOCUMENT))
    return str(path)


@pytest.fixture(scope="module")
def ndf(own: str) -> mf.RadialNDF:
    return mf.read_density(own)


def test_eval(run: Run, own: str, ndf: mf.RadialNDF) -> None:
    text = run("eval", "--density", own, "Lambda", "0.2", "0.6").stdout.splitlines()
    expected = [ndf.Lambda([np.sqrt(1 - u * u), 0.0, u]) for u in (0.2, 0.6)]
    assert [float(line.split()[1]) for line in text[1:]] == pytest.approx(expected, rel=1e-14)
    found = json.loads(run("eval", "D", "0.9", f"--density={own}", "--alpha", "0.5", "--json").stdout)
    assert (found["family"], found["parameters"]) == ("own", {"alpha": 0.5})
    sine = np.sqrt(1 - 0.81)
    assert found["results"] == [pytest.approx(ndf.with_roughness(0.5).D([sine, 0.0, 0.9]), rel=1e-13)]
    slope = float(run("eval", "sample_slope", "0.5", "--density", own).stdout.split()[-1])
    assert float(run("eval", "survival", str(slope), "--density", own).stdout.split()[-1]) == pytest.approx(
        0.5
    )
    assert run("eval", "P22", "0.1,0.2", "--density", own, "--dtype", "float32").exit_code == 0


def test_sample(run: Run, own: str, ndf: mf.RadialNDF) -> None:
    lines = run("sample", "-n", "4", "--density", own, "--seed", "3").stdout.splitlines()[1:]
    normals = np.array([[float(x) for x in line.split(",")] for line in lines])
    xi = np.random.Generator(np.random.PCG64(3)).random((4, 2))
    np.testing.assert_array_equal(normals, ndf.sample(xi))
    assert len(run("sample", "-n", "4", "--density", own, "--visible", "60").stdout.splitlines()) == 5


def test_maps_and_fits(run: Run, own: str, tmp_path: pathlib.Path) -> None:
    made = tmp_path / "map.npz"
    record = json.loads(
        run("synthesize", "--density", own, "--shape", "256", "256", "-o", str(made), "--json").stdout
    )
    assert (record["family"], record["parameters"]["alpha_x"]) == ("own", 0.3)
    fitted = run("fit", str(made), "--density", own, "--family", "ggx", "--no-scales", "--json")
    ranking = json.loads(fitted.stdout)["ranking"]
    assert sorted({entry["family"] for entry in ranking[:2]}) == ["own"]
    anisotropic = next(entry for entry in ranking if entry["symmetry"] == "anisotropic")
    assert abs(anisotropic["params"]["alpha_x"] - 0.3) < 3 * anisotropic["standard_errors"]["alpha_x"] < 0.15


def test_tables_and_shaders(run: Run, own: str, tmp_path: pathlib.Path) -> None:
    pytest.importorskip("xarray")
    output = tmp_path / "own.zarr"
    done = run("bake", "energy", "--density", own, "--alpha", "0.3", "--cos", "0.5,1", "-o", str(output))
    assert done.exit_code == 0, done.stderr
    texture = tmp_path / "own.raw"
    done = run(
        "bake",
        "split-sum",
        "--density",
        own,
        "--size",
        "4x4",
        "--check",
        "0",
        "--snippet",
        "c",
        "-o",
        str(texture),
    )
    assert done.exit_code == 0, done.stderr
    assert "own_" in (tmp_path / "own.raw.h").read_text()
    text = run("export", "c", "--density", own, "--functions", "D,G1").stdout
    assert "alpha = 0.3" in text
    assert "alpha = 0.5" in run("export", "c", "--density", own, "--functions", "D", "--alpha", "0.5").stdout


def test_report(run: Run, own: str, tmp_path: pathlib.Path) -> None:
    pytest.importorskip("matplotlib")
    page = tmp_path / "own.html"
    done = run("report", "--density", own, "--output", str(page), "--json")
    assert json.loads(done.stdout) == {"path": str(page)}
    text = page.read_text()
    assert text.count("<figure") == 11
    assert "Largest relative error of the tables" in text
    refused = run("report", "--density", own, "--quick", "--output", str(page))
    assert_one_sentence(refused, "--density makes a page of its own")


def test_errors_are_one_sentence(run: Run, own: str, tmp_path: pathlib.Path) -> None:
    assert_one_sentence(
        run("eval", "D", "0.9", "--density", "nowhere.json"), "nowhere.json: there is no such file"
    )
    hostile = tmp_path / "hostile.json"
    hostile.write_text('{"kind": "microfacet density", "version": 1, "P22": {"r": "x", "values": 1}}')
    assert_one_sentence(run("sample", "--density", str(hostile)), "P22.r must be a list")
    assert_one_sentence(
        run("eval", "--density", own, "D", "0.9", "--gamma", "2"), "own has no parameter gamma"
    )
    assert_one_sentence(run("eval", "own", "D", "0.9"), "family must be one of")
    assert_one_sentence(run("sample"), "Missing argument 'FAMILY'")
