"""Angles of a table of a BRDF, and the directions that they mean.

Directions point away from the surface. Seen from the normal, a direction is (theta, phi): the angle from the
normal and the azimuth from +x, counter-clockwise. Seen from the specular direction it is (radial, azimuth):
the angle from the specular direction, and an azimuth about it that is 0 towards the normal.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["angles", "directions", "from_normal", "from_specular", "specular", "symmetric"]

Array = NDArray[np.float64]


def angles(values: ArrayLike, name: str, low: float, high: float, *, closed: bool = True) -> Array:
    """Degrees in ascending order; ValueError names the angle that lies outside."""
    try:
        array: NDArray[Any] = np.atleast_1d(np.asarray(values))
    except ValueError:
        array = np.empty(0, dtype=object)
    if array.ndim != 1 or array.dtype.kind not in "iuf" or array.size == 0:
        raise ValueError(f"{name} must be one angle or several, in degrees, got {values!r:.80}")
    array = array.astype(np.float64)
    good = (array >= low) & ((array <= high) if closed else (array < high))
    if not good.all():
        end = "]" if closed else ")"
        raise ValueError(f"{name} must lie in [{low:g}, {high:g}{end} degrees, got {array[~good][0]:g}")
    if not np.all(np.diff(array) > 0):
        raise ValueError(f"{name} must ascend, got {values!r:.80}")
    return array


def from_normal(theta: ArrayLike, phi: ArrayLike) -> Array:
    """Unit vectors, with an axis of x, y, z at the end; exactly along the normal at 0."""
    t, p = np.radians(theta), np.radians(phi)
    s, c = np.sin(t), np.cos(t)
    return np.stack(np.broadcast_arrays(s * np.cos(p), s * np.sin(p), c), axis=-1)


def specular(wi: Array) -> Array:
    """The mirror image of a direction about the normal."""
    return np.asarray(wi * np.array([-1.0, -1.0, 1.0]))


def from_specular(wi: Array, phi_i: float, radial: ArrayLike, azimuth: ArrayLike) -> Array:
    """Unit vectors at angles from the specular direction of light from `wi`, which has the azimuth `phi_i`.

    The azimuth counts counter-clockwise for an observer towards whom the specular light travels. At normal
    incidence, where "towards the normal" has no meaning, it begins where it does for nearly normal light.
    """
    s = specular(wi)
    p = np.radians(phi_i)
    plane = np.array([np.cos(p), np.sin(p), 0.0])  # light comes from here
    cosine, sine = s[2], float(np.hypot(wi[0], wi[1]))
    up = cosine * plane + np.array([0.0, 0.0, sine])  # across s, towards the normal
    side = np.cross(s, up)
    r, a = np.radians(radial)[..., np.newaxis], np.radians(azimuth)[..., np.newaxis]
    return np.asarray(np.cos(r) * s + np.sin(r) * (np.cos(a) * up + np.sin(a) * side))


def directions(
    theta_i: Array, phi_i: Array, azimuth: Array, polar: Array, reference: str, *, below: bool = False
) -> tuple[Array, Array]:
    """Of the light, (theta_i, phi_i, 3), and of scattered light, (theta_i, phi_i, azimuth, polar, 3)."""
    wi = from_normal(theta_i[:, np.newaxis], phi_i)
    shape = (len(theta_i), len(phi_i), len(azimuth), len(polar), 3)
    if reference == "normal":
        wo = from_normal(polar, azimuth[:, np.newaxis]) * np.array([1.0, 1.0, -1.0 if below else 1.0])
        return wi, np.broadcast_to(wo, shape)
    wo = np.empty(shape)
    for i in range(len(theta_i)):
        for j, phi in enumerate(phi_i):
            wo[i, j] = from_specular(wi[i, j], float(phi), polar, azimuth[:, np.newaxis])
    return wi, wo


def symmetric(ndf: Any, phi_i: Array) -> bool:
    """Whether every plane of incidence is a plane of symmetry of the surface."""
    parameters = ndf.parameters
    if parameters.get("alpha_x") == parameters.get("alpha_y"):
        return True
    turned = np.radians(phi_i) - parameters["rotation"]
    return bool(np.all(np.abs(np.sin(2 * turned)) < 1e-9))
