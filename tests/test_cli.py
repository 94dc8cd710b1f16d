"""The command line: what it prints, its exit statuses, and that errors are one sentence."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
from click.testing import CliRunner, Result

import microfacet as mf
from limits import HANG
from microfacet import _checks
from microfacet.cli import main
from microfacet.cli.sample import Draw, View

Run = Callable[..., Result]


@pytest.fixture
def run() -> Run:
    def call(*arguments: str, stdin: str | None = None) -> Result:
        return CliRunner().invoke(main, list(arguments), input=stdin)

    return call


def command(*arguments: str, **options: Any) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "microfacet.cli", *arguments],
        capture_output=True,
        text=True,
        timeout=HANG,
        **options,
    )


# eval


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["ggx", "sigma", "0.5", "--alpha", "0.3"], [mf.ggx.sigma(0.5, 0.3)]),
        (["beckmann", "sigma", "-0.5", "--alpha", "0.5"], [mf.beckmann.sigma(-0.5, 0.5)]),
        (["beckmann", "sigma", "--alpha", "0.5", "--", "-0.5"], [mf.beckmann.sigma(-0.5, 0.5)]),
        (
            ["student_t", "D", "0.2", "1", "--alpha", ".3", "--gamma", "2.5"],
            mf.student_t.D([0.2, 1], 0.3, 2.5),
        ),
        (["bessel_k", "P2", "-1e-3", "--alpha", "1", "--a", "0.7"], [mf.bessel_k.P2(-1e-3, 1.0, 0.7)]),
        (["k0", "P22", "0.1,-0.2", "-1,2", "--alpha", "2"], mf.k0.P22([0.1, -1], [-0.2, 2], 2.0)),
        # The density needs less of gamma than the projected area does.
        (["student_t", "P2", "0.2", "--alpha", "0.3", "--gamma", "1.2"], [mf.student_t.P2(0.2, 0.3, 1.2)]),
    ],
)
def test_eval_prints_what_the_ufunc_gives(run: Run, arguments: list[str], expected: Any) -> None:
    result = run("eval", *arguments)
    assert result.exit_code == 0, result.stderr
    heading, *lines = result.stdout.splitlines()
    assert heading.endswith(f"\t{arguments[1]}")
    assert [float(line.split("\t")[-1]) for line in lines] == list(expected), "every digit is printed"


def test_eval_as_json(run: Run) -> None:
    result = run("eval", "k0", "D", "1", "0.5", "nan", "--alpha", "0.5", "--json")
    assert json.loads(result.stdout) == {
        "family": "k0",
        "quantity": "D",
        "parameters": {"alpha": 0.5},
        "dtype": "float64",
        "values": [1.0, 0.5, None],
        "results": [None, float(mf.k0.D(0.5, 0.5)), None],  # infinite, and not a number
    }


def test_eval_in_single_precision(run: Run) -> None:
    result = run("eval", "gtr", "Lambda", "0.3", "--alpha", "0.1", "--gamma", "1", "--dtype", "float32")
    printed = result.stdout.splitlines()[1].split("\t")[1]
    expected = mf.gtr.Lambda(np.float32(0.3), np.float32(0.1), np.float32(1))
    assert np.float32(printed) == expected
    assert printed == str(expected), "no digit that single precision does not have"


def test_eval_reads_stdin(run: Run) -> None:
    result = run("eval", "ggx", "P22", "-", "--alpha", "0.3", stdin="0.1 0.2\n\n0,0\n")
    values = [float(line.split("\t")[-1]) for line in result.stdout.splitlines()[1:]]
    assert values == list(mf.ggx.P22([0.1, 0.0], [0.2, 0.0], 0.3))


# sample


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


# verify


def test_verify_prints_a_table_and_the_count(run: Run) -> None:
    result = run("verify", "--id", "k0.lambda_of_x", "--id", "k0.marginal")
    assert result.exit_code == 0
    assert "k0.lambda_of_x" in result.stdout
    assert result.stdout.count("✓ holds") == 2
    assert result.stdout.splitlines()[-2:] == ["1 of 1 notebook checks hold", "1 of 1 further checks hold"]


def test_verify_as_json(run: Run) -> None:
    result = run("verify", "--id", "gtr.gamma_1", "--alpha", "0.4", "--json")
    (entry,) = json.loads(result.stdout)
    fields = "id, family, parameters, lhs, rhs, residual, tolerance, passed, source"
    assert list(entry) == fields.split(", ")
    assert entry["id"] == "gtr.gamma_1"
    assert entry["parameters"]["alpha"] == 0.4
    assert entry["passed"] is True


@pytest.mark.parametrize("form", [[], ["--json"]])
def test_verify_exits_with_1_when_a_check_fails(
    run: Run, form: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    good = next(_checks.run(ids=["k0.lambda_of_x"]))
    bad = _checks.CheckResult(**{**good.as_dict(), "residual": 1.0, "passed": False})
    monkeypatch.setattr(_checks, "run", lambda *_: iter([good, bad]))
    result = run("verify", *form)
    assert result.exit_code == 1
    if not form:
        assert "✗ fails" in result.stdout, "a check holds where it holds at every point"
        assert result.stdout.splitlines()[-1] == "0 of 1 notebook checks hold"


# fit, families, report


def test_a_surface_is_prepared_in_the_order_of_the_options(run: Run, tmp_path: Path) -> None:
    rng = np.random.default_rng(8)
    path = tmp_path / "map.npz"
    np.savez(path, heights=1e-7 * rng.normal(size=(60, 70)), pixel_size=2e-6)
    options = "--outliers 9 --level plane --form 3 --s-filter 1e-5 --l-filter 5e-5 --lag-length 6e-6"
    result = run("fit", str(path), "--family", "ggx", "--json", *options.split())
    assert result.exit_code == 0, result.stderr
    surface = mf.read_surface(path).mask_outliers(9).level().remove_form(3)
    surface = surface.filtered(short=1e-5, long=5e-5).at_lag(length=6e-6)
    assert json.loads(result.stdout)["steps"] == list(surface.steps)
    assert len(surface.steps) == 6
    points = [f"--level-point={point}" for point in ("3,3", "60,5", "30,50")]
    result = run("fit", str(path), "--family", "ggx", "--json", "--level", "three-point", *points)
    assert "plane through the pixels (3, 3), (60, 5), (30, 50)" in json.loads(result.stdout)["steps"][0]
    result = run("fit", str(path), "--family", "ggx", "--json", "--level", "none")
    assert json.loads(result.stdout)["steps"] == []


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ("--level curved", "--level must be plane"),
        ("--level three-point", "needs points"),
        ("--level three-point --level-point 1;2", "COLUMN,ROW"),
        ("--level-point 1,2", "goes with"),
        ("--level 99", "degree"),
        ("--form cube", "sphere"),
        ("--outliers -1", "threshold"),
        ("--s-filter 1e-6", "two pixels"),
        ("--lag 1 --lag-length 4e-6", "either"),
        ("--scale 1e-9", "for images"),
    ],
)
def test_bad_preparation_is_one_sentence(run: Run, tmp_path: Path, options: str, word: str) -> None:
    np.savez(tmp_path / "map.npz", heights=np.random.default_rng(8).normal(size=(20, 30)), pixel_size=2e-6)
    assert_one_sentence(run("fit", str(tmp_path / "map.npz"), *options.split()), word)


def test_slopes_are_fitted_as_they_are(run: Run, tmp_path: Path) -> None:
    slopes = 0.2 * np.random.default_rng(3).normal(size=(300, 2))
    np.save(tmp_path / "slopes.npy", slopes)
    given = ["fit", str(tmp_path / "slopes.npy"), "--slopes", "table", "--family", "beckmann"]
    answer = json.loads(run(*given, "--json").stdout)
    assert answer["ranking"][0]["params"] == mf.fit(slopes, "beckmann")[0].params
    assert answer["source"] == "slopes.npy"
    assert_one_sentence(run(*given, "--lag", "2"), "--lag is for height maps")
    assert_one_sentence(run("report", "--surface", "a.npy", "--slopes", "opengl"), "height map")


def test_families_lists_all(run: Run) -> None:
    entries = json.loads(run("families", "--json").stdout)
    assert [entry["name"] for entry in entries] == [family.name for family in mf.families()]
    assert entries[3]["parameters"][1] == {"name": "gamma", "lower": 1.5, "upper": None}
    assert len(run("families").stdout.splitlines()) == 1 + len(entries)


def test_report_ends_with_its_path(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = run("report", "--family", "ggx", "--quick", "--output", "page.html")
    assert result.exit_code == 0, result.stderr
    path = Path(result.stdout.splitlines()[-1])
    assert path.is_absolute()
    assert path.read_text("utf-8").startswith("<!DOCTYPE html>")


def test_report_as_json(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from microfacet._report import families

    def build(path: str, *arguments: object) -> families.Report:
        assert arguments[:3] == (("gtr",), {"gamma": 1.5}, None)
        return families.Report(tmp_path / path, 3, 4, 0.25)

    monkeypatch.setattr(families, "build", build)
    result = run("report", "--family", "gtr", "--gamma", "1.5", "--json")
    assert json.loads(result.stdout) == {
        "path": str(tmp_path / "report.html"),
        "passed": 3,
        "total": 4,
        "seconds": 0.25,
    }
    assert result.exit_code == 1, "a check failed"


# Errors


def assert_one_sentence(result: Result, *words: str) -> None:
    assert result.exit_code == 2, (result.stdout, result.stderr)
    assert result.stdout == ""
    assert result.stderr.startswith("microfacet: ")
    assert result.stderr.count("\n") == 1
    assert "Traceback" not in result.stderr
    for word in words:
        assert word in result.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("eval nonsense D 1 --alpha 1", ["family must be one of", "'nonsense'"]),
        ("eval ggx nonsense 1 --alpha 1", ["quantity must be one of", "'nonsense'"]),
        ("eval ggx D one --alpha 1", ["values must be numbers", "'one'"]),
        ("eval ggx D 1,2 --alpha 1", ["must be one number", "'1,2'"]),
        ("eval ggx P22 1 --alpha 1", ["2 numbers", "'1'"]),
        ("eval ggx D 1", ["ggx needs --alpha"]),
        ("eval ggx D 1 --alpha 1 --gamma 2", ["ggx has no parameter gamma"]),
        ("eval ggx D 1 --alpha -1", ["alpha must lie in (1e-101, 1e+101), got -1"]),
        ("eval ggx D 1 --alpha nan", ["alpha must lie in (1e-101, 1e+101), got nan"]),
        ("eval student_t sigma 1 --alpha 1 --gamma 1.2", ["gamma must lie in (1.5, inf), got 1.2"]),
        ("eval ggx D 1 --alpha x", ["--alpha", "'x'"]),
        ("eval ggx D 1 --alpha 1 --dtype float16", ["--dtype"]),
        ("eval ggx D --alpha 1", ["VALUES"]),
        ("eval ggx D 1 --alpha 1 --nonsense", ["--nonsense"]),
        ("sample ggx --alpha 0", ["GGX: alpha must lie in (1e-101, 1e+101), got 0"]),
        ("sample ggx --alpha 1 -n 0", ["-n"]),
        ("sample ggx --alpha 1 -o normals.txt", ["must end in .npy, .csv, .parquet"]),
        ("sample ggx --alpha 1 --visible 181", ["--visible", "181"]),
        ("sample ggx --alpha 1 --visible 180", ["no normal can be seen from 180 degrees"]),
        ("sample k0 --alpha 1 --visible 30 --bounded", ["bounded", "ggx alone", "k0"]),
        ("sample ggx --alpha 1 --phi 30", ["go with --visible"]),
        ("sample ggx --alpha 1 --visible 1 --scheme mixture --bounded", ["exclude each other"]),
        ("sample ggx --alpha 1 --visible 1 --scheme best", ["--scheme", "best"]),
        ("sample ggx --alpha 1 --json", ["--output"]),
        ("sample ggx --alpha 1 -o missing/normals.npy", ["missing", "No such file"]),
        ("verify --id k0.nonsense", ["k0.nonsense"]),
        ("verify --family nonsense", ["nonsense"]),
        ("verify --alpha -1", ["alpha must lie in (1e-101, 1e+101), got -1"]),
        ("fit missing.npz", ["missing.npz"]),
        ("fit . ", ["."]),
        ("fit map.npz --lag 0", ["--lag"]),
        ("report --family nonsense", ["family must be one of"]),
        ("report --family ggx --gamma 2", ["gamma is no parameter of ggx"]),
        ("report --gamma 1.2 --family student_t", ["gamma must lie in (1.5, inf), got 1.2"]),
        ("report --output missing/page.html", ["existing folder"]),
        ("report --surface missing.npz", ["missing.npz"]),
        ("report --surface a.npz --terrain", ["exclude each other"]),
        ("nonsense", ["No such command 'nonsense'"]),
        ("--nonsense", ["--nonsense"]),
    ],
)
def test_bad_input_is_one_sentence(
    run: Run, arguments: str, words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert_one_sentence(run(*arguments.split()), *words)
    assert not list(tmp_path.iterdir()), "nothing is written"


def test_results_that_are_nan_for_their_own_reason_are_printed(run: Run) -> None:
    result = run("eval", "ggx", "D", "nan", "1", "--alpha", "0.3")
    assert result.exit_code == 0
    assert result.stdout.splitlines()[1].split("\t")[1] == "nan"


def test_interrupt_exits_with_130(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(_checks, "run", interrupt)
    result = run("verify")
    assert result.exit_code == 130
    assert "Traceback" not in result.stderr


# As a process


def test_a_closed_pipe_is_silent() -> None:
    producer = subprocess.Popen(
        [sys.executable, "-m", "microfacet.cli", "sample", "ggx", "--alpha", "0.3", "-n", "1000000"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert producer.stdout is not None
    assert producer.stderr is not None
    assert producer.stdout.readline() == b"x,y,z\n"
    producer.stdout.close()
    assert producer.stderr.read() == b""
    assert producer.wait(timeout=HANG) == 141
    producer.stderr.close()


def test_stdin_and_stdout_of_a_process() -> None:
    done = command("eval", "beckmann", "sigma", "-", "--alpha", "0.5", input="-0.5\n0.5\n")
    assert done.returncode == 0
    assert done.stderr == ""
    rows = [line.split("\t") for line in done.stdout.splitlines()]
    assert rows == [["u", "sigma"], *([str(u), str(mf.beckmann.sigma(u, 0.5))] for u in (-0.5, 0.5))]


def test_version_and_errors_of_a_process() -> None:
    assert command("--version").stdout == f"microfacet, version {mf.__version__}\n"
    failed = command("eval", "ggx", "D", "1")
    assert (failed.returncode, failed.stdout) == (2, "")
    assert failed.stderr == "microfacet: ggx needs --alpha\n"


def test_starting_loads_no_heavy_library() -> None:
    heavy = ["matplotlib", "scipy", "mpmath", "rich", "jinja2"]
    code = f"import sys, microfacet.cli; print([name for name in {heavy} if name in sys.modules])"
    program = [sys.executable, "-c", code]
    done = subprocess.run(program, capture_output=True, text=True, timeout=HANG, check=True)
    assert done.stdout == "[]\n"


# Help


def test_no_arguments_show_the_help(run: Run) -> None:
    result = run()
    assert result.exit_code == 0
    assert all(name in result.stdout for name in main.commands)


@pytest.mark.parametrize("name", [name for name in main.commands if name != "families"])
def test_every_command_has_examples_that_parse(run: Run, name: str) -> None:
    result = run(name, "--help")
    assert result.exit_code == 0
    lines = result.stdout.split("Examples:")[1].split("Options:")[0].splitlines()
    examples = [line.strip().split("| ")[-1].split() for line in lines if line.strip()]
    assert examples
    for program, command_name, *arguments in examples:
        assert program == "microfacet"
        assert command_name == name
        main.commands[name].make_context(name, arguments, resilient_parsing=False)


def test_options_are_explained(run: Run) -> None:
    for name, entry in main.commands.items():
        for parameter in entry.params:
            if isinstance(parameter, click.Option):
                assert parameter.help, f"{name} {parameter.name}"


def test_verify_refuses_what_its_checks_do_not_cover(run: Run) -> None:
    result = run("verify", "--alpha", "1e50", "--family", "ggx")
    assert result.exit_code == 2
    assert "cover alpha in" in result.stderr


def test_report_refuses_options_of_a_surface_without_one(run: Run) -> None:
    result = run("report", "--quick", "--lag", "3", "--family", "ggx")
    assert result.exit_code == 2
    assert "--lag goes with --surface" in result.stderr
