"""Height maps whose slopes are distributed as a family says: truth for everything that looks at surfaces."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft, special
from scipy.interpolate import PchipInterpolator

from microfacet._surface import mixing
from microfacet._surface.checks import MAX_PIXELS, SurfaceError, pixel_sizes, positive, short
from microfacet._surface.surface import Surface

__all__ = ["synthesize"]

Map = NDArray[np.float64]

_CORRELATION_PIXELS = 4.0  # the default: slopes by central differences see all of the spectrum
_SUMMIT_PIXELS, _SCORES = 30, 41  # pixels beyond the last of so many quantiles
_LEAST = 1e-15  # probabilities stay this far inside (0, 1)
_FEWEST_PIXELS = 2.0  # for a correlation length; exp(-10) of the spectrum lies beyond the grid there


def synthesize(
    ndf: Any,
    shape: tuple[int, int],
    pixel_size: float | tuple[float, float] = 1e-6,
    *,
    correlation_length: float | None = None,
    amplitude_length: float | None = None,
    seed: int = 0,
    pinned: bool = False,
) -> Surface:
    r"""A random height map whose slopes at lag 1 follow a distribution.

    Every family but some GTR is a mixture of Beckmann surfaces over their squared roughness m, and the map is
    one in space:

    .. math:: h(x, y) = \sqrt{m(x, y)}\, g(x, y)

    with g a Gaussian field whose slopes have the covariance of the family's Beckmann surface, and m a field
    that varies slowly: a second, independent Gaussian field, whose probabilities become the quantiles of the
    family's mixing law (a Gaussian copula). Locally the surface is a Beckmann surface, rougher here and
    smoother there. Fields are periodic and band-limited; Beckmann needs no m, its map is a Gaussian field.

    A map is a sample: another seed gives another one, whose roughness and shape scatter as those of measured
    maps of the same correlation do. So intervals can be tested with it: they hold the parameters of `ndf` as
    often as they state. A `pinned` map has the law as exactly as a map can, and does not scatter so.

    Parameters
    ----------
    ndf : distribution
        Such as ``StudentT(alpha=0.3, gamma=2.5)``; alpha_x, alpha_y and rotation count. GTR with alpha > 1
        and gamma > 2 is no such mixture. Of a density of your own (`RadialNDF`) the law of m is estimated,
        within 0.003 in probability, or there is none: facets of a ring-shaped density are no mixture.
    shape : (int, int)
        Rows and columns, ``(ny, nx)``.
    pixel_size : float or (float, float)
        ``(dx, dy)`` in metres.
    correlation_length : float, optional
        In metres: the correlation of g is ``exp(-(r/length)^2)``, for an anisotropic family that of the
        geometric mean over the axes. 4 pixels by default, at least 2 along the steeper axis.
    amplitude_length : float, optional
        The same for the field of m, at least twice as long as the longest correlation of g. By default
        the geometric mean of the correlation length and the shorter side of the map.
    seed : int
        Same seed, same map.
    pinned : bool
        Make the mean square slope of g that of the family on this very map, and let the ranks of the second
        field over the map, in place of its probabilities, become the quantiles of m.

    Returns
    -------
    Surface
        Heights of mean 0; `steps` state how they were made.

    Raises
    ------
    SurfaceError
        If the family is no mixture, or the lengths do not fit the map.

    Notes
    -----
    What is exact: at every pixel the law of m and, for Beckmann, that of the slopes, over all seeds; of a
    pinned map, the law of m over the map by ranks and the mean square slope of g. What is not: where m
    varies, the slope has the second part ``g grad sqrt(m)``, which adds about
    ``Var(ln sqrt m) (correlation_length/amplitude_length)^2`` to the mean square of the first; it blunts the
    infinite density at slope 0 of k0 and bessel_k. And a map holds few independent values of m, about one for
    each square of the amplitude length, so the most extreme slopes of one map, a hundred in a million, come
    from its highest summit of m alone.

    Measured on pinned maps of 1024 x 1024 pixels with the default lengths (ten distributions of all families,
    twelve seeds each): a maximum-likelihood fit of the same family returns alpha within 1.5 % (3.5 % for gtr
    and for bessel_k of a = 2.5, whose parameters trade off), gamma within 3.5 %, a within 5 %, all of them
    without bias beyond 0.5 %; slopes an amplitude length apart pass a Kolmogorov-Smirnov test on the radial
    survival. Maps that are not pinned scatter by several times that (docs/fitting_coverage.md).

    Examples
    --------
    >>> import microfacet as mf
    >>> surface = mf.synthesize(mf.StudentT(alpha=0.2, gamma=3.0), (256, 256), pixel_size=1e-6, seed=1)
    >>> surface.heights.shape, surface.steps[0][:40]
    ((256, 256), 'synthetic: student_t with alpha_x 0.2, a')
    >>> gaussian = mf.synthesize(mf.Beckmann(alpha=0.2), (256, 256), pinned=True)
    >>> print(f"{mf.roughness(gaussian).Sdq:.2f}")
    0.20
    """
    rows, columns = _checked_shape(shape)
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise SurfaceError(f"seed must be a whole number in [0, inf), got {short(seed)}")
    size = pixel_sizes(pixel_size)
    quantile, stretch = mixing.quantile(ndf), mixing.stretch(ndf)
    side = min(columns * size[0], rows * size[1])
    length = positive(correlation_length or _CORRELATION_PIXELS * max(size), "correlation_length")
    anisotropy = math.sqrt(float(np.linalg.cond(stretch)))
    if length / anisotropy < _FEWEST_PIXELS * max(size) * (1 - 1e-12):
        raise SurfaceError(
            f"correlation_length must be at least {_FEWEST_PIXELS * anisotropy:.3g} pixels, so that the grid "
            f"resolves the steeper axis, got {length / max(size):.3g}"
        )
    if length * anisotropy > side / 4:
        raise SurfaceError("the map must be at least 4 correlation lengths wide, along the smoother axis too")
    random = np.random.default_rng(seed)
    target = stretch @ stretch.T / 2
    inverse = _matched(target, length, size)
    heights = _gaussian(random, (rows, columns), size, inverse)
    rms = _rms(heights, size, target) if pinned else _expected_rms((rows, columns), size, inverse, target)
    heights /= rms
    steps = f"correlation length {length:g} m"
    if quantile is not None:
        slow = positive(amplitude_length or math.sqrt(length * side), "amplitude_length")
        if not 2 * length * anisotropy <= slow <= side / 2:
            raise SurfaceError(
                f"amplitude_length must lie between twice the longest correlation and half the map, "
                f"{2 * length * anisotropy:g} and {side / 2:g} m, got {slow:g}"
            )
        field = _gaussian(random, (rows, columns), size, np.eye(2) / slow**2)
        shares = _shares(field) if pinned else np.clip(special.ndtr(field), _LEAST, 1 - _LEAST)
        heights *= np.sqrt(quantile(shares))
        steps += f", amplitude length {slow:g} m"
    called = "own density" if ndf.family == "radial" else ndf.family
    values = ", ".join(f"{name} {value:.6g}" for name, value in ndf.parameters.items())
    return Surface(
        heights - np.mean(heights),
        size,
        source=f"synthetic {called}",
        steps=(f"synthetic: {called} with {values}, {steps}, seed {seed}{', pinned' * pinned}",),
    )


def _gaussian(
    random: np.random.Generator, shape: tuple[int, int], size: tuple[float, float], inverse: Map
) -> Map:
    """A periodic Gaussian field of variance 1 with the correlation ``exp(-r^T inverse r)``, by filtering
    white noise.
    """
    root = _root_spectrum(shape, size, inverse)
    variance = np.sum(root**2 * _weights(shape)) / (shape[0] * shape[1])
    field = fft.irfft2(fft.rfft2(random.standard_normal(shape)) * root, s=shape)
    return np.asarray(field / math.sqrt(float(variance)))


def _root_spectrum(shape: tuple[int, int], size: tuple[float, float], inverse: Map) -> Map:
    """The root of the spectrum ``exp(-k^T inverse^-1 k/4)``, at the waves of `rfft2`."""
    kx = 2 * math.pi * fft.rfftfreq(shape[1], size[0])[np.newaxis, :]
    ky = 2 * math.pi * fft.fftfreq(shape[0], size[1])[:, np.newaxis]
    form = np.linalg.inv(inverse)
    exponent = form[0, 0] * kx**2 + 2 * form[0, 1] * kx * ky + form[1, 1] * ky**2
    return np.asarray(np.exp(-exponent / 8))


def _weights(shape: tuple[int, int]) -> Map:
    """For how many waves of the map each column of `rfft2` stands."""
    weights = np.full(shape[1] // 2 + 1, 2.0)
    weights[0] = 1.0
    if shape[1] % 2 == 0:
        weights[-1] = 1.0
    return weights


def _expected_rms(shape: tuple[int, int], size: tuple[float, float], inverse: Map, target: Map) -> float:
    """What `_rms` is of such a field on average over the seeds, from its spectrum."""
    power = _root_spectrum(shape, size, inverse) ** 2 * _weights(shape)
    sx = np.sin(2 * math.pi * fft.rfftfreq(shape[1]))[np.newaxis, :] / size[0]
    sy = np.sin(2 * math.pi * fft.fftfreq(shape[0]))[:, np.newaxis] / size[1]
    own = np.linalg.inv(target)
    square = power * (own[0, 0] * sx**2 + 2 * own[0, 1] * sx * sy + own[1, 1] * sy**2)
    return math.sqrt(float(np.sum(square) / np.sum(power)) / 2)


def _matched(target: Map, length: float, size: tuple[float, float]) -> Map:
    """The quadratic form of a correlation whose slopes *by central differences* have the target's shape.

    In the continuum the covariance of the slopes is twice the form; differences over two pixels see a little
    less of the steeper axis, which the fixed-point iteration makes up for.
    """
    dx, dy = size
    shape = target / math.sqrt(np.linalg.det(target))
    goal, form = _log(shape), _log(shape)
    for _ in range(30):
        m = _exp(form) / length**2
        plus, minus = np.array([dx, dy]), np.array([dx, -dy])
        cross = (math.exp(-minus @ m @ minus) - math.exp(-plus @ m @ plus)) / (2 * dx * dy)
        seen = np.array(
            [
                [-math.expm1(-4 * m[0, 0] * dx * dx) / (2 * dx * dx), cross],
                [cross, -math.expm1(-4 * m[1, 1] * dy * dy) / (2 * dy * dy)],
            ]
        )
        form = form + goal - _log(seen / math.sqrt(np.linalg.det(seen)))
    return _exp(form) / length**2


def _rms(heights: Map, size: tuple[float, float], target: Map) -> float:
    """The root mean square slope by periodic central differences, in units of the target's."""
    p = (np.roll(heights, -1, axis=1) - np.roll(heights, 1, axis=1)) / (2 * size[0])
    q = (np.roll(heights, -1, axis=0) - np.roll(heights, 1, axis=0)) / (2 * size[1])
    inverse = np.linalg.inv(target)
    square = (
        inverse[0, 0] * np.mean(p * p) + 2 * inverse[0, 1] * np.mean(p * q) + inverse[1, 1] * np.mean(q * q)
    )
    return math.sqrt(float(square) / 2)


def _shares(field: Map) -> Map:
    """The share of the map that lies below each pixel, in (0, 1), as a smooth function of the field.

    Ranks as such would jump from pixel to pixel on the highest summit, where the law of m is steep. So the
    normal scores of the ranks are interpolated between quantiles, and extended along straight lines.
    """
    reach = float(special.ndtri(1 - _SUMMIT_PIXELS / field.size))
    scores = np.linspace(-reach, reach, _SCORES)
    places = np.quantile(field, special.ndtr(scores))
    curve = PchipInterpolator(places, scores)
    inside = np.clip(field, places[0], places[-1])
    ends = np.where(field < places[0], float(curve(places[0], 1)), float(curve(places[-1], 1)))
    return np.asarray(special.ndtr(curve(inside) + ends * (field - inside)))


def _log(matrix: Map) -> Map:
    values, axes = np.linalg.eigh(matrix)
    return np.asarray(axes @ np.diag(np.log(values)) @ axes.T)


def _exp(matrix: Map) -> Map:
    values, axes = np.linalg.eigh(matrix)
    return np.asarray(axes @ np.diag(np.exp(values)) @ axes.T)


def _checked_shape(shape: Any) -> tuple[int, int]:
    array = np.asarray(shape)
    if array.shape != (2,) or array.dtype.kind not in "iu" or not (array >= 16).all():
        raise SurfaceError(f"shape must be two whole numbers of at least 16, (ny, nx), got {short(shape)}")
    if int(array[0]) * int(array[1]) > MAX_PIXELS:
        raise SurfaceError(f"a map of {short(shape)} exceeds the limit of {MAX_PIXELS} pixels")
    return int(array[0]), int(array[1])
