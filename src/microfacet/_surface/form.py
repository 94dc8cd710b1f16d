"""What is subtracted from a height map before its slopes are looked at: a plane, a polynomial, a sphere."""

from __future__ import annotations

import math
import operator
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray
from scipy.optimize import least_squares

from microfacet._surface.checks import SurfaceError, short

__all__ = ["checked_degree", "plane_through", "polynomial", "sphere"]

Map = NDArray[np.float64]
Mask = NDArray[np.bool_]

_MOST = 12  # degree; the normal equations of Legendre polynomials are well-conditioned up to there and beyond
_FIT_PIXELS = 100_000  # a sphere has four parameters: more pixels would only take time
_REACH = 2  # pixels to either side over which the height of a levelling point is averaged


def polynomial(heights: Map, mask: Mask, degree: int) -> Map:
    """The least-squares polynomial of total degree `degree` through the valid pixels, at every pixel.

    The basis is a product of Legendre polynomials, so the sums of the normal equations factor into one over
    columns and one over rows: no (pixels, terms) matrix is ever built.
    """
    ny, nx = heights.shape
    along_x, along_y = legvander(_unit(nx), degree), legvander(_unit(ny), degree)
    terms = [(j, i) for j in range(degree + 1) for i in range(degree + 1 - j)]
    rows, columns = np.array(terms).T
    middle = float(np.mean(heights[mask]))
    weighted = np.where(mask, heights - middle, 0.0)
    count = degree + 1
    square_x = (along_x[:, :, None] * along_x[:, None, :]).reshape(nx, -1)
    square_y = (along_y[:, :, None] * along_y[:, None, :]).reshape(ny, -1)
    products = (square_y.T @ (mask.astype(np.float64) @ square_x)).reshape(count, count, count, count)
    normal = products[rows[:, None], rows[None, :], columns[:, None], columns[None, :]]
    right = (along_y.T @ weighted @ along_x)[rows, columns]
    coefficients = np.zeros((count, count))
    coefficients[rows, columns] = np.linalg.lstsq(normal, right, rcond=None)[0]
    return np.asarray(middle + along_y @ coefficients @ along_x.T)


def sphere(heights: Map, mask: Mask, pixel_size: tuple[float, float]) -> tuple[Map, float]:
    """The least-squares sphere (vertical distances) at every pixel, and its radius, negative for a hollow.

    As ``z0 + k r^2/(1 + sqrt(1 - k^2 r^2))`` with r the distance from the apex and k the curvature, which
    stays regular for nearly flat maps. The paraboloid of the same curvature is where the search begins.
    """
    ny, nx = heights.shape
    dx, dy = pixel_size
    x = (np.arange(nx) - (nx - 1) / 2)[np.newaxis, :] * dx
    y = (np.arange(ny) - (ny - 1) / 2)[:, np.newaxis] * dy
    scale = max(float(x[0, -1]), float(y[-1, 0]))
    x, y = x / scale, y / scale
    row, column = np.nonzero(mask)
    chosen = slice(None, None, 1 + row.size // _FIT_PIXELS)
    px, py, h = x[0, column[chosen]], y[row[chosen], 0], heights[mask][chosen] / scale
    basis = np.column_stack((np.ones_like(px), px, py, (px**2 + py**2) / 2))
    offset, tilt_x, tilt_y, bend = np.linalg.lstsq(basis, h - np.mean(h), rcond=None)[0]
    if abs(bend) < 1e-12:
        raise SurfaceError("the map has no curvature, so no sphere fits it: level it instead")
    bend = math.copysign(min(abs(bend), 0.7), bend)  # the whole map must fit onto the sphere
    apex = (-tilt_x / bend, -tilt_y / bend)
    start = np.array([offset - bend * (apex[0] ** 2 + apex[1] ** 2) / 2, *apex, bend])

    def cap(parameters: Any, x: Map, y: Map) -> Map:
        height, x0, y0, k = parameters
        r2 = (x - x0) ** 2 + (y - y0) ** 2
        return np.asarray(height + k * r2 / (1 + np.sqrt(np.maximum(1 - k * k * r2, 0.0))))

    def residual(parameters: Map) -> Map:
        return cap(parameters, px, py) - (h - np.mean(h))

    found = least_squares(residual, start, x_scale=np.abs(start) + 1e-3)
    form = scale * (cap(found.x, x, y) + np.mean(h))
    return form, -scale / float(found.x[3])


def plane_through(
    heights: Map, mask: Mask, points: Sequence[tuple[int, int]] | None
) -> tuple[Map, tuple[tuple[int, int], ...]]:
    """The plane through the map at three points (column, row), and these points.

    The height of a point is the mean of the valid pixels up to two pixels away, so that the noise of one
    pixel does not tilt the map.
    """
    places = _checked_points(points, heights.shape)
    levels = []
    for column, row in places:
        near = (
            slice(max(row - _REACH, 0), row + _REACH + 1),
            slice(max(column - _REACH, 0), column + _REACH + 1),
        )
        if not mask[near].any():
            raise SurfaceError(f"no pixel near the levelling point ({column}, {row}) is valid")
        # where the valid pixels lie, not where they were asked for: the plane passes through their mean
        rows, columns = np.nonzero(mask[near])
        levels.append(
            (
                1.0,
                near[1].start + columns.mean(),
                near[0].start + rows.mean(),
                heights[near][mask[near]].mean(),
            )
        )
    system = np.array(levels)
    if np.linalg.cond(system[:, :3] / [1, *heights.shape[::-1]]) > 1e6:
        raise SurfaceError("the three levelling points lie on one line")
    offset, tilt_x, tilt_y = np.linalg.solve(system[:, :3], system[:, 3])
    ny, nx = heights.shape
    return offset + tilt_x * np.arange(nx)[np.newaxis, :] + tilt_y * np.arange(ny)[:, np.newaxis], places


def checked_degree(degree: Any, least: int = 1) -> int:
    """A degree of polynomials that can be fitted."""
    try:
        number = -1 if isinstance(degree, bool) else operator.index(degree)
    except TypeError:
        number = -1
    if not least <= number <= _MOST:
        raise SurfaceError(f"degree must be a whole number in [{least}, {_MOST}], got {short(degree)}")
    return number


def _checked_points(points: Any, shape: tuple[int, ...]) -> tuple[tuple[int, int], ...]:
    try:
        array = np.asarray(points)
    except ValueError:
        array = np.empty(0)
    if array.shape != (3, 2) or array.dtype.kind not in "iu":
        raise SurfaceError(
            f"three-point levelling needs points: three pixels (column, row), got {short(points)}"
        )
    ny, nx = shape
    if (array < 0).any() or (array[:, 0] >= nx).any() or (array[:, 1] >= ny).any():
        raise SurfaceError(f"the levelling points must lie on the map of {nx} x {ny} pixels")
    return tuple((int(column), int(row)) for column, row in array)


def _unit(count: int) -> Map:
    return np.linspace(-1.0, 1.0, count)
