"""The command line: what it prints, its exit statuses, and it as a process."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from cli_runs import Run, assert_one_sentence
from limits import HANG
from microfacet import _checks


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


# verify


def test_verify_prints_a_table_and_the_count(run: Run) -> None:
    result = run("verify", "--id", "k0.lambda_of_x", "--id", "k0.marginal")
    assert result.exit_code == 0
    assert "k0.lambda_of_x" in result.stdout
    assert result.stdout.count("✓ holds") == 2
    assert result.stdout.splitlines()[-2:] == ["1 of 1 notebook checks hold", "1 of 1 further checks hold"]


def test_verify_as_json(run: Run) -> None:
    result = run("verify", "--id", "gtr.gamma_1", "--alpha", "0.4", "--json")
    record = json.loads(result.stdout)
    (entry,) = record["checks"]
    assert record["families"]["gtr"]["notebook"] == {"stated": 15, "checked": 1, "held": 1}
    assert record["families"]["gtr"]["further"]["checked"] == 0
    fields = "id, family, parameters, lhs, rhs, residual, tolerance, passed, source, symbolic"
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
