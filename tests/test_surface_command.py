"""`microfacet surface`: what files hold, without an error for what they do not state."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner

import microfacet as mf
from cli_runs import assert_one_sentence
from microfacet.cli import main
from surface_file_cases import LEVELS, write_image

HEIGHTS = 1e-7 * np.random.default_rng(5).normal(size=(20, 30))


def run(*arguments):
    return CliRunner().invoke(main, ["surface", *map(str, arguments)])


@pytest.fixture
def npz(tmp_path):
    mask = np.ones(HEIGHTS.shape, bool)
    mask[:2] = False
    np.savez(tmp_path / "map.npz", heights=HEIGHTS, pixel_size=[1e-6, 2e-6], mask=mask)
    return tmp_path / "map.npz"


def test_a_map_with_everything(npz):
    result = run(npz, "--json")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    (channel,) = found["channels"]
    assert channel["pixels"] == [30, 20]
    assert channel["pixel_size"] == [1e-6, 2e-6]
    assert channel["valid"] == pytest.approx(0.9)
    assert channel["missing"] is None
    surface = mf.read_surface(npz).level()
    assert channel["roughness"] == pytest.approx(mf.roughness(surface)._asdict())
    assert (channel["lowest"], channel["highest"]) == (HEIGHTS[2:].min(), HEIGHTS[2:].max())


def test_what_is_missing_is_asked_for_without_an_error(tmp_path):
    file = tmp_path / "map.csv"
    np.savetxt(file, 1e9 * HEIGHTS, delimiter=",")
    result = run(file)
    assert result.exit_code == 0
    assert "give pixel_size (--pixel-size) in metres" in result.stderr
    assert result.stdout.split("\n")[1].split("\t")[:3] == ["0", "30 x 20", "-"]
    given = json.loads(run(file, "--json", "--pixel-size", "1e-6,2e-6", "--unit", "nm").stdout)["channels"][0]
    assert given["pixel_size"] == [1e-6, 2e-6]
    assert given["roughness"]["Sq"] == pytest.approx(np.std(HEIGHTS), rel=0.01)
    write_image(tmp_path / "map.png", LEVELS)
    assert "give height_scale (--scale)" in run(tmp_path / "map.png").stderr
    assert run(tmp_path / "map.png", "--scale", "1e-9", "--pixel-size", "1e-6").stdout.count("\t") == 20


def test_several_files_and_several_channels(npz, tmp_path):
    np.savez(tmp_path / "two.npz", left=HEIGHTS, right=2 * HEIGHTS, pixel_size=1e-6)
    result = run(npz, tmp_path / "two.npz")
    assert result.exit_code == 0
    rows = [line.split("\t") for line in result.stdout.strip().split("\n")]
    assert rows[0][:2] == ["file", "channel"]
    assert [row[1] for row in rows[1:]] == ["heights", "left", "right"] or [row[1] for row in rows[2:]] == [
        "left",
        "right",
    ]
    only = json.loads(run(tmp_path / "two.npz", "--channel", "right", "--json").stdout)
    assert [one["name"] for one in only["channels"]] == ["right"]


def test_profiles_and_slopes_are_named(tmp_path):
    (tmp_path / "profile.txt").write_text("\n".join(map(str, HEIGHTS[0])))
    (tmp_path / "slopes.csv").write_text("p,q\n0.1,0.2\n0.3,0.4\n")
    for name, kind, advice in (
        ("profile.txt", "profile", "mf.read_profile"),
        ("slopes.csv", "slopes", "--slopes"),
    ):
        found = json.loads(run(tmp_path / name, "--json").stdout)
        assert (found["kind"], found["channels"]) == (kind, [])
        assert advice in found["sentence"]


def test_a_file_that_cannot_be_read_is_one_sentence(npz, tmp_path):
    assert_one_sentence(run(tmp_path / "nothing.npz"), "there is no such file")
    result = run(npz, tmp_path / "nothing.npz", "--json")
    assert result.exit_code == 2
    ours, other = json.loads(result.stdout)["files"]
    assert ours["channels"][0]["valid"] == pytest.approx(0.9)
    assert "there is no such file" in other["error"]


@pytest.mark.parametrize("text", ["wide", "1,2,3", "1e-6,", ","])
def test_pixel_sizes_are_one_number_or_two(npz, text):
    assert_one_sentence(run(npz, "--pixel-size", text), "is neither DX nor DX,DY")
    assert_one_sentence(
        CliRunner().invoke(main, ["fit", str(npz), "--pixel-size", text]), "is neither DX nor DX,DY"
    )


def test_two_pixel_sizes_reach_the_fit(tmp_path):
    np.save(tmp_path / "map.npy", HEIGHTS)
    arguments = ["fit", str(tmp_path / "map.npy"), "--pixel-size", "1e-6,4e-6", "--no-scales", "--json"]
    result = CliRunner().invoke(main, [*arguments, "--family", "beckmann"])
    assert result.exit_code == 0, result.stderr
    surface = mf.read_surface(tmp_path / "map.npy", pixel_size=(1e-6, 4e-6)).level()
    assert json.loads(result.stdout)["roughness"]["Sdq"] == pytest.approx(mf.roughness(surface).Sdq)


def test_warnings_of_a_reading_are_notes_of_the_fit(tmp_path):
    write_image(tmp_path / "map.png", LEVELS.astype("u1"))
    arguments = ["fit", str(tmp_path / "map.png"), "--pixel-size", "1e-6", "--scale", "1e-9", "--no-scales"]
    result = CliRunner().invoke(main, [*arguments, "--family", "beckmann", "--json"])
    assert result.exit_code == 0, result.stderr
    assert any("the image has 8 bits" in note for note in json.loads(result.stdout)["warnings"])
