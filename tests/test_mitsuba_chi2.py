"""The plugins' samplers before Mitsuba's chi-square harness; the full grid is tools/measure_mitsuba.py."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import mitsuba_cases
import mitsuba_process
from mitsuba_cases import ALPHAS, FAMILIES, OURS, STRETCHED, Case

ARRAYS = mitsuba_cases.selection()
SCALAR = mitsuba_cases.selection()[::2]
TESTS = len(ARRAYS) + len(SCALAR)
CODE = """
import json
sys.path.insert(0, sys.argv[1])
import mitsuba_chi2
mitsuba_chi2.report(json.loads(sys.argv[2]), int(sys.argv[3]))
"""


def outcomes(cases: list[Case], variant: str) -> dict[str, Any]:
    names = json.dumps([str(case) for case in cases])
    lines = mitsuba_process.run(CODE, variant, str(Path(__file__).parent), names, str(TESTS))
    return {found["name"]: found for found in map(json.loads, lines.splitlines())}


@pytest.fixture(scope="module")
def arrays() -> dict[str, Any]:
    return outcomes(ARRAYS, "llvm_ad_rgb")


@pytest.fixture(scope="module")
def scalar() -> dict[str, Any]:
    return outcomes(SCALAR, "scalar_rgb")


def test_the_selection_meets_everything() -> None:
    assert {(case.material, case.surface.family) for case in ARRAYS} == {
        (m, f) for m in OURS for f in FAMILIES
    }
    assert {case.degrees for case in ARRAYS} == set(mitsuba_cases.angles("dielectric"))
    assert {case.surface.alpha for case in ARRAYS} == {*((alpha,) for alpha in ALPHAS), *STRETCHED}
    assert {case.surface.family for case in SCALAR} == set(FAMILIES)


@pytest.mark.parametrize("case", ARRAYS, ids=str)
def test_samples_follow_the_density(arrays: dict[str, Any], case: Case) -> None:
    found = arrays[str(case)]
    assert found["passed"], found["messages"]
    assert found["mass"] == pytest.approx(found["drawn"], abs=3e-3)


@pytest.mark.parametrize("case", SCALAR, ids=str)
def test_samples_of_a_scalar_variant_follow_the_density(scalar: dict[str, Any], case: Case) -> None:
    found = scalar[str(case)]
    assert found["passed"], found["messages"]


def test_the_harness_sees_a_wrong_density() -> None:
    """Adaptive cells have not blunted it: a roughness that is 4 % off fails."""
    code = """
sys.path.insert(0, sys.argv[1])
import mitsuba_chi2, mitsuba_cases
from mitsuba.chi2 import BSDFAdapter, SphericalDomain
case = mitsuba_cases.Case("conductor", mitsuba_cases.Surface("k0", (0.3,)), 30.0)
rough = mitsuba_cases.Case("conductor", mitsuba_cases.Surface("k0", (0.312,)), 30.0)
wi = [0.5, 0.0, 0.75**0.5]
sample, _ = BSDFAdapter(case.plugin, case.properties, wi=wi)
_, density = BSDFAdapter(rough.plugin, rough.properties, wi=wi)
test = mitsuba_chi2.Adaptive(SphericalDomain(), sample, density, 3)
print(test.run(0.01, 100, quiet=True), test.p_value)
"""
    verdict, p_value = mitsuba_process.run(code, "llvm_ad_rgb", str(Path(__file__).parent)).split()
    assert verdict == "False"
    assert float(p_value) < 1e-6
