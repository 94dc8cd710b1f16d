"""`microfacet render` and `microfacet gallery`: arguments, files and pictures.

Mitsuba runs in processes of their own: a wrong LLVM library ends the process that uses it.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import mitsuba_process
from limits import HANG
from microfacet._optional import sentence
from microfacet.cli import main

ELLIPSE = {"alpha_x": 0.1, "alpha_y": 0.4, "rotation": 0.6}
FIT: dict[str, Any] = {
    "ranking": [
        {"family": "student_t", "params": {**ELLIPSE, "gamma": 2.5}},
        {"family": "ggx", "params": {"alpha_x": 0.2, "alpha_y": 0.2, "rotation": 0.0}},
        {"family": "k0", "params": {"alpha_x": None, "alpha_y": 0.2, "rotation": 0.0}},
    ]
}


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ("render", "give a FAMILY"),
        ("render phong --alpha 0.2", "family must be one of beckmann, ggx"),
        ("render ggx", "GGX: give either alpha, or both alpha_x and alpha_y"),
        ("render ggx --alpha 0.2 --gamma 2", "ggx takes alpha, got alpha and gamma"),
        ("render student_t --alpha 0.2 --gamma 1", "gamma must lie in"),
        ("render gtr --alpha-x 0.2 --alpha-y 0.1 --gamma 2", "gtr has no alpha_x"),
        ("render ggx --alpha 0.2 --material Au --ior 1.5", "--ior goes with --material glass"),
        ("render ggx --alpha 0.2 --ior -1", "--ior must be in (0, inf), got -1"),
        ("render ggx --alpha 0.2 --size 5x5x5", "a size is 256 or 640x360"),
        ("render ggx --alpha 0.2 --size 0", "a size is 256 or 640x360"),
        ("render ggx --alpha 0.2 --spp 0", "'--spp'"),
        ("render ggx --alpha 0.2 -o a.gif", "--output must end in .png"),
        ("render ggx --alpha 0.2 -o nowhere/a.png", "--output must lie in an existing folder"),
        ("render ggx --alpha 0.2 --scene moon", "'moon' is not one of"),
        ("render ggx --alpha 0.2 --family ggx", "--family goes with --fit"),
        ("render ggx --fit fit.json", "--fit brings the parameters"),
        ("render --fit fit.json --alpha 0.2", "--fit brings the parameters"),
        ("render --fit fit.json --family gtr", "--family must be one of the fit's student_t, ggx"),
        ("render --fit other.json", "--fit takes what `microfacet fit FILE --json` printed"),
        ("render --fit missing.json", "missing.json"),
        ("gallery -o a.exr", "--output must end in .png, .jpg"),
        ("gallery --alpha 0.1,x", "roughnesses are 0.1,0.2,0.5"),
        ("gallery --alpha 0.1,-1", "alpha must lie in"),
        ("gallery --family phong", "family must be one of"),
        ("gallery --gamma 1", "gamma must lie in"),
    ],
)
def test_bad_arguments_are_one_sentence(
    arguments: str, sentence: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("fit.json").write_text(json.dumps({"ranking": FIT["ranking"][:2]}), encoding="utf-8")
    Path("other.json").write_text(json.dumps(FIT), encoding="utf-8")  # a number that is none
    result = CliRunner().invoke(main, arguments.split())
    assert result.exit_code == 2
    assert result.stderr.count("\n") == 1
    assert result.stderr.startswith("microfacet: ")
    assert sentence in result.stderr
    assert sorted(os.listdir()) == ["fit.json", "other.json"]


@pytest.mark.parametrize("command", ["render", "gallery"])
def test_without_mitsuba(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mitsuba", None)
    arguments = ["render", "ggx", "--alpha", "0.2"] if command == "render" else ["gallery"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 2
    assert result.stderr == f"microfacet: {sentence('rendering needs', 'mitsuba')}\n"


@pytest.mark.parametrize("command", ["render", "gallery"])
def test_help_shows_examples(command: str) -> None:
    result = CliRunner().invoke(main, [command, "--help"])
    assert result.exit_code == 0
    assert f"microfacet {command}" in result.stdout.split("Examples:")[1]


# Pictures. One process for each variant makes all of them: starting Mitsuba takes longer than these pictures.

MANY = """
import json, sys
from click.testing import CliRunner
from microfacet.cli import main

found = {}
for name, *arguments in json.loads(sys.argv[1]):
    result = CliRunner().invoke(main, arguments)
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    found[name] = [result.exit_code, result.stdout, result.stderr]
print(json.dumps(found))
"""
READ = """
import json, sys
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
found = {}
for path in sys.argv[1:]:
    picture = mi.Bitmap(path)
    values = np.array(picture)
    metadata = picture.metadata()
    record = metadata["microfacet"].strip('"') if "microfacet" in metadata else "null"
    mean = values.astype(float).mean(axis=(0, 1)).tolist()
    found[path] = [str(values.dtype), values.shape, mean, float(values.max()), json.loads(record)]
print(json.dumps(found))
"""
TINY = ["--size", "16", "--spp", "4", "--json"]
BALL = ["--scene", "sphere", *TINY]
COMMANDS = {
    "preview": ["render", "ggx", "--alpha", "0.2", *TINY, "-o", "a.png", "-o", "a.exr"],
    "ball": ["render", "k0", "--alpha", "0.3", *BALL, "--size", "24x16", "-o", "ball.exr", "-o", "ball.png"],
    "again": ["render", "k0", "--alpha", "0.3", *BALL, "--size", "24x16", "-o", "b.exr", "-o", "b.png"],
    "seed": ["render", "k0", "--alpha", "0.3", *BALL, "--size", "24x16", "-o", "c.exr", "--seed", "1"],
    "glass": ["render", "gtr", "--alpha", "0.2", "--gamma", "2.5", "--ior", "1.7", *BALL, "-o", "glass.jpg"],
    "fit": ["render", "--fit", "fit.json", *BALL, "-o", "fit.png"],
    "chosen": ["render", "--fit", "fit.json", "--family", "ggx", *BALL, "-o", "ggx.png"],
    "metal": ["render", "ggx", "--alpha", "0.2", "--material", "Xx", *TINY, "-o", "none.png"],
    "variant": ["render", "ggx", "--alpha", "0.2", "--variant", "vulkan", *TINY, "-o", "none.png"],
    "gallery": [
        *("gallery", "--family", "ggx", "--family", "bessel_k", "--alpha", "0.1,0.3"),
        *("--size", "20", "--spp", "4", "--json", "-o", "gallery.png"),
    ],
}


@pytest.fixture(scope="module", params=["scalar_rgb", "llvm_ad_rgb"])
def made(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The folder, what each command said, and what each picture holds."""
    variant = str(request.param)
    mitsuba_process.require(variant)
    folder = tmp_path_factory.mktemp(variant)
    (folder / "fit.json").write_text(json.dumps({"ranking": FIT["ranking"][:2]}), encoding="utf-8")

    def run(code: str, *arguments: str) -> Any:
        command = [sys.executable, "-c", code, *arguments]
        done = subprocess.run(command, capture_output=True, text=True, timeout=HANG, cwd=folder)
        assert done.returncode == 0, done.stderr[-3000:]
        return json.loads(done.stdout.splitlines()[-1])

    listed = [
        [name, *words, *([] if "--variant" in words else ["--variant", variant])]
        for name, words in COMMANDS.items()
    ]
    said = run(MANY, json.dumps(listed))
    pictures = run(READ, *sorted(path.name for path in folder.iterdir() if path.suffix != ".json"))
    return variant, folder, said, pictures


def record(said: Any, name: str) -> dict[str, Any]:
    code, stdout, stderr = said[name]
    assert (code, stderr) == (0, "")
    return dict(json.loads(stdout))


def test_render_says_what_it_did(made: Any) -> None:
    variant, folder, said, pictures = made
    told = record(said, "preview")
    assert told["paths"] == [str(folder / "a.png"), str(folder / "a.exr")]
    assert told["variant"] == variant
    assert told["parameters"] == {"alpha_x": 0.2, "alpha_y": 0.2, "rotation": 0.0}
    assert told["material"] == "Au"
    assert told.pop("seconds") > 0
    del told["paths"]
    assert pictures["a.png"][-1] == pictures["a.exr"][-1] == told, "the files say so too"
    assert record(said, "glass")["ior"] == 1.7


def test_pictures_hold_what_they_should(made: Any) -> None:
    _, _, _, pictures = made
    kind, shape, mean, highest, _ = pictures["a.exr"]
    assert (kind, shape) == ("float32", [16, 16, 3])
    assert highest > 1.0, "radiance is not cut"
    assert 0.05 < min(mean) < max(mean) < 1.0
    kind, shape, mean, highest, _ = pictures["a.png"]
    assert (kind, shape) == ("uint8", [16, 16, 3])
    assert 30.0 < min(mean) < max(mean) < 200.0
    assert pictures["ball.exr"][1] == [16, 24, 3]
    assert pictures["glass.jpg"][:2] == ["uint8", [16, 16, 3]]
    red, _, blue = pictures["ball.exr"][2]
    assert red > blue, "gold"


def test_the_same_seed_gives_the_same_picture(made: Any) -> None:
    variant, folder, _, pictures = made
    if variant.startswith("scalar"):  # elsewhere threads add their shares of a pixel in any order
        for suffix in (".png", ".exr"):
            assert (folder / f"ball{suffix}").read_bytes() == (folder / f"b{suffix}").read_bytes()
    first, same, other = (sum(pictures[name][2]) for name in ("ball.exr", "b.exr", "c.exr"))
    assert same == pytest.approx(first, rel=1e-6)
    assert abs(other / first - 1.0) > 1e-4
    assert other == pytest.approx(first, rel=0.2)


def test_a_fit_is_rendered(made: Any) -> None:
    _, _, said, _ = made
    assert record(said, "fit")["parameters"] == FIT["ranking"][0]["params"]
    assert record(said, "chosen")["parameters"] == FIT["ranking"][1]["params"]


def test_what_mitsuba_does_not_have(made: Any) -> None:
    _, folder, said, _ = made
    code, stdout, stderr = said["metal"]
    assert (code, stdout) == (2, "")
    assert stderr.startswith("microfacet: material must be glass, none or one of Ag, Al")
    assert stderr.endswith(", got 'Xx'\n")
    assert said["variant"][0] == 2
    assert "variant must be one of scalar_rgb" in said["variant"][2]
    assert not (folder / "none.png").exists()


def test_gallery(made: Any) -> None:
    _, _, said, pictures = made
    told = record(said, "gallery")
    assert told["families"] == {"ggx": {}, "bessel_k": {"a": 0.5}}
    assert told["alphas"] == [0.1, 0.3]
    kind, (height, width, channels), _, _, _ = pictures["gallery.png"]
    assert (kind, channels) == ("uint8", 3)
    assert width > 2 * 20
    assert height > 2 * 20


def test_no_half_of_a_file_is_left(made: Any) -> None:
    assert not [path.name for path in made[1].iterdir() if path.name.startswith(".")]


def test_a_terminated_render_leaves_what_was_there(tmp_path: Path) -> None:
    mitsuba_process.require("scalar_rgb")
    (tmp_path / "a.png").write_text("before", encoding="utf-8")
    code = """
from microfacet.cli import main
invoke = main.invoke
main.invoke = lambda ctx: (print("here", flush=True), invoke(ctx))  # once it minds that it is terminated
main()
"""
    words = "render ggx --alpha 0.2 --scene sphere --size 32 --spp 1000000000 --variant scalar_rgb -o a.png"
    process = subprocess.Popen(
        [sys.executable, "-c", code, *words.split()], cwd=tmp_path, stdout=subprocess.PIPE
    )
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(2.0)  # in whatever it does then
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=HANG)
    assert process.returncode == 143
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]
    assert (tmp_path / "a.png").read_text(encoding="utf-8") == "before"


def test_without_llvm_scalar_stands_in(tmp_path: Path) -> None:
    mitsuba_process.require("scalar_rgb")
    code = """
import sys
from microfacet.mitsuba import _llvm
_llvm.usable = lambda: (False, "there is no LLVM")
from microfacet.cli import main
main()
"""
    arguments = ["render", "ggx", "--alpha", "0.2", *BALL, "-o", str(tmp_path / "a.png")]
    done = mitsuba_process.python(code, *arguments)
    assert done.returncode == 0
    assert json.loads(done.stdout)["variant"] == "scalar_rgb"
    assert done.stderr.startswith("microfacet: scalar_rgb in place of llvm_ad_rgb")
    assert "there is no LLVM" in done.stderr


def test_mitsuba_sees_the_axes_turned() -> None:
    """The first axis of the shading frame against the parallels, where rays hit a ball."""
    code = """
import json
import numpy as np
from microfacet._render import lathe

body = lathe.revolve(lathe.sphere(), float(sys.argv[1]))
ball = mi.load_dict({"type": "scene", "ball": lathe.mesh(body, mi.load_dict({"type": "diffuse"}))})
found = []
for phi, z in ((0.3, 0.2), (2.0, -0.6), (4.0, 0.8), (6.1, 0.01)):
    r = np.sqrt(1.0 - z * z)
    point, east = [r * np.cos(phi), r * np.sin(phi), z], [-np.sin(phi), np.cos(phi), 0.0]
    si = ball.ray_intersect(mi.Ray3f([4.0 * x for x in point], [-x for x in point]))
    s, t = np.array(si.sh_frame.s).ravel(), np.array(si.sh_frame.t).ravel()
    found.append(float(np.arctan2(-np.dot(t, east), np.dot(s, east))))
print(json.dumps(found))
"""
    angles = mitsuba_process.result(code, "scalar_rgb", "0.6")
    assert angles == pytest.approx([0.6] * 4, abs=0.02)


def test_what_a_material_refuses_is_its_own_sentence() -> None:
    code = """
from microfacet import _render

try:
    _render.render(_render.Look("student_t", {"alpha": 0.1, "gamma": 1.2}), "sphere", (4, 4), 1)
except ValueError as error:
    print(error)
"""
    sentence = mitsuba_process.run(code, "scalar_rgb")
    assert sentence.startswith('microfacet_conductor: "gamma" is 1.2')
    assert sentence.count("\n") == 1
