"""Errors of the command line are one sentence; its help says how to go on."""

from __future__ import annotations

from pathlib import Path

import click
import pytest

from cli_runs import Run, assert_one_sentence
from microfacet import _checks
from microfacet.cli import main


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
