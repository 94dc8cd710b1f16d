"""Derivatives of the Mitsuba plugins by roughness and shape, beside differences of this library's values."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import microfacet as mf
import mitsuba_answers
from material_cases import Array, directions
from mitsuba_cases import GLASS, NAMES, OURS, Surface

N = 4000
STEP = 1e-4  # relative, of differences in double precision
ETA, K = 0.2, 3.9
Key = tuple[str, Surface, str]


def parameters(surface: Surface) -> list[str]:
    """As `mitsuba.traverse` names them."""
    alphas = ["alpha.value"] if len(surface.alpha) == 1 else ["alpha_u.value", "alpha_v.value"]
    return alphas + ([NAMES[surface.family]] if surface.shape is not None else [])


ROUND = [
    *(Surface(family, (0.3,)) for family in ("beckmann", "ggx", "k0")),
    *(Surface("gtr", (0.3,), gamma) for gamma in (0.5, 1.0, 2.5)),
    *(Surface("student_t", (0.3,), gamma) for gamma in (1.8, 3.0)),
    Surface("bessel_k", (0.3,), 0.7),
]
STRETCHED = [
    Surface("beckmann", (0.2, 0.5)),
    Surface("ggx", (0.2, 0.5)),
    Surface("student_t", (0.2, 0.5), 3.0),
    Surface("bessel_k", (0.2, 0.5), 3.0),
]
KEYS: list[Key] = [
    ("conductor", surface, name) for surface in ROUND + STRETCHED for name in parameters(surface)
]
KEYS += [("dielectric", surface, parameters(surface)[-1]) for surface in (ROUND[1], ROUND[2], ROUND[7])]

WI, WO = directions(N, 1).astype(np.float32), directions(N, 2).astype(np.float32)
WI[: N // 2, 2] = np.abs(WI[: N // 2, 2])  # more of them are seen from above
XI = np.random.default_rng(3).random((N, 3)).astype(np.float32)


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Any]]:
    queries = {}
    for material, surface, name in KEYS:
        constants: dict[str, Any] = {"int_ior": GLASS, "ext_ior": 1.0}
        if material == "conductor":
            constants = {key: {"type": "uniform", "value": value} for key, value in (("eta", ETA), ("k", K))}
        bsdf = {"type": OURS[material], **surface.properties, **constants}
        queries[f"{material} {surface} {name}"] = {"bsdf": bsdf, "derivative": name}
    folder = tmp_path_factory.mktemp("derivatives")
    return mitsuba_answers.ask(queries, "llvm_ad_rgb", folder, wi=WI, wo=WO, xi=XI, uv=np.zeros((N, 2)))


def changed(surface: Surface, name: str, factor: float) -> Surface:
    if name == "alpha_v.value":
        return replace(surface, alpha=(surface.alpha[0], surface.alpha[1] * factor))
    if name.startswith("alpha"):
        return replace(surface, alpha=(surface.alpha[0] * factor, *surface.alpha[1:]))
    assert surface.shape is not None
    return replace(surface, shape=surface.shape * factor)


def logarithmic(material: str, surface: Surface, name: str, wo: Array) -> tuple[Array, Array]:
    """The value for WI and `wo`, and its derivative by the logarithm of the parameter."""

    def value(of: Surface) -> Array:
        made = mf.Conductor(of.ndf, ETA, K) if material == "conductor" else mf.Dielectric(of.ndf, GLASS)
        return np.asarray(made.eval(WI.astype(np.float64), wo.astype(np.float64)))

    more, less = (value(changed(surface, name, 1.0 + sign * STEP)) for sign in (1.0, -1.0))
    return value(surface), (more - less) / (2.0 * STEP)


def size(surface: Surface, name: str) -> float:
    if name.startswith("alpha"):
        return surface.alpha[1 if name == "alpha_v.value" else 0]
    assert surface.shape is not None
    return surface.shape


@pytest.mark.parametrize("key", KEYS, ids=lambda key: " ".join(map(str, key)))
def test_derivatives_are_differences_of_our_values(answers: dict[str, Any], key: Key) -> None:
    """Of values, relative to the value; and of weights of samples, whose directions stand still."""
    material, surface, name = key
    found, scale = answers[" ".join(map(str, key))], size(surface, name)
    value, expected = logarithmic(material, surface, name, WO)
    derivative = found["d_eval"][:, 0] * scale
    ordinary = value > 1e-4
    assert np.sum(ordinary) > 200
    away = np.abs(derivative - expected)[ordinary] / value[ordinary]
    assert np.median(np.abs(expected[ordinary]) / value[ordinary]) > 1e-2, "there is something to derive"
    assert np.median(away) < 1e-5
    assert np.quantile(away, 0.98) < 1e-3

    value, expected = logarithmic(material, surface, name, found["wo"])
    ordinary = (found["sample_pdf"] > 1e-3) & (value > 1e-4)
    assert np.sum(ordinary) > 200
    product = found["d_weight"][:, 0] * found["sample_pdf"] * scale
    away = np.abs(product - expected)[ordinary] / value[ordinary]
    assert np.median(away) < 1e-4
    assert np.quantile(away, 0.95) < 1e-2
