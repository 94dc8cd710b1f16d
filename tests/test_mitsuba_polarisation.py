"""Polarised variants of the Mitsuba plugins: the light of the others, and Mueller matrices of facets."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mitsuba_answers
import mitsuba_process
from material_cases import Array, directions, unit
from mitsuba_cases import FAMILIES, GLASS, OURS, SHAPES, Surface
from test_mitsuba_images import CODE

QUIET = "mi.set_log_level(mi.LogLevel.Error)\n"  # warnings of these variants go to stdout, too
POLARISED, PLAIN = "llvm_ad_mono_polarized", "llvm_ad_rgb"
N = 800
WI, WO = directions(N, 21).astype(np.float32), directions(N, 22).astype(np.float32)
XI = np.random.default_rng(23).random((N, 3)).astype(np.float32)
I, O = WI.astype(np.float64), WO.astype(np.float64)  # noqa: E741
INPUTS = {"wi": WI, "wo": WO, "xi": XI, "uv": np.zeros((N, 2), np.float32)}
METAL = {name: {"type": "uniform", "value": value} for name, value in (("eta", 0.3), ("k", 2.7))}
CONSTANTS: dict[str, dict[str, Any]] = {
    "conductor": {**METAL, "specular_reflectance": 0.7},
    "dielectric": {
        "int_ior": GLASS,
        "ext_ior": 1.0,
        "specular_reflectance": 0.7,
        "specular_transmittance": 0.4,
    },
}
SURFACES = [
    Surface(family, (0.4,) if k % 2 or not about.anisotropic else (0.2, 0.6), SHAPES.get(family, (None,))[-1])
    for k, (family, about) in enumerate(FAMILIES.items())
]
SCATTERING, MODES = ("single", "multiple"), ("radiance", "importance")
CASES = [
    (material, surface, scattering, mode)
    for material in OURS
    for surface in SURFACES
    for scattering in SCATTERING
    for mode in (MODES if (material, scattering) == ("dielectric", "single") else MODES[:1])
]


def named(case: tuple[Any, ...]) -> str:
    return "-".join(map(str, case))


def bsdf(material: str, surface: Surface, **more: Any) -> dict[str, Any]:
    return {"type": OURS[material], **surface.properties, **CONSTANTS[material], **more}


def matrices(found: Array) -> Array:
    return found.reshape(len(found), 4, 4)


# --- the same light ---


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    queries = {
        named(case): {"bsdf": bsdf(case[0], case[1], scattering=case[2]), "mode": case[3]} for case in CASES
    }
    folder = tmp_path_factory.mktemp("polarisation")
    return {
        variant: mitsuba_answers.ask(queries, variant, folder, **INPUTS) for variant in (POLARISED, PLAIN)
    }


@pytest.mark.parametrize("case", CASES, ids=named)
def test_the_intensity_is_that_of_the_unpolarised_plugin(both: dict[str, Any], case: tuple[Any, ...]) -> None:
    """From both sides and to both, of values and of samples: M00 knows nothing of polarisation."""
    polarised, plain = (both[variant][named(case)] for variant in (POLARISED, PLAIN))
    for quantity in ("pdf", "sample_pdf", "wo"):
        np.testing.assert_allclose(polarised[quantity], plain[quantity], rtol=1e-6)
    for quantity in ("eval", "weight"):
        first, expected = polarised[quantity][:, 0], plain[quantity][:, 0]
        np.testing.assert_allclose(first, expected, rtol=2e-6, atol=1e-12)
        for side in (I[:, 2] > 0.0, I[:, 2] < 0.0):
            out = O if quantity == "eval" else plain["wo"]
            for other in (out[:, 2] > 0.0, out[:, 2] < 0.0):
                lit = case[0] == "dielectric" or (side & other & (I[:, 2] > 0) & (out[:, 2] > 0)).any()
                assert not lit or expected[side & other].any()


@pytest.mark.parametrize("case", CASES, ids=named)
def test_light_is_never_more_than_fully_polarised(both: dict[str, Any], case: tuple[Any, ...]) -> None:
    """Of any light that is let in, in all matrices of values and samples."""
    turns = np.linspace(0.0, 2.0 * np.pi, 9)
    states = np.array([[1, np.cos(t) * c, np.sin(t) * c, s] for t in turns for c, s in ((1, 0), (0.6, 0.8))])
    states = np.vstack([states, [1, 0, 0, 1], [1, 0, 0, -1], [1, 0, 0, 0]])
    for quantity in ("eval", "weight"):
        m = matrices(both[POLARISED][named(case)][quantity]).astype(np.float64)
        m = m[m[:, 0, 0] > 1e-20]
        assert len(m) > 100
        out = np.einsum("nij,sj->nsi", m, states)
        scale = m[:, None, 0, 0]
        assert np.all(out[..., 0] >= -1e-5 * scale)
        assert np.all(np.linalg.norm(out[..., 1:], axis=-1) <= out[..., 0] + 2e-5 * scale)


def test_a_value_from_inside() -> None:
    """Under total reflection, by hand: the same light, out of phase."""
    code = """
import json, numpy as np
si, wo = mi.SurfaceInteraction3f(), mi.Vector3f(-0.8, 0, -0.6)
si.wi = mi.Vector3f(0.8, 0, -0.6)
glass = {"type": "microfacet_dielectric", "alpha": 0.3, "int_ior": 1.5, "ext_ior": 1.0}
print(json.dumps(np.array(mi.load_dict(glass).eval(mi.BSDFContext(), si, wo)).ravel().tolist()))
"""
    m = np.array(mitsuba_process.result(QUIET + code, POLARISED)).reshape(4, 4)
    c, s2 = 0.6, 0.64
    root = np.sqrt(GLASS**2 * s2 - 1.0)  # of both waves, phases of total reflection
    half_s, half_p = np.arctan(root / (GLASS * c)), np.arctan(GLASS * root / c)
    delay = 2.0 * (half_p - half_s) + np.pi
    assert m[0, 0] == pytest.approx(1.3683, rel=1e-4)
    expected = np.diag([1.0, 1.0, np.cos(delay), np.cos(delay)])
    expected[2, 3], expected[3, 2] = -np.sin(delay), np.sin(delay)
    np.testing.assert_allclose(np.abs(m / m[0, 0]), np.abs(expected), atol=1e-5)


# --- Mueller matrices ---


def stokes_axes(forward: Array) -> Array:
    """Mitsuba's reference axis of light that goes `forward` (Duff et al., Orthonormal basis, 2017)."""
    x, y, z = np.moveaxis(forward, -1, 0)
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    return np.stack([1.0 + sign * x * x * a, sign * x * y * a, -sign * x], axis=-1)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("family", ["ggx", "beckmann"])
def test_a_metal_polarises_as_the_built_in_one(family: str, mode: str, tmp_path: Path) -> None:
    """All sixteen numbers; Beckmann's masking is not the same, so over the intensity."""
    common = {"distribution": family, "alpha": 0.35, **CONSTANTS["conductor"]}
    queries: dict[str, Any] = {
        "ours": {"bsdf": {"type": OURS["conductor"], **common, "correlated": False}, "mode": mode},
        "theirs": {"bsdf": {"type": "roughconductor", **common}, "mode": mode},
    }
    up = {**INPUTS, "wi": WI * np.sign(WI[:, 2:]), "wo": WO * np.sign(WO[:, 2:])}
    found = mitsuba_answers.ask(queries, POLARISED, tmp_path, **up)
    ours, theirs = (matrices(found[name]["eval"]) for name in ("ours", "theirs"))
    bright = theirs[:, 0, 0] > 1e-6
    assert bright.sum() > 0.5 * N
    first, second = (m[bright] / m[bright, :1, :1] for m in (ours, theirs))
    assert np.max(np.abs(first - second)) < 1e-4
    assert np.max(np.abs(second[:, 1:, 1:])) > 0.5


GLASSES = {"type": OURS["dielectric"], "alpha": 0.4, "int_ior": GLASS, "ext_ior": 1.0}


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("through", [False, True], ids=["reflection", "refraction"])
def test_level_facets_polarise_as_smooth_glass(through: bool, mode: str, tmp_path: Path) -> None:
    """Where the facet is the mean surface, Mitsuba's smooth `dielectric` draws the same pair."""
    smooth = {"type": "dielectric", "int_ior": GLASS, "ext_ior": 1.0}
    chosen = {"component": int(through), "mode": mode}
    inputs = dict(INPUTS)
    drawn = mitsuba_answers.ask({"one": {"bsdf": smooth, **chosen}}, POLARISED, tmp_path, **inputs)["one"]
    lit = drawn["weight"][:, 0] > 0.0
    inputs["wo"] = np.where(lit[:, None], drawn["wo"], WO)
    rough = mitsuba_answers.ask({"one": {"bsdf": GLASSES, **chosen}}, POLARISED, tmp_path, **inputs)["one"]
    ours, theirs = matrices(rough["eval"])[lit], matrices(drawn["weight"])[lit]
    for side in (I[lit, 2] > 0.0, I[lit, 2] < 0.0):
        assert side.sum() > 50
        first, second = (m[side] / m[side, :1, :1] for m in (ours, theirs))
        away = np.max(np.abs(first - second), axis=(1, 2))
        assert np.quantile(away, 0.99) < 1e-4  # phases turn fast at the critical angle
        assert np.median(away) < 1e-6


@pytest.mark.parametrize("side", [1.0, -1.0], ids=["above", "below"])
def test_brewsters_angle_polarises_across_the_plane_of_incidence(side: float, tmp_path: Path) -> None:
    """By facets of any slope: what was unpolarised oscillates across the plane, seen in Mitsuba's axes."""
    rng, n = np.random.default_rng(5), 200
    m = unit(np.column_stack([rng.normal(size=(n, 2)) * 0.3, np.ones(n)])) * side
    across = unit(np.cross(m, directions(n, 6)))
    angle = np.arctan(GLASS if side > 0 else 1.0 / GLASS)
    along = np.cross(across, m) * np.sin(angle)
    wi, wo = m * np.cos(angle) + along, m * np.cos(angle) - along
    seen = (wi[:, 2] * side > 0.05) & (wo[:, 2] * side > 0.05)
    assert seen.sum() > 50
    inputs = {
        "wi": wi[seen],
        "wo": wo[seen],
        "xi": np.full((seen.sum(), 3), 0.5),
        "uv": np.zeros((seen.sum(), 2)),
    }
    found = mitsuba_answers.ask({"one": {"bsdf": GLASSES}}, POLARISED, tmp_path, **inputs)["one"]
    intensity, Q, U, V = np.moveaxis(matrices(found["eval"])[:, :, 0].astype(np.float64), -1, 0)
    np.testing.assert_allclose(np.hypot(Q, U), intensity, rtol=1e-4)
    np.testing.assert_allclose(V, 0.0, atol=1e-5 * intensity.max())
    axis = stokes_axes(wi[seen])  # light goes towards wi
    turn = 0.5 * np.arctan2(U, Q)[:, None]
    oscillation = axis * np.cos(turn) + np.cross(wi[seen], axis) * np.sin(turn)
    np.testing.assert_allclose(np.abs(np.sum(oscillation * across[seen], axis=-1)), 1.0, atol=1e-4)


@pytest.mark.parametrize("material", OURS)
def test_light_takes_the_same_way_back(material: str, tmp_path: Path) -> None:
    """Over the cosine (and the squared index), the matrix of the way back is the transposed one."""
    flip = np.diag([1.0, 1.0, -1.0, 1.0])  # the same axes, seen from behind
    query = {"one": {"bsdf": bsdf(material, Surface("ggx", (0.3, 0.6)), specular_reflectance=1.0)}}
    query["one"]["bsdf"].pop("specular_transmittance", None)
    there = mitsuba_answers.ask(query, POLARISED, tmp_path, **INPUTS)["one"]
    back = mitsuba_answers.ask(query, POLARISED, tmp_path, **{**INPUTS, "wi": WO, "wo": WI})["one"]
    lit = np.minimum(there["eval"][:, 0], back["eval"][:, 0]) > 1e-4
    assert lit.sum() > 150
    first = matrices(there["eval"] / np.abs(O[:, 2:]))[lit]
    second = flip @ np.swapaxes(matrices(back["eval"] / np.abs(I[:, 2:])), 1, 2)[lit] @ flip
    if material == "dielectric":  # radiance is scaled by the squared index of its side
        first = first * np.where(I[lit, 2] > 0.0, GLASS**2, 1.0)[:, None, None]
        second = second * np.where(O[lit, 2] > 0.0, GLASS**2, 1.0)[:, None, None]
    away = np.max(np.abs(first - second), axis=(1, 2)) / first[:, 0, 0]
    assert np.median(away) < 1e-5
    assert np.quantile(away, 0.99) < 2e-3


def test_a_perfect_mirror_is_the_limit_of_metals(tmp_path: Path) -> None:
    """It turns the phase of one wave and keeps all polarisation, also at k whose square is no number."""
    surface = Surface("k0", (0.3,))
    queries: dict[str, Any] = {"mirror": {"bsdf": {"type": OURS["conductor"], **surface.properties}}}
    queries["metal"] = {
        "bsdf": {**queries["mirror"]["bsdf"], "eta": METAL["eta"], "k": {"type": "uniform", "value": 1e6}}
    }
    up = {**INPUTS, "wi": WI * np.sign(WI[:, 2:]), "wo": WO * np.sign(WO[:, 2:])}
    found = mitsuba_answers.ask(queries, POLARISED, tmp_path, **up)
    mirror, metal = (matrices(found[name]["eval"]) for name in queries)
    lit = mirror[:, 0, 0] > 1e-20
    mirror, metal = (m[lit] / m[lit, :1, :1] for m in (mirror, metal))
    assert np.quantile(np.abs(mirror - metal), 0.999) < 1e-4
    gram = np.swapaxes(mirror, 1, 2) @ mirror
    np.testing.assert_allclose(gram, np.broadcast_to(np.eye(4), gram.shape), atol=1e-5)


# --- samples and pictures ---


@pytest.mark.parametrize("scattering", SCATTERING)
@pytest.mark.parametrize(
    ("material", "side"), [("conductor", 1.0), ("dielectric", 1.0), ("dielectric", -1.0)]
)
def test_samples_polarise_as_values_do(material: str, side: float, scattering: str) -> None:
    """The first column, of unpolarised light from everywhere: in the axes of wi, whatever wo is."""
    code = """
import json, numpy as np, drjit as dr
bsdf, n = mi.load_dict(json.loads(sys.argv[1])), 1 << 19
si, rng = dr.zeros(mi.SurfaceInteraction3f, n), np.random.default_rng(8)
si.wi = mi.Vector3f(*json.loads(sys.argv[2]))
xi = [mi.Float(rng.random(n, dtype=np.float32)) for _ in range(6)]
si.p = mi.Point3f(xi[3], xi[4], xi[5])
wo = mi.warp.square_to_uniform_sphere(mi.Point2f(xi[0], xi[1]))
values = np.array(bsdf.eval(mi.BSDFContext(), si, wo)).reshape(4, 4, n)[:, 0] * 4 * np.pi
weights = np.array(bsdf.sample(mi.BSDFContext(), si, xi[2], mi.Point2f(xi[:2]))[1]).reshape(4, 4, n)[:, 0]
print(json.dumps([[f(x, axis=1).tolist() for f in (np.mean, np.std)] for x in (values, weights)]))
"""
    given = bsdf(material, Surface("ggx", (0.5,)), scattering=scattering)
    if material == "dielectric":
        given["specular_transmittance"] = 0.05  # what passes is polarised the other way
    sine = 0.8 if side > 0.0 else 0.5
    wi = [sine * np.cos(0.7), sine * np.sin(0.7), side * np.sqrt(1.0 - sine**2)]
    outcome = mitsuba_process.result(QUIET + code, POLARISED, json.dumps(given), json.dumps(wi))
    (value, spread), (weight, other) = (np.array(pair) for pair in outcome)
    error = np.hypot(spread, other) / np.sqrt(1 << 19)
    assert np.all(np.abs(value - weight) < 4.5 * error + 1e-7)
    assert np.hypot(value[1], value[2]) > 5.0 * error[0], "light is polarised at all"


@pytest.mark.parametrize(("scattering", "alpha"), [("single", 0.1), ("multiple", 0.3)])
def test_a_white_furnace_in_a_polarised_variant(scattering: str, alpha: float) -> None:
    """A glass ball in a white room, in which light is reflected from inside many times."""
    glass = {**GLASSES, "alpha": alpha, "scattering": scattering}
    folder = str(Path(__file__).parent)
    arguments = json.dumps([[glass], 8, 16, 200])
    light = {
        variant: mitsuba_process.result(QUIET + CODE, variant, folder, "furnaces", arguments)[0]
        for variant in (POLARISED, PLAIN)
    }
    polarised, plain = light[POLARISED], light[PLAIN]
    assert abs(polarised["mean"] - plain["mean"]) < 4.0 * np.hypot(polarised["error"], plain["error"])
    assert polarised["error"] < 4e-3
    if scattering == "multiple":
        assert abs(polarised["mean"] - 1.0) < 4.0 * polarised["error"]
    else:
        assert 0.95 < polarised["mean"] < 1.0
