"""Files that lie, break off, or are no height maps: one sentence, little memory, little time."""

from __future__ import annotations

import contextlib
import io
import os
import pickle
import shutil
import struct
import subprocess
import sys
import textwrap
import zipfile
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import microfacet as mf
from hostile_cases import HEIGHTS, archive, check_refused, npy
from limits import HANG
from surface_file_cases import our_own_readers


def npz(**arrays):
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)
    return stream.getvalue()


def npy_header(description, data=b"", version=b"\x01\x00"):
    """A .npy file with any header."""
    text = description.encode("latin1")
    size = struct.pack("<H" if version == b"\x01\x00" else "<I", len(text))
    return b"\x93NUMPY" + version + size + text + data


def claim(shape, dtype="<f8"):
    return npy_header(f"{{'descr': {dtype!r}, 'fortran_order': False, 'shape': {shape!r}}}", b"\0" * 64)


def bomb(name, megabytes):
    """A zip file of one member that does unpack to so many megabytes of zeros, built without packing them."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    block = packer.compress(bytes(2**20)) + packer.flush(zlib.Z_FULL_FLUSH)
    packed = block * megabytes + zlib.compressobj(9, zlib.DEFLATED, -15).flush()
    data = bytearray(archive({name: packed}))
    directory = data.rindex(b"PK\x01\x02")
    for method, size in ((8, 22), (directory + 10, directory + 24)):
        struct.pack_into("<H", data, method, zipfile.ZIP_DEFLATED)
        struct.pack_into("<I", data, size, megabytes * 2**20)
    return bytes(data)


def understated(size):
    """An archive whose directory understates what its member unpacks to."""
    data = bytearray(npz(heights=HEIGHTS, pixel_size=1.0))
    struct.pack_into("<I", data, data.index(b"PK\x01\x02") + 24, size)
    return bytes(data)


class Trap:
    """Unpickling this would run a command."""

    def __reduce__(self):
        return os.system, ("echo trapped > trapped",)


NPY = {
    "empty": (b"", "empty"),
    "wrong magic": (b"GIF89a" + bytes(100), "cannot be read"),
    "magic alone": (b"\x93NUMPY", "cannot be read"),
    "unknown version": (npy_header("{}", version=b"\x09\x00"), "version"),
    "header cut": (npy(HEIGHTS)[:40], "cannot be read"),
    "data cut": (npy(HEIGHTS)[:-8], "only 328 are there"),
    "header is code": (npy_header("__import__('os').getcwd()"), "cannot be read"),
    "header is deep": (npy_header("(" * 9000 + ")" * 9000), "cannot be read"),
    "header claims 4 GB": (
        npy_header("{'descr': '<f8'}", version=b"\x02\x00")[:8] + b"\xff\xff\xff\xff{",
        "cannot be read",
    ),
    "claims 1e12 elements": (claim((10**6, 10**6)), "limit"),
    "claims 1e40 elements": (claim((10**20, 10**20)), "limit"),
    "claims what is not there": (claim((1000, 1000)), "only 64 are there"),
    "negative shape": (claim((-3, -3)), "shape"),
    "shape is no tuple": (claim(9), "cannot be read"),
    "huge items": (claim((3, 3), "V2000000000"), "not numbers"),
    "objects": (npy(np.array([[1, 2], [3, None]], dtype=object), allow_pickle=True), "pickle"),
    "pickle": (pickle.dumps(Trap()), "cannot be read"),
    "array of traps": (npy(np.array([[Trap()] * 3] * 3), allow_pickle=True), "pickle"),
    "one-dimensional": (npy(np.arange(30.0)), "2-D"),
    "three-dimensional": (npy(np.zeros((3, 4, 5))), "2-D"),
    "one line": (npy(np.arange(30.0)[np.newaxis]), "at least 3 x 3"),
    "complex": (npy(HEIGHTS + 1j), "real numbers"),
    "bool": (npy(HEIGHTS > 0), "real numbers"),
    "text": (npy(np.full((4, 4), "high")), "real numbers"),
    "structured": (npy(np.zeros((4, 4), dtype="f8,f8")), "not numbers"),
    "all nan": (npy(np.full((5, 5), np.nan)), "0 valid pixels"),
    "nearly all inf": (npy(np.where(np.arange(25).reshape(5, 5) < 4, 1.0, np.inf)), "4 valid pixels"),
    "constant": (npy(np.full((5, 5), 3.0)), "all heights are equal"),
}
NPZ = {
    "empty": (b"", "empty"),
    "not a zip": (b"hello, world" * 9, "cannot be read"),
    "cut": (npz(heights=HEIGHTS, pixel_size=1.0)[:-30], "cannot be read"),
    "no members": (archive({}), "found: nothing"),
    "no heights": (npz(depth=HEIGHTS, width=HEIGHTS, pixel_size=1.0), "found: depth, pixel_size, width"),
    "no pixel size": (npz(heights=HEIGHTS), "pixel_size"),
    "half a pixel size": (npz(heights=HEIGHTS, dx=1.0), "pixel_size"),
    "zero pixel size": (npz(heights=HEIGHTS, pixel_size=0.0), "pixel_size"),
    "negative pixel size": (npz(heights=HEIGHTS, dx=1.0, dy=-1.0), "pixel_size"),
    "nan pixel size": (npz(heights=HEIGHTS, pixel_size=[1.0, np.nan]), "pixel_size"),
    "text for a pixel size": (npz(heights=HEIGHTS, pixel_size="wide"), "pixel_size"),
    "complex pixel size": (npz(heights=HEIGHTS, pixel_size=1j), "pixel_size"),
    "unknown unit": (npz(heights=HEIGHTS, pixel_size=1.0, unit="furlong"), "'furlong'"),
    "unit is a number": (npz(heights=HEIGHTS, pixel_size=1.0, unit=3), "'3'"),
    "wrong mask": (npz(heights=HEIGHTS, pixel_size=1.0, mask=np.ones((2, 2), bool)), "mask"),
    "all masked": (npz(heights=HEIGHTS, pixel_size=1.0, mask=np.zeros((6, 7), bool)), "0 valid"),
    "objects": (archive({"heights.npy": NPY["array of traps"][0]}), "pickle"),
    "member claims 1e12": (archive({"heights.npy": claim((10**6, 10**6))}), "limit"),
    "member claims 512 MB": (archive({"heights.npy": claim((8192, 8192))}), "only 64 are there"),
    "size understated": (understated(200), "cannot be read"),
    "other compression": (archive({"heights.npy": npy(HEIGHTS)}, zipfile.ZIP_LZMA), "by method 14"),
    "bomb": (bomb("heights.npy", 2000), "unpacks to 1 members of 2097152000 bytes"),
    "many members": (archive({f"{i}.npy": b"" for i in range(10001)}), "10001 members"),
}  # fmt: skip


@pytest.mark.parametrize("case", NPY)
def test_npy(tmp_path, monkeypatch, case):
    content, message = NPY[case]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "map.npy").write_bytes(content)
    check_refused("map.npy", message, pixel_size=1e-6)
    if content.startswith(b"\x93NUMPY"):  # whatever the file is called
        (tmp_path / "map.dat").write_bytes(content)
        check_refused("map.dat", message, pixel_size=1e-6)


@pytest.mark.parametrize("case", NPZ)
def test_npz(tmp_path, monkeypatch, case):
    content, message = NPZ[case]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "map.npz").write_bytes(content)
    check_refused("map.npz", message)


def test_not_a_file(tmp_path):
    check_refused(tmp_path / "nothing.npy", "no such file")
    check_refused(tmp_path, "folder")
    check_refused("map\0.npy", "cannot be read")
    check_refused("x" * 5000, "cannot be read")
    os.mkfifo(tmp_path / "pipe.npy")  # to open it would wait for ever
    check_refused(tmp_path / "pipe.npy", "not a file")
    check_refused("/dev/zero", "not a file")


def test_too_large_a_file_is_not_opened(tmp_path):
    with (tmp_path / "map.npy").open("wb") as file:
        file.truncate(2**30 + 1)  # a hole, no disk space
    check_refused(tmp_path / "map.npy", "the limit is 1073741824")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "give pixel_size"),
        ({"pixel_size": 0}, "pixel_size"),
        ({"pixel_size": 1.0, "channel": 1}, "channel 1"),
        ({"pixel_size": 1.0, "unit": "inch"}, "unit must be one of km, m"),
    ],
)
def test_options_that_do_not_fit(tmp_path, options, message):
    (tmp_path / "map.npy").write_bytes(npy(HEIGHTS))
    check_refused(tmp_path / "map.npy", message, **options)


@settings(max_examples=150)
@given(data=st.data())
@pytest.mark.parametrize("kind", ["npy", "npz", "stored"])
def test_damaged_files_are_read_or_refused(tmp_path, kind, data):
    """Bytes changed, bytes lost: a surface or a `SurfaceError`, and no warning (they are errors here)."""
    arrays = {"heights": HEIGHTS, "pixel_size": 1e-6, "unit": "um"}
    valid = {
        "npy": npy(HEIGHTS),
        "npz": npz(**arrays),
        "stored": archive({f"{name}.npy": npy(array) for name, array in arrays.items()}),
    }[kind]
    content = bytearray(valid)
    place = st.integers(0, len(valid) - 1)
    for position, value in data.draw(st.lists(st.tuples(place, st.integers(0, 255)), max_size=8)):
        content[position] = value
    content = content[: data.draw(st.one_of(st.just(len(valid)), place))]
    file = tmp_path / ("map.npy" if kind == "npy" else "map.npz")
    file.write_bytes(bytes(content))
    with contextlib.suppress(mf.SurfaceError), our_own_readers():
        surface = mf.read_surface(file, pixel_size=1e-6)
        assert np.isfinite(surface.heights[surface.mask]).all()


def test_the_worst_ones_take_little_memory(tmp_path):
    """In a process that may use no more than 1 GiB of address space, the interpreter's own included."""
    worst = {
        "claim.npy": NPY["claims 1e12 elements"][0],
        "header.npy": NPY["header claims 4 GB"][0],
        "bomb.npz": bomb("heights.npy", 2000),
        "bomb_below_the_limit.npz": bomb("heights.npy", 1000),
        "member.npz": NPZ["member claims 512 MB"][0],
        "bomb.x3p": bomb("main.xml", 2000),
        "claim.asc": b"ncols 8192\nnrows 8192\ncellsize 1\n" + b"1 " * 2000,
        "word.asc": b"ncols 5000\nnrows 5000\ncellsize 1\n" + b"1" * 2**26,
        "line.csv": b"1," * 2**25,
    }
    for name, content in worst.items():
        (tmp_path / name).write_bytes(content)
    script = """
        import resource, sys
        resource.setrlimit(resource.RLIMIT_AS, (2**30, 2**30))
        import microfacet as mf
        for file in sys.argv[1:]:
            try:
                mf.read_surface(file, pixel_size=1e-6)
            except mf.SurfaceError as error:
                print(error)
        # not ru_maxrss, which Linux carries over from the process that started this one
        status = open("/proc/self/status").read()
        print(status.split("VmHWM:")[1].split()[0])
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script), *(str(tmp_path / name) for name in worst)],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path), "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=HANG,
        check=True,
    )
    *sentences, peak = done.stdout.splitlines()
    assert done.stderr == ""
    assert len(sentences) == len(worst)
    assert not any("MemoryError" in sentence for sentence in sentences)
    assert int(peak) < 300 * 1024  # KiB


@pytest.mark.parametrize("suffix", ["csv", "asc", "x3p", "npz", "npy"])
@pytest.mark.parametrize(
    "content", [npz(heights=HEIGHTS, other=1.0), b"\xff\xd8\xff\xe0JFIF" * 9, b"1 2 3 4"]
)
def test_mislabelled_files(tmp_path, suffix, content):
    (tmp_path / f"map.{suffix}").write_bytes(content)
    if content.startswith(b"PK"):  # the content decides, not the name
        assert mf.read_surface(tmp_path / f"map.{suffix}", pixel_size=1.0).heights.shape == (6, 7)
    else:
        check_refused(tmp_path / f"map.{suffix}", rf"map\.{suffix}: ", pixel_size=1.0)


def test_other_formats(tmp_path):
    pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    (tmp_path / "map.opd").write_bytes(b"hello, world\n" * 50)
    check_refused(tmp_path / "map.opd", "not a height map in a format")


def test_a_reader_that_hangs_or_dies_is_one_sentence(tmp_path, monkeypatch):
    pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    from microfacet._surface.read import process

    (tmp_path / "map.opd").write_bytes(b"anything")
    monkeypatch.setattr(process, "HANG", 0.05)
    check_refused(tmp_path / "map.opd", "longer than 0.05 seconds$")
    monkeypatch.setattr(process, "HANG", HANG)
    monkeypatch.setattr(process, "_BASE_BYTES", 2**26)  # not enough to start the library
    check_refused(tmp_path / "map.opd", "memory|cannot be read")


def test_a_reader_has_processor_time_however_busy_the_machine_is(tmp_path, monkeypatch):
    from microfacet._surface.read import process

    shutil.copy(process.__file__.replace("process.py", "child.py"), tmp_path)
    (tmp_path / "map.opd").write_bytes(b"anything")
    monkeypatch.setattr(process, "__file__", str(tmp_path / "process.py"))
    monkeypatch.setattr(process, "PROCESSOR_SECONDS", 2)
    reader = "import time\nimport numpy\nclass Unusable(Exception): pass\ndef read(request):\n    "
    (tmp_path / "spins.py").write_text(reader + "while True: pass")
    with pytest.raises(mf.SurfaceError, match=r"longer than 2 seconds of processor time$"):
        process.run("spins", tmp_path / "map.opd", 8)
    (tmp_path / "waits.py").write_text(reader + "time.sleep(3); return {'shape': [2]}, numpy.ones(2)")
    _, heights = process.run("waits", tmp_path / "map.opd", 8)
    assert heights.tolist() == [1.0, 1.0]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["child.py", "map.opd", "spins.py", "waits.py"]


def test_heights_whose_squares_overflow_are_one_sentence(tmp_path):
    signs = np.random.default_rng(0).choice([-1.0, 1.0], size=(20, 20))
    np.save(tmp_path / "huge.npy", 1e308 * signs)
    check_refused(tmp_path / "huge.npy", r"heights must lie in \[-1e30, 1e30\] metres", pixel_size=1e-6)
