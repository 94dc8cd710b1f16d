"""Pictures by the Mitsuba plugins: beside its own, in a white furnace, and their derivatives."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import microfacet as mf
import mitsuba_process
from material_cases import directions
from mitsuba_cases import BUILT_IN, GLASS, OURS, Surface

LLVM = "llvm_ad_rgb"
CODE = """
sys.path.insert(0, sys.argv[1])
import mitsuba_images
mitsuba_images.report(*sys.argv[2:])
"""
METAL = {name: {"type": "uniform", "value": value} for name, value in (("eta", 0.2), ("k", 3.9))}
GLASSES = {"int_ior": GLASS, "ext_ior": 1.0}
CONSTANTS: dict[str, dict[str, Any]] = {"conductor": METAL, "dielectric": GLASSES}


def measured(function: str, *arguments: Any) -> Any:
    folder = str(Path(__file__).parent)
    return mitsuba_process.result(CODE, LLVM, folder, function, json.dumps(arguments))


# --- beside Mitsuba's ---

PAIRS = [(material, family) for material in OURS for family in ("ggx", "beckmann")]


@pytest.fixture(scope="module")
def comparisons() -> dict[tuple[str, str], Any]:
    pairs = []
    for material, family in PAIRS:
        theirs = {"type": BUILT_IN[material], "distribution": family, "alpha": 0.3, **CONSTANTS[material]}
        pairs.append([{**theirs, "type": OURS[material], "correlated": False}, theirs])
    return dict(zip(PAIRS, measured("compare", pairs, 24, 32), strict=True))


@pytest.mark.parametrize("pair", PAIRS, ids="-".join)
def test_pictures_are_those_of_the_built_in_plugin(comparisons: Any, pair: tuple[str, str]) -> None:
    """In each of 64 parts of the picture, whose errors are known from 24 independent pictures."""
    found = comparisons[pair]
    assert found["largest"] < 4.0
    assert found["spread"] < 1.3
    assert found["precision"] < 0.02, "so that a wrong material would show"


# --- all orders of scattering ---

ROUGH = [
    Surface("beckmann", (0.8,)),
    Surface("ggx", (0.3, 0.9)),
    Surface("gtr", (0.6,), 1.5),
    Surface("student_t", (0.8,), 2.0),
    Surface("k0", (0.5,)),
    Surface("bessel_k", (0.8,), 1.5),
]
FURNACES = [(material, surface) for k, material in enumerate(OURS) for surface in ROUGH[k::2]]


@pytest.fixture(scope="module")
def furnaces() -> dict[Any, Any]:
    """Of perfect mirrors and glass, with scattering of one order and of all."""
    found: dict[Any, Any] = {}
    for scattering, chosen, seeds, samples in (
        ("single", FURNACES[::4], 4, 8),
        ("multiple", FURNACES, 16, 64),
    ):
        bsdfs = [
            {"type": OURS[material], **surface.properties, "scattering": scattering}
            for material, surface in chosen
        ]
        outcomes = measured("furnaces", bsdfs, seeds, samples, 200)
        found.update({(scattering, *key): outcome for key, outcome in zip(chosen, outcomes, strict=True)})
    return found


@pytest.mark.parametrize(("material", "surface"), FURNACES, ids=str)
def test_a_white_furnace_closes(furnaces: Any, material: str, surface: Surface) -> None:
    found = furnaces["multiple", material, surface]
    assert abs(found["mean"] - 1.0) < 4.0 * found["error"]
    assert found["error"] < 1e-2
    assert found["farthest"] < 6.0  # of Student's t of 15 degrees, in 16 parts of the picture


@pytest.mark.parametrize(("material", "surface"), FURNACES[::4], ids=str)
def test_scattering_of_one_order_loses_light(furnaces: Any, material: str, surface: Surface) -> None:
    """What the furnace would not see if `scattering` were ignored."""
    assert furnaces["single", material, surface]["mean"] < 0.93


@pytest.mark.parametrize(("material", "surface"), FURNACES[1::3], ids=str)
def test_the_expectation_of_eval_is_ours(material: str, surface: Surface) -> None:
    wi = directions(8, 1, +1).astype(np.float32)
    wo = directions(8, 2, +1 if material == "conductor" else 0).astype(np.float32)
    bsdf = {"type": OURS[material], **surface.properties, **CONSTANTS[material], "scattering": "multiple"}
    mean, error = map(np.array, measured("expectations", bsdf, wi.tolist(), wo.tolist(), 20_000))
    options = {"scattering": "multiple"}
    ours: Any = (
        mf.Conductor(surface.ndf, 0.2, 3.9, **options)
        if material == "conductor"
        else mf.Dielectric(surface.ndf, GLASS, **options)
    )
    i, o = wi.astype(np.float64), wo.astype(np.float64)
    parts = np.array([ours.eval(i, o, n=2000, rng=seed) for seed in range(10)])
    both = np.hypot(error, parts.std(axis=0, ddof=1) / np.sqrt(len(parts)))
    assert np.all(np.abs(mean - parts.mean(axis=0)) < 4.5 * both)
    assert np.median(error / mean) < 0.1


# --- derivatives ---


@pytest.mark.parametrize(
    ("bsdf", "names"),
    [
        (
            {"type": OURS["conductor"], **Surface("student_t", (0.3,), 2.5).properties},
            ["alpha.value", "gamma"],
        ),
        ({"type": OURS["dielectric"], **Surface("ggx", (0.3,)).properties, **GLASSES}, ["alpha.value"]),
    ],
)
def test_derivatives_of_pictures_are_differences_of_pictures(bsdf: dict[str, Any], names: list[str]) -> None:
    """By prb, and by pictures of the same random numbers with a parameter 1 % up and down."""
    for name, (difference, error, derivative, own) in measured("gradients", bsdf, names, 0.01, 64).items():
        assert abs(derivative - difference) < 4.0 * np.hypot(error, own), name
        assert np.hypot(error, own) < 0.05 * abs(difference), name
