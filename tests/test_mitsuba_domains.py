"""Values that the Mitsuba plugins refuse, from a scene and after a change, and what textures may hold."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mitsuba_answers
import mitsuba_process
from material_cases import directions
from mitsuba_cases import FAMILIES, OURS, Surface
from shapes import one_shape

CONDUCTOR, DIELECTRIC = OURS["conductor"], OURS["dielectric"]
VARIANTS = ("scalar_rgb", "llvm_ad_rgb", "scalar_spectral")
NAN, INF = math.nan, math.inf
METAL = {"eta": {"type": "uniform", "value": 0.4}, "k": {"type": "uniform", "value": 2.0}}
STRETCHED = {"alpha_u": 0.2, "alpha_v": 0.4}
STUDENT = {"distribution": "student_t", "gamma": 2.5}
GTR = {"distribution": "gtr", "gamma": 1.5}
BESSEL = {"distribution": "bessel_k", "a": 0.7}
#: A plugin, what is right of it, the parameter that is not, and wrong values of it.
WRONG: list[tuple[str, dict[str, Any], str, tuple[float, ...]]] = [
    *((plugin, {}, "alpha", (0.0, -0.0, -0.3, 2e4, NAN, INF, -INF)) for plugin in OURS.values()),
    *((CONDUCTOR, {"distribution": name}, "alpha", (0.0, -2.0, NAN)) for name in ("beckmann", "k0")),
    *((CONDUCTOR, own, "alpha", (0.0, -2.0, NAN)) for own in (STUDENT, GTR, BESSEL)),
    (CONDUCTOR, STRETCHED, "alpha_u", (0.0, -1.0, NAN, INF)),
    (DIELECTRIC, STRETCHED, "alpha_v", (0.0, -1.0, NAN, INF)),
    (CONDUCTOR, STRETCHED, "rotation", (2e3, -1e9, NAN, INF)),
    (CONDUCTOR, STUDENT, "gamma", (1.5, 0.0, -2.0, NAN, INF)),
    (DIELECTRIC, GTR, "gamma", (0.0, -2.0, NAN, INF)),
    (CONDUCTOR, BESSEL, "a", (0.0, -2.0, NAN, INF)),
    (CONDUCTOR, METAL, "eta", (0.0, -1.0, NAN, INF)),
    (CONDUCTOR, METAL, "k", (-1e-3, NAN, INF)),
    (CONDUCTOR, METAL, "specular_reflectance", (-0.1, 1.01, NAN, INF)),
    (DIELECTRIC, {}, "specular_reflectance", (-0.1, 1.01, NAN)),
    (DIELECTRIC, {}, "specular_transmittance", (-0.1, 1.01, NAN)),
    (DIELECTRIC, {}, "int_ior", (0.0, -1.5, 1e4, NAN, INF)),
    (DIELECTRIC, {}, "ext_ior", (0.0, -1.5, NAN)),
    (DIELECTRIC, {}, "eta", (0.0, -1.5, 1e9, NAN, INF, 1.0)),
]
CASES = [(plugin, right, name, value) for plugin, right, name, values in WRONG for value in values]
PLAIN = {"gamma", "a", "eta", "int_ior", "ext_ior"}  # numbers; all else is a texture
CODE = """
import json
plain, cases = json.loads(sys.argv[1])
def said(act):
    try:
        act()
    except Exception as error:
        return str(error)
    return ""
def changed(bsdf, key, value):
    parameters = mi.traverse(bsdf)
    parameters[key] = value
    parameters.update()
for plugin, right, name, value in cases:
    number = name in plain and not (plugin.endswith("conductor") and name == "eta")
    constant = value if number else {"type": "uniform", "value": value}
    given = {"type": plugin, **right}
    scene = "" if name == "eta" and number else said(lambda: mi.load_dict({**given, name: constant}))
    update = ""
    if not name.endswith("_ior"):
        more = {} if number or name in right else {name: 0.5}
        key = name if number else name + ".value"
        update = said(lambda: changed(mi.load_dict({**given, **more}), key, value))
    print(json.dumps([scene, update]))
"""


@pytest.fixture(scope="module")
def complaints() -> dict[str, Any]:
    given = json.dumps([sorted(PLAIN), CASES])
    return {
        variant: [json.loads(line) for line in mitsuba_process.run(CODE, variant, given).splitlines()]
        for variant in VARIANTS
    }


def label(number: int) -> str:
    plugin, right, name, value = CASES[number]
    return f"{plugin}-{right.get('distribution', 'ggx')}-{name}-{value:g}"


@pytest.mark.parametrize("number", range(len(CASES)), ids=label)
@pytest.mark.parametrize("variant", VARIANTS)
def test_wrong_values_are_refused_in_one_sentence(complaints: Any, variant: str, number: int) -> None:
    plugin, _, name, value = CASES[number]
    scene, update = complaints[variant][number]
    if name == "eta" and plugin == DIELECTRIC:
        scene = update  # a scene gives two indices
    if name.endswith("_ior"):
        update = scene[scene.rindex(f"{plugin}: ") :]  # what can be changed is their quotient
    sentence = f'{plugin}: "{name}" is {value:g}'
    assert update.startswith(sentence), update
    assert "\n" not in update
    assert sentence in scene, scene
    assert "unknown" not in scene
    assert "lies in" in update or "needs one in" in update or "deflects nothing" in update


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_spectrum_is_refused_for_one_of_its_values(variant: str) -> None:
    code = """
wrong = {"type": "rgb", "value": [0.5, 0.0, 0.5]}
if mi.is_spectral:
    values = {"wavelengths": "400, 500, 600, 700", "values": "1.5, 0, 0, 1.2"}
    wrong = {"type": "irregular", **values}
try:
    mi.load_dict({"type": "microfacet_conductor", "eta": wrong, "k": 2.0})
except RuntimeError as error:
    print(error)
"""
    assert 'microfacet_conductor: "eta" is 0, an index' in mitsuba_process.run(code, variant)


@pytest.mark.parametrize("variant", VARIANTS)
def test_what_is_allowed_is_not_refused(variant: str) -> None:
    """The ends of all domains, all metals that Mitsuba knows, and spectra that end within what is seen."""
    code = """
from pathlib import Path
mi.set_log_level(mi.LogLevel.Error)  # warnings go to stdout, too
C, D = "microfacet_conductor", "microfacet_dielectric"
given = [
    {"type": C, "alpha": 1e4}, {"type": C, "alpha": 1e-30}, {"type": C, "alpha": 1},
    {"type": C, "alpha_u": 0.1, "alpha_v": 0.2, "rotation": -1000.0},
    {"type": C, "eta": 1e-9, "k": 0.0, "specular_reflectance": 0.0},
    {"type": D, "specular_reflectance": 1.0, "specular_transmittance": 0.0},
    {"type": D, "int_ior": 1.0001, "ext_ior": 1.0},
    {"type": C, "k": 3.0, "eta": {"type": "spectrum", "value": [(450, 0.5), (550, 0.6), (650, 0.4)]}},
]
metals = Path(mi.__file__ if hasattr(mi, "__file__") else list(mi.__path__)[0])
metals = sorted((metals if metals.is_dir() else metals.parent).glob("data/ior/*.eta.spd"))
for properties in given:
    mi.load_dict(properties)
loaded = 0
for path in metals:
    material = {"material": path.name.partition(".")[0]}
    try:
        mi.load_dict({"type": "roughconductor", **material})
    except RuntimeError:
        continue  # a file that Mitsuba itself does not read
    mi.load_dict({"type": C, **material})
    loaded += 1
print(loaded)
"""
    assert int(mitsuba_process.run(code, variant).splitlines()[-1]) > 20


N = 400
INPUTS = {
    "wi": directions(N, 41, +1).astype(np.float32),
    "wo": directions(N, 42, +1).astype(np.float32),
    "xi": np.random.default_rng(43).random((N, 3)).astype(np.float32),
    "uv": np.random.default_rng(44).random((N, 2)).astype(np.float32),
}
#: What a texel says, and what it is taken as.
TEXELS: dict[str, tuple[tuple[float, float], ...]] = {
    "alpha": ((0.0, 1e-4), (-1.0, 1e-4), (NAN, 1e-4), (1e6, 1e4)),
    "rotation": ((1e7, 1e3), (-INF, -1e3), (NAN, -1e3)),
    "eta": ((0.0, 1e-6), (-3.0, 1e-6), (NAN, 1e-6)),
    "k": ((-3.0, 0.0), (NAN, 0.0)),
    "specular_reflectance": ((-3.0, 0.0), (7.0, 1.0), (NAN, 0.0)),
}


@pytest.mark.parametrize("variant", ["llvm_ad_rgb", "scalar_rgb"])
def test_texels_outside_are_taken_at_the_nearest_end(variant: str, tmp_path: Path) -> None:
    """Of no number, at the lower one; and nothing else of the picture suffers."""
    queries = {}
    for name, pairs in TEXELS.items():
        plain = {"type": CONDUCTOR, **(STRETCHED if name == "rotation" else {"alpha": 0.3}), **METAL}
        for texel, end in pairs:
            queries[f"{name} {texel}"] = {"bsdf": {**plain, name: {"grid": [[texel, 0.5], [0.5, 0.5]]}}}
            queries[f"{name} {texel} taken"] = {"bsdf": {**plain, name: {"grid": [[end, 0.5], [0.5, 0.5]]}}}
    found = mitsuba_answers.ask(queries, variant, tmp_path, **INPUTS)
    corner = (INPUTS["uv"] < 0.5).all(axis=1)
    for name, pairs in TEXELS.items():
        for texel, _ in pairs:
            one, other = found[f"{name} {texel}"], found[f"{name} {texel} taken"]
            for quantity in ("eval", "pdf", "weight", "wo"):
                np.testing.assert_array_equal(one[quantity], other[quantity])
                assert np.all(np.isfinite(one[quantity]))
            assert one["eval"][~corner].any()


@pytest.mark.parametrize("family", FAMILIES)
def test_metals_and_glass_at_the_ends_give_numbers(family: str, tmp_path: Path) -> None:
    """Shapes and roughnesses at which tables are hard to build are refused or work."""
    shape = next(iter(one_shape({"gtr": 2.0, "student_t": 1.51, "bessel_k": 3.0})[family].values()), None)
    queries = {
        f"{plugin} {alpha}": {"bsdf": {"type": plugin, **Surface(family, (alpha,), shape).properties}}
        for plugin in OURS.values()
        for alpha in (1e-4, 0.01, 1.0, 30.0)
        if not (family == "gtr" and alpha > 1.0)
    }
    for answer in mitsuba_answers.ask(queries, "llvm_ad_rgb", tmp_path, **INPUTS).values():
        for quantity in ("eval", "pdf", "weight", "sample_pdf", "wo"):
            assert np.all(np.isfinite(answer[quantity]))


def test_samples_close_to_index_1_have_values(tmp_path: Path) -> None:
    """Down to the last number above and below it, and of indices far from it."""
    plain = {"type": DIELECTRIC, "alpha": 0.3}
    indices = (1.0 + 2.0**-23, 1.0 - 2.0**-24, 1.0 + 1e-5, 1.01, 9e3, 1e-4, 3e-8)
    queries = {f"{eta}": {"bsdf": plain, "set": {"eta": eta}} for eta in indices}
    around = {**INPUTS, "wi": directions(N, 45).astype(np.float32)}
    for answer in mitsuba_answers.ask(queries, "llvm_ad_rgb", tmp_path, **around).values():
        for quantity in ("eval", "pdf", "weight", "sample_pdf", "eval_at", "pdf_at"):
            assert np.all(np.isfinite(answer[quantity]))
        assert np.mean(answer["weight"][:, 0] > 0.0) > 0.9


def test_a_frozen_function_may_change_parameters() -> None:
    """Dr.Jit records those, and then no value may be read."""
    code = """
import drjit as dr
bsdf = mi.load_dict({"type": "microfacet_conductor", "alpha": 0.3})
parameters = mi.traverse(bsdf)
@dr.freeze
def value(alpha, wi):
    parameters["alpha.value"] = alpha
    parameters.update()
    si = dr.zeros(mi.SurfaceInteraction3f, 1)
    si.wi = wi
    return bsdf.eval(mi.BSDFContext(), si, wi)
values = [value(mi.Float(alpha), mi.Vector3f(0, 0, 1))[0][0] for alpha in (0.2, 0.3, 0.5)]
print(*(4 * v * a * a * 3.14159265 for v, a in zip(values, (0.2, 0.3, 0.5))))
"""
    found = [float(word) for word in mitsuba_process.run(code, "llvm_ad_rgb").split()]
    np.testing.assert_allclose(found, 1.0, rtol=1e-5)


def test_gradients_of_walks_are_refused_by_name() -> None:
    code = """
import drjit as dr
bsdf = mi.load_dict({"type": "microfacet_dielectric", "scattering": "multiple"})
parameters = mi.traverse(bsdf)
dr.enable_grad(parameters["alpha.value"])
parameters.update()
si = dr.zeros(mi.SurfaceInteraction3f)
si.wi = mi.Vector3f(0.6, 0, 0.8)
try:
    bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(0, 0, 1))
except RuntimeError as error:
    print(error)
"""
    said = mitsuba_process.run(code, "llvm_ad_rgb")
    assert said.startswith("microfacet_dielectric: scattering = multiple cannot be differentiated")
