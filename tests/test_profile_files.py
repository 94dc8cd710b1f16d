"""Files of profiles: the same heights however they are written, or one sentence that says why not."""

from __future__ import annotations

import gzip
import math
import zipfile
from pathlib import Path

import numpy as np
import pytest

import microfacet as mf
from hostile_cases import x3p, x3p_index
from microfacet._profile import holds_profile
from profile_file_cases import HEIGHTS, POINTS, SEVERAL, TEXTS, X, lines, with_gap
from surface_file_cases import refused

CASES = Path(__file__).parents[2] / "shared" / "cases" / "surfaces"


def written(folder, text, name="profile.txt", encoding="utf-8"):
    file = folder / name
    file.write_bytes(text.encode(encoding))
    return file


def expect(profile, heights=HEIGHTS, spacing=0.5e-6) -> None:
    assert len(profile) == 1
    assert profile.spacing == pytest.approx(spacing, rel=1e-3)
    np.testing.assert_allclose(profile.traces[0], heights * 1e-6, rtol=1e-3, atol=1e-12)


# Text


@pytest.mark.parametrize("kind", TEXTS)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_text_is_read_by_its_content(kind, encoding, tmp_path) -> None:
    if encoding == "latin-1" and "\u03bc" in TEXTS[kind]:
        pytest.skip("Latin-1 has no Greek letters")
    file = written(tmp_path, TEXTS[kind], encoding=encoding)
    expect(mf.read_profile(file))
    assert holds_profile(file)


@pytest.mark.parametrize("kind", SEVERAL)
def test_several_traces_of_a_file(kind, tmp_path) -> None:
    file = written(tmp_path, SEVERAL[kind], "traces.csv")
    profile = mf.read_profile(file)
    assert [trace.size for trace in profile.traces] == [60, 60, 40]
    for factor, trace in enumerate(profile.traces, start=1):
        np.testing.assert_allclose(trace, factor * HEIGHTS[: trace.size] * 1e-6, rtol=1e-3, atol=1e-12)
    assert profile.spacing == pytest.approx(0.5e-6)
    assert holds_profile(file)


@pytest.mark.parametrize("ending", ["csv", "dat", "prf", "xyz", "asc", ""])
def test_the_ending_of_the_name_does_not_matter(ending, tmp_path) -> None:
    expect(mf.read_profile(written(tmp_path, TEXTS["comma"], f"profile.{ending}")))


@pytest.mark.parametrize("word", ["", "nan", "NaN", "BAD", "***", "n/a", "inf", '""'])
def test_missing_heights_stay_missing(word, tmp_path) -> None:
    rows = TEXTS["comma"].splitlines()
    rows[8] = rows[8].split(",")[0] + "," + word
    trace = mf.read_profile(written(tmp_path, "\n".join(rows))).traces[0]
    assert np.flatnonzero(np.isnan(trace)).tolist() == [7]
    np.testing.assert_allclose(np.delete(trace, 7), np.delete(HEIGHTS, 7) * 1e-6)


def test_points_marked_as_invalid_are_missing(tmp_path) -> None:
    valid = np.ones(POINTS)
    valid[[5, 6]] = 0
    text = lines(X * 1e-3, HEIGHTS, valid, head="X;Y;valid\n[mm];[um];[1/0]\n", mark=";", form="{:.5f}")
    trace = mf.read_profile(written(tmp_path, text)).traces[0]
    assert np.flatnonzero(np.isnan(trace)).tolist() == [5, 6]


def test_positions_that_skip_points_leave_missing_ones(tmp_path) -> None:
    profile = mf.read_profile(written(tmp_path, with_gap()))
    assert np.flatnonzero(np.isnan(profile.traces[0])).tolist() == [20, 21, 22]
    np.testing.assert_allclose(profile.traces[0][23:], HEIGHTS[23:] * 1e-6)
    assert profile.steps == ("3 missing points where the positions skip them",)


def test_uneven_positions_are_refused_or_resampled_with_a_stated_step(tmp_path) -> None:
    x = 0.25 * (np.arange(400) + np.random.default_rng(1).uniform(0, 0.9, 400))
    x[300:] += 3
    file = written(tmp_path, lines(x, 0.1 * x**2, head="x [um],z [um]\n", form="{:.6f}"))
    refused(lambda: mf.read_profile(file), "positions are uneven, with steps from .*--resample")
    assert holds_profile(file)
    profile = mf.read_profile(file, resample=0.25e-6)
    assert profile.spacing == 0.25e-6
    assert profile.steps == ("heights interpolated linearly every 2.5e-07 m",)
    place = x[0] + 0.25 * np.arange(profile.points)
    known = np.isfinite(profile.traces[0])
    assert 0.95 < known.mean() < 1  # the wide gap stays one
    np.testing.assert_allclose(profile.traces[0][known] * 1e6, 0.1 * place[known] ** 2, atol=0.02)
    refused(lambda: mf.read_profile(file, resample=1.0), "leaves 1 points of a trace")
    refused(lambda: mf.read_profile(file, resample=1e-6, pixel_size=1e-6), "resample needs the positions")


def test_one_column_needs_a_spacing_and_a_unit(tmp_path) -> None:
    file = written(tmp_path, lines(HEIGHTS))
    assert holds_profile(file)
    refused(
        lambda: mf.read_profile(file, unit="um"), r"distance of its points, give pixel_size \(--pixel-size\)"
    )
    refused(lambda: mf.read_profile(file, pixel_size=0.5e-6), r"unit of its heights, give unit= \(--unit\)")
    profile = mf.read_profile(file, pixel_size=0.5e-6, unit="um")
    expect(profile)
    assert profile.steps == ("points 5e-07 m apart, as given by the caller",)
    commas = written(tmp_path, lines(HEIGHTS).replace(".", ","))
    expect(mf.read_profile(commas, pixel_size=0.5e-6, unit="um"))


def test_a_unit_that_contradicts_the_heading_is_an_error(tmp_path) -> None:
    file = written(tmp_path, TEXTS["comma"])
    refused(lambda: mf.read_profile(file, unit="nm"), "states the unit um, not nm")
    expect(mf.read_profile(file, unit="um"))
    refused(lambda: mf.read_profile(file, unit="mile"), "unit must be one of")
    bare = written(tmp_path, lines(X, HEIGHTS))
    refused(lambda: mf.read_profile(bare), "unit of its heights")
    expect(mf.read_profile(bare, unit="um"))


def test_points_that_are_counted_need_their_distance(tmp_path) -> None:
    file = written(tmp_path, lines(np.arange(POINTS), HEIGHTS, head="index,z [um]\n", form="{:g}"))
    refused(lambda: mf.read_profile(file), "counts points, give their distance")
    expect(mf.read_profile(file, pixel_size=0.5e-6))
    pixels = written(tmp_path, lines(np.arange(POINTS), HEIGHTS, head="x [px],z [um]\n", form="{:g}"))
    expect(mf.read_profile(pixels, pixel_size=0.5e-6))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (lines(X, HEIGHTS, head="x [um],U [V]\n"), "has the unit 'V', which is not a known length"),
        (lines(X, HEIGHTS, head="t [s],z [um]\n"), "has the unit 's', which is not a known length"),
        (lines(X, HEIGHTS, HEIGHTS, head="x [um],z1 [um],z2 [nm]\n"), "several units, nm and um"),
        (lines(HEIGHTS, HEIGHTS[::-1], head="p,q\n"), "first column does not rise"),
        (lines(X[:3], HEIGHTS[:3], head="x [um],z [um]\n"), "3 valid points of 3, at least 9"),
        ("x [um],z [um]\n", "holds no numbers"),
        ("nothing here\n", "holds no numbers"),
        (lines(X, 0 * X + 3, head="x [um],z [um]\n"), "all heights are equal"),
        (TEXTS["comma"].replace("5.0000,", "5.0000,oops"), "is not a number"),
        (
            lines(np.repeat(X, 2), np.repeat(HEIGHTS, 2), head="x [um],z [um]\n"),
            "two points lie at the position",
        ),
    ],
)
def test_what_is_no_profile_is_said(text, message, tmp_path) -> None:
    refused(lambda: mf.read_profile(written(tmp_path, text)), message)


def test_traces_of_different_spacings_are_not_one_profile(tmp_path) -> None:
    file = written(tmp_path, lines(X, HEIGHTS, 2 * X, HEIGHTS, head="x [um],z [um],x [um],z [um]\n"))
    refused(lambda: mf.read_profile(file), "spacings from 5e-07 to 1e-06 m, give resample")
    profile = mf.read_profile(file, resample=1e-6)
    np.testing.assert_allclose(profile.traces[0], HEIGHTS[::2] * 1e-6)
    np.testing.assert_allclose(profile.traces[1], HEIGHTS * 1e-6)


# What is a profile beyond doubt


def test_maps_points_and_slopes_are_no_profiles(tmp_path) -> None:
    rng = np.random.default_rng(3)
    y, x = np.mgrid[0:20, 0:30] * 1.0
    points = (x.ravel(), y.ravel(), rng.normal(size=600))
    turned = (x.T.ravel(), y.T.ravel(), rng.normal(size=600))
    for text in (
        lines(*rng.normal(size=(2, 500))),
        lines(*rng.normal(size=(2, 500)), head="p,q\n"),
        lines(*points),
        lines(*points, head="x [um],y [um],z [um]\n"),
        lines(*turned),
        lines(*rng.normal(size=(40, 30))),
        lines(*np.arange(1200.0).reshape(40, 30)),
        "ncols 4\nnrows 4\ncellsize 1\n" + lines(*rng.normal(size=(4, 4)), mark=" "),
    ):
        assert not holds_profile(written(tmp_path, text))
    for text in (lines(*points), lines(*points, head="x [um],y [um],z [um]\n"), lines(*turned)):
        with pytest.raises(mf.SurfaceError):
            mf.read_profile(written(tmp_path, text), unit="um")
    assert not holds_profile(tmp_path / "missing.txt")
    assert not holds_profile(tmp_path)


def test_arrays(tmp_path) -> None:
    file = tmp_path / "profile.npy"
    np.save(file, HEIGHTS * 1e-6)
    assert holds_profile(file)
    refused(lambda: mf.read_profile(file), "distance of its points")
    expect(mf.read_profile(file, pixel_size=0.5e-6))
    np.save(file, np.column_stack((X, HEIGHTS)).astype(np.float32))
    expect(mf.read_profile(file, unit="um"))
    np.save(file, np.random.default_rng(0).normal(size=(50, 60)))
    assert not holds_profile(file)
    np.save(file, np.array([1, "a", None], dtype=object))
    refused(lambda: mf.read_profile(file), "pickle")
    archive = tmp_path / "profile.npz"
    np.savez(archive, x=X, z=HEIGHTS, unit="um")
    assert holds_profile(archive)
    expect(mf.read_profile(archive))
    refused(lambda: mf.read_profile(archive, unit="nm"), "states the unit um, not nm")
    np.savez(archive, heights=np.stack((HEIGHTS, 2 * HEIGHTS)), spacing=0.5, unit="um")
    assert len(mf.read_profile(archive)) == 2
    assert not holds_profile(archive)  # two rows are a small map as well
    np.savez(archive, x=X[:-1], z=HEIGHTS)
    refused(lambda: mf.read_profile(archive), "x must be 60 real numbers")
    np.savez(archive, other=HEIGHTS)
    refused(lambda: mf.read_profile(archive), "no array of heights")


# Hostile files


def test_hostile_text_ends_in_a_sentence(tmp_path) -> None:
    for content, message in (
        (b"", "the file is empty"),
        (b"\x00\x01\x02" * 100, "not a profile in a format|needs SurfaceTopography"),
        (b"1," * 40_000, "longer than 65536 characters"),
        (b"1 " * 5000 + b"\n", "is a map and no profile"),
        (b"x [um],z [um]\n0,1e999\n1,2\n2,3\n" * 2, "no trace of three heights"),
        (b"x [um],z [um]\n" + b"".join(b"%d,1e300\n%d,0\n" % (k, k + 1) for k in range(0, 20, 2)), r"1e30"),
        (b"x [um],z [um]\n0,1\n1,2\n2,1\n" + b"9" * 400 + b",1\n", "3 valid points of 3"),
        ("\ufeff".encode("utf-16") + b"\xd8" * 31, "no numbers|not a"),
    ):
        file = tmp_path / "hostile.txt"
        file.write_bytes(content)
        refused(lambda file=file: mf.read_profile(file), message)
        assert not holds_profile(file) or content.startswith(b"x")


@pytest.mark.parametrize("seed", range(20))
def test_damaged_text_is_read_or_refused(seed, tmp_path) -> None:
    rng = np.random.default_rng(seed)
    content = bytearray(list(TEXTS.values())[seed].encode())
    for place in rng.integers(0, len(content), 8):
        content[place] = rng.integers(32, 256)
    file = tmp_path / "damaged.txt"
    file.write_bytes(content[: rng.integers(10, len(content))])
    try:
        profile = mf.read_profile(file)
    except mf.SurfaceError as error:
        said = str(error)
    else:
        said = f"{profile.points} points"
    assert said
    assert "\n" not in said
    assert holds_profile(file) in (True, False)


# Instruments


@pytest.mark.parametrize("along_y", [False, True])
def test_x3p_of_lines(along_y, tmp_path) -> None:
    index = x3p_index(1, POINTS) if along_y else x3p_index(POINTS, 1)
    file = tmp_path / "line.x3p"
    file.write_bytes(x3p(index.replace("SUR", "PRF"), HEIGHTS.tobytes()))
    expect(mf.read_profile(file), spacing=1e-6)
    refused(lambda: mf.read_profile(file, unit="nm"), "states the unit m, not nm")
    file.write_bytes(x3p(x3p_index(7, 6), np.arange(42.0).tobytes()))
    refused(lambda: mf.read_profile(file), "a map of 7 x 6 pixels, not a profile")


def test_what_gzip_packed(tmp_path) -> None:
    file = tmp_path / "trace.csv.gz"
    file.write_bytes(gzip.compress(TEXTS["comma"].encode()))
    expect(mf.read_profile(file))
    assert holds_profile(file)


def test_a_distance_that_replaces_another_is_a_warning(tmp_path) -> None:
    file = written(tmp_path, TEXTS["comma"])
    profile = mf.read_profile(file, pixel_size=1e-6)
    expect(profile, spacing=1e-6)
    assert profile.warnings == ("the positions are 5e-07 m apart, which the caller replaced by 1e-06 m",)
    assert mf.read_profile(file, pixel_size=0.5e-6).warnings == ()


def test_a_number_that_marks_missing_points_is_doubted(tmp_path) -> None:
    marked = np.where(np.isin(np.arange(POINTS), (3, 9)), -9999.0, HEIGHTS)
    profile = mf.read_profile(written(tmp_path, lines(X, marked, head="x [um],z [um]\n")))
    assert "2 points hold -0.009999, far from all other heights" in profile.warnings[0]


def test_mitutoyo_spreadsheets(tmp_path) -> None:
    """A spreadsheet as SurfTest writes it: positions in the unit of the cut-off, heights in that of Ra."""
    pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    data, certificate = book.active, book.create_sheet("Certificate")
    data.title = "DATA"
    data["A1"] = "Ra 1.234 um"
    for row, (x, z) in enumerate(zip(X, HEIGHTS, strict=True), start=1):
        data.cell(row, 5, (x + 0.5) * 1e-3)
        data.cell(row, 6, z)
    certificate["E2"], certificate["E48"] = "01 Dec 2025", "0.8 mm"
    book.save(tmp_path / "surftest.xlsx")
    profile = mf.read_profile(tmp_path / "surftest.xlsx")
    expect(profile)
    assert "SurfaceTopography" in profile.steps[0]


def test_a_bomb_in_a_spreadsheet_earns_no_memory(tmp_path) -> None:
    pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    with zipfile.ZipFile(tmp_path / "bomb.xlsx", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("xl/worksheets/sheet1.xml", b"0" * 2**27)
    refused(lambda: mf.read_profile(tmp_path / "bomb.xlsx"), ".")


def test_netcdf_line_scans(tmp_path) -> None:
    library = pytest.importorskip("SurfaceTopography", reason="the extra 'surface' is not installed")
    pytest.importorskip("netCDF4")
    scan = library.UniformLineScan(HEIGHTS, POINTS * 0.5, unit="um")
    scan.to_netcdf(str(tmp_path / "scan.nc"))
    expect(mf.read_profile(tmp_path / "scan.nc"))


# The two profiles that people brought


@pytest.mark.skipif(not CASES.is_dir(), reason="the cases are not part of the project")
def test_the_two_files_of_one_profile() -> None:
    one = mf.read_profile(CASES / "profile_xz.csv")
    other = mf.read_profile(CASES / "profile_z.txt", pixel_size=5e-7, unit="um")
    table = np.loadtxt(CASES / "profile_xz.csv", delimiter=",", skiprows=1)
    assert one.spacing == pytest.approx(5e-7, rel=1e-12)
    np.testing.assert_allclose(one.traces[0], table[:, 1] * 1e-6, rtol=1e-14)
    np.testing.assert_array_equal(one.traces[0], other.traces[0])
    assert one.level().roughness() == other.level().roughness()
    assert math.isclose(one.level().roughness().Rq, np.std(one.level().traces[0]))
    assert holds_profile(CASES / "profile_xz.csv")
    assert holds_profile(CASES / "profile_z.txt")
    others = [file for file in CASES.iterdir() if "profile" not in file.name]
    assert not any(map(holds_profile, others))
