"""The Mitsuba plugins as scenes describe them: dictionaries and XML, changes, mistakes, variants."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import mitsuba_answers
import mitsuba_process
from mitsuba_cases import FAMILIES, GLASS, OURS
from mitsuba_parameter_cases import INPUTS, LLVM, METAL, SCALAR, STUDENT
from shapes import one_shape

CONDUCTOR, DIELECTRIC = OURS["conductor"], OURS["dielectric"]
SHAPES = one_shape({"gtr": 1.5, "student_t": 2.5, "bessel_k": 0.7})
METALLIC = '<spectrum name="eta" type="uniform"><float name="value" value="0.2"/></spectrum>\n'
METALLIC += '<spectrum name="k" type="uniform"><float name="value" value="3.9"/></spectrum>'
CHECKS = {"type": "checkerboard", "color0": 0.1, "color1": 0.4}


def xml(plugin: str, inside: str) -> str:
    return f'<bsdf version="3.0.0" type="{plugin}">\n{inside}\n</bsdf>'


#: The same twice: as a dictionary, and as text.
TWINS = {
    "student_t metal": (
        {"type": CONDUCTOR, "distribution": "student_t", "alpha": 0.3, "gamma": 2.5, **METAL},
        xml(
            CONDUCTOR,
            '<string name="distribution" value="student_t"/><float name="alpha" value="0.3"/>'
            f'<float name="gamma" value="2.5"/>{METALLIC}',
        ),
    ),
    "named metal": (
        {"type": CONDUCTOR, "material": "Au", "alpha": 0.3, "correlated": False},
        xml(
            CONDUCTOR,
            '<string name="material" value="Au"/><float name="alpha" value="0.3"/>'
            '<boolean name="correlated" value="false"/>',
        ),
    ),
    "bessel_k glass": (
        {
            "type": DIELECTRIC,
            "distribution": "bessel_k",
            "a": 0.7,
            "alpha_u": 0.2,
            "alpha_v": 0.5,
            "int_ior": "bk7",
        },
        xml(
            DIELECTRIC,
            '<string name="distribution" value="bessel_k"/><float name="a" value="0.7"/>'
            '<float name="alpha_u" value="0.2"/><float name="alpha_v" value="0.5"/>'
            '<string name="int_ior" value="bk7"/>',
        ),
    ),
    "textures": (
        {"type": CONDUCTOR, "distribution": "k0", "alpha": CHECKS, **METAL, "specular_reflectance": CHECKS},
        xml(
            CONDUCTOR,
            '<string name="distribution" value="k0"/>'
            + "".join(
                f'<texture type="checkerboard" name="{name}"><spectrum name="color0" value="0.1"/>'
                '<spectrum name="color1" value="0.4"/></texture>'
                for name in ("alpha", "specular_reflectance")
            )
            + METALLIC,
        ),
    ),
}
#: A dictionary, what is changed of it, and the same as one dictionary.
CHANGES: dict[str, tuple[dict[str, Any], dict[str, Any], dict[str, Any]]] = {
    f"{family}": (
        {"type": CONDUCTOR, "distribution": family, "alpha": 0.5, **other},
        {"alpha.value": 0.3, **own},
        {"type": CONDUCTOR, "distribution": family, "alpha": 0.3, **own},
    )
    for family, record in FAMILIES.items()
    for own in (SHAPES[family],)
    for other in ({shape.name: shape.examples[-1] for shape in record.parameters[1:]},)
}
CHANGES |= {
    "both roughnesses": (
        {"type": CONDUCTOR, "alpha_u": 0.7, "alpha_v": 0.1},
        {"alpha_u.value": 0.2, "alpha_v.value": 0.5},
        {"type": CONDUCTOR, "alpha_u": 0.2, "alpha_v": 0.5},
    ),
    "metal": (
        {"type": CONDUCTOR, "alpha": 0.3, **METAL, "specular_reflectance": 0.1},
        {"eta.value": 1.2, "k.value": 2.5, "specular_reflectance.value": 0.7},
        {
            "type": CONDUCTOR,
            "alpha": 0.3,
            "eta": {"type": "uniform", "value": 1.2},
            "k": {"type": "uniform", "value": 2.5},
            "specular_reflectance": 0.7,
        },
    ),
    "glass": (
        {"type": DIELECTRIC, "alpha": 0.3, "int_ior": 1.2, "ext_ior": 1.0, "specular_reflectance": 0.2},
        {"eta": GLASS, "specular_reflectance.value": 0.9},
        {"type": DIELECTRIC, "alpha": 0.3, "int_ior": GLASS, "ext_ior": 1.0, "specular_reflectance": 0.9},
    ),
}


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    queries: dict[str, Any] = {}
    for name, (dictionary, text) in TWINS.items():
        queries |= {f"dictionary {name}": {"bsdf": dictionary}, f"xml {name}": {"xml": text}}
    for name, (before, change, after) in CHANGES.items():
        queries |= {f"changed {name}": {"bsdf": before, "set": change}, f"as wanted {name}": {"bsdf": after}}
        queries[f"unchanged {name}"] = {"bsdf": before}
    folder = tmp_path_factory.mktemp("parameters")
    return {variant: mitsuba_answers.ask(queries, variant, folder, **INPUTS) for variant in (LLVM, SCALAR)}


both = pytest.mark.parametrize("variant", [LLVM, SCALAR])


@both
@pytest.mark.parametrize("name", TWINS)
def test_xml_says_what_a_dictionary_says(answers: Any, variant: str, name: str) -> None:
    first, second = (answers[variant][f"{kind} {name}"] for kind in ("dictionary", "xml"))
    for quantity in first:
        np.testing.assert_array_equal(first[quantity], second[quantity])
    assert first["eval"].any()


@both
@pytest.mark.parametrize("name", CHANGES)
def test_changed_parameters_are_followed(answers: Any, variant: str, name: str) -> None:
    """As by a plugin that was made with them; tables are built again."""
    changed, wanted, before = (answers[variant][f"{k} {name}"] for k in ("changed", "as wanted", "unchanged"))
    assert np.max(np.abs(changed["eval"] - before["eval"])) > 1e-3
    for quantity in ("eval", "pdf", "weight", "sample_pdf"):
        np.testing.assert_allclose(changed[quantity], wanted[quantity], rtol=1e-5, atol=1e-7)
    np.testing.assert_allclose(changed["wo"], wanted["wo"], atol=1e-5)


@pytest.mark.parametrize("name", [f"as wanted {name}" for name in CHANGES])
def test_scalar_and_array_variants_agree(answers: Any, name: str) -> None:
    one, other = answers[SCALAR][name], answers[LLVM][name]
    for quantity in ("eval", "pdf"):
        ordinary = one[quantity] > 1e-5
        np.testing.assert_allclose(one[quantity][ordinary], other[quantity][ordinary], rtol=1e-4)
        assert np.median(np.abs(one[quantity][ordinary] / other[quantity][ordinary] - 1.0)) < 1e-6
    np.testing.assert_array_equal(one["flags"], other["flags"])


def names_of(bsdf: dict[str, Any]) -> list[str]:
    code = (
        "import json\nprint(json.dumps(list(mi.traverse(mi.load_dict(json.loads(sys.argv[1]))).properties)))"
    )
    return list(mitsuba_process.result(code, SCALAR, json.dumps(bsdf)))


@pytest.mark.parametrize(
    ("bsdf", "names"),
    [
        (
            {
                "type": CONDUCTOR,
                "distribution": "student_t",
                "gamma": 3.0,
                **METAL,
                "specular_reflectance": 0.5,
            },
            {"alpha.value", "gamma", "eta.value", "k.value", "specular_reflectance.value"},
        ),
        (
            {
                "type": DIELECTRIC,
                "distribution": "bessel_k",
                "a": 0.7,
                "alpha_u": 0.1,
                "alpha_v": 0.2,
                "specular_reflectance": 0.5,
                "specular_transmittance": 0.5,
            },
            {
                "alpha_u.value",
                "alpha_v.value",
                "a",
                "eta",
                "specular_reflectance.value",
                "specular_transmittance.value",
            },
        ),
    ],
)
def test_parameters_have_the_names_of_the_documents(bsdf: dict[str, Any], names: set[str]) -> None:
    assert set(names_of(bsdf)) == names


# --- mistakes ---

#: Properties, and words that the sentence holds.
MISTAKES: list[tuple[str, dict[str, Any], list[str]]] = [
    (CONDUCTOR, {"distribution": "phong"}, ["distribution", "phong", "student_t"]),
    (CONDUCTOR, {"alpha": 0.0}, ["alpha", "0"]),
    (CONDUCTOR, {"alpha": -0.1}, ["alpha", "-0.1"]),
    (CONDUCTOR, {"alpha_u": 0.1}, ["alpha_v"]),
    (CONDUCTOR, {"alpha_u": 0.1, "alpha_v": 0.2, "alpha": 0.1}, ["alpha"]),
    (CONDUCTOR, {"distribution": "gtr", "gamma": 2.0, "alpha_u": 0.1, "alpha_v": 0.2}, ["alpha"]),
    (CONDUCTOR, STUDENT, ["gamma", "student_t"]),
    (CONDUCTOR, {**STUDENT, "gamma": 1.2}, ["gamma", "1.2", "1.5"]),
    (DIELECTRIC, {**STUDENT, "gamma": 1.2}, ["gamma", "1.2", "1.5"]),
    (DIELECTRIC, {"distribution": "bessel_k"}, ["a", "bessel_k"]),
    (DIELECTRIC, {"distribution": "bessel_k", "a": -1.0}, ["a", "-1"]),
    (DIELECTRIC, {"distribution": "gtr", "gamma": -1.0}, ["gamma", "-1"]),
    (CONDUCTOR, {"scattering": "double"}, ["scattering", "double"]),
    (CONDUCTOR, {"scattering": "multiple", "correlated": False}, ["correlated"]),
    (CONDUCTOR, {"eta": METAL["eta"]}, ["eta", "k"]),
    (CONDUCTOR, {"material": "Unobtainium"}, ["Unobtainium"]),
    (CONDUCTOR, {"material": "Cu", **METAL}, ["material", "eta"]),
    (DIELECTRIC, {"int_ior": 0.0}, ["int_ior", "0"]),
    (DIELECTRIC, {"int_ior": 1.5, "ext_ior": 1.5}, ["int_ior", "ext_ior"]),
    (DIELECTRIC, {"int_ior": "unobtainium"}, ["unobtainium"]),
    (CONDUCTOR, {"rougness": 0.2}, ["rougness"]),
]


@pytest.fixture(scope="module")
def complaints() -> list[str]:
    code = """
import json
for properties in json.loads(sys.argv[1]):
    try:
        mi.load_dict(properties)
        print(json.dumps("nothing"))
    except Exception as error:
        print(json.dumps(str(error)))
"""
    given = [{"type": plugin, **properties} for plugin, properties, _ in MISTAKES]
    return [json.loads(line) for line in mitsuba_process.run(code, SCALAR, json.dumps(given)).splitlines()]


@pytest.mark.parametrize("number", range(len(MISTAKES)), ids=lambda k: ",".join(MISTAKES[k][1]) or "nothing")
def test_mistakes_are_named(complaints: list[str], number: int) -> None:
    plugin, _, words = MISTAKES[number]
    said = complaints[number]
    assert all(word in said for word in [plugin, *words]), said
    assert len([line for line in said.splitlines() if all(word in line for word in words)]) == 1
