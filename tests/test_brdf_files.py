"""Tables of predicted scattering as files of other programs, and the command that writes them."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import microfacet as mf
from brdf_cases import GOLD, GROUND, NM, ROUGH, TABLES
from cli_runs import Run, assert_one_sentence
from microfacet._optics import grid
from microfacet.cli import main


@pytest.fixture(scope="module")
def table() -> mf.BrdfTable:
    angles = {"theta_i": [0, 40], "phi_i": [0, 30], "polar": [0, 20, 40, 60], "azimuth": [0, 90, 180, 270]}
    return mf.brdf_table(GROUND, NM, GOLD, **angles, n=64)


@pytest.fixture(scope="module")
def mirrored() -> mf.BrdfTable:
    return mf.brdf_table(
        ROUGH, NM, GOLD, theta_i=[0, 40], reference="specular", polar=[0, 5, 90], azimuth=[0, 90, 180], n=64
    )


def places(table: mf.BrdfTable) -> list[tuple[int, ...]]:
    return list(np.ndindex(table.values.shape))


def test_csv(table: mf.BrdfTable, tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    assert table.save(path) == [str(path)]
    with path.open(newline="") as stream:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(stream)]
    assert len(rows) == table.values.size
    for row, place in zip(rows, places(table), strict=True):
        k, i, j, a, p = place
        assert row["wavelength_m"] == pytest.approx(NM[k])
        assert row["n"] + 1j * row["k"] == pytest.approx(GOLD[k])
        said = [row[f"{name}_deg"] for name in ("theta_i", "phi_i", "phi_s", "theta_s")]
        assert said == [table.theta_i[i], table.phi_i[j], table.azimuth[a], table.polar[p]]
        assert row["brdf_per_sr"] == pytest.approx(table.values[place], rel=1e-8)
        assert row["brdf_single_per_sr"] == pytest.approx(table.single[place], rel=1e-8)
        assert row["albedo"] == pytest.approx(table.albedo[k, i, j], rel=1e-8)


def test_csv_about_the_specular_direction_has_both_kinds_of_angles(
    mirrored: mf.BrdfTable, tmp_path: Path
) -> None:
    mirrored.save(tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(newline="") as stream:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(stream)]
    wo = mirrored.directions()[1]
    for row, (_, i, j, a, p) in zip(rows, places(mirrored), strict=True):
        assert (row["radial_deg"], row["azimuth_deg"]) == (mirrored.polar[p], mirrored.azimuth[a])
        np.testing.assert_allclose(
            grid.from_normal(row["theta_s_deg"], row["phi_s_deg"]), wo[i, j, a, p], atol=1e-8
        )


def test_netcdf(table: mf.BrdfTable, tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray", reason="the extra 'bake' is not installed")
    pytest.importorskip("h5netcdf", reason="the extra 'bake' is not installed")
    table.save(tmp_path / "table.nc")
    with xarray.open_dataset(tmp_path / "table.nc", engine="h5netcdf") as found:
        assert found.brdf.dims == ("wavelength", "theta_i", "phi_i", "phi_s", "theta_s")
        np.testing.assert_array_equal(found.brdf, table.values)
        np.testing.assert_array_equal(found.brdf_error, table.errors)
        np.testing.assert_array_equal(found.albedo_single, table.albedo_single)
        np.testing.assert_array_equal(found.n + 1j * found.k, GOLD)
        assert found.brdf.units == "sr-1"
        assert json.loads(found.attrs["parameters"])["gamma"] == 3.0
    assert [entry.name for entry in tmp_path.iterdir()] == ["table.nc"]


def test_astm(table: mf.BrdfTable, tmp_path: Path) -> None:
    table.save(tmp_path / "table.astm")
    head, body = re.split(r"^VARS (.*)\n", (tmp_path / "table.astm").read_text("ascii"), flags=re.MULTILINE)[
        ::2
    ]
    names = re.search(r"^VARS (.*)$", (tmp_path / "table.astm").read_text("ascii"), re.MULTILINE)[1].split(
        ","
    )
    assert names == ["theta_i", "phi_i", "theta_s", "phi_s", "500nm", "600nm"]
    rows = np.array([line.split(",") for line in body.splitlines()], dtype=float)
    assert f"NUM_POINTS {len(rows)}" in head.splitlines()
    assert rows.shape == (table.values[0].size, 6)
    for row, (i, j, a, p) in zip(rows, np.ndindex(table.values.shape[1:]), strict=True):
        angles = [table.theta_i[i], table.phi_i[j], table.polar[p], table.azimuth[a]]
        np.testing.assert_allclose(row[:4], np.radians(angles), rtol=1e-8)
        np.testing.assert_allclose(row[4:], table.values[:, i, j, a, p], rtol=1e-8)


def read_blocks(text: str) -> tuple[dict[str, Any], list[list[str]]]:
    """Keywords, lists of angles by name, and the lines between DataBegin and DataEnd, without comments."""
    lines = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    begin, end = lines.index(["DataBegin"]), lines.index(["DataEnd"])
    assert end == len(lines) - 1
    head: dict[str, Any] = {}
    number = 0
    while number < begin:
        name, *rest = lines[number]
        if rest and rest[0].isdigit():
            number += 1
            head[name] = [float(text) for text in lines[number]]
            assert len(head[name]) == int(rest[0])
        else:
            head[name] = rest[0] if rest else None
        number += 1
    return head, lines[begin + 1 : end]


def test_zemax(mirrored: mf.BrdfTable, tmp_path: Path) -> None:
    """The order of angles: sample rotation, incidence, azimuth (rows), radial (columns)."""
    paths = mirrored.save(tmp_path / "gold.bsdf", "zemax")
    assert [Path(path).name for path in paths] == ["gold_500nm.bsdf", "gold_600nm.bsdf"]
    for k, path in enumerate(paths):
        head, body = read_blocks(Path(path).read_text("ascii"))
        assert list(head) == [
            "Source", "Symmetry", "SpectralContent", "ScatterType", "SampleRotation", "AngleOfIncidence",
            "ScatterAzimuth", "ScatterRadial", "Monochrome",
        ]  # fmt: skip
        assert (head["Symmetry"], head["ScatterType"]) == ("PlaneSymmetrical", "BRDF")
        assert head["AngleOfIncidence"] == [0, 40]
        assert (head["ScatterAzimuth"], head["ScatterRadial"]) == ([0, 90, 180], [0, 5, 90])
        for i in range(2):
            name, tis = body.pop(0)
            assert name == "TIS"
            assert float(tis) == pytest.approx(mirrored.albedo[k, i, 0], rel=1e-5)
            rows = np.array([body.pop(0) for _ in range(3)], dtype=float)
            np.testing.assert_allclose(rows, mirrored.values[k, i, 0], rtol=1e-4)
        assert body == []


def test_zemax_of_a_surface_with_grooves(tmp_path: Path) -> None:
    angles = {"theta_i": [30], "reference": "specular", "polar": [0, 5], "n": 16}
    one = mf.brdf_table(GROUND, phi_i=0, **angles).save(tmp_path / "one.bsdf", "zemax")[0]
    turned = mf.brdf_table(GROUND, phi_i=[0, 90], **angles).save(tmp_path / "two.bsdf", "zemax")[0]
    assert read_blocks(Path(one).read_text())[0]["Symmetry"] == "Asymmetrical"
    head, body = read_blocks(Path(turned).read_text())
    assert (head["Symmetry"], head["SampleRotation"]) == ("Asymmetrical4D", [0, 90])
    assert sum(line[0] == "TIS" for line in body) == 2


def test_lighttools(table: mf.BrdfTable, tmp_path: Path) -> None:
    """A block for each direction of the light; azimuths are turned so that light comes from 90 degrees."""
    paths = table.save(tmp_path / "gold.bsdf", "lighttools")
    head, body = read_blocks(Path(paths[1]).read_text("ascii"))
    assert head["ScatterRadial"] == [0, 20, 40, 60]
    assert head["ScatterAzimuth"] == [0, 90, 180, 270]
    for i in range(2):
        for j in range(2):
            said = dict(body.pop(0) for _ in range(6))
            assert list(said) == ["AOI", "POI", "Side", "Wavelength", "ScatterType", "TIS"]
            assert (float(said["AOI"]), float(said["POI"])) == (table.theta_i[i], table.phi_i[j] + 90)
            assert (said["Wavelength"], said["Side"]) == ("600", "Front")
            rows = np.array([body.pop(0) for _ in range(4)], dtype=float)
            # azimuth 0 of the file is azimuth 270 of the table
            np.testing.assert_allclose(rows, table.values[1, i, j][[3, 0, 1, 2]], rtol=1e-4)
    assert body == []


@pytest.mark.parametrize(
    ("name", "format", "words"),
    [
        ("a.bsdf", None, "zemax"),
        ("a.txt", None, "must end in"),
        ("a.csv", "speos", "format must be one of"),
        ("a.bsdf", "zemax", "specular"),
        ("nowhere/a.csv", None, "nowhere"),
    ],
)
def test_bad_files_are_one_sentence(
    table: mf.BrdfTable, name: str, format: str | None, words: str, tmp_path: Path
) -> None:
    with pytest.raises((ValueError, OSError), match=words):
        table.save(tmp_path / name, format)
    assert list(tmp_path.iterdir()) == []


def test_formats_about_the_normal(mirrored: mf.BrdfTable, tmp_path: Path) -> None:
    for name, format in (("a.astm", None), ("a.bsdf", "lighttools")):
        with pytest.raises(ValueError, match="from the normal"):
            mirrored.save(tmp_path / name, format)


# The command


@pytest.fixture
def run() -> Run:
    return lambda *arguments: CliRunner().invoke(main, ["brdf", *map(str, arguments)])


QUICK = ("--theta-i", "0,40", "--polar", "0,20,40", "--azimuth", "0,180", "-n", "64")


def test_the_command_says_what_the_table_says(run: Run, tmp_path: Path) -> None:
    gold = tmp_path / "gold.csv"
    gold.write_text(TABLES["commas"])
    chosen = ["student_t", "--alpha", 0.3, "--gamma", 2.5, "--index", gold, *QUICK]
    light = ["--wavelength", "500nm", "--wavelength", "0.55um", "--wavelength", "6e-7"]
    result = run(
        *chosen,
        *light,
        "--abg",
        "--json",
        "-o",
        tmp_path / "t.csv",
        "-o",
        tmp_path / "t.bsdf",
        "--format",
        "zemax",
    )
    assert result.exit_code == 0, result.stderr
    answer = json.loads(result.stdout)
    expected = mf.brdf_table(
        ROUGH, [500e-9, 550e-9, 600e-9], gold, theta_i=[0, 40], polar=[0, 20, 40], azimuth=[0, 180], n=64
    )
    np.testing.assert_allclose(answer["albedo"], expected.albedo, rtol=1e-12)
    np.testing.assert_allclose(answer["wavelengths"], expected.wavelengths)
    assert answer["abg"] == [pytest.approx(one._asdict()) for one in expected.abg()]
    names = ["t.csv", "t_500nm.bsdf", "t_550nm.bsdf", "t_600nm.bsdf"]
    assert [Path(path).name for path in answer["files"]] == names
    assert all(Path(path).exists() for path in answer["files"])
    assert (tmp_path / "t.csv").read_text().startswith("wavelength_m,")
    assert "S-filter of 5e-07 m" in answer["remarks"][0]


def test_the_brdf_of_a_measured_surface(run: Run, tmp_path: Path) -> None:
    surface = mf.synthesize(ROUGH, (128, 128), 2e-6, seed=1)
    np.savez(tmp_path / "map.npz", heights=surface.heights, pixel_size=2e-6)
    options = ["--surface", tmp_path / "map.npz", "--index", "0.97+1.87j", *QUICK]
    answer = json.loads(run(*options, "student_t", "--lag", 2, "--json").stdout)
    best = mf.fit(mf.read_surface(tmp_path / "map.npz").level(), "student_t", lag=2)[0]
    assert answer["parameters"] == best.ndf.parameters
    assert any("15 times the shortest period" in line for line in answer["remarks"])
    said = run(*options, "--single")
    assert said.exit_code == 0, said.stderr
    assert said.stdout.startswith("wavelength\ttheta_i\tphi_i\talbedo\tof one order\tlargest BRDF\n")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], ["FAMILY"]),
        (["phong"], ["phong"]),
        (["ggx"], ["alpha"]),
        (["ggx", "--alpha", "0.3", "--lag", "2"], ["--lag goes with --surface"]),
        (["ggx", "--alpha", "0.3", "--surface", "map.npz"], ["--alpha is fitted"]),
        (["ggx", "--alpha", "0.3", "--index", "1.5,2"], ["--index", "1.5,2"]),
        (["ggx", "--alpha", "0.3", "--wavelength", "550"], ["metres"]),
        (["ggx", "--alpha", "0.3", "--wavelength", "550 furlongs"], ["550nm"]),
        (["ggx", "--alpha", "0.3", "-o", "a.bsdf"], ["zemax"]),
        (["ggx", "--alpha", "0.3", "-o", "a.xyz"], ["must end in"]),
        (["ggx", "--alpha", "0.3", "--btdf"], ["BTDF"]),
        (["--surface", "missing.npz"], ["missing.npz"]),
    ],
)
def test_bad_options_are_one_sentence(run: Run, options: list[str], words: list[str]) -> None:
    assert_one_sentence(run(*options), *words)
