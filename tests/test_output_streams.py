"""Standard output that is full, slow, or without a reader: what is printed is whole, or the status is 2."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(os.name == "nt", reason="pipes and devices of POSIX")

MAIN = [sys.executable, "-c", "from microfacet.cli import main; main()"]
PRINTING = {
    "sample": ["sample", "ggx", "--alpha", "0.3", "-n", "20000"],
    "eval": ["eval", "k0", "sigma", *(f"{k / 997}" for k in range(997)), "--alpha", "0.4"],
    "eval --json": ["eval", "k0", "sigma", "0.25", "--alpha", "0.4", "--json"],
    "verify --json": ["verify", "--family", "ggx", "--json"],
    "verify": ["verify", "--family", "ggx"],
    "families": ["families"],
    "help": ["--help"],
    "help of a command": ["bake", "--help"],
    "version": ["--version"],
}
UNBUFFERED = {"buffered": {"PYTHONUNBUFFERED": ""}, "unbuffered": {"PYTHONUNBUFFERED": "1"}}
# Each once, and those that print in ways of their own unbuffered too.
CASES = [(command, "buffered") for command in PRINTING]
CASES += [(command, "unbuffered") for command in ("sample", "eval", "verify", "help")]


def environment(how: str) -> dict[str, str]:
    return os.environ | UNBUFFERED[how]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
@pytest.mark.parametrize(("command", "how"), CASES)
def test_a_full_disk_is_one_sentence(command: str, how: str) -> None:
    with open("/dev/full", "wb") as full:
        done = subprocess.run(
            [*MAIN, *PRINTING[command]], stdout=full, stderr=subprocess.PIPE, text=True, env=environment(how)
        )
    assert done.returncode == 2
    assert done.stderr == "microfacet: standard output: No space left on device\n"


@pytest.mark.parametrize("how", UNBUFFERED)
@pytest.mark.parametrize("command", ["sample", "eval", "verify --json"])
def test_a_pipe_that_does_not_wait_gets_all(command: str, how: str) -> None:
    """Its reader takes a little at a time."""
    expected = subprocess.run([*MAIN, *PRINTING[command]], capture_output=True).stdout
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    process = subprocess.Popen(
        [*MAIN, *PRINTING[command]], stdout=writing, stderr=subprocess.PIPE, env=environment(how)
    )
    os.close(writing)
    got = b""
    while part := os.read(reading, 50_000):
        got += part
        time.sleep(0.002)
    os.close(reading)
    assert process.communicate()[1] == b""
    assert process.returncode == 0
    if command == "verify --json":  # times differ
        assert got.count(b"\n") == expected.count(b"\n")
        assert got.endswith(b"}\n")
    else:
        assert got == expected


@pytest.mark.parametrize("how", UNBUFFERED)
def test_a_disk_that_fills_up(how: str, tmp_path: Path) -> None:
    """A limit on the size of files takes part of a write before it refuses the rest."""
    limit = "import resource, signal; signal.signal(signal.SIGXFSZ, signal.SIG_IGN);"
    limit += "resource.setrlimit(resource.RLIMIT_FSIZE, (100_001, 100_001));"
    with (tmp_path / "normals.csv").open("wb") as stream:
        done = subprocess.run(
            [sys.executable, "-c", f"{limit} {MAIN[-1]}", *PRINTING["sample"]],
            stdout=stream,
            stderr=subprocess.PIPE,
            text=True,
            env=environment(how),
        )
    assert (done.returncode, done.stderr) == (2, "microfacet: standard output: File too large\n")


@pytest.mark.parametrize(("command", "how"), CASES)
def test_a_reader_that_leaves_is_no_error(command: str, how: str) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [*MAIN, *PRINTING[command]], stdout=writing, stderr=subprocess.PIPE, env=environment(how)
    )
    os.close(writing)
    assert (done.returncode, done.stderr) == (141, b"")


def test_nobody_hears_the_sentence() -> None:
    for arguments, status in ((["sample", "phong"], 2), (["families"], 0)):
        with open("/dev/full", "wb") as full:
            done = subprocess.run([*MAIN, *arguments], stdout=subprocess.DEVNULL, stderr=full)
        assert done.returncode == status


def test_a_caller_keeps_its_streams() -> None:
    code = """
        import sys
        from microfacet.cli import main
        before = sys.stdout, sys.stderr
        try:
            main(["families", "--json"])
        except SystemExit as end:
            assert end.code == 0
        assert (sys.stdout, sys.stderr) == before
        print("still here")
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith("[")
    assert done.stdout.endswith("]\nstill here\n")
    assert done.stderr == ""
