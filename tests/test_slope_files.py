"""Slopes read from tables and normal maps."""

from __future__ import annotations

import sys

import numpy as np
import pytest

import microfacet as mf
from surface_file_cases import LEVELS, png, refused, write_image

# Slopes


def slope_file(folder, kind, slopes):
    file = folder / f"slopes.{kind}"
    if kind == "npy":
        np.save(file, slopes)
    elif kind == "npz":
        np.savez(file, slopes=slopes)
    elif kind == "parquet":
        arrow = pytest.importorskip("pyarrow", reason="the extra 'parquet' is not installed")
        parquet = pytest.importorskip("pyarrow.parquet")
        parquet.write_table(arrow.table({"p": slopes[:, 0], "i": slopes[:, 0], "q": slopes[:, 1]}), file)
    else:
        heading = "p,q\n" if kind == "csv" else ""
        mark = "," if kind == "csv" else " "
        file.write_text(heading + "\n".join(mark.join(map(repr, row)) for row in slopes.tolist()))
    return file


@pytest.mark.parametrize("kind", ["npy", "npz", "csv", "txt", "parquet"])
def test_slopes_from_tables(tmp_path, kind):
    slopes = np.random.default_rng(3).normal(size=(50, 2))
    slopes[7, 1] = np.nan
    sample = mf.read_slopes(slope_file(tmp_path, kind, slopes))
    assert np.array_equal(sample.values, np.delete(slopes, 7, axis=0))
    others = ("columns left out: i",) if kind == "parquet" else ()
    assert sample.steps == (*others, "1 of 50 rows left out, which are not finite")
    assert sample.source == f"slopes.{kind}"
    assert np.array_equal(np.asarray(sample), sample.values)
    assert len(sample) == 49


def test_slopes_are_fitted_as_an_array_is(tmp_path):
    slopes = 0.2 * np.random.default_rng(3).normal(size=(500, 2))
    sample = mf.read_slopes(slope_file(tmp_path, "npy", slopes))
    assert mf.fit(sample, "beckmann")[0].params == mf.fit(slopes, "beckmann")[0].params


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.npy", b"", "empty"),
        ("a.npy", b"hello", "cannot be read"),
        ("a.npz", b"hello", "cannot be read"),
        ("a.xls", b"\xd0\xcf\x11\xe0\0\0", "slopes come in"),
        ("a.xls", b"hello", "not a table of numbers"),
        ("a.csv", b"a,b,c\n1,2,3\n", "slopes are two columns.*3 named a, b, c"),
        ("a.csv", b"p,slope_x,q\n1,2,3\n", "several columns may be the slopes along x: p, slope_x"),
        (
            "a.csv",
            b"x,z\n" + b"".join(b"%d,%d\n" % (i, i % 3) for i in range(20)),
            "this is a profile .positions that rise evenly",
        ),
        ("a.csv", b"p [deg],q [deg]\n1,2\n", "the unit 'deg', and slopes are pure numbers"),
        ("a.csv", b"p,q\n", "not a table"),
        ("a.csv", b"p,q\nnan,nan\n", "not a table"),
        ("a.csv", b"p,q\n1,2\n1,two\n", "line 3 holds 'two'.*not a table of numbers"),
        ("a.parquet", b"hello, world", "cannot be read|pyarrow"),
        ("a.parquet", b"PAR1" + bytes(50) + b"\xff\xff\xff\x7fPAR1", "cannot be read|pyarrow|crashed"),
    ],
)
def test_bad_slopes(tmp_path, name, content, message):
    (tmp_path / name).write_bytes(content)
    refused(lambda: mf.read_slopes(tmp_path / name), message)
    refused(lambda: mf.read_slopes(tmp_path / f"other_{name}"), "no such file")


def normals_of(slopes):
    p, q = slopes[..., 0], slopes[..., 1]
    return np.stack((-p, -q, np.ones_like(p)), axis=-1) / np.sqrt(1 + p**2 + q**2)[..., np.newaxis]


SLOPES = 0.4 * np.random.default_rng(5).normal(size=(7, 9, 2))


@pytest.mark.parametrize(
    ("kind", "suffix", "step"), [("u1", "png", 127.5), ("u2", "png", 32767.5), ("f4", "exr", 1e7)]
)
def test_normal_maps(tmp_path, kind, suffix, step):
    """The rows of an image run down, and so does the green of the DirectX convention."""
    normals = normals_of(SLOPES)
    pixels = (
        normals.astype("f4")
        if kind == "f4"
        else np.round((normals + 1) / 2 * np.iinfo(kind).max).astype(kind)
    )
    write_image(tmp_path / f"n.{suffix}", pixels)
    sample = mf.read_normal_map(tmp_path / f"n.{suffix}")
    assert sample.values == pytest.approx(SLOPES.reshape(-1, 2), abs=6 / step)
    other = mf.read_normal_map(tmp_path / f"n.{suffix}", "directx")
    assert other.values == pytest.approx(sample.values * [1, -1])
    assert sample.steps == ("normal map of 9 x 7 pixels, opengl convention",)


def test_normals_that_do_not_point_up_are_left_out(tmp_path):
    pixels = ((normals_of(SLOPES) + 1) / 2).astype("f4")
    pixels[2, 3] = (0.5, 0.5, 0.4)
    pixels[0, 0, 2] = np.nan
    write_image(tmp_path / "n.exr", pixels)
    sample = mf.read_normal_map(tmp_path / "n.exr")
    assert len(sample) == 61
    assert sample.steps[1:] == (
        "components taken to be mapped to [0, 1]",
        "2 of 63 pixels left out, whose z is not positive",
    )
    write_image(tmp_path / "down.exr", np.zeros((4, 4, 3), "f4") - 1)
    refused(lambda: mf.read_normal_map(tmp_path / "down.exr"), "none of the 16 pixels")


def test_bad_normal_maps(tmp_path):
    write_image(tmp_path / "grey.png", LEVELS)
    refused(lambda: mf.read_normal_map(tmp_path / "grey.png"), "three channels")
    refused(lambda: mf.read_normal_map(tmp_path / "grey.png", "vulkan"), "opengl or directx")
    refused(lambda: mf.read_normal_map(tmp_path / "grey.bmp"), "no such file")
    (tmp_path / "grey.bmp").write_bytes(b"BM" + bytes(60))
    refused(lambda: mf.read_normal_map(tmp_path / "grey.bmp"), "a normal map is a PNG, TIFF, EXR or JPEG")


def test_without_the_libraries_one_sentence_says_what_to_install(tmp_path, monkeypatch):
    (tmp_path / "map.png").write_bytes(png(8, 8))
    monkeypatch.setitem(sys.modules, "OpenImageIO", None)
    refused(lambda: mf.read_surface(tmp_path / "map.png", pixel_size=1.0), r"\.\[surface\]")
    (tmp_path / "a.parquet").write_bytes(b"PAR1")
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    refused(lambda: mf.read_slopes(tmp_path / "a.parquet"), r"\.\[parquet\]")
