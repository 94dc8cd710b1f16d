"""The profile with the preparation that a slope density needs: levelling, form, outliers, filters."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from microfacet._profile import form
from microfacet._profile.outliers import outliers
from microfacet._profile.parameters import ProfileRoughness, roughness
from microfacet._profile.spectrum import ProfileSpectrum, spectrum
from microfacet._profile.traces import Traces
from microfacet._surface import filters
from microfacet._surface.checks import SurfaceError, positive
from microfacet._surface.checks import short as shown
from microfacet._surface.form import checked_degree

__all__ = ["Profile"]

Trace = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Profile(Traces):
    """Heights at equal distances along one line or several, in metres.

    Point ``i`` of each trace lies at ``x = i spacing``. The arrays are read-only copies. What a profile says
    of a surface is its roughness along that line: whether the surface is as rough across it, nothing tells.

    Parameters
    ----------
    traces : array_like
        Heights in metres of one trace (n,), of several of the same length (k, n), or a sequence of traces of
        any lengths. A point that is not finite or is masked is missing.
    spacing : float
        Distance of neighbouring points in metres, positive.
    unit : str
        The unit in which the source stated its heights, for display; `traces` are metres.
    source : str
        Where the heights come from, for display.
    steps : tuple of str
        Every preparation step taken so far, in order, one phrase each.
    lag : int
        The lag in points at which `slopes` are taken unless another is asked for.
    cutoff : float, optional
        Cut-off wavelength in metres of the L-filter that the heights have passed, if any: what is left is a
        roughness profile, and its section lengths are of this length.
    warnings : tuple of str
        What is doubtful about the heights or their distances, one sentence each.

    Raises
    ------
    SurfaceError
        If a trace is not at least 3 real numbers in a row, fewer than 9 points are valid, there are more than
        2**26, or the spacing is not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> import microfacet as mf
    >>> x = np.arange(4001) * 0.5e-6
    >>> waves = mf.Profile(1e-6 * np.cos(2 * np.pi * x / 50e-6) + 0.01 * x, spacing=0.5e-6).level()
    >>> waves.steps, len(waves), f"{waves.length:.4g} m"
    (('levelled: least-squares line subtracted from each trace',), 1, '0.002 m')
    >>> print(f"{waves.roughness().Rq:.3g} m, {waves.roughness().Rdq:.3g}")
    7.07e-07 m, 0.0889
    """

    def level(self, degree: int = 1) -> Profile:
        """Subtract from each trace its least-squares line, or polynomial.

        Parameters
        ----------
        degree : int
            Of the polynomial, in [1, 12].

        Returns
        -------
        Profile
            The levelled profile; its `steps` name the step.
        """
        number = checked_degree(degree)
        what = "line" if number == 1 else f"polynomial of degree {number}"
        return self._step(
            f"levelled: least-squares {what} subtracted from each trace",
            lambda trace: trace - form.polynomial(trace, number),
        )

    def remove_form(self, shape: int | str = 2) -> Profile:
        """Subtract from each trace the form of the part on which the roughness lies.

        Parameters
        ----------
        shape : int or "circle"
            Degree of a least-squares polynomial, in [2, 12], or the least-squares circle (of vertical
            distances), for a ball or a roller.

        Returns
        -------
        Profile
            What remains; its `steps` name the form, with the radius (negative for a hollow).

        Examples
        --------
        >>> import numpy as np
        >>> import microfacet as mf
        >>> x = np.linspace(-2e-3, 2e-3, 801)
        >>> ball = mf.Profile(np.sqrt(25e-6 - x**2), spacing=5e-6)
        >>> ball.remove_form("circle").steps
        ('form removed: least-squares circle of radius 0.005 m',)
        """
        if shape == "circle":
            radii: list[float] = []

            def straightened(trace: Trace) -> Trace:
                fitted, radius = form.circle(trace, self.spacing)
                radii.append(radius)
                return trace - fitted

            result = self._step("", straightened)
            listed = ", ".join(f"{radius:.4g}" for radius in radii[:4]) + (", ..." if len(radii) > 4 else "")
            step = f"form removed: least-squares circle of radius {listed} m"
            return replace(result, steps=(*self.steps, step))
        if isinstance(shape, str):
            raise SurfaceError(f"form must be circle or the degree of a polynomial, got {shown(shape)}")
        degree = checked_degree(shape, least=2)
        return self._step(
            f"form removed: least-squares polynomial of degree {degree} subtracted from each trace",
            lambda trace: trace - form.polynomial(trace, degree),
        )

    def mask_outliers(self, threshold: float = 8.0) -> Profile:
        """Leave out the points that stick out of their neighbourhood.

        A point is masked where its distance from the median of the 11 points around it exceeds `threshold`
        robust standard deviations of these points (1.4826 times their median absolute distance, at least the
        median of that along the trace): Hampel's filter.

        Parameters
        ----------
        threshold : float
            Positive, in robust standard deviations.

        Returns
        -------
        Profile
            The profile with fewer valid points; its `steps` say how many went.
        """
        threshold = positive(threshold, "the outlier threshold")
        before = self.points * self.valid_fraction

        def kept(trace: Trace) -> Trace:
            return np.where(outliers(trace, threshold), math.nan, trace)

        result = self._step("", kept)
        count = round(before - result.points * result.valid_fraction)
        step = (
            f"{count} outlier{'s' * (count != 1)} of {before:.0f} points masked: beyond {threshold:g} robust "
            "standard deviations of the local median"
        )
        return replace(result, steps=(*self.steps, step))

    def filtered(self, short: float | None = None, long: float | None = None) -> Profile:
        """Gaussian S-filter and L-filter (ISO 16610-21), which transmit half of a wave at their cut-off.

        A wave of length w passes the S-filter, which removes what is short, with the amplitude
        ``2^-(short/w)^2``; what passes an S-filter of cut-off `long` is the waviness that the L-filter
        removes. Weights are normalised over the valid points: nothing leaks in from missing points or from
        beyond the ends, and the ends stay. Within half a cut-off of an end the mean line is less certain.

        Parameters
        ----------
        short, long : float, optional
            Cut-off wavelengths in metres of the S-filter (at least two spacings) and of the L-filter, which
            is the longer one.

        Returns
        -------
        Profile
            The filtered profile; its `steps` name each filter.

        Notes
        -----
        ISO 16610-21:2011, Geometrical product specifications: Filtration, Linear profile filters, Gaussian.

        Examples
        --------
        >>> import microfacet as mf
        >>> line = mf.Profile.from_surface(mf.sample_terrain(), row=100).level().filtered(400.0, 5000.0)
        >>> line.steps[-2:], line.cutoff
        (('S-filter: Gaussian, cut-off 400 m (ISO 16610-21)',
          'L-filter: Gaussian, cut-off 5000 m (ISO 16610-21)'), 5000.0)
        """
        for value, what in ((short, "S-filter"), (long, "L-filter")):
            if value is not None and positive(value, f"the cut-off of the {what}") < 2 * self.spacing:
                raise SurfaceError(
                    f"the cut-off of the {what} is {value:g} m, less than two spacings of {self.spacing:g} m"
                )
        if short is not None and long is not None and short >= long:
            raise SurfaceError(f"the S-filter ({short:g} m) must be shorter than the L-filter ({long:g} m)")
        result = self
        if short is not None:
            step = f"S-filter: Gaussian, cut-off {short:g} m (ISO 16610-21)"
            result = result._step(step, lambda trace: self._smooth(trace, short))
        if long is not None:
            step = f"L-filter: Gaussian, cut-off {long:g} m (ISO 16610-21)"
            result = result._step(step, lambda trace: trace - self._smooth(trace, long))
            result = replace(result, cutoff=float(long))
        return result

    def roughness(self, trace: int | None = None, section_length: float | None = None) -> ProfileRoughness:
        """Parameters of ISO 21920-2 of one trace, or their means over all: see `ProfileRoughness`.

        Parameters
        ----------
        trace : int, optional
            Which trace, counted from 0; the mean of each parameter over all of them by default.
        section_length : float, optional
            In metres: Rp, Rv and Rz are means over sections of this length. By default the cut-off of the
            L-filter, or the whole trace where there was none.

        Returns
        -------
        ProfileRoughness
            A named tuple.

        Raises
        ------
        SurfaceError
            If there is no such trace, all heights are equal, or too few points are neighbours.
        """
        if trace is not None and not (isinstance(trace, int) and 0 <= trace < len(self)):
            raise SurfaceError(f"trace must be a whole number in [0, {len(self)}), got {shown(trace)}")
        length = self.cutoff if section_length is None else positive(section_length, "section_length")
        return roughness(self, range(len(self)) if trace is None else [trace], length)

    def psd(self, segment_length: float | None = None) -> ProfileSpectrum:
        """Power spectral density of the heights along the line, one-sided: see `ProfileSpectrum`.

        Parameters
        ----------
        segment_length : float, optional
            In metres, of the segments whose spectra are averaged (Welch's method, Hann window, half
            overlapping); a quarter of the longest trace by default. Longer ones reach longer waves, shorter
            ones scatter less.

        Returns
        -------
        ProfileSpectrum
        """
        return spectrum(self, segment_length)

    def _smooth(self, trace: Trace, cutoff: float) -> Trace:
        heights = trace[np.newaxis]
        return np.asarray(filters.gaussian(heights, np.isfinite(heights), (self.spacing, 1.0), cutoff)[0])

    def _step(self, step: str, change: Callable[[Trace], Trace]) -> Profile:
        changed = tuple(change(trace) if np.isfinite(trace).any() else trace for trace in self.traces)
        return replace(self, traces=changed, steps=(*self.steps, step))
