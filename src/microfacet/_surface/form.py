"""What is subtracted from a height map before its slopes are looked at: plane, polynomial, sphere."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray
from scipy.optimize import least_squares

from microfacet._surface.checks import SurfaceError, short

__all__ = ["checked_degree", "cylinder", "plane_through", "polynomial", "sphere"]

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

    The search begins at the paraboloid of the same curvature.
    """
    grid = _Grid.of(heights, mask, pixel_size)
    quadratic = grid.quadratic()
    tilt, bend = quadratic[1:3], _limited((quadratic[3] + quadratic[5]) / 2)
    apex = -tilt / bend
    start = np.array([quadratic[0] - bend * (apex @ apex) / 2, *apex, bend])

    def shape(parameters: Map, x: Map, y: Map) -> Map:
        height, x0, y0, curvature = parameters
        return np.asarray(height + _cap((x - x0) ** 2 + (y - y0) ** 2, curvature))

    form, found = grid.fitted(shape, start)
    return form, -grid.scale / float(found[3])


def cylinder(heights: Map, mask: Mask, pixel_size: tuple[float, float]) -> tuple[Map, float, float]:
    """The least-squares cylinder at every pixel, its radius, and the direction of its axis in radians.

    Heights rise linearly along the axis, so the part need not lie flat. The search begins at the parabolic
    cylinder along the direction in which the map bends least.
    """
    grid = _Grid.of(heights, mask, pixel_size)
    offset, tilt_x, tilt_y, bend_xx, bend_xy, bend_yy = grid.quadratic()
    bends, axes = np.linalg.eigh(np.array([[bend_xx, bend_xy], [bend_xy, bend_yy]]))
    most = int(np.argmax(np.abs(bends)))
    across = axes[:, most]
    bend = _limited(float(bends[most]))
    tilt = np.array([tilt_x, tilt_y])
    ridge = -float(tilt @ across) / bend
    along = np.array([across[1], -across[0]])  # the axis, a quarter turn clockwise
    start = np.array(
        [offset - bend * ridge**2 / 2, float(tilt @ along), ridge, math.atan2(along[1], along[0]), bend]
    )

    def shape(parameters: Map, x: Map, y: Map) -> Map:
        height, tilt, ridge, angle, curvature = parameters
        t, s = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
        return np.asarray(height + tilt * t + _cap((s - ridge) ** 2, curvature))

    form, found = grid.fitted(shape, start)
    return form, -grid.scale / float(found[4]), float(found[3]) % math.pi


@dataclass(frozen=True)
class _Grid:
    """Heights and places in units of half the longer side, from the middle of the map; some of the pixels."""

    x: Map
    y: Map
    scale: float
    middle: float
    chosen: tuple[Map, Map, Map]

    @classmethod
    def of(cls, heights: Map, mask: Mask, pixel_size: tuple[float, float]) -> _Grid:
        ny, nx = heights.shape
        x = (np.arange(nx) - (nx - 1) / 2)[np.newaxis, :] * pixel_size[0]
        y = (np.arange(ny) - (ny - 1) / 2)[:, np.newaxis] * pixel_size[1]
        scale = max(float(x[0, -1]), float(y[-1, 0]))
        x, y = x / scale, y / scale
        row, column = np.nonzero(mask)
        some = slice(None, None, 1 + row.size // _FIT_PIXELS)
        row, column = row[some], column[some]
        values = heights[row, column]
        middle = float(np.mean(values))
        return cls(x, y, scale, middle, (x[0, column], y[row, 0], (values - middle) / scale))

    def quadratic(self) -> Map:
        """Coefficients of 1, x, y, x^2/2, x y, y^2/2."""
        x, y, z = self.chosen
        basis = np.column_stack((np.ones_like(x), x, y, x * x / 2, x * y, y * y / 2))
        return np.asarray(np.linalg.lstsq(basis, z, rcond=None)[0])

    def fitted(self, shape: Callable[[Map, Map, Map], Map], start: Map) -> tuple[Map, Map]:
        """The shape of least squares at every pixel, in metres, and its parameters."""
        x, y, z = self.chosen

        def residual(parameters: Map) -> Map:
            return shape(parameters, x, y) - z

        found = np.asarray(least_squares(residual, start, x_scale=np.abs(start) + 1e-3).x)
        return self.scale * shape(found, self.x, self.y) + self.middle, found


def _cap(r2: Map, curvature: Any) -> Map:
    """A circle as ``k r^2/(1 + sqrt(1 - k^2 r^2))``, which stays regular where it is nearly flat."""
    return np.asarray(curvature * r2 / (1 + np.sqrt(np.maximum(1 - curvature**2 * r2, 0.0))))


def _limited(bend: float) -> float:
    """A curvature at which the whole map fits onto the circle, as a start."""
    if abs(bend) < 1e-12:
        raise SurfaceError("the map has no curvature, so no sphere and no cylinder fits it: level it instead")
    return math.copysign(min(abs(bend), 0.7), bend)


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
