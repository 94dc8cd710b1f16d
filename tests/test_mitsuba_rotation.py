"""The angle of the roughness of the Mitsuba plugins: this library's `rotation`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mitsuba_answers
import mitsuba_process
from material_cases import directions
from mitsuba_cases import FAMILIES, GLASS, OURS, SHAPES, Surface
from test_mitsuba_values import EXACT, deviation, well_conditioned

VARIANTS = ("llvm_ad_rgb", "scalar_rgb")
N = 4000
WI, WO = directions(N, 31).astype(np.float32), directions(N, 32).astype(np.float32)
I, O = WI.astype(np.float64), WO.astype(np.float64)  # noqa: E741
UV = np.random.default_rng(33).random((N, 2)).astype(np.float32)
INPUTS = {"wi": WI, "wo": WO, "xi": np.random.default_rng(34).random((N, 3)).astype(np.float32), "uv": UV}
METAL = {name: {"type": "uniform", "value": value} for name, value in (("eta", 0.2), ("k", 3.9))}
CONSTANTS: dict[str, dict[str, Any]] = {"conductor": METAL, "dielectric": {"int_ior": GLASS, "ext_ior": 1.0}}
TURNS = (0.4, -1.1, 100.0)
SURFACES = [
    (Surface(family, (0.15, 0.5), SHAPES.get(family, (None,))[-1]), TURNS[k % len(TURNS)])
    for k, (family, about) in enumerate(FAMILIES.items())
    if about.anisotropic
]
MAP = [[0.3, -0.9], [2.0, 0.0]]
CASES = [(material, *surface) for material in OURS for surface in SURFACES]


def named(case: tuple[Any, ...]) -> str:
    return "-".join(map(str, case))


def bsdf(material: str, surface: Surface, **more: Any) -> dict[str, Any]:
    return {"type": OURS[material], **surface.properties, **CONSTANTS[material], **more}


def ours(material: str, surface: Surface, rotation: float) -> Any:
    import microfacet as mf

    x, y = surface.alpha
    ndf = FAMILIES[surface.family].cls(alpha_x=x, alpha_y=y, rotation=rotation, **surface.own)
    return mf.Conductor(ndf, 0.2, 3.9) if material == "conductor" else mf.Dielectric(ndf, GLASS)


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    queries: dict[str, Any] = {}
    for case in CASES:
        material, surface, rotation = case
        queries[named(case)] = {"bsdf": bsdf(material, surface, rotation=rotation)}
        queries[f"plain {named(case)}"] = {"bsdf": bsdf(material, surface)}
    metal = bsdf("conductor", SURFACES[0][0])
    text = "".join(f'<float name="{name}" value="{metal[name]}"/>' for name in ("alpha_u", "alpha_v"))
    text += '<string name="distribution" value="beckmann"/><float name="rotation" value="0.4"/>'
    for name in ("eta", "k"):
        value = METAL[name]["value"]
        text += f'<spectrum name="{name}" type="uniform"><float name="value" value="{value}"/></spectrum>'
    queries |= {
        "xml": {"xml": f'<bsdf version="3.0.0" type="{OURS["conductor"]}">{text}</bsdf>'},
        "changed": {"bsdf": {**metal, "rotation": 2.0}, "set": {"rotation.value": 0.4}},
        "wanted": {"bsdf": {**metal, "rotation": 0.4}},
        "map": {"bsdf": {**metal, "rotation": {"grid": MAP}}},
        "round": {"bsdf": {"type": OURS["conductor"], "alpha": 0.3, "rotation": 0.4}},
        "round, plain": {"bsdf": {"type": OURS["conductor"], "alpha": 0.3}},
    }
    folder = tmp_path_factory.mktemp("rotation")
    return {variant: mitsuba_answers.ask(queries, variant, folder, **INPUTS) for variant in VARIANTS}


both = pytest.mark.parametrize("variant", VARIANTS)


@both
@pytest.mark.parametrize("case", CASES, ids=named)
def test_turned_roughness_is_ours(answers: Any, variant: str, case: tuple[Any, ...]) -> None:
    material, surface, rotation = case
    found, plain = answers[variant][named(case)], answers[variant][f"plain {named(case)}"]
    expected = ours(material, surface, rotation).eval(I, O)
    good = well_conditioned(I, O, 1.0 if material == "conductor" else GLASS)
    if material == "conductor":
        good &= (I[:, 2] > 0.0) & (O[:, 2] > 0.0)
    bound = EXACT * max(1.0, abs(rotation))  # an angle in single precision
    assert deviation(found["eval"][good, 0], expected[good]) < bound
    assert deviation(plain["eval"][good, 0], expected[good]) > 0.05, "a turn shows"
    drawn = (found["sample_pdf"] > 0.0) & (np.abs(found["wo"][:, 2]) > 0.05) & (np.abs(WI[:, 2]) > 0.05)
    drawn &= well_conditioned(I, found["wo"].astype(np.float64), GLASS)
    ratio = found["pdf_at"][drawn] / found["sample_pdf"][drawn]
    assert np.quantile(np.abs(ratio - 1.0), 0.98) < 1e-3


@both
def test_a_texture_of_angles(answers: Any, variant: str) -> None:
    """Which of its four texels it is follows from the place."""
    column, row = (UV > 0.5).astype(int).T
    found = answers[variant]["map"]["eval"][:, 0]
    good = well_conditioned(I, O, 1.0) & (I[:, 2] > 0.0) & (O[:, 2] > 0.0)
    angle = np.array(MAP)[row, column]
    for turn in np.unique(MAP):
        here = good & (angle == turn)
        assert deviation(found[here], ours("conductor", SURFACES[0][0], turn).eval(I, O)[here]) < 2 * EXACT


@both
@pytest.mark.parametrize("name", ["xml", "changed"])
def test_it_is_one_parameter_however_it_is_given(answers: Any, variant: str, name: str) -> None:
    for quantity in ("eval", "pdf", "weight", "wo"):
        np.testing.assert_allclose(
            answers[variant][name][quantity], answers[variant]["wanted"][quantity], rtol=1e-5, atol=1e-6
        )


@both
def test_what_is_round_stays_as_it_is(answers: Any, variant: str) -> None:
    one, other = (answers[variant][name] for name in ("round", "round, plain"))
    for quantity in one:
        np.testing.assert_array_equal(one[quantity], other[quantity])


def test_an_angle_can_be_differentiated(tmp_path: Path) -> None:
    """Beside differences of this library's values, which are doubles."""
    surface, step, at = Surface("k0", (0.2, 0.5)), 1e-4, 0.7
    query = {"one": {"bsdf": bsdf("conductor", surface, rotation=at), "derivative": "rotation.value"}}
    found = mitsuba_answers.ask(query, VARIANTS[0], tmp_path, **INPUTS)["one"]["d_eval"][:, 0]
    up, down = (ours("conductor", surface, at + sign * step).eval(I, O) for sign in (1, -1))
    expected = (up - down) / (2 * step)
    good = well_conditioned(I, O, 1.0) & (I[:, 2] > 0.0) & (O[:, 2] > 0.0)
    assert np.max(np.abs(expected[good])) > 0.1
    np.testing.assert_allclose(found[good], expected[good], rtol=2e-3, atol=2e-5)


@pytest.mark.parametrize("material", OURS)
def test_samples_follow_the_turned_density(material: str) -> None:
    """Mitsuba's own harness, once for each plugin; and it rejects the density that is not turned."""
    code = """
import json
from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain
plugin, turned, plain, wi = json.loads(sys.argv[1])
sample, density = BSDFAdapter(plugin, turned, wi=wi)
_, wrong = BSDFAdapter(plugin, plain, wi=wi)
for pdf in (density, wrong):
    test = ChiSquareTest(SphericalDomain(), sample, pdf, 3, 500_000, ires=64, seed=5)
    print(json.dumps(bool(test.run(0.001, 1, quiet=True))))
"""
    surface, rotation = SURFACES[1]
    plain = bsdf(material, surface)
    given = json.dumps([OURS[material], {**plain, "rotation": rotation}, plain, [0.48, 0.36, 0.8]])
    turned, wrong = mitsuba_process.run(code, VARIANTS[0], given).split()[-2:]
    assert (turned, wrong) == ("true", "false")


def test_a_family_without_axes_refuses_it() -> None:
    code = """
try:
    mi.load_dict({"type": "microfacet_conductor", "distribution": "gtr", "gamma": 2.0, "rotation": 0.3})
except RuntimeError as error:
    print(error)
"""
    said = mitsuba_process.run(code, "scalar_rgb")
    assert 'microfacet_conductor: "rotation" is given, but this distribution is isotropic' in said
