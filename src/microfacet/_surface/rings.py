"""The frequency plane of a map by ring and by direction: where the power of its Fourier coefficients lies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft, ndimage

from microfacet._surface.height_map import HeightMap

__all__ = ["DEGREES", "Rings", "angular_density", "binned", "by_sector", "peak"]

DEGREES = 180  # directions of the angular spectrum, one for each degree
_PER_DECADE = 20  # rings
_SECTORS = 12  # directions in which the density is given for every ring
_CELL = 0.5  # standard deviation over which a coefficient is spread, in cells of the lattice
_NARROWEST = 1.0  # the same in degrees, at least
_SMOOTHED = 3.0  # degrees, before the largest is looked for: single coefficients scatter
_BLOCK = 1 << 18  # coefficients at a time

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Rings:
    """Rings of the frequency plane: their edges, and the spacing of the coefficients."""

    edges: Vector
    step: float

    @staticmethod
    def of(surface: HeightMap) -> Rings:
        ny, nx = surface.heights.shape
        dx, dy = surface.pixel_size
        low, high = min(1 / (nx * dx), 1 / (ny * dy)), 0.5 / max(dx, dy)
        low *= 1 - 1e-9
        high *= 1 + 1e-9
        number = max(1, math.ceil(_PER_DECADE * math.log10(high / low)))
        return Rings(np.geomspace(low, high, number + 1), math.sqrt(1 / (nx * dx * ny * dy)))


def binned(coefficients: Any, surface: HeightMap, rings: Rings) -> tuple[Vector, Vector, Vector, float]:
    """Power and count of coefficients by ring and degree, the sum of frequencies by ring, all power."""
    ny, nx = surface.heights.shape
    fx, fy = fft.rfftfreq(nx, surface.pixel_size[0]), fft.fftfreq(ny, surface.pixel_size[1])
    twice = np.full(fx.size, 2.0)  # for the half of the plane that a real map does not need
    twice[0] = 1.0
    if nx % 2 == 0:
        twice[-1] = 1.0
    number = rings.edges.size - 1
    power, count = np.zeros(number * DEGREES), np.zeros(number * DEGREES)
    moment, total = np.zeros(number), 0.0
    begin, per_log = math.log(rings.edges[0]), number / math.log(rings.edges[-1] / rings.edges[0])
    step = max(1, _BLOCK // fx.size)
    for first in range(0, ny, step):
        rows = slice(first, min(first + step, ny))
        part = coefficients[rows]
        square = (part.real**2 + part.imag**2) * twice
        total += float(np.sum(square))
        f = np.hypot(fx, fy[rows, np.newaxis])
        inside = (f >= rings.edges[0]) & (f < rings.edges[-1])
        ring = ((np.log(f[inside]) - begin) * per_log).astype(np.intp)
        np.clip(ring, 0, number - 1, out=ring)
        degree = np.rint(np.degrees(np.arctan2(fy[rows, np.newaxis], fx))[inside]).astype(np.intp) % DEGREES
        weight = np.broadcast_to(twice, f.shape)[inside]
        place = ring * DEGREES + degree
        power += np.bincount(place, square[inside], power.size)
        count += np.bincount(place, weight, power.size)
        moment += np.bincount(ring, weight * f[inside], number)
    return power.reshape(number, -1), count.reshape(number, -1), moment, total


def angular_density(power: Vector, frequencies: Vector, step: float) -> Vector:
    """Mean square height per radian: the power of each coefficient over the angle that its cell takes up.

    `power` is the density, summed over the coefficients of each ring and degree.
    """
    result = np.zeros(DEGREES)
    for row, frequency in zip(power, frequencies, strict=True):
        width = max(_NARROWEST, math.degrees(_CELL * step / frequency))
        result += ndimage.gaussian_filter1d(row, min(width, DEGREES / 3), mode="wrap")
    return result * (step * step * DEGREES / math.pi)


def peak(angular: Vector) -> float:
    """The angle of the maximum of the smoothed density, by a parabola through the three largest values."""
    angular = ndimage.gaussian_filter1d(angular, _SMOOTHED, mode="wrap")
    k = int(np.argmax(angular))
    left, top, right = (float(angular[(k + i) % DEGREES]) for i in (-1, 0, 1))
    bend = left - 2 * top + right
    shift = 0.5 * (left - right) / bend if bend < 0 else 0.0
    return (k + shift) * math.pi / DEGREES % math.pi


def by_sector(power: Vector, count: Vector) -> tuple[Vector, Vector]:
    """Directions fifteen degrees apart, and the density of every ring about each."""
    wide = DEGREES // _SECTORS
    sums = [
        np.roll(values, wide // 2, axis=1).reshape(-1, _SECTORS, wide).sum(axis=2)
        for values in (power, count)
    ]
    density = np.divide(sums[0], sums[1], out=np.full(sums[0].shape, math.nan), where=sums[1] > 0)
    return np.linspace(0, math.pi, _SECTORS, endpoint=False), np.ascontiguousarray(density.T)
