"""What files and arguments say, quoted by our messages: escaped, cut, and one line."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from rich.console import Console

import microfacet as mf
from hostile_cases import INDEX, archive, npy
from microfacet._text import listed, printable
from microfacet.cli import main, printing

CLEAR = "\x1b[2J\x1b]0;mine\x07"  # clears a terminal and names its window
TURNED = "\u202egnp.exe"
ODD = [CLEAR, TURNED, "a\r\nb", "\x00", "\x9b31m", "\u2028", "\ud800", "x" * 10_000, "\n" * 999, "[/bold]"]
each_odd = pytest.mark.parametrize("text", ODD, ids=lambda text: f"{text[:9]!a}")


def plain(text: str, most: int = 500) -> None:
    assert len(text) <= most
    assert all(character.isprintable() for character in text), ascii(text)


@each_odd
def test_printable(text: str) -> None:
    plain(printable(text), 60)
    plain(printable("a" * 50 + text), 60)
    plain(listed([text] * 20), 250)
    assert printable("µm, 5°") == "µm, 5°"
    assert printable(text, 10) == printable(text)[:10] or printable(text, 10).endswith("...")


def refused(file: Path, read: Callable[[Path], object]) -> str:
    with pytest.raises(mf.SurfaceError) as caught:
        read(file)
    return str(caught.value).replace(str(file), "")


@each_odd
def test_names_of_arrays(text: str, tmp_path: Path) -> None:
    name = text.replace("\ud800", "?").replace("\x00", "?")
    heights = npy(np.zeros((4, 4)))
    (tmp_path / "map.npz").write_bytes(archive({f"{name}{k}.npy": heights for k in range(30)}))
    plain(refused(tmp_path / "map.npz", mf.read_surface))
    with pytest.raises(mf.SurfaceError) as caught:
        mf.read_surface(tmp_path / "map.npz", channel=text)
    plain(str(caught.value).replace(str(tmp_path), ""))


@each_odd
def test_types_of_arrays(text: str, tmp_path: Path) -> None:
    """The fields of a structure have names."""
    kind = np.dtype([(f"{text[:500]}{k}", "f8") for k in range(20)])
    (tmp_path / "map.npy").write_bytes(npy(np.zeros((4, 4), kind)))
    plain(refused(tmp_path / "map.npy", lambda file: mf.read_surface(file, pixel_size=1.0)))


@each_odd
def test_columns(text: str, tmp_path: Path) -> None:
    arrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    name = text.replace("\ud800", "?")
    columns = {f"{name}{k}": [1.0, 2.0] for k in range(9)}
    parquet.write_table(arrow.table(columns), tmp_path / "slopes.parquet")
    plain(refused(tmp_path / "slopes.parquet", mf.read_slopes))


@pytest.mark.parametrize(
    "text", [TURNED, "\x9b31m", "\u2028", "x" * 10_000, "[/bold]"], ids=lambda text: f"{text[:9]!a}"
)
def test_members_and_types_of_x3p(text: str, tmp_path: Path) -> None:
    for old in ("bindata/data.bin", "<DataType>D<", ">1e-6<", "SizeX>7"):
        new = {
            "<DataType>D<": f"<DataType>{text.replace('[', '')}<",
            ">1e-6<": f">{text}<",
            "SizeX>7": f"SizeX>{text}",
        }
        (tmp_path / "map.x3p").write_bytes(archive({"main.xml": INDEX.replace(old, new.get(old, text))}))
        plain(refused(tmp_path / "map.x3p", mf.read_surface))


@pytest.mark.skipif(os.name == "nt", reason="names of POSIX")
@pytest.mark.parametrize(
    "name", [CLEAR, TURNED, "a\r\nb", "[/bold]", "[red]x", "t\tab", "<script>alert(1)</script>"]
)
def test_names_of_files(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On the terminal, in tables for programs, in JSON and in pages."""
    monkeypatch.chdir(tmp_path)
    name = name.replace("/", "∕") + ".npy"
    np.save(name, np.random.default_rng(0).normal(size=(300, 2)))
    Path("other.npy").write_bytes(b"x")
    fit = ["fit", name, "--slopes", "table", "--family", "ggx", "--family", "beckmann"]
    result = CliRunner().invoke(main, fit)
    assert result.exit_code == 0
    plain(result.stderr.replace("\n", " "), 1000)
    result = CliRunner().invoke(main, [*fit, "other.npy", "--dask", "none"])
    assert result.exit_code == 2
    lines = result.stdout.splitlines()
    assert len(lines) == 3
    assert {line.count("\t") for line in lines} == {9}
    plain(result.stdout.replace("\n", " ").replace("\t", " "), 2000)
    plain(result.stderr.replace("\n", " "), 2000)
    result = CliRunner().invoke(main, [*fit, "--json"])
    assert json.loads(result.stdout)["source"] == printable(name, 255)
    result = CliRunner().invoke(main, [*fit, "--report", "page.html"])
    assert result.exit_code == 0
    page = Path("page.html").read_text(encoding="utf-8")
    plain(page.replace("\n", " ").replace("\u202f", " "), 10**7)  # our own narrow spaces, in numbers
    assert "<script>alert" not in page


def test_cells_are_no_markup() -> None:
    stream = io.StringIO()
    out = Console(file=stream, force_terminal=True, width=200, color_system=None)
    printing.show(out, ["file", "n"], [["scan[red].npy", "[/bold]"], [CLEAR, "1"]], left=1)
    assert "scan[red].npy" in stream.getvalue()
    assert "[/bold]" in stream.getvalue()
    assert "\x1b[2J" not in stream.getvalue()


def test_progress_is_no_markup() -> None:
    """A file of such a name, seen by whoever watches the fit on a terminal."""
    code = """
import sys
sys.stderr.isatty = lambda: True
from microfacet.cli.printing import progress_line
with progress_line() as progress:
    progress("[/bold].npy \\x1b[2J", 1, 2)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "\x1b[2J" not in done.stderr


@each_odd
@pytest.mark.parametrize(
    "arguments",
    [
        ["eval", "?", "D", "0.5"],
        ["eval", "ggx", "?", "0.5"],
        ["eval", "ggx", "D", "?", "--alpha", "0.3"],
        ["sample", "ggx", "--alpha", "?"],
        ["sample", "ggx", "--alpha", "0.3", "-o", "?"],
        ["fit", "?"],
        ["fit", "none.npy", "--unit", "?"],
        ["fit", "none.npy", "--channel", "?"],
        ["synthesize", "ggx", "--alpha", "0.3", "-o", "?"],
        ["bake", "?", "ggx", "--alpha", "0.3", "-o", "t.nc"],
        ["bake", "energy", "ggx", "--alpha", "?", "-o", "t.nc"],
        ["bake", "energy", "ggx", "--alpha", "0.3", "-o", "?"],
        ["verify", "--id", "?"],
        ["render", "ggx", "--alpha", "0.3", "-o", "?"],
        ["report", "--family", "?", "--output", "page.html"],
        ["?"],
    ],
    ids=lambda arguments: " ".join(arguments),
)
def test_arguments(arguments: list[str], text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, [argument.replace("?", text) for argument in arguments])
    assert result.exit_code == 2
    assert result.stderr.endswith("\n")
    plain(result.stderr[:-1], 1100)


# What `render --fit` reads


DEEP = 200_000
FITS = {
    "deep": "[" * DEEP + "]" * DEEP,
    "deep objects": '{"ranking":' * DEEP,
    "deep inside": '{"ranking": ' + "[" * DEEP + "]" * DEEP + "}",
    "huge": '{"ranking": []' + " " * 2**24 + "}",
    "long number": '{"ranking": [{"family": "ggx", "params": {"alpha": ' + "9" * 9000 + "}}]}",
    "large number": '{"ranking": [{"family": "ggx", "params": {"alpha": ' + "9" * 999 + "}}]}",
    "infinite": '{"ranking": [{"family": "ggx", "params": {"alpha": Infinity}}]}',
    "no object": "3",
    "no ranking": '{"rank": []}',
    "empty ranking": '{"ranking": []}',
    "ranking of numbers": '{"ranking": [1]}',
    "no family": '{"ranking": [{}]}',
    "unknown family": json.dumps({"ranking": [{"family": CLEAR * 99, "params": {"alpha": 0.3}}]}),
    "unknown parameter": json.dumps({"ranking": [{"family": "ggx", "params": {CLEAR * 99: 0.3}}]}),
    "text for a number": json.dumps({"ranking": [{"family": "ggx", "params": {"alpha": CLEAR * 99}}]}),
    "no parameters": '{"ranking": [{"family": "ggx", "params": {}}]}',
    "list of parameters": '{"ranking": [{"family": "ggx", "params": [0.3]}]}',
    "no JSON": "family,alpha\n",
    "bytes": "\udcff\udcfe",
    "zeros": "\x00" * 100,
}


@pytest.mark.parametrize("case", FITS)
def test_any_fit(case: str, tmp_path: Path) -> None:
    (tmp_path / "fit.json").write_text(FITS[case], encoding="utf-8", errors="surrogateescape")
    result = CliRunner().invoke(main, ["render", "--fit", str(tmp_path / "fit.json")])
    assert result.exit_code == 2, result.output
    plain(result.stderr[:-1], 1100)
    result = CliRunner().invoke(main, ["render", "--fit", str(tmp_path / "fit.json"), "--family", CLEAR])
    assert result.exit_code == 2, result.output
    plain(result.stderr[:-1], 1100)
