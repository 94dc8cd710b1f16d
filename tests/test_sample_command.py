"""The command `sample`: files, visible normals, blocks."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from cli_runs import Run, assert_one_sentence
from microfacet.cli.sample import Draw, View


def test_sample_prints_unit_normals(run: Run) -> None:
    result = run("sample", "student_t", "--alpha", "0.3", "--gamma", "2.5", "-n", "50", "--seed", "4")
    assert result.stdout.splitlines()[0] == "x,y,z"
    normals = np.loadtxt(result.stdout.splitlines()[1:], delimiter=",")
    xi = np.random.default_rng(4).random((50, 2))
    np.testing.assert_array_equal(normals, mf.StudentT(alpha=0.3, gamma=2.5).sample(xi))


def read_parquet(path: Path) -> Any:
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    table = parquet.read_table(path)
    assert table.column_names == ["x", "y", "z"]
    return np.stack([column.to_numpy() for column in table.columns], axis=-1)


READERS: dict[str, Callable[[Path], Any]] = {
    ".npy": np.load,
    ".csv": lambda path: np.loadtxt(path, delimiter=",", skiprows=1),
    ".parquet": read_parquet,
}


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("suffix", READERS)
def test_sample_writes_files(
    run: Run, tmp_path: Path, suffix: str, dtype: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if suffix == ".parquet":
        pytest.importorskip("pyarrow", reason="pyarrow is not installed")
    monkeypatch.setattr("microfacet.cli.sample._BLOCK", 7)
    path = tmp_path / f"normals{suffix}"
    result = run(
        "sample", "ggx", "--alpha", "0.3", "-n", "30", "--seed", "4", "-o", str(path), "--dtype", dtype
    )
    assert result.exit_code == 0, result.stderr
    assert result.stdout == f"{path}\n"
    normals = READERS[suffix](path)
    assert normals.shape == (30, 3)
    assert suffix == ".csv" or normals.dtype == dtype
    xi = np.random.default_rng(4).random((30, 2))
    if dtype == "float32":
        xi = (xi * 2**24 // 1 / 2**24).astype(dtype)
    expected = mf.GGX(alpha=0.3).sample(xi)
    np.testing.assert_array_equal(normals.astype(dtype), expected, "blocks make no difference")
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


VISIBLE = {
    "ggx": (["--alpha", "0.3"], mf.GGX(alpha=0.3)),
    "k0": (["--alpha", "0.5"], mf.K0(alpha=0.5)),
    "student_t": (["--alpha", "0.3", "--gamma", "3"], mf.StudentT(alpha=0.3, gamma=3.0)),
}


@pytest.mark.parametrize("family", VISIBLE)
@pytest.mark.parametrize("scheme", ["continuous", "mixture"])
def test_sample_of_visible_normals(
    run: Run, tmp_path: Path, family: str, scheme: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    given, ndf = VISIBLE[family]
    path = tmp_path / "visible.npy"
    options = ["--visible", "100", "--phi", "30", "--scheme", scheme, "-n", "50", "--seed", "9"]
    monkeypatch.setattr("microfacet.cli.sample._BLOCK", 11)
    result = run("sample", family, *given, *options, "-o", str(path), "--json")
    assert result.exit_code == 0, result.stderr
    summary = json.loads(result.stdout)
    assert summary["path"] == str(path)
    assert summary["visible"] == {"theta": 100.0, "phi": 30.0}
    assert (summary["scheme"], summary["count"], summary["seed"]) == (scheme, 50, 9)
    w, (theta, phi) = View(100.0, 30.0).direction, np.radians([100.0, 30.0])
    expected = [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]
    np.testing.assert_allclose(w, expected, rtol=1e-15)
    xi = np.random.default_rng(9).random((50, summary["dims"]))
    normals = np.load(path)
    np.testing.assert_array_equal(normals, ndf.sample_visible(w, xi, scheme=scheme))
    assert (normals @ w > 0).all()


def test_bounded_normals_reflect_upwards_more_often(run: Run, tmp_path: Path) -> None:
    path, w = tmp_path / "normals.npy", View(85.0).direction
    lost = []
    for bounded in ([], ["--bounded"]):
        given = ["--alpha", "0.8", "--visible", "85", "-n", "1000", "-o", str(path)]
        assert run("sample", "ggx", *given, *bounded).exit_code == 0
        normals = np.load(path)
        lost.append(np.mean(2.0 * (normals @ w) * normals[:, 2] < w[2]))
    assert lost[1] < 0.7 * lost[0]


def test_any_block_can_be_drawn_on_its_own() -> None:
    draw = Draw(mf.GGX(alpha=0.3), 10_000_000_000, 3)
    whole = draw.block(0, 1000)
    for start, stop in ((0, 1), (1, 4), (333, 1000), (999, 1000)):
        np.testing.assert_array_equal(draw.block(start, stop), whole[start:stop])
    assert draw.block(9_999_999_990, 10_000_000_000).shape == (10, 3), "far into the sequence, at once"


def test_parquet_without_its_library_is_one_sentence(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    result = run("sample", "ggx", "--alpha", "1", "-o", str(tmp_path / "normals.parquet"))
    assert_one_sentence(result, "needs pyarrow", ".[parquet]")
    assert not list(tmp_path.iterdir())


def test_sample_never_leaves_half_a_file(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "normals.npy"
    path.write_bytes(b"old")

    def blocks(*_: object) -> Iterator[np.ndarray]:
        yield np.zeros((2, 3))
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(Draw, "blocks", blocks)
    result = run("sample", "ggx", "--alpha", "0.3", "-o", str(path))
    assert_one_sentence(result, "No space left on device")
    assert path.read_bytes() == b"old"
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]
