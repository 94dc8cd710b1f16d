"""What stands where a file is written: a file is replaced by a whole one, and nothing else is replaced."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

from limits import HANG
from microfacet._files import replacing
from microfacet._report import families, surfaces
from microfacet.cli import main

pytestmark = pytest.mark.skipif(os.name == "nt", reason="modes, pipes and devices of POSIX")

WRITERS = {
    "report": (["report", "--quick", "--family", "beckmann", "--output"], "page.html", b"<!DOCTYPE html>"),
    "fit": (["fit", "slopes.npy", "--slopes", "table", "--report"], "fit.html", b"<!DOCTYPE html>"),
    "sample npy": (["sample", "k0", "--alpha", "0.2", "-o"], "normals.npy", b"\x93NUMPY"),
    "sample csv": (["sample", "k0", "--alpha", "0.2", "-o"], "normals.csv", b"x,y,z\n"),
    "sample parquet": (["sample", "k0", "--alpha", "0.2", "-o"], "normals.parquet", b"PAR1"),
    "synthesize": (["synthesize", "ggx", "--alpha", "0.2", "--shape", "16", "16", "-o"], "map.npz", b"PK"),
    "bake": (["bake", "energy", "ggx", "--alpha", "0.4", "--cos", "0.5", "-o"], "table.nc", b"\x89HDF"),
}
each_writer = pytest.mark.parametrize("writer", WRITERS)


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder of our own; pages, which take seconds, are set without their content."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(families.content, "collect", lambda *_: SimpleNamespace(passed=0, total=0))
    monkeypatch.setattr(families, "set_page", lambda *_: "<!DOCTYPE html>")
    monkeypatch.setattr(surfaces, "collect", lambda *_: None)
    monkeypatch.setattr(surfaces, "set_page", lambda *_, **__: "<!DOCTYPE html>")
    np.save("slopes.npy", np.random.default_rng(3).normal(size=(400, 2)))


def write(writer: str, path: str) -> None:
    needs = {"sample parquet": "pyarrow", "bake": "h5netcdf"}.get(writer)
    if needs is not None:
        pytest.importorskip(needs)
    result = CliRunner().invoke(main, [*WRITERS[writer][0], path])
    assert result.exit_code == 0, result.output


def begins_well(writer: str, content: bytes) -> bool:
    return content.startswith(WRITERS[writer][2])


def leftovers() -> set[str]:
    return {path.name for path in Path().iterdir() if path.name.startswith(".")}


@each_writer
def test_links_and_modes_stay(writer: str) -> None:
    name = WRITERS[writer][1]
    Path("elsewhere").mkdir()
    real = Path("elsewhere", f"real{Path(name).suffix}")
    real.write_text("before")
    real.chmod(0o604)
    Path(name).symlink_to(real)
    write(writer, name)
    assert Path(name).is_symlink()
    assert stat.S_IMODE(real.stat().st_mode) == 0o604
    assert begins_well(writer, real.read_bytes())
    assert not leftovers()


@each_writer
def test_a_link_to_what_is_not_there_yet(writer: str) -> None:
    name = WRITERS[writer][1]
    real = Path(f"other{Path(name).suffix}")
    Path(name).symlink_to(real)
    write(writer, name)
    assert Path(name).is_symlink()
    assert begins_well(writer, real.read_bytes())


@each_writer
def test_a_pipe_is_written_through(writer: str) -> None:
    """Here at the end of a link."""
    name = WRITERS[writer][1]
    os.mkfifo("pipe")
    Path(name).symlink_to("pipe")
    got: list[bytes] = []
    reader = threading.Thread(target=lambda: got.append(Path(name).read_bytes()))
    reader.start()
    write(writer, name)
    reader.join(60)
    assert stat.S_ISFIFO(os.stat(name).st_mode)
    assert Path(name).is_symlink()
    assert begins_well(writer, got[0])
    assert not leftovers()


@each_writer
def test_a_device_stays_one(writer: str) -> None:
    name = WRITERS[writer][1]
    try:
        os.mknod(name, stat.S_IFCHR | 0o666, os.makedev(1, 3))  # a null of our own
        os.close(os.open(name, os.O_WRONLY))
    except OSError:
        pytest.skip("no devices can be made here")
    write(writer, name)
    assert stat.S_ISCHR(os.stat(name).st_mode)
    assert os.stat(name).st_rdev == os.makedev(1, 3)


@each_writer
def test_a_folder_is_refused(writer: str) -> None:
    name = WRITERS[writer][1]
    Path(name).mkdir()
    result = CliRunner().invoke(main, [*WRITERS[writer][0], name])
    assert result.exit_code == 2
    assert result.stderr.strip().count("\n") == 0
    assert "director" in result.stderr or "folder" in result.stderr
    assert not list(Path(name).iterdir())


@pytest.mark.parametrize("suffix", [".png", ".exr"])
def test_pictures(suffix: str) -> None:
    mi = pytest.importorskip("mitsuba")
    from microfacet._render import picture

    mi.set_variant("scalar_rgb")
    os.mkfifo(f"pipe{suffix}")
    got: list[bytes] = []
    reader = threading.Thread(target=lambda: got.append(Path(f"pipe{suffix}").read_bytes()))
    reader.start()
    picture.save(f"pipe{suffix}", np.full((4, 4, 3), 0.5, np.float32), {})
    reader.join(60)
    assert got[0].startswith((b"\x89PNG", b"v/1\x01"))


# Standard output and other open files


@pytest.mark.parametrize("how", ["wb", "ab"])
@pytest.mark.parametrize("path", ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"])
def test_standard_output(path: str, how: str) -> None:
    """Through a link, whose name has a suffix; to the end of what the shell has opened to append to."""
    if not os.path.exists(path):
        pytest.skip(f"no {path}")
    Path("link.csv").symlink_to(path)
    Path("normals.csv").write_text("before\n")
    options = ["--alpha", "0.3", "-n", "3", "-o", "link.csv", "--json"]
    with open("normals.csv", how) as stream:
        done = subprocess.run(
            [sys.executable, "-m", "microfacet.cli", "sample", "ggx", *options],
            stdout=stream,
            stderr=subprocess.PIPE,
            check=True,
            timeout=HANG,
        )
    first, *lines = Path("normals.csv").read_text().splitlines()
    summary = done.stderr
    assert first == ("x,y,z" if how == "wb" else "before")
    assert len(lines) == (3 if how == "wb" else 4)
    assert summary.startswith(b"{")


def test_a_page_to_standard_output() -> None:
    arguments = [sys.executable, "-m", "microfacet.cli", *WRITERS["report"][0], "/dev/stdout"]
    content = subprocess.run(arguments, stdout=subprocess.PIPE, check=True).stdout
    assert begins_well("report", content)


def test_an_open_file_of_any_number() -> None:
    with open("log", "wb+") as log:
        log.write(b"before\n")
        log.flush()
        with replacing(f"/dev/fd/{log.fileno()}") as stream:
            stream.write(b"after\n")
    assert Path("log").read_bytes() == b"before\nafter\n"


def test_a_pipe_without_a_reader_is_quiet() -> None:
    os.mkfifo("pipe.csv")
    reading = os.open("pipe.csv", os.O_RDONLY | os.O_NONBLOCK)
    options = ["--alpha", "0.3", "-n", "100000", "-o", "pipe.csv"]
    process = subprocess.Popen(
        [sys.executable, "-m", "microfacet.cli", "sample", "ggx", *options], stderr=subprocess.PIPE
    )
    while True:
        try:
            if os.read(reading, 10):
                break
        except BlockingIOError:
            pass
    os.close(reading)
    assert process.communicate()[1] == b""
    assert process.returncode == 141


def test_a_disk_that_fills_up() -> None:
    """The sentence names the file, and nothing is left."""
    code = """
import resource, signal
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
from microfacet.cli import main
main()
"""
    for name in ("normals.csv", "normals.npy"):
        Path(name).write_text("before")
        options = ["--alpha", "0.3", "-n", "30000", "-o", name]
        command = [sys.executable, "-c", code, "sample", "ggx", *options]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 2
        assert done.stderr == f"microfacet: {os.path.realpath(name)}: File too large\n"
        assert Path(name).read_text() == "before"
    assert not leftovers()


# The one place


def test_the_umask_holds_and_is_never_touched() -> None:
    """Other threads create files meanwhile."""
    before = os.umask(0o027)
    try:
        seen: list[int] = []

        def look() -> None:
            for _ in range(200):
                with replacing("new") as stream:
                    stream.write(b"x")
                Path("new").unlink()

        writer = threading.Thread(target=look)
        writer.start()
        number = 0
        while writer.is_alive():
            number += 1
            handle = os.open(f"made{number}", os.O_CREAT | os.O_WRONLY, 0o666)
            seen.append(stat.S_IMODE(os.fstat(handle).st_mode))
            os.close(handle)
            os.unlink(f"made{number}")
        assert set(seen) == {0o640}
        with replacing("new") as stream:
            stream.write(b"x")
        assert stat.S_IMODE(os.stat("new").st_mode) == 0o640
    finally:
        os.umask(before)


def test_an_owner_stays() -> None:
    if os.geteuid() != 0:
        pytest.skip("only root gives files away")
    Path("hers").write_text("before")
    os.chown("hers", 12345, 12346)
    os.chmod("hers", 0o2660)
    with replacing("hers") as stream:
        stream.write(b"after")
    status = os.stat("hers")
    assert (status.st_uid, status.st_gid, stat.S_IMODE(status.st_mode)) == (12345, 12346, 0o2660)


def test_a_file_that_may_not_be_written_stays() -> None:
    with tempfile.TemporaryDirectory() as folder:  # where another user may come
        os.chmod(folder, 0o777)
        kept = Path(folder, "kept")
        kept.write_text("before")
        kept.chmod(0o444)
        before = os.geteuid()
        if before == 0:
            os.seteuid(65534)
        try:
            with pytest.raises(PermissionError, match="kept"), replacing(kept) as stream:
                stream.write(b"after")
        finally:
            os.seteuid(before)
        assert kept.read_text() == "before"
        assert os.listdir(folder) == ["kept"]


@pytest.mark.parametrize("name", ["x" * 255, "ö" * 127, "file\n", "-o", ".hidden"])
def test_names_of_any_length(name: str) -> None:
    with replacing(name) as stream:
        stream.write(b"x")
    assert Path(name).read_bytes() == b"x"
    assert len(list(Path().iterdir())) == 2


def test_what_fails_leaves_the_old_one() -> None:
    Path("kept").write_text("before")
    with pytest.raises(TypeError), replacing("kept") as stream:
        stream.write("text")  # type: ignore[arg-type]
    assert Path("kept").read_text() == "before"
    assert not leftovers()


@pytest.mark.parametrize("path", ["no/file", "loop", "slopes.npy/file", "."])
def test_where_no_file_can_be(path: str) -> None:
    Path("loop").symlink_to("loop")
    with pytest.raises(OSError, match=r".") as caught, replacing(path) as stream:
        stream.write(b"x")
    assert ".part" not in str(caught.value)
    assert not leftovers()


@pytest.mark.parametrize(
    ("command", "begins"),
    [
        (["sample", "k0", "--alpha", "0.2", "-n", "3", "-o"], b"x,y,z\n"),
        (["synthesize", "ggx", "--alpha", "0.2", "--shape", "16", "16", "-o"], b"PK"),
        (["report", "--quick", "--family", "k0", "--output"], b"<!DOCTYPE html>"),
    ],
)
@pytest.mark.parametrize("output", ["/dev/stdout", "link"])
def test_standard_output_gets_the_content_alone(command: list[str], begins: bytes, output: str) -> None:
    """Without an ending in its name; what is said of the file goes to stderr."""
    os.symlink("/dev/stdout", "link")
    done = subprocess.run(
        [sys.executable, "-m", "microfacet", *command, output], capture_output=True, check=True, timeout=HANG
    )
    assert done.stdout.startswith(begins)
    assert output.encode() not in done.stdout
    assert done.stderr.decode().endswith(f"{os.path.abspath(output)}\n")
