"""Albedos: of one order of scattering by quadrature, of all orders by random walks."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._arrays import lifted, numbered
from microfacet._bsdf.arguments import directions_of
from microfacet._bsdf.kernels import WALK, MaterialKernels
from microfacet._bsdf.quadrature import escaped
from microfacet._bsdf.visible_means import (
    about_mean_plane,
    average_of_visible,
    needs_means,
    scale_of_radiance,
)

__all__ = ["albedo", "average_albedo"]

Array = NDArray[np.float64]

PARTS = ("all", "reflected", "transmitted")
_WALKS = 1 << 18  # computed at a time


def albedo(
    material: MaterialKernels, wi: ArrayLike, n: int, seed: Array, part: str, with_error: bool
) -> Any | tuple[Any, Any]:
    """What `Material.albedo` says."""
    owner = f"{type(material).__name__}.albedo"
    _check(owner, part)
    given = directions_of(material, "albedo", wi=wi)
    walks = 0 if _in_closed_form(material) else _count(owner, n)
    if walks:
        given.append(numbered(*given))
    value, error = lifted(partial(_albedo, material, walks, seed, part), *given, results=("", ""))
    return (value, error) if with_error else value


def _albedo(
    material: MaterialKernels, walks: int, seed: Array, part: str, wi: Array, *numbers: Array
) -> tuple[Any, Any]:
    """Values and errors for NumPy arrays; walks also take the number of each direction."""
    directions = material._units(wi.astype(np.float64))[0].reshape(-1, 3)
    if walks == 0:
        value, error = _by_quadrature(material, directions, part)
    else:
        value, error = _by_walks(material, directions, numbers[0].reshape(-1), walks, seed, part)
    shape = (*wi.shape[:-1], *material._channels)
    return value.reshape(shape)[()], error.reshape(shape)[()]


def average_albedo(
    material: MaterialKernels, n: int, seed: Array, side: str, part: str, with_error: bool
) -> Any | tuple[Any, Any]:
    """What `Material.average_albedo` says."""
    owner = f"{type(material).__name__}.average_albedo"
    if side not in ("above", "below"):
        raise ValueError(f'{owner}: side must be "above" or "below", got {side!r}')
    _check(owner, part)
    up = 1.0 if side == "above" else -1.0
    if _in_closed_form(material):
        value, error = _average_by_quadrature(material, up, part)
    else:
        value, error = _average_by_walks(material, _count(owner, n), seed, up, part)
    value, error = value.reshape(material._channels)[()], error.reshape(material._channels)[()]
    return (value, error) if with_error else value


def _in_closed_form(material: MaterialKernels) -> bool:
    return material.scattering == "single" and material._closed


def _check(owner: str, part: str) -> None:
    if part not in PARTS:
        raise ValueError(f"{owner}: part must be one of {', '.join(PARTS)}, got {part!r}")


def _count(owner: str, n: object) -> int:
    if not (isinstance(n, int | np.integer) and n >= 1):
        raise ValueError(f"{owner}: n must be a whole number in [1, inf), got {n!r}")
    return int(n)


def _by_quadrature(material: MaterialKernels, wi: Array, part: str) -> tuple[Array, Array]:
    channels = int(np.prod(material._channels, dtype=np.int64))
    value, error = np.zeros((2, len(wi), channels))
    valid = np.isfinite(wi).all(axis=-1)
    value[~valid] = error[~valid] = np.nan
    # Along the surface, and from below a metal, nothing is scattered.
    height = material._height(wi)
    seen = valid & ((height != 0) if material._transmits else (height > 0))
    if material._transmits and float(material._constants[0]) == 1.0:  # no surface: all goes straight on
        value[seen] = float(part != "reflected")
        return value, error
    found = escaped(material, wi[seen])
    passed = found.passed * scale_of_radiance(material, height[seen])[:, np.newaxis]
    value[seen] = {"all": found.reflected + passed, "reflected": found.reflected, "transmitted": passed}[part]
    error[seen] = found.error
    return value, error


def _average_by_quadrature(material: MaterialKernels, up: float, part: str) -> tuple[Array, Array]:
    if needs_means(material):
        (reflected, passed), error = average_of_visible(material, up)
        passed = passed * scale_of_radiance(material, np.full(1, up))
        return {"all": reflected + passed, "reflected": reflected, "transmitted": passed}[part], error
    before: Array | None = None
    for nodes in (12, 20, 32):
        wi, weights = _hemisphere(material, nodes, up)
        values, errors = _by_quadrature(material, wi, part)
        value, error = weights @ values, weights @ errors
        if before is not None:
            error = error + np.abs(value - before)
            if np.all(error < 1e-6):
                break
        before = value
    return value, error


def _by_walks(
    material: MaterialKernels, wi: Array, numbers: Array, n: int, seed: Array, part: str
) -> tuple[Array, Array]:
    """Means over `n` walks of each direction: walk k of direction i is one and the same whatever n is."""
    channels = int(np.prod(material._channels, dtype=np.int64))
    sums, squares = np.zeros((2, len(wi), channels))
    group = max(1, _WALKS // n)
    for start in range(0, len(wi), group):
        some = slice(start, min(start + group, len(wi)))
        number = numbers[some, np.newaxis] * 2.0**32
        for first in range(0, n, _WALKS):
            elements = number + np.arange(first, min(first + _WALKS, n))
            directions = np.broadcast_to(wi[some, np.newaxis], (*elements.shape, 3))
            weight = _weights(material, directions, seed, elements, part)
            sums[some] += weight.sum(axis=1)
            squares[some] += (weight * weight).sum(axis=1)
    return _mean(sums, squares, n)


def _average_by_walks(
    material: MaterialKernels, n: int, seed: Array, up: float, part: str
) -> tuple[Array, Array]:
    """Walks from directions drawn from cos/pi."""
    sums, squares = np.zeros((2, int(np.prod(material._channels, dtype=np.int64))))
    generator = np.random.default_rng(int(seed))
    for first in range(0, n, _WALKS):
        elements = np.arange(float(first), float(min(first + _WALKS, n)))
        xi = generator.random((len(elements), 2))
        cosine, sine, turn = np.sqrt(1 - xi[:, 0]), np.sqrt(xi[:, 0]), 2 * np.pi * xi[:, 1]
        wi = about_mean_plane(material, np.stack((sine * np.cos(turn), sine * np.sin(turn), up * cosine), -1))
        weight = _weights(material, wi, seed, elements, part)
        sums += weight.sum(axis=0)
        squares += (weight * weight).sum(axis=0)
    return _mean(sums, squares, n)


def _weights(material: MaterialKernels, wi: Array, seed: Array, elements: Array, part: str) -> Array:
    """Weights of walks, (..., channels); 0 where light leaves on another side than the wanted one."""
    parts = [wi[..., 0], wi[..., 1], wi[..., 2]]
    wo, weight, facets = material._of("walk", parts, [elements, seed, material._radiance], WALK)
    if part != "all":
        axes = (np.newaxis,) * len(material._channels)
        side = material._height(wo) * material._height(wi)[(..., *axes)]
        weight = np.where(side > 0 if part == "reflected" else side < 0, weight, 0 * weight)
    if material.scattering == "single":
        weight = np.where(facets == 1, weight, 0 * weight)
    return np.asarray(weight, np.float64).reshape(*elements.shape, -1)


def _mean(sums: Array, squares: Array, n: int) -> tuple[Array, Array]:
    """Mean and its standard error."""
    mean = sums / n
    variance = np.maximum(squares / n - mean**2, 0.0)
    return mean, np.sqrt(variance / max(n - 1, 1))


def _hemisphere(material: MaterialKernels, nodes: int, up: float) -> tuple[Array, Array]:
    """Directions and weights of cos/pi over a hemisphere; only a half circle, and that only with stretch."""
    x, weights = np.polynomial.legendre.leggauss(nodes)
    x, weights = (x + 1) / 2, weights / 2
    cosine, weights = x**3, weights * 6 * x**5  # 2 c dc, with more nodes near the horizon
    stretched = "alpha_x" in material.ndf._names and material.ndf._values[0] != material.ndf._values[1]
    count = nodes // 2 + 2 if stretched else 1
    azimuth = np.arange(count) * np.pi / count
    sine = np.sqrt(1 - cosine**2)[:, np.newaxis]
    wi = np.stack(
        np.broadcast_arrays(sine * np.cos(azimuth), sine * np.sin(azimuth), up * cosine[:, np.newaxis]), -1
    )
    return wi.reshape(-1, 3), np.repeat(weights / count, count)
