"""Samplers and densities that the tests of `testing` share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
QUICK: dict[str, Any] = {"n": 100_000, "resolution": (16, 16)}


def towards(degrees: float, azimuth: float = 0.0) -> Array:
    theta, phi = np.radians(degrees), np.radians(azimuth)
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def caps(w: Array, alpha: float) -> Callable[[Array], Array]:
    """Visible normals of GGX by spherical caps (dupuy2023sampling), without the library."""
    stretched = w * [alpha, alpha, 1.0]
    stretched /= np.linalg.norm(stretched)

    def sample(xi: Array) -> Array:
        z = (1.0 - xi[:, 0]) * (1.0 + stretched[2]) - stretched[2]
        s, phi = np.sqrt((1.0 - z) * (1.0 + z)), 2.0 * np.pi * xi[:, 1]
        m = np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1) + stretched
        m *= [alpha, alpha, 1.0]
        return np.asarray(m / np.linalg.norm(m, axis=-1, keepdims=True))

    return sample


def cosine(xi: Array) -> Array:
    s, phi = np.sqrt(xi[:, 0]), 2.0 * np.pi * xi[:, 1]
    return np.stack([s * np.cos(phi), s * np.sin(phi), np.sqrt(1.0 - s**2)], axis=-1)


def lambert(m: Array) -> Array:
    return np.asarray(m[..., 2] / np.pi)
