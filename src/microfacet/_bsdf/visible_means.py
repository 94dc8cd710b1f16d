"""Light that leaves after one facet, as a mean over the normals that a direction sees.

Densities that are constant in cells jump, and a ring has none, so that no rule of high order helps; but
normals can be drawn from quasi-random numbers, and what a facet sends out is a share of the light, at most 1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from microfacet._bsdf.arguments import flag
from microfacet._bsdf.kernels import MaterialKernels

__all__ = ["about_mean_plane", "average_of_visible", "means_of_visible", "needs_means", "scale_of_radiance"]

Array = NDArray[np.float64]

_AGREED = 2e-5
# Fibonacci's lattices: about the best rules of as many points in the unit square (H. Niederreiter, Random
# number generation and quasi-Monte Carlo methods, 1992, section 5.3).
_LATTICES = ((4181, 2584), (17711, 10946), (75025, 46368))
_ROOT = 2.0**0.5  # of the choice between reflection and transmission, where samples make it
_AVERAGES = (1 << 14, 1 << 16, 1 << 18)


def needs_means(material: MaterialKernels) -> bool:
    """Whether quadrature has nothing smooth to integrate."""
    return hasattr(material.ndf, "mean_normal") or _is_ring(material)


def _is_ring(material: MaterialKernels) -> bool:
    return bool(getattr(material.ndf.kernels, "singular", False))


def scale_of_radiance(material: MaterialKernels, cosine: Array) -> Array:
    """The factor of radiance that is transmitted: the square of the relative index of refraction."""
    if not material._radiance:
        return np.ones(cosine.shape)
    eta = float(material._constants[0])
    return np.minimum(np.where(cosine > 0, 1 / eta, eta), 1e150) ** 2


def means_of_visible(material: MaterialKernels, wi: Array) -> tuple[Array, Array]:
    """Reflected and passed, (directions, 2, channels), and the difference of the last two lattices."""
    channels = int(np.prod(material._channels, dtype=np.int64))
    found = np.zeros((len(wi), 2, channels))
    error = np.zeros((len(wi), channels))
    for direction, w in enumerate(wi):
        for level, (n, step) in enumerate(_LATTICES):
            number = np.arange(n)
            xi = np.stack(((number + 0.5) / n, np.mod(number * step + 0.5, n) / n, number * _ROOT % 1.0), -1)
            mean = _mean(material, np.broadcast_to(w, (n, 3)), xi)
            error[direction] = np.abs(mean - found[direction]).max(axis=0)
            found[direction] = mean
            if level > 0 and np.all(error[direction] <= _AGREED):
                break
    return found, error


def average_of_visible(material: MaterialKernels, up: float) -> tuple[Array, Array]:
    """The same (2, channels) of light from all sides, of density cos/pi about the mean plane."""
    root = 1.0
    for _ in range(64):  # x^6 = x + 1, whose powers make an even sequence in five dimensions
        root = (1.0 + root) ** (1 / 6)
    steps = root ** -np.arange(1.0, 6.0)
    found = error = np.zeros((2, int(np.prod(material._channels, dtype=np.int64))))
    for level, n in enumerate(_AVERAGES):
        u = np.mod(0.5 + np.arange(1.0, n + 1)[:, np.newaxis] * steps, 1.0)
        radius, turn = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
        wi = np.stack((radius * np.cos(turn), radius * np.sin(turn), up * np.sqrt(1 - u[:, 0])), -1)
        mean = _mean(material, about_mean_plane(material, wi), u[:, 2:])
        error, found = np.abs(mean - found), mean
        if level > 0 and np.all(error <= _AGREED):
            break
    return found, error.max(axis=0)


def _mean(material: MaterialKernels, wi: Array, xi: Array) -> Array:
    n = len(xi)
    if _is_ring(material):  # its samples alone have numbers
        wo, drawn, _ = material._sample(False, wi, xi[:, : material.sample_dims])
        through = (material._height(wi) * material._height(wo) < 0)[:, np.newaxis]
        sent = drawn.reshape(n, -1) / n
        scale = scale_of_radiance(material, material._height(wi))[:, np.newaxis]
        return np.stack(
            [np.where(through, 0.0, sent).sum(axis=0), np.where(through, sent / scale, 0.0).sum(axis=0)]
        )
    above = np.where(material._height(wi)[:, np.newaxis] > 0, wi, -wi)
    m = material.ndf.sample_visible(above, xi[:, :2])
    density = np.asarray(material.ndf.D_visible(m, above))
    light = material._of("facets", [*wi.T, *m.T], [flag(getattr(material, "correlated", True))])
    # A facet at the edge of a cell may have no density but for rounding; it is left out.
    weight = np.where(density > 0, 1 / np.where(density > 0, density, 1.0), 0.0) / n
    return np.stack([weight @ np.asarray(part).reshape(n, -1) for part in light])


def about_mean_plane(material: MaterialKernels, w: Array) -> Array:
    """Directions about +z, turned so that they lie about the normal of the mean plane."""
    normal = getattr(material.ndf, "mean_normal", None)
    if normal is None:
        return w
    x, y, z = normal
    s = 1 / (1 + z)
    turned: Array = w @ np.array(
        [[1 - x * x * s, -x * y * s, -x], [-x * y * s, 1 - y * y * s, -y], [x, y, z]]
    )
    return turned
