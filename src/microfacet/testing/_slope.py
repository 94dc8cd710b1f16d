"""Kolmogorov-Smirnov test of visible slopes in the plane of incidence, against their closed distribution."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from microfacet._value import Value
from microfacet.testing._threshold import sidak

__all__ = ["SlopeResult", "ks_visible_slope", "visible_slope_cdf"]

Array = NDArray[np.float64]

# Slopes that a unit normal of these components can hold.
_STEEPEST = {"float32": 1e17, "float64": 1e149}


@dataclass(frozen=True, eq=False, repr=False)
class SlopeResult(Value):
    """Outcome of `ks_visible_slope`; true where the sampler passed.

    Attributes
    ----------
    passed : bool
        Whether p_value >= threshold.
    statistic : float
        Largest distance between the two distribution functions.
    p_value, threshold : float
        Probability of one as large by chance, and the significance after Sidak's correction.
    n : int
        Samples.
    """

    passed: bool
    statistic: float
    p_value: float
    threshold: float
    n: int

    def __bool__(self) -> bool:
        return self.passed

    def __repr__(self) -> str:
        verdict = "passed" if self.passed else "failed"
        return (
            f"SlopeResult({verdict}: p = {self.p_value:.2g} against {self.threshold:.2g}, "
            f"distance {self.statistic:.2g}, {self.n:,} samples)"
        )


def visible_slope_cdf(ndf: Any, w: ArrayLike, p: ArrayLike) -> Array:
    """Probability that a normal seen from `w` has a slope of at most `p` in the plane of incidence.

    With c = w.z, s = |(w.x, w.y)|, F the distribution function of slopes along the azimuth of w and
    J(-p) = int_-inf^p F, it is ((c - s p) F(p) + s J(-p))/sigma(w) up to p = c/s, beyond which facets face
    away. No term is negative, so that it keeps its digits below the horizon, too.

    Parameters
    ----------
    ndf : distribution
        Of this library.
    w : array_like, shape (3,)
        Unit direction with sigma(w) > 0. Where it is vertical, the plane is that of x.
    p : array_like

    Examples
    --------
    >>> import microfacet as mf
    >>> w = [0.8, 0.0, 0.6]
    >>> print(f"{mf.testing.visible_slope_cdf(mf.GGX(alpha=0.5), w, 0.0):.6g}")
    0.756939
    """
    w = np.asarray(w, dtype=np.float64)
    along, s = _azimuth(w)
    p = np.minimum(np.asarray(p, dtype=np.float64), w[2] / s if s > 0.0 else np.inf)
    # sigma is homogeneous: towards (along, p), not of unit length, it is E[(p - slope)+] = J(-p).
    excess = ndf.sigma(np.broadcast_to(along[0], p.shape), np.broadcast_to(along[1], p.shape), p)
    below = ndf.slope_cdf(p * _stretch(ndf, along))
    with np.errstate(invalid="ignore"):
        return np.asarray(((w[2] - s * p) * below + (s * excess if s > 0.0 else 0.0)) / ndf.sigma(w))


def ks_visible_slope(
    ndf: Any,
    w: ArrayLike,
    *,
    sampler: Callable[[NDArray[Any]], ArrayLike] | None = None,
    n: int = 1_000_000,
    dims: int | None = None,
    dtype: DTypeLike = np.float64,
    seed: int | np.random.Generator = 0,
    significance: float = 0.01,
    tests: int = 1,
) -> SlopeResult:
    """Whether the slopes of sampled visible normals follow their distribution in the plane of incidence.

    It sees a small shift of all slopes sooner than `chi2` does, and none across that plane.

    Parameters
    ----------
    ndf : distribution
        Of this library.
    w : array_like, shape (3,)
        Unit direction with sigma(w) > 0.
    sampler : callable, optional
        Uniform random numbers (k, dims) to normals (k, 3); by default ``ndf.sample_visible`` towards `w`.
    n, dims, dtype, seed, significance, tests
        As for `chi2`; `dims` is ``ndf.visible_dims`` by default.

    Returns
    -------
    SlopeResult

    Examples
    --------
    >>> import microfacet as mf
    >>> bool(mf.testing.ks_visible_slope(mf.Beckmann(alpha=0.3), [0.8, 0.0, 0.6], n=10_000))
    True
    """
    from scipy.stats import kstest

    threshold = sidak(significance, tests)
    w = np.asarray(w, dtype=np.float64)
    rng = np.random.default_rng(seed)
    kind: Any = np.dtype(dtype).type
    xi = rng.random((n, ndf.visible_dims if dims is None else dims), dtype=kind)
    normals = np.asarray(sampler(xi) if sampler else ndf.sample_visible(w, xi))
    steepest = _STEEPEST["float32" if normals.dtype == np.float32 else "float64"]
    m = normals.astype(np.float64)
    along, _ = _azimuth(w)
    with np.errstate(divide="ignore", invalid="ignore"):
        p = -(m[:, 0] * along[0] + m[:, 1] * along[1]) / m[:, 2]
    u = visible_slope_cdf(ndf, w, np.maximum(p, -steepest))
    u = np.where(p <= -steepest, u * rng.random(n), u)  # too steep to be told apart: counted alone
    outcome = kstest(u, "uniform")
    statistic, p_value = float(outcome.statistic), float(outcome.pvalue)
    return SlopeResult(p_value >= threshold, statistic, p_value, threshold, n)


def _azimuth(w: Array) -> tuple[Array, float]:
    """The unit vector below `w` in the plane, and the length of its projection."""
    if w.shape != (3,):
        raise ValueError(f"w must have shape (3,), got {w.shape}")
    s = float(np.hypot(w[0], w[1]))
    return (w[:2] / s if s > 0.0 else np.array([1.0, 0.0])), s


def _stretch(ndf: Any, along: Array) -> float:
    """Roughness along x over roughness along the azimuth: slopes along both differ by that factor alone."""
    parameters = ndf.parameters
    if "alpha_x" not in parameters:
        return 1.0

    def roughness(angle: float) -> float:
        turn = angle - parameters["rotation"]
        return float(np.hypot(parameters["alpha_x"] * np.cos(turn), parameters["alpha_y"] * np.sin(turn)))

    return roughness(0.0) / roughness(float(np.arctan2(along[1], along[0])))
