"""Directions and materials that the tests of the plugins' parameters share."""

from __future__ import annotations

import numpy as np

from material_cases import directions

LLVM, SCALAR = "llvm_ad_rgb", "scalar_rgb"
N = 300
WI, WO = directions(N, 1).astype(np.float32), directions(N, 2).astype(np.float32)
WI[:, 2], WO[:, 2] = np.abs(WI[:, 2]), np.abs(WO[:, 2])
INPUTS = {
    "wi": WI,
    "wo": WO,
    "xi": np.random.default_rng(3).random((N, 3)).astype(np.float32),
    "uv": np.random.default_rng(4).random((N, 2)).astype(np.float32),
}
METAL = {name: {"type": "uniform", "value": value} for name, value in (("eta", 0.2), ("k", 3.9))}
STUDENT = {"distribution": "student_t"}
