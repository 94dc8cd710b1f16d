"""The plugins in every variant of Mitsuba, and the code of their page."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import microfacet as mf
import mitsuba_answers
import mitsuba_process
from mitsuba_cases import GLASS, OURS
from mitsuba_parameter_cases import INPUTS, LLVM, METAL, SCALAR, STUDENT, WI, WO, N

I, O = WI.astype(np.float64), WO.astype(np.float64)  # noqa: E741


# --- the page ---


def test_the_code_of_the_document_runs() -> None:
    text = (Path(__file__).parents[1] / "docs" / "mitsuba.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    assert len(blocks) == 3
    mitsuba_process.run("\n".join(blocks), LLVM)
    (described,) = re.findall(r"```xml\n(.*?)```", text, flags=re.DOTALL)
    code = "print(mi.load_string(sys.argv[1].replace('<bsdf', '<bsdf version=\"3.0.0\"', 1)))"
    assert "conductor" in mitsuba_process.run(code, SCALAR, described)


# --- variants ---


@pytest.mark.parametrize("variant", ["scalar_spectral", "llvm_ad_spectral"])
@pytest.mark.parametrize("material", OURS)
def test_spectral_variants(variant: str, material: str, tmp_path: Path) -> None:
    """Four wavelengths at a time, of a metal by its table and of glass; gold is redder than blue."""
    plugin = OURS[material]
    own = {"material": "Au"} if material == "conductor" else {"int_ior": GLASS, "ext_ior": 1.0}
    query = {"bsdf": {"type": plugin, **STUDENT, "gamma": 2.5, "alpha": 0.3, **own}}
    found = mitsuba_answers.ask({"one": query}, variant, tmp_path, **INPUTS)["one"]
    ndf = mf.StudentT(alpha=0.3, gamma=2.5)
    good = np.sum(I * (I + O), axis=-1) / np.linalg.norm(I + O, axis=-1) > 0.1
    if material == "conductor":
        mirror = mf.Conductor(ndf).eval(I, O)
        share = (found["eval"] / mirror[:, None])[good & (mirror > 1e-4)]
        assert found["eval"].shape == (N, 4)
        assert np.all(share < 1.0)
        assert np.all(share[:, -1] > 1.5 * share[:, 0])
    else:
        expected = mf.Dielectric(ndf, GLASS).eval(I, O)
        ordinary = good & (expected > 1e-5)
        for k in range(4):
            np.testing.assert_allclose(found["eval"][ordinary, k], expected[ordinary], rtol=1e-5)


OTHERS = [
    "scalar_spectral_polarized",
    "llvm_ad_mono",
    "llvm_ad_mono_polarized",
    "llvm_ad_spectral_polarized",
]


@pytest.mark.skipif(
    not os.environ.get("MICROFACET_ALL_VARIANTS"),
    reason="each variant is compiled for some ten seconds: set MICROFACET_ALL_VARIANTS",
)
@pytest.mark.parametrize("variant", OTHERS)
def test_the_other_variants(variant: str, tmp_path: Path) -> None:
    """What a Mueller matrix says of unpolarised light stands in its first entry."""
    queries = {
        material: {"bsdf": {"type": plugin, **STUDENT, "gamma": 2.5, "alpha": 0.3, **constants}}
        for (material, plugin), constants in zip(
            OURS.items(), (METAL, {"int_ior": GLASS, "ext_ior": 1.0}), strict=True
        )
    }
    found = mitsuba_answers.ask(queries, variant, tmp_path, **INPUTS)
    ndf = mf.StudentT(alpha=0.3, gamma=2.5)
    ours: dict[str, Any] = {"conductor": mf.Conductor(ndf, 0.2, 3.9), "dielectric": mf.Dielectric(ndf, GLASS)}
    good = np.sum(I * (I + O), axis=-1) / np.linalg.norm(I + O, axis=-1) > 0.1
    for material, answer in found.items():
        expected = ours[material].eval(I, O)
        ordinary = good & (expected > 1e-5)
        value = answer["eval"].reshape(N, -1)[:, 0]
        np.testing.assert_allclose(value[ordinary], expected[ordinary], rtol=2e-5)
        entries = answer["eval"].reshape(N, -1)
        assert np.all(np.abs(entries) <= entries.max(axis=1, keepdims=True) * (1.0 + 1e-5))
