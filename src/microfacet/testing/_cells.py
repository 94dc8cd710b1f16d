"""Cells of a sphere that hold about the same number of samples each, whatever the density.

A cell is a rectangle in the angles (theta, phi). Strips of theta end at quantiles of pilot samples, cells of
a strip at quantiles of phi in it, so that a lobe of any width is resolved. The pilot samples are not among
those that are tested: given the cells, the test is the usual one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Cells", "angles"]

Array = NDArray[np.float64]

_TURN = 2.0 * np.pi
_APART = 8.0  # between the azimuths of one strip and the next in one sorted list; more than a turn


def angles(directions: NDArray[np.floating], cut: float = -np.pi) -> tuple[Array, Array]:
    """theta in [0, pi] and phi in [cut, cut + 2 pi)."""
    x, y, z = (np.asarray(directions[..., i], dtype=np.float64) for i in range(3))
    theta = np.arctan2(np.hypot(x, y), z)
    phi = np.mod(np.arctan2(y, x) - cut, _TURN)
    return theta, cut + np.where(phi < _TURN, phi, 0.0)  # the remainder of -1e-17 rounds to a whole turn


@dataclass(frozen=True)
class Cells:
    """Rectangles that cover the domain, and the pilot samples that they were made from."""

    theta: Array  # (strips + 1,) edges
    phi: Array  # (strips, columns + 1) edges
    pilot: Array  # (2, pilots) theta and phi

    @classmethod
    def around(cls, pilot: NDArray[np.floating], top: float, strips: int, columns: int) -> Cells:
        """Cells of the domain theta <= `top` with about as many of the `pilot` directions in each."""
        theta, phi = angles(pilot)
        centre = np.angle(np.mean(np.exp(1j * phi)))
        cut = float(centre - np.pi)  # opposite to most of the samples
        theta, phi = angles(pilot, cut)
        shares = np.linspace(0.0, 1.0, strips + 1)[1:-1]
        edges = np.unique(np.concatenate([[0.0, top], np.quantile(theta, shares).clip(0.0, top)]))
        strip = np.searchsorted(edges[1:-1], theta, side="right")
        across = np.empty((len(edges) - 1, columns + 1))
        across[:, 0], across[:, -1] = cut, cut + _TURN
        even = np.linspace(cut, cut + _TURN, columns + 1)[1:-1]
        for i in range(len(edges) - 1):
            inside = phi[strip == i]
            shares = np.linspace(0.0, 1.0, columns + 1)[1:-1]
            across[i, 1:-1] = np.quantile(inside, shares) if len(inside) > columns else even
        return cls(edges, across, np.stack([theta, phi])[:, theta <= top])

    def __len__(self) -> int:
        return int(self.phi.shape[0] * (self.phi.shape[1] - 1))

    @property
    def rectangles(self) -> Array:
        """theta from, to, phi from, to of every cell, (cells, 4)."""
        strips, columns = self.phi.shape[0], self.phi.shape[1] - 1
        lower, upper = np.repeat(self.theta[:-1], columns), np.repeat(self.theta[1:], columns)
        sides = (self.phi[:, :-1].ravel(), self.phi[:, 1:].ravel())
        return np.stack([lower, upper, *sides], axis=-1).reshape(strips * columns, 4)

    def find(self, theta: Array, phi: Array) -> NDArray[np.intp]:
        """The number of the cell of each direction inside the domain."""
        strip = np.searchsorted(self.theta[1:-1], theta, side="right")
        columns = self.phi.shape[1] - 1
        walls = self.phi[:, 1:-1] - self.phi[:, :1] + _APART * np.arange(len(self.phi))[:, None]
        # The walls of all strips in one sorted list; each strip has columns - 1 of them.
        place = np.searchsorted(walls.ravel(), phi - self.phi[0, 0] + _APART * strip, side="right")
        found: NDArray[np.intp] = strip * columns + (place - strip * (columns - 1))
        return found

    def count(self, directions: NDArray[np.floating]) -> tuple[NDArray[np.int64], int]:
        """How many directions lie in each cell, and how many in none."""
        theta, phi = angles(directions, self.phi[0, 0])
        inside = theta <= self.theta[-1]  # false for nan
        found = self.find(theta[inside], phi[inside])
        return np.bincount(found, minlength=len(self)), int(np.count_nonzero(~inside))
