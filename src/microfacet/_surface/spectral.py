"""The power spectral density of a map: by frequency, by direction, and by both."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft, signal

from microfacet._surface import form
from microfacet._surface.checks import SMALLEST_TRANSFORMED, SurfaceError, short
from microfacet._surface.filling import filled
from microfacet._surface.height_map import HeightMap
from microfacet._surface.k_correlation import KCorrelation, fitted
from microfacet._surface.rings import DEGREES, Rings, angular_density, binned, by_sector, peak
from microfacet._threads import threads
from microfacet._value import Value

__all__ = ["Spectrum", "spectrum"]

_LOWEST_MODES = 2.0  # below so many periods in the map a window blurs what is there

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Spectrum(Value):
    """The power spectral density of a map, made by `spectrum`.

    Attributes
    ----------
    frequencies : ndarray, shape (K,)
        Spatial frequencies in cycles per metre, the inverse of wavelengths: the mean over each ring of the
        frequency plane, of which there are twenty a decade up to Nyquist's frequency.
    psd : ndarray, shape (K,)
        Two-dimensional density in m^4, averaged over all directions.
    errors : ndarray, shape (K,)
        Its standard errors, those of a Gaussian surface of one population.
    modes : ndarray, shape (K,)
        Independent Fourier coefficients in each ring.
    sectors : ndarray, shape (12,)
        Directions in radians, counter-clockwise from +x, fifteen degrees apart.
    directional : ndarray, shape (12, K)
        The density in m^4 averaged over the sector of fifteen degrees about each direction; nan where a ring
        has no coefficient in it.
    angles, angular : ndarray, shape (180,)
        Mean square height for each radian of direction, in m^2/rad, over [0, pi).
    Std : float
        Texture direction of ISO 25178-2, in radians in [0, pi): where `angular`, smoothed over a few degrees,
        is largest, which is across the grooves of a ground surface. It says nothing of an isotropic one.
    mean_square : float
        The integral of the density over the whole frequency plane in m^2: the mean square height over the
        valid pixels, with the weight of the squared window.
    abc : KCorrelation
        The ABC model fitted to `psd`.
    window : str or None
        The window, None for a map that was taken for periodic.
    filled : float
        The share of pixels that were missing and had to be filled.
    notes : tuple of str
        What a reader of the numbers should know.
    """

    frequencies: Vector
    psd: Vector
    errors: Vector
    modes: Vector
    sectors: Vector
    directional: Vector
    angles: Vector
    angular: Vector
    Std: float
    mean_square: float
    abc: KCorrelation
    window: str | None
    filled: float
    notes: tuple[str, ...]

    def __post_init__(self) -> None:
        self._keep(**vars(self))  # which makes the arrays read-only

    def as_dict(self) -> dict[str, Any]:
        """As a record of lists and numbers, in units of the metre.

        Examples
        --------
        >>> import microfacet as mf
        >>> surface = mf.synthesize(mf.Beckmann(alpha=0.2), (128, 128), pixel_size=1e-6)
        >>> sorted(mf.spectrum(surface).as_dict())[:4]
        ['Std', 'abc', 'angles', 'angular']
        """
        return {**self._record("abc"), "abc": self.abc.as_dict()}


def spectrum(surface: HeightMap, *, window: str | None = "hann") -> Spectrum:
    r"""Power spectral density of a prepared map.

    .. math:: S(f_x, f_y) = \frac{\Delta x\,\Delta y}{\sum w^2}\,
              \Big|\sum_{ij} w_{ij}\,z_{ij}\,e^{-2\pi i (f_x x_j + f_y y_i)}\Big|^2,\qquad
              \iint S\,df_x\,df_y = \overline{z^2}

    with the heights z from their least-squares plane and a separable window w. The density is two-sided,
    over cycles per metre, in m^4; over wave vectors q = 2 pi f it has the same values, and its integral
    carries 1/(2 pi)^2.

    Parameters
    ----------
    surface : Surface
        Prepared as needed: what waviness and form contribute stands at the low frequencies.
    window : str or None
        One that `scipy.signal.get_window` knows by name alone, so that the edges of a map that does not
        continue beyond them leave no streaks. None takes the map for periodic, as `synthesize` makes it; then
        only its mean is taken off.

    Returns
    -------
    Spectrum
        By frequency, by direction, with the ABC model fitted to it.

    Raises
    ------
    SurfaceError
        If the window has no name that SciPy knows, or the map is flat or smaller than 16 x 16 pixels.

    Notes
    -----
    Missing pixels continue smoothly what lies around them (Laplace's equation), and the density is scaled to
    the mean square of the valid ones; `filled` gives their share. What is finer than the holes is then not
    seen in them, and steps between guessed and measured heights add some power there: with a fifth of the
    pixels missing at random, the highest decade is not to be trusted.

    T. D. B. Jacobs, T. Junge, L. Pastewka, Quantitative characterization of surface topography using spectral
    analysis, Surface Topography: Metrology and Properties 5 (2017) 013001. F. J. Harris, On the use of
    windows for harmonic analysis with the discrete Fourier transform, Proceedings of the IEEE 66 (1978) 51.

    Examples
    --------
    >>> import microfacet as mf
    >>> surface = mf.synthesize(mf.Beckmann(alpha=0.2), (256, 256), pixel_size=1e-6)
    >>> found = mf.spectrum(surface, window=None)
    >>> ratio = found.mean_square / mf.roughness(surface).Sq ** 2
    >>> print(f"{ratio:.6f}")
    1.000000
    """
    ny, nx = surface.heights.shape
    if min(ny, nx) < (least := SMALLEST_TRANSFORMED):
        raise SurfaceError(f"a spectrum needs a map of at least {least} x {least} pixels, got {nx} x {ny}")
    wx, wy = _window(window, nx), _window(window, ny)
    coefficients, mean_square = _transformed(surface, wx, wy, window is None)
    spread = _spread(wx) * _spread(wy)
    rings = Rings.of(surface)
    power, count, moment, total = binned(coefficients, surface, rings)
    del coefficients
    dx, dy = surface.pixel_size
    to_density = mean_square / (total / (nx * dx * ny * dy))  # whatever the transform's normalisation
    power = power * to_density
    ring_power, ring_count = power.sum(axis=1), count.sum(axis=1)
    there = ring_count > 0
    modes = ring_count[there] / 2  # of a real map the other half of the plane is the same
    frequencies, psd = moment[there] / ring_count[there], ring_power[there] / ring_count[there]
    errors = psd / np.sqrt(np.maximum(modes / spread, 1.0))
    edges = np.stack((rings.edges[:-1][there], rings.edges[1:][there]))
    angular = angular_density(power[there], frequencies, rings.step)
    sectors, directional = by_sector(power[there], count[there])
    lowest = 0.0 if window is None else _LOWEST_MODES / min(nx * dx, ny * dy)
    share = 1 - float(np.mean(surface.mask))
    return Spectrum(
        frequencies,
        psd,
        errors,
        modes,
        sectors,
        directional,
        np.linspace(0, math.pi, DEGREES, endpoint=False),
        angular,
        peak(angular),
        mean_square,
        fitted(frequencies, psd, np.maximum(modes / spread, 1.0), edges, lowest),
        window,
        share,
        _notes(share),
    )


def _notes(share: float) -> tuple[str, ...]:
    if share == 0:
        return ()
    return (
        f"{100 * share:.3g} % of the pixels are missing and were filled smoothly for the spectrum, which is "
        "not to be trusted at wavelengths below twice the size of the holes",
    )


def _window(name: str | None, count: int) -> Vector:
    if name is None:
        return np.ones(count)
    try:
        # fftbins=False is symmetric; half a pixel outward, so that no measured row is thrown away.
        return np.asarray(signal.get_window(name, count + 2, fftbins=False)[1:-1], dtype=np.float64)
    except (ValueError, TypeError, AttributeError) as error:
        raise SurfaceError(
            "window must be None or the name of a window of scipy.signal without parameters, "
            f"got {short(name)}"
        ) from error


def _spread(window: Vector) -> float:
    """How many neighbouring coefficients a window makes depend on each other."""
    return float(window.size * np.sum(window**4) / np.sum(window**2) ** 2)


def _transformed(surface: HeightMap, wx: Vector, wy: Vector, periodic: bool) -> tuple[Any, float]:
    """Fourier coefficients for fx >= 0, and the mean square height that they stand for."""
    z = filled(surface.heights, surface.mask)
    if not periodic:
        z -= form.polynomial(surface.heights, surface.mask, 1)
    z -= float(wy @ z @ wx) / (wx.sum() * wy.sum())  # so that nothing stands at frequency 0
    scale = float(np.max(np.abs(z), where=surface.mask, initial=0.0))
    if not scale > 1e-12 * float(np.max(np.abs(surface.heights), where=surface.mask, initial=0.0)):
        raise SurfaceError("the map is flat, which leaves no spectrum to describe")
    z /= scale  # so that no square underflows
    z *= wx
    z *= wy[:, np.newaxis]
    seen = np.where(surface.mask, z, 0.0) if not surface.mask.all() else z
    squares = float(np.vdot(seen, seen))
    weight = float(np.square(wy) @ surface.mask @ np.square(wx))
    return fft.rfft2(z, workers=threads(), overwrite_x=True), scale * scale * squares / weight
