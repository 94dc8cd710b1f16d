"""What a picture is made of, without Mitsuba: bodies, light, passes, tones, labels."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

import microfacet as mf
from microfacet._render import environment, lathe, passes, scenes
from microfacet._render.gallery import Sheet, sheet
from microfacet._render.look import Look
from microfacet._render.picture import SHOULDER, display


def test_the_pieces_of_the_body_touch() -> None:
    points, normals = lathe.trophy()
    assert np.all(np.abs(np.hypot(*normals.T) - 1.0) < 1e-12)
    steps = np.diff(points, axis=0)
    length = np.hypot(*steps.T)
    assert length.max() < 0.06
    assert np.sum(normals[1:] * normals[:-1], axis=-1).min() > 0.97, "no edge"
    outside = np.stack([steps[:, 1], -steps[:, 0]], axis=-1)[length > 1e-9] / length[length > 1e-9, None]
    assert np.sum(outside * normals[1:][length > 1e-9], axis=-1).min() > 0.99
    assert points[0].tolist() == [0.0, 0.0]
    assert points[:, 1].min() > -1e-12, "it stands on the floor"
    assert abs(points[-1, 0]) < 1e-12, "it is closed"


@pytest.mark.parametrize("rotation", [0.0, 0.4, -1.2])
def test_the_axes_of_roughness_turn_by_one_angle(rotation: float) -> None:
    """Derivatives of the position by u and v: from differences over the facets of the ball."""
    body = lathe.revolve(lathe.sphere(), rotation)
    p, uv = (grid[40:-40] for grid in (body.positions, body.uv))  # apart from the poles, where u, v are steep
    east, north = (p[1:-1, 1] - p[1:-1, -2]) / 2.0, (p[2:, 0] - p[:-2, 0]) / 2.0
    turn = uv[1:-1, -1] - uv[1:-1, 0]  # once around
    d_east, d_north = (uv[1:-1, 1] - uv[1:-1, -2] + turn) / 2.0, (uv[2:, 0] - uv[:-2, 0]) / 2.0
    jacobian = np.linalg.inv(np.stack([d_east, d_north], axis=-1))  # of steps by u and v
    by_u = jacobian[..., :1, 0] * east + jacobian[..., 1:, 0] * north
    by_v = jacobian[..., :1, 1] * east + jacobian[..., 1:, 1] * north
    length = np.linalg.norm(by_u, axis=-1)
    np.testing.assert_allclose(np.linalg.norm(by_v, axis=-1), length, rtol=1e-3)
    np.testing.assert_allclose(np.sum(by_u * by_v, axis=-1) / length**2, 0.0, atol=1e-3)
    parallel = np.sum(by_u * east, axis=-1) / length / np.linalg.norm(east, axis=-1)
    meridian = np.sum(by_u * north, axis=-1) / length / np.linalg.norm(north, axis=-1)
    np.testing.assert_allclose(np.arctan2(meridian, parallel), rotation, atol=1e-3)


def test_light_of_1_from_above_is_pi_on_the_floor() -> None:
    np.testing.assert_allclose(
        environment.irradiance(lambda w: np.ones((*w.shape[:-1], 3))), np.pi, rtol=1e-4
    )


def test_the_floor_meets_the_horizon() -> None:
    far = environment.HORIZON * np.pi / environment.irradiance(environment.studio)
    tiles = scenes._tiles(far, 256)
    for edge in (tiles[0], tiles[-1], tiles[:, 0], tiles[:, -1]):
        np.testing.assert_allclose(edge, np.broadcast_to(far, edge.shape), rtol=1e-3)
    assert tiles.min() > 0.0
    assert tiles.max() < 0.5, "no floor gives back more than it gets"
    at_horizon = environment.studio(np.array([[0.0, 1.0, 0.0], [0.0, 1.0, -1e-3]]))
    np.testing.assert_allclose(at_horizon, np.broadcast_to(environment.HORIZON, (2, 3)))


@pytest.mark.parametrize("spp", [1, 7, 64, 100, 257, 4096])
@pytest.mark.parametrize("pixels", [16, 256 * 256, 4096 * 4096])
def test_passes_add_up(spp: int, pixels: int) -> None:
    counts = list(passes.counts(spp, pixels))
    assert sum(counts) == spp
    assert all(count % math.isqrt(count) == 0 for count in counts), "Mitsuba would round them up"
    assert all(count * pixels <= max(passes.LARGEST, pixels) for count in counts)


def test_tones() -> None:
    x = np.linspace(0.0, 40.0, 4001)
    shown = display(x)
    np.testing.assert_array_equal(shown[x <= SHOULDER], x[x <= SHOULDER])
    assert np.all(np.diff(shown) >= 0.0)
    assert shown[-1] == pytest.approx(1.0)
    slope = (display(np.array(SHOULDER + 1e-6)) - SHOULDER) / 1e-6
    assert slope == pytest.approx(1.0, abs=1e-4), "no kink"


def test_materials_as_mitsuba_takes_them() -> None:
    ellipse = {"alpha_x": 0.1, "alpha_y": 0.3, "rotation": 0.5, "gamma": 2.5}
    metal = Look("student_t", ellipse, "Cu", scattering="multiple")
    assert metal.bsdf() == {
        "type": "microfacet_conductor",
        "distribution": "student_t",
        "alpha_u": 0.1,
        "alpha_v": 0.3,
        "gamma": 2.5,
        "material": "Cu",
        "scattering": "multiple",
    }
    assert metal.rotation == 0.5
    assert Look("ggx", ellipse | {"alpha_x": 0.3}).rotation == 0.0, "a circle has no axes"
    glass = Look("gtr", {"alpha": 0.1, "gamma": 1.5}, "glass", 1.7).bsdf()
    assert (glass["type"], glass["int_ior"], glass["alpha"]) == ("microfacet_dielectric", 1.7, 0.1)


def test_a_sheet_shows_its_pictures_in_place() -> None:
    colours = np.linspace(0.1, 0.5, 6)
    pictures = [np.full((30, 30, 4), value) for value in colours]
    for picture in pictures:
        picture[..., 3] = 1.0
    labels = Sheet([("A", ""), ("B", "γ = 2"), ("C", "")], ["α = 0.1", "α = 0.2"])
    whole = sheet(labels, pictures, display)
    assert whole.dtype == np.uint8
    height, width, _ = whole.shape
    x, y = width - 3 * 31 + 15, height - 2 * 31 + 15
    encoded = 255.0 * (1.055 * colours ** (1 / 2.4) - 0.055)
    seen = [whole[y + 31 * row, x + 31 * column, 0] for row in range(2) for column in range(3)]
    np.testing.assert_allclose(seen, encoded, atol=1.0)


TITLES = "|".join(family.title for family in mf.families())
QUANTILES = re.findall(
    rf"^\| ({TITLES})(?:, \w+ = ([\d.]+))?(?: \(at alpha = 0.1\))? "
    r"\| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|$",
    (Path(__file__).parents[1] / "docs" / "gallery.md").read_text(encoding="utf-8"),
    flags=re.MULTILINE,
)


@pytest.mark.parametrize(("title", "shape", "values"), [(row[0], row[1], row[2:]) for row in QUANTILES])
def test_the_page_states_how_slopes_are_distributed(title: str, shape: str, values: tuple[str, ...]) -> None:
    """Each stated slope rounds the one that a share of the normals exceeds."""
    family = next(family for family in mf.families() if family.title == title)
    survival = getattr(mf, family.name).survival
    for share, value in zip((0.9, 0.5, 0.1, 0.01), values, strict=True):
        half = 0.5 * 10.0 ** -len(value.partition(".")[2])
        ends = 0.1 * (float(value) + np.array([-half, half]))
        above, below = survival(ends, 0.1, *([float(shape)] if shape else []))
        assert below <= share <= above


def test_the_page_states_all_of_them() -> None:
    assert {row[0] for row in QUANTILES} == {family.title for family in mf.families()}
