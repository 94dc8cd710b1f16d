"""The height map with the preparation that a slope density needs: levelling, form, outliers, filters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from microfacet._surface import filters, form
from microfacet._surface.checks import SurfaceError, positive, short
from microfacet._surface.height_map import HeightMap

__all__ = ["Surface"]


@dataclass(frozen=True, eq=False)
class Surface(HeightMap):
    """Heights on a rectangular grid of pixels, in metres.

    Column ``j`` lies at ``x = j dx`` and row ``i`` at ``y = i dy``: +x runs along the columns, +y up the rows
    in the order in which they are stored, +z away from the material. The arrays are read-only; they are
    copies, unless the heights are read-only when they are given, float64 and no view of another array.

    Parameters
    ----------
    heights : array_like, shape (ny, nx)
        Heights in metres. A pixel that is not finite is invalid, whatever `mask` says.
    pixel_size : float or (float, float)
        ``(dx, dy)`` in metres, positive; one number means square pixels.
    mask : array_like of bool, shape (ny, nx), optional
        True where the height is valid. Heights of invalid pixels become nan.
    unit : str
        The unit in which the source stated its heights, for display; `heights` are metres.
    source : str
        Where the heights come from, for display.
    steps : tuple of str
        Every preparation step taken so far, in order, one phrase each.
    lag : int
        The lag in pixels at which `slopes` are taken unless another is asked for.
    warnings : tuple of str
        What is doubtful about the source, a sentence each; every result repeats them.

    Raises
    ------
    SurfaceError
        If the heights are not a real 2-D array of at least 3 x 3 and at most 2**26 pixels, fewer than 9
        pixels are valid, or a pixel size is not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> y, x = np.mgrid[0:5, 0:6] * 1e-6
    >>> tilted = Surface(0.5 * x - 0.25 * y, pixel_size=1e-6)
    >>> tilted.slopes(lag=2).round(12)
    array([[ 0.5 , -0.25],
           [ 0.5 , -0.25]])
    >>> bool(abs(tilted.level().heights).max() < 1e-20)
    True
    """

    def level(
        self,
        kind: str = "plane",
        *,
        degree: int | None = None,
        points: Sequence[tuple[int, int]] | None = None,
    ) -> Surface:
        """Subtract a plane or a polynomial.

        Parameters
        ----------
        kind : {"plane", "polynomial", "three-point"}
            The least-squares plane through the valid pixels, the least-squares polynomial of total degree
            `degree`, or the plane through three points.
        degree : int, optional
            Total degree of the polynomial, in [1, 12]; giving it means ``kind="polynomial"``.
        points : sequence of 3 (int, int), optional
            ``(column, row)`` of the three points; the height of each is the mean of the valid pixels up to
            two pixels away.

        Returns
        -------
        Surface
            The levelled map; its `steps` name the step.

        Examples
        --------
        >>> import microfacet as mf
        >>> terrain = mf.sample_terrain().level("three-point", points=[(10, 10), (390, 10), (10, 330)])
        >>> terrain.steps[-1]
        'levelled: plane through the pixels (10, 10), (390, 10), (10, 330) subtracted'
        """
        if kind not in ("plane", "polynomial", "three-point"):
            raise SurfaceError(f"kind must be plane, polynomial or three-point, got {short(kind)}")
        if (degree is not None and kind == "three-point") or (degree is None and kind == "polynomial"):
            raise SurfaceError("a degree belongs to polynomial levelling, and to nothing else")
        if points is not None and kind != "three-point":
            raise SurfaceError("points belong to three-point levelling")
        if kind == "three-point":
            shape, places = form.plane_through(self.heights, self.mask, points)
            what = "plane through the pixels " + ", ".join(map(str, places))
        else:
            number = 1 if degree is None else form.checked_degree(degree)
            shape = form.polynomial(self.heights, self.mask, number)
            what = "least-squares plane" if number == 1 else f"least-squares polynomial of degree {number}"
        return self._step(f"levelled: {what} subtracted", self.heights - shape)

    def remove_form(self, shape: int | str = 2) -> Surface:
        """Subtract the form of the part on which the roughness lies.

        Parameters
        ----------
        shape : int, "sphere" or "cylinder"
            Total degree of a least-squares polynomial, in [2, 12], or the least-squares sphere or cylinder
            (of vertical distances; the axis of the cylinder may lie anywhere and rise).

        Returns
        -------
        Surface
            What remains; its `steps` name the form, with its radius (negative for a hollow).

        Examples
        --------
        >>> import numpy as np
        >>> y, x = np.mgrid[-20:21, -20:21] * 1e-6
        >>> ball = Surface(np.sqrt(1e-8 - x**2 - y**2), pixel_size=1e-6)
        >>> ball.remove_form("sphere").steps
        ('form removed: least-squares sphere of radius 0.0001 m',)
        """
        if shape == "sphere":
            fitted, radius = form.sphere(self.heights, self.mask, self.pixel_size)
            return self._step(
                f"form removed: least-squares sphere of radius {radius:.4g} m", self.heights - fitted
            )
        if shape == "cylinder":
            fitted, radius, angle = form.cylinder(self.heights, self.mask, self.pixel_size)
            what = f"cylinder of radius {radius:.4g} m, axis at {math.degrees(angle):.4g} degrees"
            return self._step(f"form removed: least-squares {what}", self.heights - fitted)
        if isinstance(shape, str):
            raise SurfaceError(
                f"form must be sphere, cylinder or the degree of a polynomial, got {short(shape)}"
            )
        degree = form.checked_degree(shape, least=2)
        fitted = form.polynomial(self.heights, self.mask, degree)
        return self._step(f"form removed: least-squares polynomial of degree {degree}", self.heights - fitted)

    def mask_outliers(self, threshold: float = 8.0) -> Surface:
        """Mask the pixels that stick out of their neighbourhood: spikes, pits, dust.

        A pixel is masked where its distance from the median of the 5 x 5 pixels around it exceeds `threshold`
        robust standard deviations, that is 1.4826 times the median of all these distances. A polynomial of
        degree 2 is taken off for the comparison, so the map need not be level. Steep slopes of a heavy-tailed
        surface stick out as well: a threshold below about 6 cuts into what is to be measured, so compare the
        fit with and without it.

        Parameters
        ----------
        threshold : float
            Positive, in robust standard deviations.

        Returns
        -------
        Surface
            The map with fewer valid pixels; its `steps` say how many went.

        Examples
        --------
        >>> import numpy as np
        >>> heights = np.random.default_rng(0).normal(size=(40, 50))
        >>> heights[7, 9] = 500.0
        >>> Surface(heights, pixel_size=1.0).mask_outliers().steps
        ('1 outlier of 2000 pixels masked: beyond 8 robust standard deviations of the local median',)
        """
        threshold = positive(threshold, "the outlier threshold")
        out = filters.outliers(self.heights, self.mask, threshold)
        count, total = int(np.count_nonzero(out)), int(np.count_nonzero(self.mask))
        step = (
            f"{count} outlier{'s' * (count != 1)} of {total} pixels masked: beyond {threshold:g} robust "
            "standard deviations of the local median"
        )
        return self._step(step, np.where(out, math.nan, self.heights))

    def filtered(self, short: float | None = None, long: float | None = None) -> Surface:
        """Gaussian S-filter and L-filter (ISO 16610-61), which transmit half of a wave at their cut-off.

        A wave of length w passes the S-filter, which removes what is small, with the amplitude
        ``2^-(short/w)^2``; what passes an S-filter of cut-off `long` is what the L-filter removes. Weights
        are normalised over the valid pixels: nothing leaks in from missing pixels or from beyond the edge.

        Parameters
        ----------
        short, long : float, optional
            Cut-off wavelengths in metres of the S-filter (at least two pixels) and of the L-filter, which is
            the longer one.

        Returns
        -------
        Surface
            The filtered map; its `steps` name each filter.

        Notes
        -----
        ISO 16610-61:2015, Geometrical product specification: Filtration, Linear areal filters, Gaussian.
        An S-filter changes the slopes that this library fits; state its cut-off with every result.

        Examples
        --------
        >>> import microfacet as mf
        >>> terrain = mf.sample_terrain().level().filtered(short=400.0, long=5000.0)
        >>> terrain.steps[-2:]
        ('S-filter: Gaussian, cut-off 400 m (ISO 16610-61)',
         'L-filter: Gaussian, cut-off 5000 m (ISO 16610-61)')
        """
        for value, what in ((short, "S-filter"), (long, "L-filter")):
            if value is not None and positive(value, f"the cut-off of the {what}") < 2 * max(self.pixel_size):
                raise SurfaceError(
                    f"the cut-off of the {what} is {value:g} m, less than two pixels of "
                    f"{max(self.pixel_size):g} m"
                )
        if short is not None and long is not None and short >= long:
            raise SurfaceError(f"the S-filter ({short:g} m) must be shorter than the L-filter ({long:g} m)")
        result = self
        if short is not None:
            low = filters.gaussian(self.heights, self.mask, self.pixel_size, short)
            result = self._step(f"S-filter: Gaussian, cut-off {short:g} m (ISO 16610-61)", low)
        if long is not None:
            rest = result.heights - filters.gaussian(result.heights, self.mask, self.pixel_size, long)
            result = result._step(f"L-filter: Gaussian, cut-off {long:g} m (ISO 16610-61)", rest)
        return result

    def _step(self, step: str, heights: NDArray[np.float64]) -> Surface:
        return replace(self, heights=heights, steps=(*self.steps, step))
