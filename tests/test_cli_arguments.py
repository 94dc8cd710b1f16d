"""What the command line takes for an option and for a value, its callers, and the paths that it prints."""

from __future__ import annotations

import json
import re
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
from click.testing import CliRunner, Result

import microfacet as mf
from microfacet._docs import QUANTITIES
from microfacet.cli import main

Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(main, list(arguments))


def assert_sentence(result: Result, sentence: str) -> None:
    assert (result.exit_code, result.stdout) == (2, ""), result.stderr
    assert result.stderr == f"microfacet: {sentence}\n"


# Options that do not exist

SLIPS = [
    (name, option, opt)
    for name, command in main.commands.items()
    for option in command.params
    if isinstance(option, click.Option)
    for opt in option.opts
    if len(opt) > 6
]


@pytest.mark.parametrize(("name", "option", "opt"), SLIPS, ids=lambda value: str(value))
def test_a_slip_of_the_pen_is_named(run: Run, name: str, option: click.Option, opt: str) -> None:
    """Whatever the command: the option as it was typed, and the one that was meant."""
    wrong = opt[:-2] + opt[-1]
    for given in ([wrong, "0.3"], [f"{wrong}=0.3"]):
        result = run(name, *given)
        assert result.exit_code == 2
        assert result.stderr == f"microfacet: No such option: {wrong}. Did you mean {opt}?\n"


@pytest.mark.parametrize(
    ("line", "wrong", "near"),
    [
        ("ggx D 0.5 --alpa 0.3", "--alpa", "--alpha"),
        ("ggx D --alhpa 0.3 -0.5", "--alhpa", "--alpha"),
        ("--alpah 0.3", "--alpah", "--alpha"),
        ("ggx --gama=2 D 0.5 --alpha 0.3", "--gama", "--gamma"),
        ("student_t sigma -0.5 0.2 --gamm 2.5 --alpha 1", "--gamm", "--gamma"),
        ("ggx D 0.5 --alpha-x 0.3", "--alpha-x", "--alpha"),
        ("ggx D 0.5 --alpha 1 --jsn", "--jsn", "--json"),
        ("ggx D 0.5 --alpha 1 -j", "-j", None),
    ],
)
def test_no_mistyped_option_is_a_value(run: Run, line: str, wrong: str, near: str | None) -> None:
    said = f"No such option: {wrong}." + (f" Did you mean {near}?" if near else "")
    assert_sentence(run("eval", *line.split()), said)


@pytest.mark.parametrize(
    ("quantity", "values"),
    [
        ("sigma", ["-0.5", "-.25", "-1e-3", "-1", "-0.", "-nan"]),
        ("P2", ["-inf", "-Infinity", "-3", "-1E5"]),
        ("slope_cdf", ["-.5", "0", "-7e-1"]),
    ],
)
def test_negative_numbers_are_values(run: Run, quantity: str, values: list[str]) -> None:
    result = run("eval", "beckmann", quantity, *values, "--alpha", "0.5")
    assert result.exit_code == 0, result.stderr
    found = [float(line.split("\t")[1]) for line in result.stdout.splitlines()[1:]]
    np.testing.assert_array_equal(found, getattr(mf.beckmann, quantity)(np.array(values, dtype=float), 0.5))


def test_what_begins_like_a_number_and_is_none_is_a_bad_value(run: Run) -> None:
    assert_sentence(run("eval", "ggx", "D", "-0.5x", "--alpha", "1"), "values must be numbers, got '-0.5x'")


# Values outside the domain

OUTSIDE = {"u": ["30", "-1.5", "1.1", "inf"], "xi": ["1", "-0.25", "7"], "r": ["-2", "-inf"]}


@pytest.mark.parametrize("family", mf.families(), ids=lambda family: family.name)
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_values_outside_the_domain_are_named(run: Run, family: Any, quantity: str) -> None:
    (first, *others) = QUANTITIES[quantity].arguments
    given = {p.name: "2.5" if p.lower > 0 else "0.5" for p in family.parameters}
    options = [word for name, value in given.items() for word in (f"--{name}", value)]
    for value in OUTSIDE.get(first.name, []):
        for values in ([value], ["0.5", value, "0.25"]):
            result = run("eval", family.name, quantity, *values, *options)
            said = f"{quantity}: {first.name} ({first.meaning}) must lie {first.domain}, got {value}"
            assert_sentence(result, said)
    inside = "0.5,-3" if others else "0.5"
    assert run("eval", family.name, quantity, inside, *options).exit_code == 0


def test_the_value_is_named_with_every_digit(run: Run) -> None:
    result = run("eval", "ggx", "D", "0.3", "1.0000000001", "--alpha", "1")
    assert result.stderr.endswith("must lie in [-1, 1], got 1.0000000001\n")
    assert "cosine of the angle" in result.stderr


def test_domains_are_those_of_the_docstrings() -> None:
    for quantity, about in QUANTITIES.items():
        for argument in about.arguments:
            if interval := re.fullmatch(r"in [\[(](.*), (.*)[\])]", argument.domain):
                assert (argument.lower, argument.upper) == tuple(map(float, interval.groups())), quantity
            else:
                assert (argument.lower, argument.upper) == (-np.inf, np.inf)


def test_a_view_from_nowhere_is_named(run: Run) -> None:
    for view in (
        ["--visible", "nan"],
        ["--visible", "30", "--phi", "nan"],
        ["--visible", "30", "--phi", "inf"],
    ):
        result = run("sample", "ggx", "--alpha", "0.3", *view)
        assert result.exit_code == 2
        assert "finite numbers of degrees" in result.stderr
    result = run("bake", "energy", "ggx", "--alpha", "0.5", "--cos", "0.5,30", "-o", "a.nc")
    assert_sentence(result, "bake: cos_theta must lie in (0, 1], got 0.5 to 30")


# The path of what was written

WRITTEN = {
    "a.csv": "sample ggx --alpha 0.3 -n 3 -o a.csv",
    "a.npy": "sample k0 --alpha 0.3 -n 3 --visible 60 -o a.npy",
    "map.npz": "synthesize ggx --alpha 0.3 --shape 32 32 -o map.npz",
    "table.nc": "bake energy ggx --alpha 0.5 --cos 0.5 -o table.nc",
}


@pytest.mark.parametrize("name", WRITTEN)
def test_the_path_of_what_was_written_is_printed(run: Run, name: str, tmp_path: Path) -> None:
    result = run(*WRITTEN[name].split())
    assert result.exit_code == 0, result.stderr
    assert result.stdout == f"{tmp_path / name}\n"
    assert (tmp_path / name).exists()
    assert json.loads(run(*WRITTEN[name].split(), "--json").stdout)["path"] == str(tmp_path / name)


# Called from Python


def test_main_runs_in_any_thread(capfd: pytest.CaptureFixture[str]) -> None:
    statuses: list[Any] = []

    def call(*arguments: str) -> None:
        try:
            main(list(arguments))
        except SystemExit as end:
            statuses.append(end.code)

    for arguments in (["families"], ["eval", "ggx", "sigma", "0.25", "--alpha", "0.7"], ["eval", "ggx"]):
        thread = threading.Thread(target=call, args=arguments)
        thread.start()
        thread.join()
    assert statuses == [0, 0, 2]
    printed, said = capfd.readouterr()
    assert f"0.25\t{mf.ggx.sigma(0.25, 0.7)}\n" in printed
    assert said.startswith("microfacet: Missing argument")
    assert said.count("\n") == 1
