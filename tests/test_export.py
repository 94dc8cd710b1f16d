"""`microfacet.export` and its command: what files say, and what is said of wrong arguments."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import microfacet as mf
from cli_runs import assert_one_sentence
from microfacet._export.choice import chosen
from microfacet._export.density import density_of
from microfacet._export.functions import FUNCTIONS
from microfacet._export.languages import languages
from microfacet.cli import main

TABULATED = [family.name for family in mf.families() if density_of(family.name).tabulated]
ALONE = [family.name for family in mf.families() if density_of(family.name).tables_alone]
CLOSED = [family.name for family in mf.families() if family.name not in TABULATED]
TEXTS = [name for name, language in languages().items() if not language.document]


def command(*words: str) -> Any:
    return CliRunner().invoke(main, words)


# Files


@pytest.mark.parametrize("family", CLOSED)
@pytest.mark.parametrize("language", TEXTS)
def test_every_language_has_every_closed_family(language: str, family: str) -> None:
    if language == "osl" and family in ALONE:
        with pytest.raises(ValueError, match=f"^{family}_D cannot be had in OSL: OSL has no constant arrays"):
            mf.export(language, family)
        return
    text = mf.export(language, family)
    assert text.isascii()
    assert text.endswith("\n")
    assert max(map(len, text.splitlines())) < 250
    for function in ("D", "G1", "sample_visible", "pdf_visible"):
        assert f" {family}_{function}(" in text
    assert "{prefix}" not in text


def test_what_a_ring_does_not_have_is_not_said_to_be_accurate() -> None:
    """Its density is 0 or infinite; its areas are values like others, but for those next to its end."""
    head = mf.export("c", "dirac", ["D", "D_visible", "conductor_eval", "sigma"]).partition("\n\n")[0]
    assert "Largest relative errors" not in head
    (said,) = re.findall(r"Relative errors of 99.9 % of the values: (.*)\.\n", head)
    assert re.fullmatch(r"sigma [1-9]e-\d+", said)


def test_the_same_call_gives_the_same_bytes() -> None:
    """In another process, whose sets and dictionaries are in another order, too."""
    program = "import microfacet as mf, sys; sys.stdout.write(mf.export('wgsl', 'student_t', ['conductor']))"
    texts = {
        subprocess.run(
            [sys.executable, "-c", program],
            capture_output=True,
            text=True,
            check=True,
            env={**_environment(), "PYTHONHASHSEED": seed},
        ).stdout
        for seed in ("1", "2")
    }
    assert texts == {mf.export("wgsl", "student_t", ["conductor"])}


def _environment() -> dict[str, str]:
    import os

    return dict(os.environ)


@pytest.mark.parametrize(
    "options",
    [
        {"family": "student_t", "functions": ["D", "sample"], "gamma": 2.5},
        {"family": "ggx", "functions": ["dielectric_pdf"], "eta": 1.5, "prefix": "my_"},
        {"family": "k0", "functions": ["G2"], "alpha_x": 0.1, "alpha_y": 0.3, "rotation": 0.5},
        {"family": "beckmann", "functions": ["conductor"], "fresnel": "schlick", "channels": 3},
        {
            "family": "ggx",
            "functions": ["conductor_eval"],
            "retroreflective": True,
            "free": ["alpha", "eta", "k"],
        },
        {"family": "student_t", "functions": ["sample_visible"], "scheme": "continuous"},
    ],
    ids=lambda options: options["family"],
)
def test_the_command_in_the_head_makes_the_file_again(options: dict[str, Any]) -> None:
    text = mf.export("glsl", **options)
    (line,) = (line for line in text.splitlines() if line.startswith("//   microfacet export"))
    words = shlex.split(line.removeprefix("//"))
    result = command(*words[1:])
    assert result.exit_code == 0, result.stderr
    assert result.stdout == text


def test_files_are_written_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "ggx.h"
    text = mf.export("c", "ggx", ["D"], path=path)
    assert path.read_text("utf-8") == text
    with pytest.raises(ValueError, match="language"):
        mf.export("cobol", "ggx", path=tmp_path / "no.h")
    with pytest.raises(OSError, match="none"):
        mf.export("materialx", "ggx", ["D"], path=tmp_path / "none" / "ggx.mtlx")
    result = command("export", "materialx", "ggx", "-o", str(tmp_path / "ggx.mtlx"))
    assert result.exit_code == 0, result.stderr
    assert sorted(entry.name for entry in tmp_path.iterdir()) == [
        *("ggx.h", "ggx.mtlx", "ggx_genglsl.glsl", "ggx_genmsl.metal", "ggx_genosl.osl", "ggx_genslang.slang")
    ]


def test_heads_say_what_a_file_is() -> None:
    text = mf.export("hlsl", "student_t", ["Lambda", "sample_visible"], gamma=2.5)
    head = text.partition("\n\n")[0]
    for words in ("Student-T", "HLSL", "alpha in (1e-06, 1e+06)", "gamma = 2.5", "BSD-3-Clause"):
        assert words in head
    assert f"microfacet {mf.__version__}" in head
    assert "Largest relative errors found in single precision: Lambda" in head
    assert "Errors of 99.9 % of the directions drawn: sample_visible" in head
    assert (
        "\n// Smith's Lambda towards w: sigma(w) = w.z (1 + Lambda(w)); inf at w.z = 0.\nfloat student_t_L"
        in text
    )


def test_parameters_are_free_where_they_are_not_given() -> None:
    assert "float student_t_D(float3 m, float alpha, float gamma) {" in mf.export("hlsl", "student_t", ["D"])
    assert "float student_t_D(float3 m, float alpha) {" in mf.export("hlsl", "student_t", ["D"], gamma=3.0)
    text = mf.export("hlsl", mf.StudentT(alpha_x=0.1, alpha_y=0.3, gamma=3.0), ["D"])
    assert "float student_t_D(float3 m) {" in text
    text = mf.export("hlsl", mf.StudentT(alpha=0.1, gamma=3.0), ["D"], free="alpha")
    assert "float student_t_D(float3 m, float alpha) {" in text
    text = mf.export("hlsl", "ggx", ["D"], anisotropic=True)
    assert "float ggx_D(float3 m, float alpha_x, float alpha_y) {" in text
    text = mf.export("hlsl", "ggx", ["conductor_eval"], channels=3)
    assert "float3 ggx_conductor_eval(float3 wi, float3 wo, float alpha, float3 eta, float3 k) {" in text


@pytest.mark.parametrize("family", TABULATED)
def test_shapes_from_tables(family: str) -> None:
    density = density_of(family)
    shape = {
        p.name: 0.3 if p.name == "alpha" else min(p.lower + 1.25, 0.5 * (p.lower + p.upper))
        for p in density.parameters
        if p.name in density.tabulated
    }
    text = mf.export("wgsl", family, ["D", "Lambda", "sample_visible"], **shape)
    assert "array<f32" in text
    assert density.exact  # formulas stand where shapes are free
    assert f"fn {family}_D(m: vec3f, alpha: f32, {density.parameters[-1].name}: f32)" in mf.export(
        "wgsl", family, ["D"]
    )
    with pytest.raises(ValueError, match="cannot be had in OSL"):
        mf.export("osl", family, **shape)


def test_a_density_of_the_users_own() -> None:
    ndf = mf.RadialNDF(lambda r: np.exp(-(r**4)), alpha=0.3)
    text = mf.export("c", ndf, ["D", "sigma"], free=["alpha"], prefix="my_")
    assert "static inline float my_radial_sigma(mf_vec3 w, float alpha)" in text
    assert f"from {ndf!r}." in text.replace("\n//   ", " ")


# Sizes


@pytest.mark.parametrize("family", CLOSED)
@pytest.mark.parametrize("anisotropic", [False, True])
def test_graphs_are_short(family: str, anisotropic: bool) -> None:
    choice = chosen(density_of(family), ("D",), {}, None, anisotropic)
    most = {"D": 200, "sigma": 300, "Lambda": 300, "G1": 300, "sample_visible": 1000}
    found = {name: choice.graph(name, False).operations for name in most}
    assert all(found[name] <= most[name] for name in most), found


# What is said of wrong arguments


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["cobol", "ggx"], ["language must be one of c, cuda, glsl", "'cobol'"]),
        (["c", "phong"], ["family must be one of beckmann", "'phong'"]),
        (["c", "ggx", "--functions", "D,E"], ["functions must be of D, P22", "'E'"]),
        (["c", "ggx", "--functions", ","], ["at least one function"]),
        (["c", "ggx", "--gamma", "2"], ["ggx has no parameter 'gamma' here, it takes alpha"]),
        (["c", "student_t", "--gamma", "1.2"], ["gamma must lie in (1.5, inf)", "1.2"]),
        (["c", "student_t", "--free", "alpha"], ["gamma is neither free nor given"]),
        (["c", "student_t", "--free", "alpha,gamma", "--gamma", "2"], ["gamma is either free or 2.0"]),
        (["c", "gtr", "--anisotropic"], ["gtr has no axes"]),
        (["c", "ggx", "--prefix", "2x"], ["prefix must be letters", "'2x'"]),
        (["c", "ggx", "--prefix", "a__b"], ["single underscores"]),
        (["c", "ggx", "--alpha", "nan"], ["alpha must lie in"]),
        (["c", "ggx", "--fresnel", "cook"], ["--fresnel"]),
        (["materialx", "ggx"], ["materialx needs a path"]),
        (["c", "ggx", "--functions", "conductor", "--eta", "-1"], ["eta must lie in [0, inf]"]),
        (["c", "ggx", "-o", "/nowhere/ggx.h"], ["/nowhere/ggx.h"]),
    ],
    ids=lambda part: " ".join(part[:4]) if isinstance(part, list) else None,
)
def test_wrong_arguments(words: list[str], says: list[str]) -> None:
    assert_one_sentence(command("export", *words), *says)


def test_wrong_arguments_in_python() -> None:
    for options, says in (
        ({"scheme": "fast"}, "scheme must be one of mixture, continuous"),
        ({"channels": 2}, "channels must be 1 or 3"),
        ({"fresnel": "cook"}, "fresnel must be one of conductor, schlick"),
        ({"alpha": "wide"}, "alpha must be a number in"),
    ):
        with pytest.raises(ValueError, match=says):
            mf.export("c", "ggx", **options)
    with pytest.raises(ValueError, match="family must be one of"):
        mf.export("c", 3)


def test_list() -> None:
    result = command("export", "--list")
    assert result.exit_code == 0
    for word in (*languages(), *FUNCTIONS):
        assert word in result.stdout
