"""The autocorrelation of a map, and how fast it falls: Sal, Str and Std of ISO 25178-2."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from microfacet._surface import form
from microfacet._surface.checks import SMALLEST_TRANSFORMED, SurfaceError, positive
from microfacet._surface.decay import decay, picture, radial
from microfacet._surface.height_map import HeightMap
from microfacet._surface.spectral import spectrum
from microfacet._threads import threads
from microfacet._value import Value

__all__ = ["Autocorrelation", "autocorrelation", "correlated"]

_FALLEN = 0.2  # the standard's default
_LARGE = 1 << 24  # pixels from which single precision is used, for its memory
_SHOWN = 5  # longest distances up to which the mean over all directions is given
_WIDE = 10  # slowest decays that should fit side by side into the map

Map = NDArray[Any]
Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Autocorrelation(Value):
    """The normalised autocorrelation of a map, made by `autocorrelation`.

    Attributes
    ----------
    Sal : float
        Autocorrelation length in metres: the shortest distance at which the autocorrelation has fallen to
        `threshold`.
    Str : float
        Texture aspect ratio in (0, 1]: Sal over the longest such distance. 1 is isotropic. nan where the
        autocorrelation stays above the threshold in some direction as far as it was looked at.
    Std : float
        Texture direction in radians in [0, pi), of `Spectrum`: across the grooves.
    threshold : float
        To which value the autocorrelation has to fall.
    fastest, slowest : float
        Directions of the shortest and of the longest distance, radians in [0, pi), counter-clockwise from +x.
    longest : float
        The longest distance in metres, nan like Str.
    lengths, values : ndarray, shape (K,)
        Distances in metres, a pixel apart, up to five times the longest, and the autocorrelation averaged
        over all directions there.
    picture : ndarray
        The autocorrelation about the shift of zero, for pictures.
    picture_pixel : (float, float)
        Its pixel size in metres.
    notes : tuple of str
        What a reader of the numbers should know.
    """

    Sal: float
    Str: float
    Std: float
    threshold: float
    fastest: float
    slowest: float
    longest: float
    lengths: Vector
    values: Vector
    picture: Vector
    picture_pixel: tuple[float, float]
    notes: tuple[str, ...]

    def __post_init__(self) -> None:
        self._keep(**vars(self))  # which makes the arrays read-only

    def as_dict(self) -> dict[str, Any]:
        """As a record of lists and numbers, in metres and radians, without the picture.

        Examples
        --------
        >>> import microfacet as mf
        >>> surface = mf.synthesize(mf.Beckmann(alpha=0.2), (128, 128), pixel_size=1e-6)
        >>> sorted(mf.autocorrelation(surface).as_dict())[:4]
        ['Sal', 'Std', 'Str', 'fastest']
        """
        return self._record("picture", "picture_pixel")


def autocorrelation(
    surface: HeightMap, *, threshold: float = _FALLEN, periodic: bool = False
) -> Autocorrelation:
    r"""Autocorrelation of a prepared map, with Sal, Str and Std of ISO 25178-2.

    .. math:: \rho(t) = \frac{\overline{z(r)\,z(r + t)}}{\overline{z^2}},\quad
              S_{al} = \min_{\rho(t) \le s} |t|,\quad S_{tr} = S_{al} / \max_{t \in Q} |t|

    with the mean over all pairs of valid pixels that lie t apart inside the map, heights z from their
    least-squares plane, and Q the shifts up to which the autocorrelation stays above s on the straight way
    from zero. Shifts reach to half of either side.

    Parameters
    ----------
    surface : Surface
        Prepared as needed: waviness and form lengthen the autocorrelation.
    threshold : float
        The value s to which it has to fall, in (0, 1).
    periodic : bool
        Whether the map continues at its opposite edge, as `synthesize` makes it; then only its mean is taken
        off.

    Returns
    -------
    Autocorrelation
        The parameters, the mean over all directions, and a picture.

    Raises
    ------
    SurfaceError
        If the threshold does not lie in (0, 1), or the map is flat or smaller than 16 x 16 pixels.

    Notes
    -----
    Missing pixels are not filled: pairs with a missing one do not count, which is exact where pixels are
    missing at random. Maps of more than 16 million pixels are transformed in single precision.

    ISO 25178-2:2021, Geometrical product specifications: Surface texture, Areal, Terms, definitions and
    surface texture parameters.

    Examples
    --------
    >>> import microfacet as mf
    >>> surface = mf.synthesize(mf.Beckmann(alpha=0.2), (512, 512), correlation_length=8e-6)
    >>> found = mf.autocorrelation(surface, periodic=True)
    >>> print(f"{found.Sal / (1.27 * 8e-6):.1f} {found.Str:.1f}")  # exp(-r^2) is 0.2 at r = 1.27
    1.0 1.0
    """
    limit = positive(threshold, "threshold")
    if limit >= 1:
        raise SurfaceError(f"threshold must lie in (0, 1), got {limit:g}")
    direction = spectrum(surface, window=None if periodic else "hann").Std
    return correlated(surface, direction, limit, periodic)


def correlated(
    surface: HeightMap, direction: float, limit: float = _FALLEN, periodic: bool = False
) -> Autocorrelation:
    """The autocorrelation of a map whose texture direction is known."""
    found, pixel = _correlated(surface, periodic), surface.pixel_size
    angles, distances, reach = decay(found, pixel, limit)
    ends = np.isfinite(distances)
    near, far = int(np.argmin(distances)), int(np.argmax(distances))
    sal = float(distances[near]) if ends.any() else math.nan
    longest = float(distances[far]) if ends.all() else math.nan
    extent = longest if ends.all() else reach
    lengths, values = radial(found, pixel, min(reach, _SHOWN * extent))
    shown, picture_pixel = picture(found, pixel, 2.5 * extent)
    return Autocorrelation(
        Sal=sal,
        Str=sal / longest,
        Std=direction,
        threshold=limit,
        fastest=float(angles[near]) if ends.any() else math.nan,
        slowest=_middle(angles, ~ends) if not ends.all() else float(angles[far]),
        longest=longest,
        lengths=lengths,
        values=values,
        picture=shown,
        picture_pixel=picture_pixel,
        notes=_notes(surface, sal, longest, reach, limit),
    )


def _middle(angles: Vector, chosen: NDArray[np.bool_]) -> float:
    """The mean of axes, which are the same half a turn on."""
    return float(np.angle(np.mean(np.exp(2j * angles[chosen]))) / 2 % math.pi)


def _notes(surface: HeightMap, sal: float, longest: float, reach: float, limit: float) -> tuple[str, ...]:
    ny, nx = surface.heights.shape
    width = min(nx * surface.pixel_size[0], ny * surface.pixel_size[1])
    if math.isnan(sal):
        return (f"the autocorrelation stays above {limit:g} within half of the map: Sal and Str are unknown",)
    if math.isnan(longest):
        return (
            f"along one direction the autocorrelation stays above {limit:g} as far as half of the map, so "
            f"Str is unknown but below {sal / reach:.2g}",
        )
    if width < _WIDE * longest:
        return (
            f"the map is only {width / longest:.2g} times as wide as its autocorrelation is long, too little "
            "for Sal and Str to be more than rough",
        )
    return ()


def _correlated(surface: HeightMap, periodic: bool) -> Map:
    """The autocorrelation at shifts of whole pixels: rows -ny//2..ny//2, columns 0..nx//2."""
    ny, nx = surface.heights.shape
    if min(ny, nx) < (least := SMALLEST_TRANSFORMED):
        raise SurfaceError(
            f"an autocorrelation needs a map of at least {least} x {least} pixels, got {nx} x {ny}"
        )
    mask = surface.mask
    z = np.where(mask, surface.heights, 0.0)
    if not periodic:
        z -= form.polynomial(surface.heights, mask, 1)
    z -= np.mean(z, where=mask)
    z[~mask] = 0.0
    scale = float(max(np.max(z), -np.min(z)))
    if not scale > 1e-12 * float(np.max(np.abs(surface.heights), where=mask, initial=0.0)):
        raise SurfaceError("the map is flat, which leaves no autocorrelation to describe")
    z /= scale
    precision = np.float32 if z.size > _LARGE else np.float64
    up, right = ny // 2, nx // 2
    shape = (ny, nx) if periodic else (fft.next_fast_len(ny + up, True), fft.next_fast_len(nx + right, True))
    products = _pairs(z.astype(precision, copy=False), shape, up, right)
    del z
    if mask.all() and periodic:
        return np.asarray(products / products[up, 0])
    if mask.all():
        across = ny - np.abs(np.arange(-up, up + 1))
        pairs = np.outer(across, nx - np.arange(right + 1)).astype(precision)
    else:
        pairs = np.maximum(np.rint(_pairs(mask.astype(precision), shape, up, right)), 0)
    few = pairs < 0.01 * pairs[up, 0]  # shifts at which nearly nothing overlaps say nothing
    products /= np.maximum(pairs, 1)
    products /= products[up, 0]
    products[few] = 0
    return np.asarray(products)


def _pairs(values: Map, shape: tuple[int, int], up: int, right: int) -> Map:
    """Sums over all pixels of the product with the pixel a shift away."""
    coefficients: Any = fft.rfft2(values, shape, workers=threads())
    np.multiply(coefficients, np.conj(coefficients), out=coefficients)
    sums = fft.irfft2(coefficients, shape, workers=threads(), overwrite_x=True)
    return np.asarray(np.concatenate((sums[-up:, : right + 1], sums[: up + 1, : right + 1])))
