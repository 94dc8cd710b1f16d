"""Lookup textures: their numbers, what is read from them, the files, and the snippets that read them."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.integrate import quad

import microfacet as mf
from cli_runs import assert_one_sentence
from microfacet._bake.texture.rows import row
from microfacet._bake.texture.snippets import LANGUAGES
from microfacet.cli import main
from texture_cases import COMPILERS, KINDS, program, run_as_cpp, sampled_by_wgsl, texture

each_family = pytest.mark.parametrize(
    "family", [f for f in mf.families() if not f.singular], ids=lambda family: family.name
)


def directions(cosine: Any) -> Any:
    cosine = np.asarray(cosine)
    return np.stack((np.sqrt(1 - cosine**2), 0 * cosine, cosine), -1)


def shape_of(family: Any) -> dict[str, float]:
    """A shape inside the domain."""
    return {p.name: min(p.lower + 2.0, (p.lower + p.upper) / 2) for p in family.parameters[1:]}


# The integrals


@each_family
def test_split_sum_is_the_integral_over_directions(family: Any) -> None:
    """Over directions out, with nothing shared with the quadrature over facets but f itself."""
    ndf = family.cls(alpha=0.7, **shape_of(family))
    white = mf.Conductor(ndf)
    nodes, weights = np.polynomial.legendre.leggauss(200)
    # Dense towards the mirrored direction, where some densities are infinite.
    near, part_near = ((nodes + 1) / 2) ** 3, 3 * ((nodes + 1) / 2) ** 2 * weights / 2
    azimuth = np.pi * (1 - near)
    for c in (0.3, 0.8):
        wi = directions(c)
        cosine = np.concatenate((c - c * near, c + (1 - c) * near))[:, np.newaxis]
        of_cosine = np.concatenate((c * part_near, (1 - c) * part_near))
        sine = np.sqrt(1 - cosine**2)
        wo = np.stack(np.broadcast_arrays(sine * np.cos(azimuth), sine * np.sin(azimuth), cosine), -1)
        light = white.eval(wi, wo)
        half = wi + wo
        grazing = (1 - np.sum(half * wi, -1) / np.linalg.norm(half, axis=-1)) ** 5
        parts = [2 * np.pi * of_cosine @ (light * part) @ part_near for part in (1 - grazing, grazing)]
        found = row("split_sum", ndf, np.array([c]))
        np.testing.assert_allclose(found.values[0], parts, atol=1e-8)
        assert found.error < 1e-6


def test_split_sum_of_a_smooth_density_to_many_digits() -> None:
    white = mf.Conductor(mf.GGX(alpha=0.9))
    c, wi = 0.6, directions(0.6)
    nodes, weights = np.polynomial.legendre.leggauss(200)
    cosine = (nodes + 1) / 2
    azimuth = (np.arange(400) + 0.5) * np.pi / 400
    sine = np.sqrt(1 - cosine**2)[:, np.newaxis]
    wo = np.stack(np.broadcast_arrays(sine * np.cos(azimuth), sine * np.sin(azimuth), cosine[:, None]), -1)
    half = wi + wo
    grazing = (1 - np.sum(half * wi, -1) / np.linalg.norm(half, axis=-1)) ** 5
    light = white.eval(wi, wo)
    parts = [np.sum(weights / 2 @ (light * part)) * 2 * np.pi / 400 for part in (1 - grazing, grazing)]
    np.testing.assert_allclose(row("split_sum", white.ndf, np.array([c])).values[0], parts, atol=1e-6)


def test_the_albedo_of_rough_ggx_is_one_less_log_two() -> None:
    """At alpha = 1, along the normal, in closed form."""
    split = row("split_sum", mf.GGX(alpha=1.0), np.array([1.0])).values[0]
    assert math.isclose(split.sum(), 1 - math.log(2), abs_tol=1e-7)
    missing = row("energy", mf.GGX(alpha=1.0), np.array([1.0])).values[0, 0]
    assert math.isclose(missing, math.log(2), abs_tol=1e-7)


@each_family
def test_kinds_agree(family: Any) -> None:
    """Scale and bias make the albedo, which is what is not missing; the average is that of the albedo."""
    ndf = family.cls(alpha=0.4, **shape_of(family))
    cosine = np.array([0.05, 0.4, 0.9])
    albedo, energy, split = (row(kind, ndf, cosine).values for kind in ("albedo", "energy", "split_sum"))
    np.testing.assert_allclose(split.sum(-1), albedo[:, 0], atol=3e-7)
    np.testing.assert_array_equal(albedo, 1 - energy)
    np.testing.assert_allclose(albedo[:, 0], mf.Conductor(ndf).albedo(directions(cosine)), atol=1e-15)
    white = mf.Conductor(ndf)
    expected, _ = quad(lambda x: 6 * x**5 * white.albedo(directions(x**3)), 0, 1, epsabs=1e-7, limit=40)
    np.testing.assert_allclose(albedo[:, 1], expected, atol=1e-6)


@each_family
def test_a_smooth_surface_is_a_mirror(family: Any) -> None:
    cosine = np.array([0.2, 0.6, 1.0])
    before = np.inf
    for alpha in (1e-1, 1e-2, 1e-4):
        ndf = family.cls(alpha=alpha, **shape_of(family))
        missing = row("energy", ndf, cosine).values.max()
        assert missing < before or missing < 1e-8  # there the quadrature ends
        before = missing
        scale, bias = row("split_sum", ndf, cosine).values.T
    assert before < 1e-5
    np.testing.assert_allclose(bias, (1 - cosine) ** 5, atol=1e-5)
    np.testing.assert_allclose(scale, 1 - (1 - cosine) ** 5, atol=1e-5)


def test_datasets_have_split_sum_too() -> None:
    pytest.importorskip("xarray")
    table = mf.bake("split_sum", "k0", alpha=[0.3, 0.6], cos_theta=[0.2, 0.7])
    assert dict(table.sizes) == {"alpha": 2, "cos_theta": 2}
    expected = row("split_sum", mf.K0(alpha=0.6), np.array([0.2, 0.7])).values
    found = np.stack([table[name].sel(alpha=0.6) for name in ("scale", "bias")], -1)
    np.testing.assert_array_equal(found, expected)
    with pytest.raises(ValueError, match="split_sum takes no material, eta or k"):
        mf.bake("split_sum", "k0", alpha=[0.3], eta=1.5)


# What is read


def test_texels_lie_where_the_axes_say() -> None:
    table = mf.lookup_texture("energy", "ggx", size=(8, 4), check=0, dtype="float32")
    assert table.values.shape == (1, 4, 8, 2)
    assert table.cosine.values == tuple((np.arange(8) + 0.5) / 8)
    assert table.roughness.values == tuple(((np.arange(4) + 0.5) / 4) ** 2)
    for j, alpha in enumerate(table.roughness.values):
        expected = 1 - mf.Conductor(mf.GGX(alpha=alpha)).albedo(directions(table.cosine.values))
        np.testing.assert_allclose(table.values[0, j, :, 0], expected, atol=1e-7)
        at = table.lookup(table.cosine.values, alpha)
        np.testing.assert_allclose(at, table.values[0, j], atol=1e-7)


def test_between_texels_it_is_linear_and_beyond_them_constant() -> None:
    table = texture("split_sum", 1)
    v = table.values[0].astype(np.float64)
    cosine = (table.cosine.values[3] + table.cosine.values[4]) / 2
    alpha = ((math.sqrt(table.roughness.values[2]) * 3 + math.sqrt(table.roughness.values[3])) / 4) ** 2
    expected = 0.75 * (v[2, 3] + v[2, 4]) / 2 + 0.25 * (v[3, 3] + v[3, 4]) / 2
    np.testing.assert_allclose(table.lookup(cosine, alpha), expected, rtol=1e-12)
    np.testing.assert_array_equal(table.lookup(1e-9, 1e-9), v[0, 0])
    np.testing.assert_array_equal(table.lookup(1.0, 50.0), v[-1, -1])


def test_slices() -> None:
    """Steps of the reciprocal are found, and what lies between two slices is linear in it."""
    table = texture("energy", 3)
    assert table.shape.name == "gamma"
    assert table.shape.mapping == "reciprocal"
    one = mf.lookup_texture(
        "energy", "student_t", size=(12, 10), shape=2.5, check=0, cosine_mapping="sqrt",
        roughness_mapping="linear",
    )  # fmt: skip
    np.testing.assert_array_equal(table.values[1], one.values[0])
    between = table.lookup(0.3, 0.4, 1 / 0.45)
    np.testing.assert_allclose(between, (table.lookup(0.3, 0.4, 2.0) + table.lookup(0.3, 0.4, 2.5)) / 2)
    with pytest.raises(ValueError, match="has 3 slices: shape must say where to look"):
        table.lookup(0.3, 0.4)
    for values, mapping in ((np.geomspace(2, 16, 4), "log"), (np.linspace(2, 5, 4), "linear")):
        found = mf.lookup_texture("energy", "student_t", size=(2, 2), shape=values, check=0)
        assert found.shape.mapping == mapping


def test_the_stated_error_is_that_of_other_points() -> None:
    table = mf.lookup_texture("split_sum", "ggx", size=(16, 16), check=16)
    stated = table.errors["lookup"]
    rng = np.random.default_rng(3)
    u, v = rng.random((2, 60))
    cosine, alpha = u, v**2
    exact = np.array(
        [
            row("split_sum", mf.GGX(alpha=a), np.array([c])).values[0]
            for c, a in zip(cosine, alpha, strict=True)
        ]
    )
    wrong = np.abs(table.lookup(cosine, alpha) - exact)
    for k, channel in enumerate(table.channels):
        assert stated[channel]["mean"] / 4 < wrong[:, k].mean() < 4 * stated[channel]["mean"]
    # More texels, smaller errors.
    fine = mf.lookup_texture("split_sum", "ggx", size=(32, 32), check=16).errors["lookup"]
    assert all(fine[name]["mean"] < stated[name]["mean"] / 2 for name in table.channels)


def test_furnace() -> None:
    """A perfect mirror returns all light with either lobe, up to what the texture misses between texels."""
    table = mf.lookup_texture("energy", "ggx", size=(64, 64), check=0, dtype="float16")
    nodes, weights = np.polynomial.legendre.leggauss(64)
    x, weights = (nodes + 1) / 2, weights / 2
    cosine = x**3
    inside = cosine > table.cosine.values[0]  # before its first texel a texture is constant
    for alpha in (0.05, 0.3, 0.9):
        once = mf.Conductor(mf.GGX(alpha=alpha)).albedo(directions(cosine))
        missing, average = table.lookup(cosine, alpha).T
        turquin = once * (1 + missing / (1 - missing))
        lobe = 2 * np.sum(weights * 3 * x**2 * cosine * missing) / average[0]
        kulla_conty = once + missing * lobe
        for furnace in (turquin, kulla_conty):
            assert np.abs(furnace - 1)[inside].max() < 4e-3
            assert np.abs(furnace - 1).max() < 4e-2


# Files


def raw(path: Path) -> tuple[dict[str, Any], Any]:
    """As its JSON says."""
    about = json.loads(Path(f"{path}.json").read_text())
    dtype = np.dtype(about["type"]).newbyteorder("<" if about["byte_order"] == "little" else ">")
    shape = [about[name] for name in ("slices", "height", "width")]
    return about, np.fromfile(path.parent / about["file"], dtype).reshape(*shape, len(about["channels"]))


@pytest.mark.parametrize("slices", [1, 3])
def test_raw_and_its_json(slices: int, tmp_path: Path) -> None:
    table = texture("energy", slices)
    table.save(tmp_path / "t.raw")
    about, values = raw(tmp_path / "t.raw")
    np.testing.assert_array_equal(values, table.values)
    assert about["channels"] == ["missing", "missing_average"]
    assert [axis["along"] for axis in about["axes"]] == ["width", "height", "slices"][: 2 + (slices > 1)]
    names = {"linear": lambda x: x, "sqrt": math.sqrt, "reciprocal": lambda x: 1 / x}
    for axis in about["axes"]:
        steps = np.diff([names[axis["mapping"]](value) for value in axis["values"]])
        np.testing.assert_allclose(steps, steps[0], rtol=1e-9)
    assert about["errors"]["quadrature"] < 1e-6


@pytest.mark.parametrize("dtype", ["float32", "float16"])
@pytest.mark.parametrize("slices", [1, 3])
def test_openexr(dtype: str, slices: int, tmp_path: Path) -> None:
    oiio = pytest.importorskip("OpenImageIO")
    table = texture("split_sum", slices)
    if dtype == "float16":
        table = mf.lookup_texture("split_sum", "k0", size=(6, 5), check=0, dtype=dtype)
    table.save(tmp_path / "t.exr")
    file = oiio.ImageInput.open(str(tmp_path / "t.exr"))
    spec = file.spec()
    pixels = file.read_image(0, 0, 0, 3, "float")
    file.close()
    count, height, width, _ = table.values.shape
    assert (spec.width, spec.height, spec.channelnames) == (width, count * height, ("R", "G", "B"))
    assert str(spec.format) == {"float32": "float", "float16": "half"}[dtype]
    np.testing.assert_array_equal(pixels[..., :2], table.values.reshape(count * height, width, 2))
    assert not pixels[..., 2].any()
    assert json.loads(spec.getattribute("microfacet")) == table.metadata
    # The same table is the same bytes, at any time of day.
    before = (tmp_path / "t.exr").read_bytes()
    assert b"1980:01:01" in before
    table.save(tmp_path / "t.exr")
    assert (tmp_path / "t.exr").read_bytes() == before


def test_texture_systems_read_what_lookup_reads(tmp_path: Path) -> None:
    """OpenImageIO's, which renderers of OSL call: the first row is at t = 0."""
    oiio = pytest.importorskip("OpenImageIO")
    table = texture("energy", 1)
    table.save(tmp_path / "t.exr")
    options = oiio.TextureOpt()
    options.interpmode = oiio.InterpMode.Bilinear
    options.swrap = options.twrap = oiio.Wrap.Clamp
    system = oiio.TextureSystem(False)
    for cosine, alpha in np.random.default_rng(5).random((50, 2)):
        found = system.texture(str(tmp_path / "t.exr"), options, cosine, math.sqrt(alpha), 0, 0, 0, 0, 2)
        np.testing.assert_allclose(found, table.lookup(cosine, alpha), atol=2e-6)


def test_files_are_whole_or_not_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    arguments: dict[str, Any] = {"size": (4, 4), "check": 0}
    with pytest.raises(KeyboardInterrupt):
        mf.lookup_texture("energy", "ggx", output=tmp_path / "a.raw", progress=interrupted, **arguments)
    assert list(tmp_path.iterdir()) == []
    told: list[tuple[str, int, int]] = []
    mf.lookup_texture(
        "energy", "ggx", output=tmp_path / "a.raw", progress=lambda *x: told.append(x), **arguments
    )
    assert told == [("energy of ggx", done, 4) for done in range(4)]
    old = (tmp_path / "a.raw").read_bytes()
    monkeypatch.setattr("os.replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        mf.lookup_texture("energy", "k0", output=tmp_path / "a.raw", **arguments)
    assert (tmp_path / "a.raw").read_bytes() == old
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.raw", "a.raw.json"]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"kind": "bsdf"}, "kind must be one of albedo, energy, split_sum, got 'bsdf'"),
        ({"family": "phong"}, "family must be one of beckmann, .*, got 'phong'"),
        ({"family": "student_t"}, "student_t needs gamma, its shape"),
        ({"shape": 2.0}, "ggx has no shape parameter"),
        ({"size": (1, 64)}, r"size must be two whole numbers in \[2, 4096\], got \(1, 64\)"),
        ({"size": 64}, "size must be two whole numbers"),
        ({"size": (4096, 4097)}, "size must be two whole numbers"),
        ({"family": "student_t", "shape": np.linspace(2, 3, 99), "size": (512, 512)}, "16777216 texels"),
        ({"family": "student_t", "shape": [2.0, 3.0, 7.0]}, "the steps of gamma must be equal"),
        ({"family": "student_t", "shape": [3.0, 2.0]}, "gamma must be increasing numbers"),
        ({"family": "student_t", "shape": [1.2, 2.0]}, "StudentT: gamma must lie in"),
        ({"dtype": "float64"}, "dtype must be one of float32, float16, got 'float64'"),
        ({"cosine_mapping": "log"}, "cosine_mapping must be one of linear, sqrt, got 'log'"),
        ({"check": -1}, "check must be a whole number"),
        ({"output": "t.png"}, "output must end in .exr, .raw, got 't.png'"),
        ({"output": "t.exr", "format": "dds"}, "format must be one of exr, raw, got 'dds'"),
        ({"output": "nowhere/t.raw"}, "must lie in a folder that exists"),
    ],
)  # fmt: skip
def test_bad_arguments(
    arguments: dict[str, Any], sentence: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=sentence):
        mf.lookup_texture(**{"kind": "energy", "family": "ggx", "output": "t.raw", **arguments})
    assert list(tmp_path.iterdir()) == []


# The command


def invoke(*arguments: str) -> Any:
    return CliRunner().invoke(main, ["bake", *arguments])


def test_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    short = ["--size", "6x5", "--check", "4", "--half"]
    done = invoke("split-sum", "k0", *short, "--snippet", "hlsl", "--snippet", "c", "-o", "t.raw")
    assert done.exit_code == 0, done.stderr
    assert done.stdout.split() == [str(tmp_path / name) for name in ("t.raw", "t.raw.hlsl", "t.raw.h")]
    assert "error of what is read between the texels" in done.stderr
    about, values = raw(tmp_path / "t.raw")
    assert about["command"] == "microfacet bake split-sum k0 --size 6x5 --half -o FILE"
    assert values.dtype == np.float16
    assert values.shape == (1, 5, 6, 2)
    assert "k0_ambient_compensated" in (tmp_path / "t.raw.hlsl").read_text()
    line = "energy student_t --gamma 2:4:3:reciprocal --size 4 --check 2 --json --format raw"
    done = invoke(*line.split(), "--snippet", "wgsl", "--prefix", "skin_", "-o", "t.bin")
    assert done.exit_code == 0, done.stderr
    said = json.loads(done.stdout)
    assert (said["size"], said["slices"], said["channels"]) == ([4, 4], 3, ["missing", "missing_average"])
    assert said["path"] == str(tmp_path / "t.bin")
    assert "fn skin_missing_energy(" in Path(said["snippets"][0]).read_text()
    # The command that the file names makes the same file.
    about, _ = raw(tmp_path / "t.bin")
    again = [*about["command"].split()[2:-1], "again.raw", "--check", "0"]
    assert invoke(*again).exit_code == 0
    assert (tmp_path / "again.raw").read_bytes() == (tmp_path / "t.bin").read_bytes()


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("energy ggx --alpha 0.3 -o t.raw", ["--alpha is an option of datasets (.nc, .zarr) alone"]),
        (
            "energy ggx --alpha 0.3 --half -o t.nc",
            ["--half is an option of lookup textures (.exr, .raw) alone"],
        ),
        ("energy ggx -o t.nc", ["Missing option '--alpha'"]),
        ("energy ggx --size 64:64 -o t.raw", ["a size is WIDTHxHEIGHT, such as 64x64, got '64:64'"]),
        ("energy ggx --snippet basic -o t.raw", ["language must be one of glsl, glsl-es", "got 'basic'"]),
        ("energy ggx --snippet c --prefix 3d -o t.raw", ["prefix must be the beginning of a name"]),
        ("energy gtr --gamma 1:2:3:cubic -o t.raw", ["a grid is 0.1,0.2,0.5 or START:STOP:COUNT"]),
        ("energy gtr --gamma 0:2:3:log -o t.raw", ["a grid is"]),
        ("bsdf ggx -o t.exr", ["kind must be one of albedo, energy, split_sum"]),
        ("energy ggx --format raw -o /dev/stdout", ["raw writes a JSON beside its file"]),
    ],
)
def test_bad_commands(line: str, words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert_one_sentence(invoke(*line.split()), *words)
    assert list(tmp_path.iterdir()) == []


# Snippets


def test_every_language_is_compiled() -> None:
    assert set(COMPILERS) == set(LANGUAGES)


@pytest.mark.parametrize("slices", [1, 3])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("language", LANGUAGES)
def test_snippets_compile(language: str, kind: str, slices: int, tmp_path: Path) -> None:
    COMPILERS[language](texture(kind, slices).snippet(language), program(language, kind, slices), tmp_path)


@pytest.mark.parametrize("language", LANGUAGES)
def test_textures_of_a_family_can_be_read_by_one_program(language: str, tmp_path: Path) -> None:
    both = "".join(texture(kind, 1).snippet(language) for kind in ("energy", "split_sum"))
    COMPILERS[language](both, program(language, "split_sum", 1), tmp_path)


@pytest.mark.parametrize("slices", [1, 3])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("language", ["c", "cuda", "metal"])
def test_snippets_on_the_processor_read_what_lookup_reads(
    language: str, kind: str, slices: int, tmp_path: Path
) -> None:
    table = texture(kind, slices)
    size = (table.values.shape[2], slices * table.values.shape[1])
    text = program(language, kind, slices)
    numbers = np.ascontiguousarray(table.values, np.float32)
    found = np.zeros(2, np.float32)
    rng = np.random.default_rng(1)
    points = [*rng.random((300, 2)), (0.0, 0.0), (1.0, 1.0), (1e-4, 0.99), (1.0, 3.0)]
    for flags in (["-O0"], ["-O3", "-ffast-math"]):
        call = run_as_cpp(language, table.snippet(language), text, size, tmp_path, *flags)
        for cosine, alpha in points:
            call(numbers.ctypes.data, cosine, alpha, 0.6, found.ctypes.data)
            first, second = table.lookup(cosine, alpha, 2.2 if slices > 1 else None)
            if kind == "albedo":
                first, second = 1 - first, 1 - second
            assert found[1] == pytest.approx(second, abs=3e-6)
            assert found[0] == pytest.approx(composed(kind, first, second, 0.6), rel=1e-5, abs=1e-5)


def composed(kind: str, first: float, second: float, normal: float) -> float:
    """The sum that the program returns."""
    if kind == "split_sum":
        albedo = normal * first + second
        return albedo + albedo * (1 + normal * (1 - first - second) / (first + second))
    average = normal + (1 - normal) / 21
    colour = average**2 * (1 - second) / (1 - average * second)
    return 1 + normal * first / (1 - first) + colour * first * first / (math.pi * max(second, 1e-6))


@pytest.mark.parametrize("slices", [1, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_the_snippet_in_wgsl_reads_what_lookup_reads(kind: str, slices: int, tmp_path: Path) -> None:
    """On whatever adapter there is; filters of graphics processors know 256 places between two texels."""
    table = texture(kind, slices)
    rng = np.random.default_rng(2)
    points = rng.random((256, 2)).astype(np.float32)
    values = sampled_by_wgsl(table, points, tmp_path)
    expected = table.lookup(*points.astype(np.float64).T, 2.2 if slices > 1 else None)
    steps = max(np.abs(np.diff(table.values, axis=axis)).max() for axis in (1, 2))
    np.testing.assert_allclose(values, expected, atol=2 * steps / 512 + 2e-6)
