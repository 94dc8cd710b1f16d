"""What stands where a bake writes: only a table of ours is replaced, and by one bake at a time."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import microfacet as mf
from microfacet._bake import run as running
from microfacet.cli import main

xarray = pytest.importorskip("xarray")
zarr = pytest.importorskip("zarr")
pytest.importorskip("h5netcdf")

SMALL: dict[str, Any] = {"alpha": [0.4, 0.7], "cos_theta": [0.6]}
ARGUMENTS = ["bake", "energy", "ggx", "--alpha", "0.4,0.7", "--cos", "0.6"]


def bake(output: Path) -> Any:
    return CliRunner().invoke(main, [*ARGUMENTS, "-o", str(output)])


def everything(folder: Path) -> dict[str, Any]:
    """What lies in a folder, and of files the content."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        if path.is_file()
        else stat.S_IFMT(path.lstat().st_mode)
        for path in sorted(folder.rglob("*"))
    }


def refused(output: Path, word: str) -> None:
    before = everything(output.parent)
    result = bake(output)
    assert result.exit_code == 2, result.output
    assert word in result.stderr
    assert result.stderr.count("\n") == 1
    assert everything(output.parent) == before


def folder_of_notes(path: Path) -> None:
    path.mkdir()
    (path / "notes.txt").write_text("x")


def empty_folder(path: Path) -> None:
    path.mkdir()


def store_of_others(path: Path) -> None:
    xarray.Dataset({"missing": ("alpha", [1.0, 2.0])}).to_zarr(path, zarr_format=2)


def bare_group(path: Path) -> None:
    zarr.open_group(path, mode="w", zarr_format=2)


def a_file(path: Path) -> None:
    path.write_text("x")


def with_notes(path: Path) -> None:
    mf.bake("energy", "ggx", **SMALL, output=path)
    (path / "notes.txt").write_text("x")


def with_notes_in_an_array(path: Path) -> None:
    mf.bake("energy", "ggx", **SMALL, output=path)
    (path / "missing" / "README").write_text("x")


def with_a_folder(path: Path) -> None:
    mf.bake("energy", "ggx", **SMALL, output=path)
    (path / "plots").mkdir()


def with_a_link(path: Path) -> None:
    mf.bake("energy", "ggx", **SMALL, output=path)
    (path / "missing_average").rename(path.parent / "elsewhere")
    (path / "missing_average").symlink_to(path.parent / "elsewhere")


def with_another_array(path: Path) -> None:
    mf.bake("energy", "ggx", **SMALL, output=path)
    xarray.Dataset({"mine": ("alpha", [1.0, 2.0])}).to_zarr(path, mode="a", zarr_format=2)


def with_another_attribute(path: Path) -> None:
    mf.bake("energy", "ggx", **SMALL, output=path)
    group = zarr.open_group(path, mode="r+", zarr_format=2, use_consolidated=False)
    group.attrs["measured by"] = "me"
    zarr.consolidate_metadata(group.store, zarr_format=2)


def with_deep_metadata(path: Path) -> None:
    mf.bake("energy", "ggx", **SMALL, output=path)
    (path / ".zmetadata").write_text('{"metadata":' * 100_000)


STANDING = [
    folder_of_notes,
    empty_folder,
    store_of_others,
    bare_group,
    a_file,
    with_notes,
    with_notes_in_an_array,
    with_a_folder,
    with_a_link,
    with_another_array,
    with_another_attribute,
    with_deep_metadata,
]


@pytest.mark.parametrize("standing", STANDING, ids=lambda standing: standing.__name__)
def test_a_store_replaces_none_but_ours(standing: Callable[[Path], None], tmp_path: Path) -> None:
    standing(tmp_path / "data.zarr")
    refused(tmp_path / "data.zarr", "move it away, or choose another output")


@pytest.mark.parametrize("standing", [folder_of_notes, empty_folder, store_of_others])
def test_a_file_replaces_no_folder(standing: Callable[[Path], None], tmp_path: Path) -> None:
    standing(tmp_path / "data.nc")
    refused(tmp_path / "data.nc", "is a folder")


def test_what_comes_while_it_computes_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    output = tmp_path / "data.zarr"
    whole = running._write

    def slow(*arguments: Any) -> None:
        folder_of_notes(output)
        whole(*arguments)

    monkeypatch.setattr(running, "_write", slow)
    result = bake(output)
    assert result.exit_code == 2
    assert (output / "notes.txt").read_text() == "x"
    monkeypatch.undo()
    (output / "notes.txt").unlink()
    output.rmdir()
    assert bake(output).exit_code == 0  # from the cells that were kept
    assert [path.name for path in tmp_path.iterdir()] == ["data.zarr"]


def test_an_older_store_keeps_its_mode_and_its_link(tmp_path: Path) -> None:
    (tmp_path / "disk").mkdir()
    (tmp_path / "data.zarr").symlink_to(tmp_path / "disk" / "real.zarr")
    assert bake(tmp_path / "data.zarr").exit_code == 0
    (tmp_path / "disk" / "real.zarr").chmod(0o750)
    assert bake(tmp_path / "data.zarr").exit_code == 0
    assert (tmp_path / "data.zarr").is_symlink()
    assert stat.S_IMODE((tmp_path / "disk" / "real.zarr").stat().st_mode) == 0o750


# The folder of cells


@pytest.mark.parametrize("suffix", [".nc", ".zarr"])
def test_the_folder_of_cells_may_be_taken(suffix: str, tmp_path: Path) -> None:
    output = tmp_path / f"t{suffix}"
    folder = tmp_path / f".{output.name}.bake"
    folder_of_notes(folder)
    refused(output, "holds 'notes.txt'")
    (folder / "notes.txt").unlink()
    (folder / "000000.npz").symlink_to("/etc/passwd")
    refused(output, "holds '000000.npz'")
    (folder / "000000.npz").unlink()
    folder.rmdir()
    folder.symlink_to(tmp_path)
    refused(output, "is no folder")
    folder.unlink()
    folder.write_text("x")
    refused(output, "is no folder")


def test_what_comes_into_the_folder_of_cells_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = running._write

    def watched(*arguments: Any) -> None:
        (tmp_path / ".t.nc.bake" / "notes.txt").write_text("x")
        whole(*arguments)

    monkeypatch.setattr(running, "_write", watched)
    assert bake(tmp_path / "t.nc").exit_code == 0
    assert everything(tmp_path / ".t.nc.bake") == {"notes.txt": b"x"}


@pytest.mark.parametrize(
    "text",
    ["[" * 200_000, '{"recipe":' * 200_000, "9" * 10_000, "[]", "{}", '"', "\x00", "[" + " " * 2**23 + "]"],
    ids=["deep", "deep objects", "digits", "list", "object", "cut", "zero", "huge"],
)
def test_the_recipe_of_anybody(text: str, tmp_path: Path) -> None:
    folder = tmp_path / ".t.nc.bake"
    folder.mkdir()
    (folder / "recipe.json").write_text(text)
    result = bake(tmp_path / "t.nc")
    assert result.exit_code == 2
    assert "holds a bake of something else" in result.stderr
    assert result.stderr.count("\n") == 1


def test_cells_of_another_shape_are_computed_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import numpy as np

    monkeypatch.setattr(running, "_write", lambda *_: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        mf.bake("energy", "ggx", **SMALL, output=tmp_path / "t.nc")
    monkeypatch.undo()
    np.savez(tmp_path / ".t.nc.bake" / "000000.npz", missing=np.zeros(7), missing_average=np.zeros(()))
    table = mf.bake("energy", "ggx", **SMALL, output=tmp_path / "t.nc")
    assert table.equals(mf.bake("energy", "ggx", **SMALL))


# Several at once


@pytest.mark.skipif(os.name == "nt", reason="locks of POSIX")
@pytest.mark.parametrize("suffix", [".nc", ".zarr"])
def test_a_second_bake_gets_a_sentence(suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    output = tmp_path / f"t{suffix}"
    begun, may_end = threading.Event(), threading.Event()
    whole = running._write

    def slow(*arguments: Any) -> None:
        begun.set()
        may_end.wait(60)
        whole(*arguments)

    monkeypatch.setattr(running, "_write", slow)
    first = threading.Thread(target=mf.bake, args=("energy", "ggx"), kwargs={**SMALL, "output": output})
    first.start()
    assert begun.wait(60)
    done = subprocess.run(
        [sys.executable, "-m", "microfacet.cli", *ARGUMENTS, "-o", str(output)],
        capture_output=True,
        text=True,
    )
    may_end.set()
    first.join()
    assert done.returncode == 2
    assert "another bake is at work" in done.stderr
    assert done.stderr.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == [output.name]
    monkeypatch.undo()
    assert bake(output).exit_code == 0


@pytest.mark.skipif(os.name == "nt", reason="locks of POSIX")
def test_many_at_once_make_one_table(tmp_path: Path) -> None:
    """Whoever is refused is told so; what is there at the end is whole."""
    arguments = [*ARGUMENTS, "-o", str(tmp_path / "t.zarr")]
    imports = "import microfacet._bake, xarray, zarr; from microfacet.cli import main"
    code = f"{imports}; input(); main({arguments})"
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", code], stdin=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        for _ in range(4)
    ]
    time.sleep(0.5)
    for process in processes:
        assert process.stdin is not None
        process.stdin.write("\n")
        process.stdin.flush()
    ends = [(process.communicate()[1], process.returncode) for process in processes]
    assert all(
        (status, said) == (0, "") or (status == 2 and "another bake" in said) for said, status in ends
    ), ends
    assert any(status == 0 for _, status in ends)
    assert [path.name for path in tmp_path.iterdir()] == ["t.zarr"]
    assert xarray.open_zarr(tmp_path / "t.zarr").load().equals(mf.bake("energy", "ggx", **SMALL))


def test_a_table_goes_through_a_pipe(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "t.nc")
    got: list[bytes] = []
    reader = threading.Thread(target=lambda: got.append((tmp_path / "t.nc").read_bytes()))
    reader.start()
    assert bake(tmp_path / "t.nc").exit_code == 0
    reader.join(60)
    assert stat.S_ISFIFO((tmp_path / "t.nc").stat().st_mode)
    (tmp_path / "got.nc").write_bytes(got[0])
    table = xarray.load_dataset(tmp_path / "got.nc", engine="h5netcdf")
    assert table.equals(mf.bake("energy", "ggx", **SMALL))
