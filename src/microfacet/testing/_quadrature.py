"""Integrals of a density over cells, fine enough for a test that counts a million samples.

Panels are halved where halving changes the integral. A density at grazing incidence changes within a
fraction of a cell, and one point in its middle would tell another distribution: correct samplers would fail.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from microfacet.testing._cells import Cells, directions

__all__ = ["integrate"]

Array = NDArray[np.float64]
Density = Callable[[Array], NDArray[np.floating]]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(7)
_NODES, _WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS
_AT_ONCE = 1 << 12  # panels; 49 evaluations in each
_DEEPEST = 60  # halvings of a cell before the first integral
_ENOUGH = 3  # pilot samples that say where a panel's mass is
_MOST = 1 << 18  # panels in all, before a density counts as too rough


def integrate(density: Density, cells: Cells, tolerance: float) -> Array:
    """The integral over each cell to about `tolerance`, or a ValueError where that cannot be reached."""
    panels, owner = _panels(cells)
    value = _gauss(density, panels)
    total = np.zeros(len(cells))
    made, level = len(panels), 0
    while len(panels):
        halves = [_halved(panels, axis) for axis in (0, 1)]
        parts = [[_gauss(density, half) for half in pair] for pair in halves]
        change = np.abs([first + second - value for first, second in parts])
        # Errors of many panels along a kink add up; of a singular point there is one at a time.
        settled = change.max(axis=0) <= tolerance * max(0.5**level, 1.0 / 32.0)
        along = change.argmax(axis=0)
        better = np.where(along == 0, parts[0][0] + parts[0][1], parts[1][0] + parts[1][1])
        np.add.at(total, owner[settled], better[settled])
        split = ~settled
        panels = np.concatenate([_along(along, halves[0][i], halves[1][i])[split] for i in (0, 1)])
        value = np.concatenate([np.where(along == 0, parts[0][i], parts[1][i])[split] for i in (0, 1)])
        owner = np.concatenate([owner[split], owner[split]])
        made, level = made + len(panels), level + 1
        if made > _MOST:
            raise ValueError(
                f"the density cannot be integrated: {len(panels)} panels change after {level} halvings; "
                "is it finite and integrable, and smooth but for lines?"
            )
    return total


def _gauss(density: Density, panels: Array) -> Array:
    """Tensor Gauss-Legendre over rectangles of the coordinates."""
    result = np.empty(len(panels))
    for start in range(0, len(panels), _AT_ONCE):
        t0, t1, p0, p1 = panels[start : start + _AT_ONCE].T[:, :, None]
        t, phi = t0 + (t1 - t0) * _NODES, p0 + (p1 - p0) * _NODES
        m, area = directions(t[:, :, None], phi[:, None, :])
        values = np.asarray(density(m), dtype=np.float64)
        if values.shape != m.shape[:-1]:
            raise ValueError(
                f"the density of directions {m.shape} must have shape {m.shape[:-1]}, got {values.shape}"
            )
        if not np.all(values >= 0.0) or np.any(np.isinf(values)):
            raise ValueError("the density must be finite and not negative between the cells' edges")
        values = values * area
        size = ((t1 - t0) * (p1 - p0))[:, 0]
        result[start : start + _AT_ONCE] = size * np.einsum("kij,i,j->k", values, _WEIGHTS, _WEIGHTS)
    return result


def _halved(panels: Array, axis: int) -> tuple[Array, Array]:
    low, high = 2 * axis, 2 * axis + 1
    middle = 0.5 * (panels[:, low] + panels[:, high])
    first, second = panels.copy(), panels.copy()
    first[:, high] = second[:, low] = middle
    return first, second


def _panels(cells: Cells) -> tuple[Array, NDArray[np.intp]]:
    """Where to begin: each cell halved where its pilot samples leave most of it empty.

    A lobe in the corner of a wide cell, or two at its ends, would lie between the nodes of one panel.
    """
    panels, owner = cells.rectangles, np.arange(len(cells))
    points, place = cells.pilot, cells.find(*cells.pilot)
    for _ in range(_DEEPEST):
        lonely = []
        for axis in (0, 1):
            low, width = panels[:, 2 * axis], panels[:, 2 * axis + 1] - panels[:, 2 * axis]
            eighth = np.clip(8.0 * (points[axis] - low[place]) / width[place], 0.0, 7.0).astype(np.intp)
            counts = np.bincount(8 * place + eighth, minlength=8 * len(panels)).reshape(-1, 8)
            enough = (counts.sum(axis=1) >= _ENOUGH) & (width > 0.0)
            lonely.append(np.where(enough, np.count_nonzero(counts == 0, axis=1), 0))
        along = np.argmax(lonely, axis=0)
        split = np.max(lonely, axis=0) >= 4
        if not split.any():
            break
        first, second = (_along(along, _halved(panels, 0)[i], _halved(panels, 1)[i]) for i in (0, 1))
        column = 2 * along[place]
        upper = split[place] & (points[along[place], np.arange(len(place))] >= second[place, column])
        number = np.cumsum(split) + len(panels) - 1  # of the second half of each panel that is split
        place = np.where(upper, number[place], place)
        panels = np.concatenate([np.where(split[:, None], first, panels), second[split]])
        owner = np.concatenate([owner, owner[split]])
    return panels, owner


def _along(axis: NDArray[np.intp], first: Array, second: Array) -> Array:
    """Of each row, `first` where the axis is 0, else `second`."""
    return np.where(axis[:, None] == 0, first, second)
