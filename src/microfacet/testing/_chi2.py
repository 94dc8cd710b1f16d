"""Pearson's chi-square test of sampled directions against a density."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from microfacet._value import Value
from microfacet.testing._cells import DOMAINS, Cells, theta
from microfacet.testing._quadrature import integrate
from microfacet.testing._threshold import sidak

__all__ = ["Chi2Result", "chi2"]

Array = NDArray[np.float64]
Sampler = Callable[[NDArray[Any]], ArrayLike]

_BATCH = 1 << 17
_PILOTS = 64  # for each cell
_FEWEST = 5.0  # expected samples of a cell; below, the statistic is no chi-square
_MASS = 1e-3  # by which the integral of a density may miss what it should be


@dataclass(frozen=True, eq=False, repr=False)
class Chi2Result(Value):
    """Outcome of `chi2`; true where the sampler passed.

    Attributes
    ----------
    passed : bool
        Whether p_value >= threshold, the density integrates to 1, and no sample lies outside.
    statistic, dof, p_value : float, int, float
        Pearson's statistic, its degrees of freedom, and the probability of one as large by chance.
    threshold : float
        The significance, after Sidak's correction.
    n : int
        Samples tested, without the pilot samples.
    histogram, expected : ndarray, shape (cells,)
        What was counted and what the density predicts, before cells were pooled.
    cells : ndarray, shape (cells, 4)
        theta from, to, phi from, to of each.
    mass : float
        Integral of the density over the domain.
    outside : int
        Samples outside the domain, or nan.
    """

    passed: bool
    statistic: float
    dof: int
    p_value: float
    threshold: float
    n: int
    histogram: NDArray[np.int64]
    expected: Array
    cells: Array
    mass: float
    outside: int

    def __post_init__(self) -> None:
        self._keep(**self._state())

    def __bool__(self) -> bool:
        return self.passed

    def __repr__(self) -> str:
        words = [
            f"p = {self.p_value:.2g} against {self.threshold:.2g}",
            f"chi-square {self.statistic:.1f} of {self.dof} degrees",
            f"{self.n:,} samples",
        ]
        if self.outside:
            words.append(f"{self.outside:,} outside")
        if abs(self.mass - 1.0) > _MASS:
            words.append(f"the density integrates to {self.mass:.4g}")
        return f"Chi2Result({'passed' if self.passed else 'failed'}: {', '.join(words)})"


def chi2(
    samples: Sampler | ArrayLike,
    density: Callable[[Array], ArrayLike],
    *,
    domain: str = "hemisphere",
    n: int = 1_000_000,
    dims: int = 2,
    dtype: DTypeLike = np.float64,
    resolution: tuple[int, int] = (32, 32),
    seed: int | np.random.Generator = 0,
    significance: float = 0.01,
    tests: int = 1,
    lossy: bool = False,
) -> Chi2Result:
    """Whether sampled directions follow a density, by Pearson's chi-square test.

    Parameters
    ----------
    samples : callable or array_like, shape (N, 3)
        The sampler: uniform random numbers (k, dims) in [0, 1) to directions (k, 3). Or directions that have
        been drawn independently; the first of them then decide on the cells and are not tested.
    density : callable
        Directions (..., 3), of unit length and inside the domain, to their density per steradian (...).
    domain : {"hemisphere", "sphere"}
        Where the density is not 0: z >= 0 or everywhere.
    n : int
        How many directions to draw, beside the pilot samples.
    dims : int
        Random numbers that the sampler takes for one direction.
    dtype : float64 or float32
        Of the random numbers.
    resolution : (int, int)
        Strips of the polar angle, and cells of each strip. More cells see finer detail, fewer see a small
        deviation of the whole sooner.
    seed : int or numpy.random.Generator
        Same seed, same result.
    significance : float
        Probability that a correct sampler fails, in all of
    tests : int
        tests of a series (Sidak's correction; see `sidak`).
    lossy : bool
        Whether the density may integrate to less than 1, the rest being samples that are nan or outside the
        domain, as a sampler of reflected directions draws some below the horizon.

    Returns
    -------
    Chi2Result
        True where the sampler passed.

    Raises
    ------
    ValueError
        If what the callables return has the wrong shape, if the density is negative, infinite or too rough
        to integrate, or if there are too few samples for two cells.

    Notes
    -----
    Cells hold about the same share of 64 pilot samples per cell, so that a lobe is resolved whatever its
    width. The density is integrated over each by Gauss quadrature, halved until the error is small beside
    the scatter of the count. Neighbouring cells are pooled until 5 samples are expected.

    Examples
    --------
    A sampler of your own, here of the cosine lobe, and one that gets it wrong:

    >>> import numpy as np
    >>> from microfacet.testing import chi2
    >>> def cosine(xi, power=0.5):
    ...     s, phi = xi[:, 0] ** power, 2 * np.pi * xi[:, 1]
    ...     return np.stack([s * np.cos(phi), s * np.sin(phi), np.sqrt(1 - s**2)], axis=-1)
    >>> bool(chi2(cosine, lambda m: m[..., 2] / np.pi, n=100_000))
    True
    >>> bool(chi2(lambda xi: cosine(xi, 0.52), lambda m: m[..., 2] / np.pi, n=100_000))
    False
    """
    if domain not in DOMAINS:
        raise ValueError(f"domain must be 'hemisphere' or 'sphere', got {domain!r}")
    if min(resolution) < 1 or resolution[0] * resolution[1] < 2:
        raise ValueError(f"resolution must be two positive numbers of at least 2 cells, got {resolution}")
    threshold = sidak(significance, tests)
    number = resolution[0] * resolution[1]
    pilot, batches = _draws(samples, _PILOTS * number, n, dims, np.dtype(dtype), seed)
    pilot = pilot[np.isfinite(pilot).all(axis=-1)]
    cells = Cells.around(pilot, DOMAINS[domain], *resolution)
    histogram = np.zeros(len(cells), dtype=np.int64)
    n = outside = 0
    for batch in batches:
        counts, beyond = cells.count(batch)
        histogram += counts
        n, outside = n + len(batch), outside + beyond
    # A hundredth of the scatter of a cell's count.
    shares = integrate(lambda m: np.asarray(density(m)), cells, 0.01 / math.sqrt(n * len(histogram)))
    mass = float(shares.sum())
    observed, expected = _pooled(histogram, n * shares)
    if lossy and n * (1.0 - mass) >= _FEWEST:
        observed, expected = np.append(observed, outside), np.append(expected, n * (1.0 - mass))
    whole = mass <= 1.0 + _MASS and (lossy or mass >= 1.0 - _MASS)
    none_lost = outside == 0 or (lossy and n * (1.0 - mass) >= _FEWEST)
    statistic, dof, p_value = _pearson(observed, expected)
    passed = bool(p_value >= threshold and whole and none_lost)
    rectangles = cells.rectangles
    rectangles[:, :2] = theta(rectangles[:, :2])
    outcome = (passed, statistic, dof, p_value, threshold, n)
    return Chi2Result(*outcome, histogram, n * shares, rectangles, mass, outside)


def _draws(
    samples: Sampler | ArrayLike,
    pilots: int,
    n: int,
    dims: int,
    dtype: np.dtype[Any],
    seed: int | np.random.Generator,
) -> tuple[NDArray[Any], Iterator[NDArray[Any]]]:
    """Pilot samples, and the samples to be tested in batches."""
    if not callable(samples):
        given = _directions(np.asarray(samples), None)
        pilots = min(pilots, len(given) // 4)
        return given[:pilots], (given[i : i + _BATCH] for i in range(pilots, len(given), _BATCH))
    if n < 1:
        raise ValueError(f"n must be at least 1, got {n}")
    rng = np.random.default_rng(seed)

    def draw(count: int) -> NDArray[Any]:
        xi = rng.random((count, dims), dtype=dtype.type)
        return _directions(np.asarray(samples(xi)), count)

    return draw(pilots), (draw(min(_BATCH, n - i)) for i in range(0, n, _BATCH))


def _directions(array: NDArray[Any], count: int | None) -> NDArray[Any]:
    if array.ndim != 2 or array.shape[-1] != 3 or count not in (None, len(array)):
        raise ValueError(f"samples must be directions of shape ({count or 'N'}, 3), got {array.shape}")
    return array


def _pooled(histogram: NDArray[np.int64], expected: Array) -> tuple[Array, Array]:
    """Neighbouring cells joined until each has enough expected samples; what is left joins the last."""
    ends, gathered = [], 0.0
    for i, share in enumerate(expected):
        gathered += share
        if gathered >= _FEWEST:
            ends.append(i + 1)
            gathered = 0.0
    starts = np.array([0, *ends[:-1]])
    return np.add.reduceat(histogram.astype(np.float64), starts), np.add.reduceat(expected, starts)


def _pearson(observed: Array, expected: Array) -> tuple[float, int, float]:
    from scipy.stats import chi2 as distribution

    if len(expected) < 2:
        raise ValueError(
            "fewer than two cells have five expected samples: draw more samples or check the density"
        )
    statistic = float(np.sum((observed - expected) ** 2 / expected))
    dof = len(expected) - 1
    return statistic, dof, float(distribution.sf(statistic, dof))
