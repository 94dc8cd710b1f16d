"""The Mitsuba plugins evaluate what this library does, and what Mitsuba's own do where those can."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import microfacet as mf
import mitsuba_answers
from material_cases import Array, directions, unit
from mitsuba_cases import BUILT_IN, FAMILIES, GLASS, OURS, SHAPES, Surface

N = 8000
EXACT = 1e-5  # of single precision
FIT = 0.0035  # of one masking factor of Mitsuba's Beckmann
LLVM = "llvm_ad_rgb"
COPPER = {"eta": [0.2, 1.04, 1.18], "k": [3.9, 2.6, 2.4]}
METAL = {name: {"type": "rgb", "value": value} for name, value in COPPER.items()}
GLASSES = {"int_ior": GLASS, "ext_ior": 1.0}
CONSTANTS: dict[str, dict[str, Any]] = {"conductor": METAL, "dielectric": GLASSES}
MODES = ("radiance", "importance")
REFLECTION, TRANSMISSION = 0x8, 0x10  # BSDFFlags.GlossyReflection, GlossyTransmission
SURFACES = [
    Surface(family, alpha, shape)
    for family, about in FAMILIES.items()
    for shape in SHAPES.get(family, (None,))
    for alpha in ((0.3,), (0.2, 0.5))
    if len(alpha) == 1 or about.anisotropic
]
# A tail so heavy that single precision meets its end; the mean slope has the rounding of gamma twentyfold.
SURFACES.append(Surface("student_t", (0.3,), float(np.float32(1.55))))

KNOWN = [Surface(family, alpha) for family in ("beckmann", "ggx") for alpha in ((0.3,), (0.2, 0.5))]
ALPHA_MAP = [[0.15, 0.5], [0.3, 0.2]]
TINT = [[0.2, 0.9], [0.5, 0.7]]


def exact_directions(n: int, seed: int) -> Array:
    """Of float32, and of length 1 to much less than its rounding: the plugins do not normalise, we do."""
    near = directions(n, seed)[:, np.newaxis] + 1e-6 * np.random.default_rng(seed).normal(size=(n, 64, 3))
    w = (near / np.linalg.norm(near, axis=-1, keepdims=True)).astype(np.float32)
    error = np.abs(np.linalg.norm(w.astype(np.float64), axis=-1) - 1.0)
    return np.asarray(w[np.arange(n), np.argmin(error, axis=-1)])


WI, WO = exact_directions(N, 1), exact_directions(N, 2)
XI = np.random.default_rng(3).random((N, 3)).astype(np.float32)
# Random numbers may be exactly 0, and as large as the largest below 1; from above, and from anywhere.
ENDS = np.array([0.0, 2.0**-24, 2.0**-12, 0.5, 1.0 - 2.0**-12, 1.0 - 2.0**-24], np.float32)
CORNERS = np.stack(np.meshgrid(ENDS, ENDS, ENDS), axis=-1).reshape(-1, 3)
XI[: len(CORNERS)] = XI[N // 2 : N // 2 + len(CORNERS)] = CORNERS
WI[: len(CORNERS), 2] = np.abs(WI[: len(CORNERS), 2])
I, O = WI.astype(np.float64), WO.astype(np.float64)  # noqa: E741
UV = np.random.default_rng(4).random((N, 2)).astype(np.float32)
SAME = (I[:, 2] > 0.0) & (O[:, 2] > 0.0)

each_material = pytest.mark.parametrize("material", OURS)
each_surface = pytest.mark.parametrize("surface", SURFACES, ids=str)
each_known = pytest.mark.parametrize("surface", KNOWN, ids=str)
Answers = dict[str, dict[str, Any]]


def made(plugin: str, surface: Surface, **more: Any) -> dict[str, Any]:
    material = "conductor" if plugin.endswith("conductor") else "dielectric"
    return {"type": plugin, **surface.properties, **CONSTANTS[material], **more}


def queries() -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    for material, plugin in OURS.items():
        for surface in SURFACES:
            found[f"{material} {surface}"] = {"bsdf": made(plugin, surface)}
    for surface in SURFACES[::6]:
        plugin = OURS["dielectric"]
        found[f"dielectric {surface} importance"] = {"bsdf": made(plugin, surface), "mode": "importance"}
    separable = {"correlated": False}
    for material, plugin in OURS.items():
        for surface in KNOWN:
            for which, name, more in (
                ("ours", plugin, separable),
                ("theirs", BUILT_IN[material], {"sample_visible": True}),
            ):
                for mode in MODES:
                    entry = {"bsdf": made(name, surface, **more), "mode": mode}
                    found[f"{which} {material} {surface} {mode}"] = entry
    ggx = {"distribution": "ggx", "alpha": 0.3}
    special: dict[str, tuple[str, dict[str, Any], dict[str, Any]]] = {
        "copper": ("conductor", {**ggx, "material": "Cu"}, {}),
        "mirror": ("conductor", {**ggx, "material": "none"}, {}),
        "alpha map": ("conductor", {"distribution": "ggx", "alpha": {"grid": ALPHA_MAP}}, {}),
        "two alpha maps": (
            "dielectric",
            {"distribution": "ggx", "alpha_u": {"grid": ALPHA_MAP}, "alpha_v": 0.25, **GLASSES},
            {},
        ),
        "checks": (
            "conductor",
            {"distribution": "ggx", "alpha": {"type": "checkerboard", "color0": 0.1, "color1": 0.4}},
            {},
        ),
        "tinted metal": ("conductor", {**ggx, **METAL, "specular_reflectance": {"grid": TINT}}, {}),
        "tinted glass": (
            "dielectric",
            {
                **ggx,
                "int_ior": "diamond",
                "ext_ior": "water",
                "specular_reflectance": {"type": "rgb", "value": [0.9, 0.5, 0.1]},
                "specular_transmittance": {"grid": TINT},
            },
            {},
        ),
        "usual glass": ("dielectric", ggx, {}),
        "reflection alone": ("dielectric", {**ggx, **GLASSES}, {"types": REFLECTION}),
        "transmission alone": ("dielectric", {**ggx, **GLASSES}, {"types": TRANSMISSION}),
        "first component": ("dielectric", {**ggx, **GLASSES}, {"component": 0}),
        "second component": ("dielectric", {**ggx, **GLASSES}, {"component": 1}),
        "no reflection": ("conductor", {**ggx, **METAL}, {"types": TRANSMISSION}),
        "first of a metal": ("conductor", {**ggx, **METAL}, {"component": 0}),
    }
    for name, (material, properties, context) in special.items():
        ours = {"type": OURS[material], **separable, **properties}
        theirs = {"type": BUILT_IN[material], **properties}
        found[f"ours {name}"] = {"bsdf": ours, **context}
        found[f"theirs {name}"] = {"bsdf": theirs, **context}
    return found


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Answers:
    """All questions of this module, in one process."""
    folder = tmp_path_factory.mktemp("answers")
    return mitsuba_answers.ask(queries(), LLVM, folder, wi=WI, wo=WO, xi=XI, uv=UV)


def deviation(value: Array, expected: Array) -> float:
    ordinary = expected > 1e-5
    assert np.sum(ordinary) > 60
    return float(np.max(np.abs(value[ordinary] / expected[ordinary] - 1.0)))


def well_conditioned(wi: Array, wo: Array, glass: float = GLASS) -> Array:
    """Apart from the critical angle and grazing facets, where cosines in single precision lose digits."""
    eta = np.where(wi[:, 2] > 0.0, glass, 1.0 / glass)
    through = wi[:, 2] * wo[:, 2] < 0.0
    m = unit(np.where(through[:, None], wi + eta[:, None] * wo, wi + wo))
    i, o = np.abs(np.sum(wi * m, axis=-1)), np.abs(np.sum(wo * m, axis=-1))
    return np.asarray((np.abs(eta**2 - 1.0 + i**2) > 0.02) & (np.minimum(i, o) > 0.1))


# --- this library's materials ---


@each_surface
def test_a_metal_is_ours(answers: Answers, surface: Surface) -> None:
    found = answers[f"conductor {surface}"]
    metal = mf.Conductor(surface.ndf, **COPPER)
    good = SAME & well_conditioned(I, O, 1.0)
    assert deviation(found["eval"][good], metal.eval(I, O)[good]) < EXACT
    assert deviation(found["pdf"][good], metal.pdf(I, O)[good]) < EXACT
    assert np.all(found["eval"][~SAME] == 0.0)
    assert np.all(found["pdf"][~SAME] == 0.0)


@each_surface
def test_glass_is_ours(answers: Answers, surface: Surface) -> None:
    found = answers[f"dielectric {surface}"]
    glass, good = mf.Dielectric(surface.ndf, GLASS), well_conditioned(I, O)
    product = mf.Dielectric(surface.ndf, GLASS, mode="importance", correlated=False)
    density = product.eval(I, O) / surface.ndf.G1(O * np.sign(O[:, 2:]))  # all that facets send there
    through = I[:, 2] * O[:, 2] < 0.0
    for side in (I[:, 2] > 0.0, I[:, 2] < 0.0):
        for kind in (through, ~through):
            chosen = side & kind & good
            assert deviation(found["eval"][chosen, 0], glass.eval(I, O)[chosen]) < EXACT
            assert deviation(found["pdf"][chosen], density[chosen]) < EXACT


@pytest.mark.parametrize("surface", SURFACES[::6], ids=str)
def test_glass_in_the_mode_of_importance_is_ours(answers: Answers, surface: Surface) -> None:
    found = answers[f"dielectric {surface} importance"]
    glass, good = mf.Dielectric(surface.ndf, GLASS, mode="importance"), well_conditioned(I, O)
    assert deviation(found["eval"][good, 0], glass.eval(I, O)[good]) < EXACT


@each_known
@each_material
def test_the_product_of_masking_and_shadowing_is_ours(
    answers: Answers, material: str, surface: Surface
) -> None:
    found = answers[f"ours {material} {surface} radiance"]["eval"]
    if material == "conductor":
        expected = mf.Conductor(surface.ndf, **COPPER, correlated=False).eval(I, O)
        good = SAME
    else:
        expected = np.repeat(
            mf.Dielectric(surface.ndf, GLASS, correlated=False).eval(I, O)[:, None], 3, axis=1
        )
        good = well_conditioned(I, O)
    assert deviation(found[good], expected[good]) < EXACT
    other = answers[f"{material} {surface}"]["eval"]
    assert deviation(other[good], expected[good]) > 0.05, "which of both it is shows"


# --- Mitsuba's ---


@each_known
@each_material
@pytest.mark.parametrize("mode", MODES)
def test_values_are_those_of_the_built_in_plugin(
    answers: Answers, material: str, surface: Surface, mode: str
) -> None:
    ours, theirs = (answers[f"{which} {material} {surface} {mode}"] for which in ("ours", "theirs"))
    good = well_conditioned(I, O, GLASS if material == "dielectric" else 1.0)
    factor = EXACT if surface.family == "ggx" else FIT
    assert deviation(ours["eval"][good], theirs["eval"][good]) < (2.0 * factor if factor == FIT else factor)
    # Their density of refraction and reflection is that of all facets, whether light can leave or not.
    assert deviation(ours["pdf"][good], theirs["pdf"][good]) < factor


SPECIAL = [
    name.removeprefix("ours ") for name in queries() if f"theirs {name.removeprefix('ours ')}" in queries()
]


@pytest.mark.parametrize("name", [name for name in SPECIAL if not name.startswith(tuple(OURS))])
def test_what_is_special_is_as_with_the_built_in_plugin(answers: Answers, name: str) -> None:
    ours, theirs = answers[f"ours {name}"], answers[f"theirs {name}"]
    good = well_conditioned(I, O, {"tinted glass": 2.419 / 1.333}.get(name, GLASS))
    np.testing.assert_array_equal(ours["flags"], theirs["flags"])
    if name == "no reflection":
        assert not ours["eval"].any()
        assert not ours["pdf"].any()
        assert not ours["weight"].any()
        return
    for quantity in ("eval", "pdf"):
        assert deviation(ours[quantity][good], theirs[quantity][good]) < EXACT
    np.testing.assert_array_equal((ours["eval"] > 0.0)[good], (theirs["eval"] > 0.0)[good])


@pytest.mark.parametrize("name", [name for name in SPECIAL if name != "no reflection"])
def test_samples_say_what_the_built_in_plugin_says_of_theirs(answers: Answers, name: str) -> None:
    """Index of refraction, kind and component of a sample follow from the side that it leaves on."""
    for which in ("ours", "theirs"):
        found = answers[f"{which} {name}"]
        valid = found["weight"].max(axis=-1) > 0.0
        assert np.mean(valid) > 0.2
        through = (WI[:, 2] * found["wo"][:, 2] < 0.0)[valid]
        below = (WI[:, 2] < 0.0)[valid]
        np.testing.assert_array_equal(found["type"][valid], np.where(through, TRANSMISSION, REFLECTION))
        np.testing.assert_array_equal(found["component"][valid], through)
        for side in (below, ~below):
            assert len(np.unique(found["eta"][valid][through & side])) <= 1
        if which == "ours":
            expected = {
                (bool(t), bool(b)): e for t, b, e in zip(through, below, found["eta"][valid], strict=True)
            }
        else:
            for t, b, e in zip(through, below, found["eta"][valid], strict=True):
                assert expected.get((bool(t), bool(b)), e) == pytest.approx(e, rel=1e-6)


# --- what holds for any ---

EVERY = list(queries())
OWN = [name for name in EVERY if not name.startswith("theirs")]


@pytest.mark.parametrize("name", OWN)
def test_eval_pdf_is_eval_and_pdf(answers: Answers, name: str) -> None:
    found = answers[name]
    np.testing.assert_allclose(found["eval_alone"], found["eval"], rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(found["pdf_alone"], found["pdf"], rtol=1e-6, atol=1e-12)
    for quantity in ("eval", "pdf", "weight", "sample_pdf"):
        assert np.all(np.isfinite(found[quantity]))
        assert np.all(found[quantity] >= 0.0)


# Glass with the heaviest tail refracts at horizontal facets, towards directions that single precision crowds.
WEIGHTED = [name for name in OWN if name != "ours no reflection" and not re.match("dielectric.*1.55", name)]


@pytest.mark.parametrize("name", WEIGHTED)
def test_the_weight_is_the_value_over_the_density(answers: Answers, name: str) -> None:
    """As far as a direction in single precision tells the facet that it came from."""
    found = answers[name]
    valid = (found["sample_pdf"] > 0.0) & (np.abs(found["wo"][:, 2]) > 0.05) & (np.abs(WI[:, 2]) > 0.05)
    valid &= well_conditioned(I, found["wo"].astype(np.float64), 1.5)
    assert np.sum(valid) > 300
    np.testing.assert_allclose(np.linalg.norm(found["wo"][valid], axis=-1), 1.0, rtol=1e-6)
    ratio = found["pdf_at"][valid] / found["sample_pdf"][valid]
    assert np.quantile(np.abs(ratio - 1.0), 0.98) < 1e-3
    product = found["weight"][valid] * found["pdf_at"][valid][:, None]
    away = np.abs(product / np.maximum(found["eval_at"][valid], 1e-20) - 1.0)[found["eval_at"][valid] > 1e-6]
    assert np.quantile(away, 0.98) < 1e-3


@pytest.mark.parametrize("name", OWN)
def test_every_random_number_gives_a_direction(answers: Answers, name: str) -> None:
    """Also 0, where a slope may be infinite: a direction that is no number spreads through a picture."""
    wo, weight = answers[name]["wo"], answers[name]["weight"]
    assert np.all(np.isfinite(wo))
    length = np.linalg.norm(wo, axis=-1)
    assert np.all(np.abs(length[weight.max(axis=-1) > 0.0] - 1.0) < 1e-5)


def test_walks_among_very_many_facets_end_by_roulette(tmp_path: Path) -> None:
    """Not by a bound: from the 1,025th facet on every second walk goes on and counts twice, as ours do."""
    n, alpha = 4000, 320.0
    up = np.broadcast_to(np.array([0.0, 0.0, 1.0], np.float32), (n, 3))
    xi = np.random.default_rng(5).random((n, 3)).astype(np.float32)
    mirror = {"type": OURS["conductor"], "alpha": alpha, "scattering": "multiple"}
    answers = mitsuba_answers.ask(
        {"mirror": {"bsdf": mirror}}, LLVM, tmp_path, wi=up, wo=up, xi=xi, uv=xi[:, :2]
    )
    weight = answers["mirror"]["weight"][:, 0]
    expected = mf.Conductor(mf.GGX(alpha=alpha), scattering="multiple").walk(up, rng=1)[1]
    assert set(np.unique(weight)) <= {0.0, *2.0 ** np.arange(20)}
    for ours, theirs in ((expected == 1, weight == 1), (expected > 1, weight > 1)):
        assert ours.any()
        assert theirs.any()
        assert abs(np.mean(theirs) - np.mean(ours)) < 5.0 * np.sqrt(2 * np.mean(ours) / n)
