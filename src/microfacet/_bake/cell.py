"""The part of a table with one roughness, one shape and one eta."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from microfacet._bake.recipe import Recipe
from microfacet._bsdf.quadrature import escaped
from microfacet._bsdf.split_sum import SchlickParts

__all__ = ["compute"]

Array = NDArray[np.float64]


def compute(recipe: Recipe, cell: int) -> dict[str, Array]:
    """Results by name; the same for a cell wherever, whenever and next to whatever it is computed."""
    computed = {"albedo": _albedo, "energy": _energy, "split_sum": _split_sum, "bsdf": _bsdf}
    values = computed[recipe.kind](recipe, cell)
    return {name: np.asarray(values[name], np.float64) for name in recipe.variables}


def _seed(recipe: Recipe, cell: int) -> int:
    """Of the walks in a cell."""
    return int(np.random.SeedSequence([recipe.seed, cell]).generate_state(1, np.uint64)[0] >> np.uint64(11))


def _directions(cosine: Array) -> Array:
    return np.stack((np.sqrt(1 - cosine**2), np.zeros_like(cosine), cosine), -1)


def _albedo(recipe: Recipe, cell: int) -> dict[str, Array]:
    wi = _directions(np.array(recipe.cos_theta))
    once = escaped(recipe.optics(cell, "single"), wi)
    walks = {"n": recipe.walks, "rng": _seed(recipe, cell), "with_error": True}
    material = recipe.optics(cell, "multiple")
    if recipe.material == "conductor":
        value, error = material.albedo(wi, **walks)
        return {"single": once.reflected[:, 0], "multiple": value, "multiple_error": error}
    value, error = material.albedo(wi, part="reflected", **walks)
    return {
        "single_reflected": once.reflected[:, 0],
        "single_transmitted": once.passed[:, 0],
        "multiple_reflected": value,
        "multiple_transmitted": 1 - value,  # a walk loses nothing
        "multiple_error": error,
    }


def _energy(recipe: Recipe, cell: int) -> dict[str, Array]:
    material = recipe.optics(cell, "single")
    missing = 1 - material.albedo(_directions(np.array(recipe.cos_theta)))
    return {"missing": missing, "missing_average": 1 - material.average_albedo()}


def _split_sum(recipe: Recipe, cell: int) -> dict[str, Array]:
    found = escaped(SchlickParts(recipe.ndf(cell)), _directions(np.array(recipe.cos_theta))).reflected
    return {"scale": found[:, 0], "bias": found[:, 1]}


def _bsdf(recipe: Recipe, cell: int) -> dict[str, Array]:
    cos_i, cos_o, azimuth = np.meshgrid(*recipe.inner.values(), indexing="ij")
    sine = np.sqrt(1 - cos_o**2)
    wi, wo = _directions(cos_i), np.stack((sine * np.cos(azimuth), sine * np.sin(azimuth), cos_o), -1)
    material = recipe.optics(cell, recipe.scattering)
    walks = {"n": recipe.walks, "rng": _seed(recipe, cell)} if recipe.scattering == "multiple" else {}
    return {"f": material.eval(wi, wo, **walks) / np.abs(cos_o)}
