"""Points at which an exported function is measured: the same for every measurement."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet._export.functions import OPTICS

__all__ = ["parameter_sets", "points"]

Array = NDArray[np.float32]


def parameter_sets(
    parameters: Mapping[str, float | None], intervals: Mapping[str, tuple[float, float]], count: int
) -> list[dict[str, float]]:
    """Values of all parameters, numbers of single precision: those that are free are drawn."""
    rng = np.random.default_rng(1)
    sets = []
    for _ in range(count):
        drawn = {name: _drawn(name, intervals[name.partition(".")[0]], rng) for name in parameters}
        fixed = {name: value for name, value in parameters.items() if value is not None}
        sets.append({name: float(np.float32(value)) for name, value in drawn.items()} | fixed)
    return sets


def _drawn(name: str, interval: tuple[float, float], rng: np.random.Generator) -> float:
    """Roughness from 0.01 to 1, shapes that begin a little above their lower end, angles, indices."""
    lower, upper = interval
    draw = rng.random()
    if math.isinf(lower):
        return float(2.0 * math.pi * draw)
    if name.partition(".")[0] in OPTICS:
        # Where nothing refracts, an index of 1, half vectors are small differences.
        return float(1.2 + 2.0 * draw) if math.isinf(upper) else float(lower + (upper - lower) * draw)
    if name.startswith("alpha"):
        return float(10.0 ** (-2.0 * draw))
    return float(min(lower + 10.0 ** (-1.3 + 3.0 * draw), 0.5 * (lower + upper)))


def points(inputs: Sequence[str], roughness: float, count: int) -> dict[str, Array]:
    """Arguments that are no parameters, by the names of their components.

    Normals and slopes are as a surface of this roughness has them, far ones too. Directions lie on the whole
    sphere, not closer than 1e-3 to the horizon.
    """
    rng = np.random.default_rng(2)
    found: dict[str, Any] = {}
    azimuth, near = 2.0 * math.pi * rng.random(count), np.sinh(4.0 * rng.random(count)) / 4.0
    p, q = roughness * near * np.cos(azimuth), roughness * near * np.sin(azimuth)
    found |= {"p": p, "q": q, "r": np.hypot(p, q)}
    found |= _components("m", np.stack([-p, -q, np.ones(count)]))
    for name, lowest in (("wi", 1e-3), ("wo", -1.0), ("w", -1.0)):
        height = rng.uniform(lowest, 1.0, count)
        height = np.where(np.abs(height) < 1e-3, 1e-3, height)
        turn, side = 2.0 * math.pi * rng.random(count), np.sqrt(1.0 - height**2)
        found |= _components(name, np.stack([side * np.cos(turn), side * np.sin(turn), height]))
    uniforms = rng.random((4, count))
    found |= {f"xi.{letter}": uniforms[i] for i, letter in enumerate("xyzw")}
    found["choice"] = rng.random(count)
    below_one = np.nextafter(np.float32(1), np.float32(0))
    return {
        name: np.minimum(found[name].astype(np.float32), below_one) if name.startswith(("xi", "choice"))
        else found[name].astype(np.float32)
        for name in inputs if name in found
    }  # fmt: skip


def _components(name: str, vectors: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    unit = vectors / np.linalg.norm(vectors, axis=0)
    return {f"{name}.{letter}": unit[i] for i, letter in enumerate("xyz")}
