"""Distributions, materials and directions that the tests of materials share."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import microfacet as mf
from shapes import one_shape

Array = NDArray[Any]

SHAPES = one_shape({"gtr": 1.5, "student_t": 2.5, "bessel_k": 0.7, "generalised_exponential": 3.0})
COPPER = ([0.2, 1.04, 1.18], [3.9, 2.6, 2.4])
ETAS = (1.5, 0.7)


def of_family(name: str, alpha: float) -> Any:
    """An isotropic distribution of the family `name`."""
    family = next(f for f in mf.families() if f.name == name)
    return family.cls(alpha=alpha, **SHAPES[name])


def stretched(name: str, alpha_x: float = 0.3, alpha_y: float = 0.6, rotation: float = 0.4) -> Any:
    """One that is anisotropic and turned, where the family can be; else of the rounder axis."""
    family = next(f for f in mf.families() if f.name == name)
    if not family.anisotropic:
        return of_family(name, alpha_x)
    # No steeper slopes than GGX's, of which quadrature finds nearly all.
    steep = float(family.kernels.sample_slope(0.9, 1.0, *SHAPES[name].values()))
    part = min(1.0, 3.0 / steep)
    return family.cls(alpha_x=part * alpha_x, alpha_y=part * alpha_y, rotation=rotation, **SHAPES[name])


FAMILIES = [family.name for family in mf.families() if not family.singular]


def towards(degrees: float, azimuth: float = 0.0) -> Array:
    """A unit direction; exact where the angle is 0, 90 or 180."""
    s, c = np.sin(np.radians(degrees)), np.sin(np.radians(90.0 - degrees))
    return np.array([s * np.cos(np.radians(azimuth)), s * np.sin(np.radians(azimuth)), c])


def directions(n: int, seed: int = 1, side: int = 0) -> Array:
    """Evenly over the sphere, or over one side of it."""
    w = np.random.default_rng(seed).normal(size=(n, 3))
    w /= np.linalg.norm(w, axis=-1, keepdims=True)
    if side:
        w[:, 2] = side * np.abs(w[:, 2])
    return w


def mirrored(wi: Array, m: Array) -> Array:
    return np.asarray(2.0 * np.sum(wi * m, axis=-1, keepdims=True) * m - wi)


def unit(v: Array) -> Array:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def absorbing(ndf: Any) -> dict[str, Any]:
    return {
        "metal": mf.Conductor(ndf, 0.2, 3.9, scattering="multiple"),
        "dark metal": mf.Conductor(ndf, 1.4, 0.3, scattering="multiple"),
        "glass": mf.Dielectric(ndf, 1.5, scattering="multiple", mode="importance"),
        "glass, radiance": mf.Dielectric(ndf, 1.5, scattering="multiple"),
        "diffuse": mf.Diffuse(ndf, 0.6),
    }


def mean(x: Array, scale: Any = 1.0) -> tuple[Array, Array]:
    """The mean of estimates along the first axis, and its standard error."""
    values = np.asarray(x, np.float64) * scale
    return values.mean(axis=0), values.std(axis=0) / np.sqrt(len(values))


def agree(a: tuple[Array, Array], b: tuple[Array, Array]) -> None:
    """Two means, each with its error."""
    distance = np.abs(a[0] - b[0]) / np.maximum(np.hypot(a[1], b[1]), 1e-300)
    assert np.all(np.where(a[0] == b[0], 0.0, distance) < 4.0), (a, b, distance)


def materials(family: str, scattering: str = "single") -> list[Any]:
    ndf = stretched(family)
    found = [
        mf.Conductor(ndf, 0.2, 3.9, scattering=scattering),
        mf.Dielectric(ndf, 1.5, mode="importance", scattering=scattering),
        mf.Dielectric(ndf, 0.1, scattering=scattering),
        mf.Dielectric(ndf, 1.0, scattering=scattering),
        mf.Diffuse(ndf, 0.9, scattering=scattering),
    ]
    return [
        material for material in found if scattering == "multiple" or not isinstance(material, mf.Diffuse)
    ]
