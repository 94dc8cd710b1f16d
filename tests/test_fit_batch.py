"""Many files: one table as CSV or Parquet, and workers only where they are worth their start."""

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
from microfacet.cli import batch, cluster, fits, main


@pytest.fixture
def run() -> Run:
    return lambda *arguments: CliRunner().invoke(main, ["fit", *map(str, arguments)])


@pytest.fixture
def files(tmp_path: Path) -> list[Path]:
    """Two maps of pixels that are not square, one of them with holes, and a file that is no map."""
    found = []
    for seed, missing in ((1, 0.0), (2, 0.25)):
        surface = mf.synthesize(mf.StudentT(alpha=0.2, gamma=3.0), (64, 80), (1e-6, 2e-6), seed=seed)
        mask = np.random.default_rng(seed).random((64, 80)) >= missing
        found.append(tmp_path / f"map {seed}, first.npz")
        np.savez(found[-1], heights=surface.heights, mask=mask, dx=1e-6, dy=2e-6)
    found.append(tmp_path / "broken.npz")
    found[-1].write_bytes(b"no zip")
    return found


OPTIONS = ("--family", "ggx", "--family", "student_t", "--no-scales")


def test_the_table_has_a_row_for_every_file(run: Run, files: list[Path], tmp_path: Path) -> None:
    table = tmp_path / "table.csv"
    result = run(*files, *OPTIONS, "--output", table)
    assert result.exit_code == 2, "a file could not be read"
    assert str(table) in result.stdout
    with table.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["file"] for row in rows] == list(map(str, files))
    for row, file in zip(rows[:2], files, strict=False):
        surface = mf.read_surface(file).level()
        results = mf.fit(surface, ["ggx", "student_t"])
        best, *others = results
        assert (row["fits"], row["verdict"]) == (str(results.verdict.fits), results.verdict.sentence)
        assert float(row["p_value"]) == results.verdict.p_value
        assert row["warnings"] == "; ".join(results.warnings)
        assert (float(row["pixel_size_x"]), float(row["pixel_size_y"])) == (1e-6, 2e-6)
        assert (row["columns"], row["rows"], row["lag"]) == ("80", "64", "1")
        assert float(row["valid_fraction"]) == surface.mask.mean()
        assert float(row["lag_length"]) == pytest.approx(math.sqrt(2) * 1e-6)
        values = mf.roughness(surface)
        assert (float(row["Sq"]), float(row["Sdq"])) == (values.Sq, values.Sdq)
        assert (row["family"], row["symmetry"]) == (best.family, best.symmetry)
        for name, number in best.params.items():
            assert float(row[name]) == number
            assert float(row[f"{name}_error"]) == best.standard_errors[name]
        assert float(row["anderson_darling"]) == best.goodness.anderson_darling
        assert row["tied"].split("; ") == [f"{o.family} ({o.symmetry})" for o in others if o.tied] or [""]
        second = next(other for other in others if other.family != best.family)
        assert row["second"] == f"{second.family} ({second.symmetry})"
        assert float(row["second_held_out"]) == second.held_out - best.held_out
        assert row["noise"] == ""
    assert "broken.npz" in rows[2]["error"]
    assert {value for name, value in rows[2].items() if name not in ("file", "error")} == {""}


def test_parquet_holds_the_same_as_csv(run: Run, files: list[Path], tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet", reason="the extra 'parquet' is not installed")
    for name in ("table.csv", "table.parquet"):
        assert run(*files, *OPTIONS, "-o", tmp_path / name).exit_code == 2
    with (tmp_path / "table.csv").open(encoding="utf-8", newline="") as stream:
        expected = list(csv.DictReader(stream))
    found = parquet.read_table(tmp_path / "table.parquet")
    assert found.column_names == list(expected[0])
    for row, text in zip(found.to_pylist(), expected, strict=True):
        assert {name: "" if value is None else str(value) for name, value in row.items()} == text
    assert str(found.schema.field("error").type) == "string"
    assert str(found.schema.field("Sdq").type) == "double"


def test_one_file_and_json(run: Run, files: list[Path], tmp_path: Path) -> None:
    table = tmp_path / "one.csv"
    result = run(files[1], *OPTIONS, "--json", "--output", table)
    assert result.exit_code == 0, result.stderr
    answer = json.loads(result.stdout)
    assert answer["output"] == str(table)
    assert answer["extent"]["shape"] == [64, 80]
    assert answer["extent"]["pixel_size"] == [1e-6, 2e-6]
    assert 0.7 < answer["extent"]["valid_fraction"] < 0.8
    assert len(table.read_text("utf-8").splitlines()) == 2


def test_the_names_of_columns_keep_their_neighbours() -> None:
    rows: list[dict[str, Any]] = [{"file": 1, "alpha": 2, "end": 3}, {"file": 1, "alpha_x": 4, "end": 5}]
    assert batch._columns([*rows, {"file": 0, "error": "x"}]) == [
        "file", "error", "alpha_x", "alpha", "end",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["-o", "table.xlsx"], ".parquet"),
        (["-o", "nowhere/table.csv"], "existing folder"),
        (["-o", "/dev/stdout", "--json"], "--output"),
    ],
)
def test_bad_outputs_are_one_sentence(
    run: Run,
    files: list[Path],
    options: list[str],
    word: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(fits, "run", lambda *_: pytest.fail("fitted before the output was looked at"))
    assert_one_sentence(run(files[0], *options), word)


def test_small_files_start_no_workers(run: Run, files: list[Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "client", lambda *_: pytest.fail("workers were started"))
    monkeypatch.setattr(cluster, "processors", lambda: 8)
    assert run(files[0], files[1], *OPTIONS).exit_code == 0


@pytest.mark.parametrize(("sizes", "workers"), [((2**26, 2**26), True), ((2**26, 2**26 - 1), False)])
def test_workers_are_a_matter_of_bytes(
    sizes: tuple[int, ...], workers: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = []
    for k, size in enumerate(sizes):
        names.append(str(tmp_path / f"{k}.npy"))
        with open(names[-1], "wb") as stream:
            stream.truncate(size)  # no disk is used
    monkeypatch.setattr(cluster, "processors", lambda: 4)
    assert cluster.worthwhile([*names, "missing.npy"]) == workers
    monkeypatch.setattr(cluster, "processors", lambda: 2)
    assert not cluster.worthwhile(names)
