"""Cells of a sphere that hold about the same number of samples each, whatever the density.

A cell is a rectangle in two coordinates: *log tan theta*, which tells apart angles close to the pole and
close to the equator where theta itself has no digits left, and the azimuth phi. Strips of the first end at
quantiles of pilot samples, cells of a strip at quantiles of phi in it, so that a lobe of any width is
resolved. The pilot samples are not among those that are tested: given the cells, the test is the usual one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["DOMAINS", "Cells", "coordinates", "directions", "theta"]

Array = NDArray[np.float64]

_END = 350.0  # log tan theta of what counts as the pole and as the equator: 1e-152 from them
#: The largest first coordinate of each domain. Below the equator it goes on as 700 - log tan(pi - theta).
DOMAINS = {"hemisphere": _END, "sphere": 3.0 * _END}
_TURN = 2.0 * np.pi
_APART = 8.0  # between the azimuths of one strip and the next in one sorted list; more than a turn


def coordinates(m: NDArray[np.floating], cut: float = -np.pi) -> tuple[Array, Array]:
    """Log tan theta, and phi in [cut, cut + 2 pi); nan for nan."""
    x, y, z = (np.asarray(m[..., i], dtype=np.float64) for i in range(3))
    with np.errstate(divide="ignore"):
        t = np.clip(np.log(np.hypot(x, y)) - np.log(np.abs(z)), -_END, _END)
    phi = np.mod(np.arctan2(y, x) - cut, _TURN)
    # The remainder of -1e-17 rounds to a whole turn.
    return np.where(z < 0.0, 2.0 * _END - t, t), cut + np.where(phi < _TURN, phi, 0.0)


def directions(t: Array, phi: Array) -> tuple[Array, Array]:
    """Unit vectors (..., 3), and their solid angle per area of the coordinates."""
    below = t > _END
    t = np.where(below, 2.0 * _END - t, t)
    s, c = 1.0 / np.sqrt(1.0 + np.exp(-2.0 * t)), 1.0 / np.sqrt(1.0 + np.exp(2.0 * t))
    area = s * s * c
    m = np.stack(np.broadcast_arrays(s * np.cos(phi), s * np.sin(phi), np.where(below, -c, c)), axis=-1)
    return m, np.broadcast_to(area, m.shape[:-1])


def theta(t: Array) -> Array:
    """The polar angle; 0, pi/2 and pi at the ends."""
    angle = np.arctan(np.exp(np.where(t > _END, 2.0 * _END - t, t)))
    angle = np.where(np.abs(angle) < 1e-150, 0.0, angle)
    return np.where(t > _END, np.pi - angle, angle)


@dataclass(frozen=True)
class Cells:
    """Rectangles that cover the domain, and the pilot samples that they were made from."""

    polar: Array  # (strips + 1,) edges of the first coordinate
    phi: Array  # (strips, columns + 1) edges of the second
    pilot: Array  # (2, pilots) the samples' coordinates

    @classmethod
    def around(cls, pilot: NDArray[np.floating], top: float, strips: int, columns: int) -> Cells:
        """Cells of the domain up to the coordinate `top`, about as many of the `pilot` directions in each."""
        _, phi = coordinates(pilot)
        cut = float(np.angle(np.mean(np.exp(1j * phi))) - np.pi)  # opposite to most of the samples
        t, phi = coordinates(pilot, cut)
        inner = np.quantile(t, np.linspace(0.0, 1.0, strips + 1)[1:-1]).clip(-_END, top)
        edges = np.unique(np.concatenate([[-_END, top], inner]))
        strip = np.searchsorted(edges[1:-1], t, side="right")
        across = np.empty((len(edges) - 1, columns + 1))
        across[:, 0], across[:, -1] = cut, cut + _TURN
        even = np.linspace(cut, cut + _TURN, columns + 1)[1:-1]
        for i in range(len(edges) - 1):
            inside = phi[strip == i]
            shares = np.linspace(0.0, 1.0, columns + 1)[1:-1]
            across[i, 1:-1] = np.quantile(inside, shares) if len(inside) > columns else even
        return cls(edges, across, np.stack([t, phi])[:, t <= top])

    def __len__(self) -> int:
        return int(self.phi.shape[0] * (self.phi.shape[1] - 1))

    @property
    def rectangles(self) -> Array:
        """From, to in the first coordinate, from, to in phi of every cell, (cells, 4)."""
        strips, columns = self.phi.shape[0], self.phi.shape[1] - 1
        lower, upper = np.repeat(self.polar[:-1], columns), np.repeat(self.polar[1:], columns)
        sides = (self.phi[:, :-1].ravel(), self.phi[:, 1:].ravel())
        return np.stack([lower, upper, *sides], axis=-1).reshape(strips * columns, 4)

    def find(self, t: Array, phi: Array) -> NDArray[np.intp]:
        """The number of the cell of each direction inside the domain."""
        strip = np.searchsorted(self.polar[1:-1], t, side="right")
        columns = self.phi.shape[1] - 1
        walls = self.phi[:, 1:-1] - self.phi[:, :1] + _APART * np.arange(len(self.phi))[:, None]
        # The walls of all strips in one sorted list; each strip has columns - 1 of them.
        place = np.searchsorted(walls.ravel(), phi - self.phi[0, 0] + _APART * strip, side="right")
        found: NDArray[np.intp] = strip * columns + (place - strip * (columns - 1))
        return found

    def count(self, m: NDArray[np.floating]) -> tuple[NDArray[np.int64], int]:
        """How many directions lie in each cell, and how many in none."""
        t, phi = coordinates(m, self.phi[0, 0])
        inside = t <= self.polar[-1]  # false for nan
        found = self.find(t[inside], phi[inside])
        return np.bincount(found, minlength=len(self)), int(np.count_nonzero(~inside))
