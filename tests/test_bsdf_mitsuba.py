"""Single scattering against Mitsuba 3, whose masking is Smith's product and whose Beckmann G1 is a fit."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import microfacet as mf
import mitsuba_process
from limits import HANG
from material_cases import Array, directions, unit

EXACT = 1e-5  # of single precision
FIT = 0.0035  # of one G1 of its Beckmann
SHAPE = {"alpha_x": 0.2, "alpha_y": 0.5}
METAL = ([0.2, 1.04, 1.18], [3.9, 2.6, 2.4])
ETA = 1.5
N = 8000
DISTRIBUTIONS = {"ggx": mf.GGX(**SHAPE), "beckmann": mf.Beckmann(**SHAPE)}

each_family = pytest.mark.parametrize("family", DISTRIBUTIONS)

WI, WO = directions(N, 1).astype(np.float32), directions(N, 2).astype(np.float32)
I, O = WI.astype(np.float64), WO.astype(np.float64)  # noqa: E741
METAL_PAIRS = (I[:, 2] > 0.0) & (O[:, 2] > 0.0)


@pytest.fixture(scope="module")
def mitsuba(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Its values, computed in another process."""
    mitsuba_process.require("llvm_ad_rgb")
    folder = tmp_path_factory.mktemp("mitsuba")
    np.savez(folder / "directions.npz", wi=WI, wo=WO)
    script = Path(__file__).with_name("mitsuba_values.py")
    command = [sys.executable, str(script), str(folder / "directions.npz"), str(folder / "values.npz")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=HANG)
    assert done.returncode == 0, done.stderr
    return dict(np.load(folder / "values.npz"))


def deviation(value: Array, expected: Array) -> float:
    ordinary = expected > 1e-5
    assert np.sum(ordinary) > 60
    return float(np.max(np.abs(value[ordinary] / expected[ordinary] - 1.0)))


@each_family
def test_metal(mitsuba: Any, family: str) -> None:
    metal = mf.Conductor(DISTRIBUTIONS[family], *METAL, correlated=False)
    expected, value = metal.eval(I, O), mitsuba[f"{family}-metal"]
    assert deviation(value[METAL_PAIRS], expected[METAL_PAIRS]) < (EXACT if family == "ggx" else 2.0 * FIT)
    assert np.all(value[~METAL_PAIRS] == 0.0)
    assert np.all(expected[~METAL_PAIRS] == 0.0)
    density = metal.pdf(I, O)[METAL_PAIRS]
    assert deviation(mitsuba[f"{family}-metal-pdf"][METAL_PAIRS], density) < (
        EXACT if family == "ggx" else FIT
    )


def well_conditioned(side: Array, through: Array) -> Array:
    """Apart from the critical angle and grazing facets, where cosines in single precision lose digits."""
    eta = np.where(side > 0.0, ETA, 1.0 / ETA)
    m = unit(np.where(through[:, None], I + eta[:, None] * O, I + O))
    i, o = np.abs(np.sum(I * m, axis=-1)), np.abs(np.sum(O * m, axis=-1))
    return np.asarray((np.abs(eta**2 - 1.0 + i**2) > 0.02) & (np.minimum(i, o) > 0.1))


@each_family
@pytest.mark.parametrize("mode", ["radiance", "importance"])
def test_glass(mitsuba: Any, family: str, mode: str) -> None:
    glass = mf.Dielectric(DISTRIBUTIONS[family], ETA, mode=mode, correlated=False)
    expected, value = glass.eval(I, O), mitsuba[f"{family}-{mode}"]
    through = I[:, 2] * O[:, 2] < 0.0
    good = well_conditioned(I[:, 2], through)
    for side in (I[:, 2] > 0.0, I[:, 2] < 0.0):
        for kind in (through, ~through):
            chosen = side & kind & good
            assert deviation(value[chosen], expected[chosen]) < (EXACT if family == "ggx" else 2.0 * FIT)


def test_masking_and_shadowing_of_correlated_heights_is_not_the_product(mitsuba: Any) -> None:
    """What the comparison would not see if `correlated` were ignored."""
    ours = mf.Conductor(DISTRIBUTIONS["ggx"], *METAL).eval(I, O)[METAL_PAIRS]
    assert deviation(mitsuba["ggx-metal"][METAL_PAIRS], ours) > 0.05
