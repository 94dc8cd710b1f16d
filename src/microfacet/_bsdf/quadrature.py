"""Light that leaves after one facet, as an integral over the facets' slopes.

An integral over directions would have to find the lobe, while the distribution says where the normals are.
`panels.py` cuts the plane of slopes into pieces on which the integrand is smooth, for Gauss's rule.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._bsdf.arguments import flag
from microfacet._bsdf.kernels import MaterialKernels
from microfacet._bsdf.panels import Panels, panels
from microfacet._bsdf.visible_means import means_of_visible, needs_means
from microfacet._threads import in_threads

__all__ = ["Escaped", "escaped"]

Array = NDArray[np.float64]

_AGREED = 1e-7  # the difference of two levels; the error of the finer one is far below it
_LEVELS = 6
_DIRECTIONS = 32  # at a time on the coarsest level, with
_NODES = 1 << 16  # nodes at most a thread, of which
_TOGETHER = 1 << 12  # are evaluated at a time: their arrays stay in the cache


class Escaped(NamedTuple):
    """Parts of the light, of shape (directions, channels), and the difference of the last two levels."""

    reflected: Array
    passed: Array
    error: Array


def escaped(material: MaterialKernels, wi: Array) -> Escaped:
    """Parts of the light from `wi` (directions, 3), not along the surface, that leave after one facet."""
    if needs_means(material):
        parts, differences = means_of_visible(material, wi)
        return Escaped(parts[:, 0], parts[:, 1], differences)
    channels = int(np.prod(material._channels, dtype=np.int64))
    found = np.zeros((len(wi), 2, channels))
    error = np.full((len(wi), channels), np.inf)
    open_ = np.arange(len(wi))
    for level in range(_LEVELS):
        size = max(1, _DIRECTIONS >> level)
        groups = [open_[first : first + size] for first in range(0, len(open_), size)]
        finer_level = partial(_level, material, level=level, channels=channels)
        results = in_threads(finer_level, [wi[some] for some in groups])
        for some, finer in zip(groups, results, strict=True):
            if level > 0:
                error[some] = np.abs(finer - found[some]).max(axis=1)
            found[some] = finer
        open_ = open_[~(error[open_] <= _AGREED).all(axis=1)]
    return Escaped(found[:, 0], found[:, 1], error)


def _level(material: MaterialKernels, wi: Array, level: int, channels: int) -> Array:
    """Reflected and passed, (directions, 2, channels), by rules that get finer with the level."""
    nodes, weights = np.polynomial.legendre.leggauss(8 + 4 * level)
    nodes, weights = (nodes + 1) / 2, weights / 2
    critical = _critical(material, wi)
    above = np.where(wi[:, 2:] < 0, -wi, wi)  # the kernels' coordinates
    result = np.zeros((len(wi), 2, channels))
    for passes in (False, True) if material._transmits else (False,):
        pieces = panels(material.ndf, above, critical, passes, level)
        each = len(nodes) * channels
        integrate = partial(_integrate, material, wi, passes=passes, nodes=nodes, weights=weights)
        parts = in_threads(partial(_in_parts, integrate, each), _cut(pieces, _NODES // each))
        sums = np.concatenate([np.zeros((0, channels)), *(some for part in parts for some in part)])
        for channel in range(channels):  # in one sum, which is the same however the parts were cut
            result[:, int(passes), channel] = np.bincount(pieces.direction, sums[:, channel], len(wi))
    return result


def _in_parts(integrate: Callable[[Panels], Array], each: int, pieces: Panels) -> list[Array]:
    return [integrate(some) for some in _cut(pieces, _TOGETHER // each)]


def _cut(pieces: Panels, size: int) -> list[Panels]:
    size = max(1, size)
    return [pieces.cut(first, first + size) for first in range(0, len(pieces.weight), size)]


def _critical(material: MaterialKernels, wi: Array) -> Array:
    """Cosine of the angle beyond which a facet reflects all; 0 where there is none."""
    if not material._transmits:
        return np.zeros(len(wi))
    eta = float(material._constants[0])
    relative = np.where(wi[:, 2] > 0, eta, 1 / eta)
    return np.asarray(np.sqrt(np.maximum(0.0, 1 - relative**2)))


def _integrate(
    material: MaterialKernels, wi: Array, pieces: Panels, passes: bool, nodes: Array, weights: Array
) -> Array:
    """The integral over each panel, (panels, channels)."""
    # Where a square root or a power ends, s = v^2 (3 - 2 v) makes it smooth.
    singular = pieces.singular[:, np.newaxis]
    at = np.where(singular, nodes**2 * (3 - 2 * nodes), nodes)
    jacobian = np.where(singular, 6 * nodes * (1 - nodes), 1.0) * weights
    width = (pieces.end - pieces.begin)[:, np.newaxis]
    r = np.exp(pieces.begin[:, np.newaxis] + width * at)
    p, q = pieces.along_x[:, np.newaxis] * r, pieces.along_y[:, np.newaxis] * r
    z = 1 / np.sqrt(1 + p * p + q * q)
    directions = [np.broadcast_to(w[pieces.direction, np.newaxis], r.shape) for w in wi.T]
    correlated = flag(getattr(material, "correlated", True))
    light = material._of("facets", [*directions, -p * z, -q * z, z], [correlated])[int(passes)]
    measure = jacobian * width * r * r * z**3 * pieces.weight[:, np.newaxis]  # dm = z^3 dp dq
    return np.asarray(np.einsum("ij,ijc->ic", measure, light.reshape(*r.shape, -1)))
