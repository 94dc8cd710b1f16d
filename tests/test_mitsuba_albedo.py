"""The albedo that the Mitsuba plugins tell (of the `aov` integrator): what their materials send back."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import microfacet as mf
import mitsuba_process
from material_cases import Array
from mitsuba_cases import AZIMUTH, GLASS, OURS, Surface, surfaces

VARIANT = "llvm_ad_rgb"
DEGREES = (0.0, 35.0, 60.0, 80.0, 89.0, 105.0, 150.0)
PLACES = 1 << 11
REFLECTANCE, TRANSMITTANCE = [0.9, 0.5, 0.1], [0.2, 0.6, 1.0]
METAL = {name: {"type": "uniform", "value": value} for name, value in (("eta", 0.2), ("k", 3.9))}
CONSTANTS: dict[str, dict[str, Any]] = {"conductor": METAL, "dielectric": {"int_ior": GLASS, "ext_ior": 1.0}}
TINTS = {
    name: {"type": "rgb", "value": value}
    for name, value in (("specular_reflectance", REFLECTANCE), ("specular_transmittance", TRANSMITTANCE))
}
SURFACES = [*surfaces(), *surfaces(stretched=True)]
SOME = SURFACES[::7]
CODE = """
import json, numpy as np, drjit as dr
bsdfs, directions, places = json.loads(sys.argv[1])
n, rng = len(directions) * places, np.random.default_rng(3)
si = dr.zeros(mi.SurfaceInteraction3f, n)
si.wi = mi.Vector3f(*(mi.Float(np.repeat(np.float32(axis), places)) for axis in zip(*directions)))
si.p = mi.Point3f(*(mi.Float(rng.random(n, dtype=np.float32)) for _ in range(3)))
for bsdf in map(mi.load_dict, bsdfs):
    albedo = np.broadcast_to(np.array(bsdf.eval_diffuse_reflectance(si)), (3, n)).reshape(3, -1, places)
    found = [f(albedo, axis=-1).T.tolist() for f in (np.mean, np.std, np.min, np.max)]
    print(json.dumps(np.swapaxes(found, 0, 1).tolist()))
"""


def towards(degrees: float) -> list[float]:
    t, p = np.radians([degrees, AZIMUTH])
    return [np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)]


WI = np.array([towards(degrees) for degrees in DEGREES])


def measured(bsdfs: list[dict[str, Any]], places: int = PLACES) -> Array:
    """Of every BSDF and direction: mean, deviation, least and largest value of three channels."""
    given = json.dumps([bsdfs, WI.tolist(), places])
    lines = mitsuba_process.run(CODE, VARIANT, given).splitlines()
    return np.array([json.loads(line) for line in lines[-len(bsdfs) :]])


def bsdf(material: str, surface: Surface, **more: Any) -> dict[str, Any]:
    return {"type": OURS[material], **surface.properties, **CONSTANTS[material], **more}


def ours(material: str, surface: Surface, **more: Any) -> Any:
    """Light is counted, not radiance, which is scaled where it passes."""
    if material == "conductor":
        return mf.Conductor(surface.ndf, 0.2, 3.9, **more)
    return mf.Dielectric(surface.ndf, GLASS, mode="importance", **more)


@pytest.fixture(scope="module")
def albedos() -> dict[str, Array]:
    return {material: measured([bsdf(material, surface) for surface in SURFACES]) for material in OURS}


@pytest.mark.parametrize("number", range(len(SURFACES)), ids=lambda k: str(SURFACES[k]))
@pytest.mark.parametrize("material", OURS)
def test_it_is_what_the_material_sends_back(albedos: Any, material: str, number: int) -> None:
    """Exact in the mean of many places, each of which is a number in [0, 1] not far from it."""
    mean, deviation, least, largest = np.moveaxis(albedos[material][number], 1, 0)[..., 0]
    assert np.all((least >= 0.0) & (largest <= 1.0))
    expected = ours(material, SURFACES[number]).albedo(WI)
    error = np.maximum(5.0 * deviation / np.sqrt(PLACES), 1e-4)
    assert np.all(np.abs(mean - expected) < error)
    assert np.all(deviation < 0.05)
    assert np.all(albedos[material][number, DEGREES.index(0.0), 0] > 0.2), "light comes back at all"


def test_factors_are_in_it() -> None:
    """Of glass, each of its own part."""
    found = measured([bsdf("dielectric", surface, **TINTS) for surface in SOME])
    for surface, (mean, deviation, *_) in zip(SOME, np.moveaxis(found, 2, 1), strict=True):
        glass = ours("dielectric", surface)
        expected = sum(
            np.multiply.outer(glass.albedo(WI, part=part), tint)
            for part, tint in (("reflected", REFLECTANCE), ("transmitted", TRANSMITTANCE))
        )
        assert np.all(np.abs(mean - expected) < np.maximum(5.0 * deviation / np.sqrt(PLACES), 1e-4))


def test_all_orders_send_back_all_light() -> None:
    """Of perfect mirrors and of clear glass; of gold less."""
    mirrors = [
        {"type": OURS["conductor"], **surface.properties, "scattering": "multiple"} for surface in SOME
    ]
    glasses = [bsdf("dielectric", surface, scattering="multiple") for surface in SOME]
    for found in measured([*mirrors, *glasses], 64):
        up = [k for k, degrees in enumerate(DEGREES) if degrees < 90.0]
        np.testing.assert_allclose(found[up, 0], 1.0, atol=2e-4)
    metal = Surface("ggx", (0.8,))
    (found,) = measured([bsdf("conductor", metal, scattering="multiple")], 512)
    expected, error = ours("conductor", metal, scattering="multiple").albedo(
        WI, n=20_000, rng=1, with_error=True
    )
    away = np.abs(found[:, 0, 0] - expected)
    assert np.all(away < 5.0 * np.hypot(error, found[:, 1, 0] / np.sqrt(512)) + 1e-4)


def test_the_aov_integrator_shows_it() -> None:
    """At roughness 0.05, where eval times pi in the direction of the normal is 55."""
    code = """
import numpy as np
metal = {"type": "microfacet_conductor", "alpha": 0.05, "material": "Au"}
film = {"type": "hdrfilm", "width": 16, "height": 16, "pixel_format": "rgb"}
picture = mi.render(mi.load_dict({
    "type": "scene",
    "integrator": {"type": "aov", "aovs": "albedo:albedo"},
    "sensor": {"type": "perspective", "fov": 20, "film": film,
               "to_world": mi.ScalarTransform4f().look_at([0, 0, 4], [0, 0, 0], [0, 1, 0])},
    "shape": {"type": "sphere", "bsdf": metal},
}), spp=16)
print(*np.array(picture)[6:10, 6:10, -3:].mean(axis=(0, 1)))
"""
    red, green, blue = map(float, mitsuba_process.run(code, VARIANT).split())
    assert 0.9 < red < 1.0
    assert red > green > blue > 0.2
