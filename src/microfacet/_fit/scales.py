"""Roughness and shape against the lag at which slopes are taken."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from microfacet._family import Family
from microfacet._fit.estimate import Candidates, Progress, chosen_families, fit
from microfacet._fit.model import ANISOTROPIC
from microfacet._fit.result import FitResult, one_a_family
from microfacet._profile import Profile
from microfacet._surface import Surface
from microfacet._value import Value

__all__ = ["ScaleFit", "by_family", "fit_scales"]

_MAX_SLOPES = 200_000
_FEWEST_BASELINES = 8  # that have to fit side by side into the map
# alpha goes with this power of the lag for heights that do not depend on each other (-1), with some room: a
# random walk has -1/2, a smooth surface 0.
_NOISE_EXPONENT = -0.85


@dataclass(frozen=True, eq=False)
class ScaleFit(Value):
    """Fits of one surface at several lags.

    Attributes
    ----------
    lags : tuple of int
        In pixels, ascending; slopes are differences over twice the lag.
    lengths : tuple of float
        The same in metres (of the two pixel sizes, the geometric mean).
    results : tuple of list of FitResult
        For each lag, what `fit` returns.
    typical_slopes : tuple of float
        For each lag the median length of the slope, in directions of equal roughness (under the first
        family).
    exponents : tuple of float
        Between each lag and the next, the power of the lag with which the typical slope goes: 0 for a surface
        that is smooth at these lags, -1 for heights that do not depend on each other.
    noise_lags : tuple of int
        Lags at which the roughness is that of noise: from the smallest, as long as the exponent stays below
        -0.85.
    notes : tuple of str
        What the numbers say of the map.
    """

    lags: tuple[int, ...]
    lengths: tuple[float, ...]
    results: tuple[list[FitResult], ...]
    typical_slopes: tuple[float, ...]
    exponents: tuple[float, ...]
    noise_lags: tuple[int, ...]
    notes: tuple[str, ...]


def fit_scales(
    surface: Surface | Profile,
    lags: Iterable[int] | None = None,
    families: Candidates = None,
    max_slopes: int | None = _MAX_SLOPES,
    progress: Progress | None = None,
    *,
    symmetry: str | None = None,
) -> ScaleFit:
    """Fit a surface at several lags, and say where its roughness is that of noise.

    Roughness has no value of its own: alpha and shape depend on the lag over which slopes are taken.
    Measurement noise that differs from pixel to pixel shows itself by alpha halving when the lag doubles: the
    difference of two heights that do not depend on each other is the same at every distance.

    Parameters
    ----------
    surface : Surface or Profile
        The map or profile, prepared as it shall be fitted.
    lags : iterable of int, optional
        In pixels, at least 1; by default 1, 2, 4, ... as far as 8 baselines of 2 lags fit side by side into
        the map.
    families
        As in `fit`.
    max_slopes : int or None
        As in `fit`, for each lag.
    progress : callable, optional
        Called with (what begins, steps done, steps in all).
    symmetry : {"isotropic", "anisotropic"}, optional
        As in `fit`.

    Returns
    -------
    ScaleFit

    Raises
    ------
    ValueError
        If there is no lag or the map is too small for one; as in `fit`.

    Examples
    --------
    >>> import numpy as np
    >>> import microfacet as mf
    >>> heights = np.random.default_rng(1).normal(size=(128, 128))
    >>> scales = mf.fit_scales(mf.Surface(heights, 10.0), families="beckmann")
    >>> scales.lags, scales.noise_lags
    ((1, 2, 4, 8), (1, 2, 4, 8))
    """
    if not isinstance(surface, Surface | Profile):
        raise ValueError(f"surface must be a Surface or a Profile, got {type(surface).__name__}")
    chosen = tuple(sorted(set(_default_lags(surface) if lags is None else lags)))
    if not chosen:
        raise ValueError("lags must name at least one lag, got none")
    candidates = chosen_families(families)
    named, progress = None if families is None else candidates, progress or (lambda *_: None)
    results = []
    for done, lag in enumerate(chosen):
        progress(f"lag {lag}", done, len(chosen))
        results.append(fit(surface, named, lag, max_slopes, symmetry=symmetry))
    chosen = tuple(int(found[0].lag or 0) for found in results)
    typical = tuple(_typical_slope(found[0], candidates) for found in results)
    exponents = tuple(
        math.log(typical[k + 1] / typical[k]) / math.log(chosen[k + 1] / chosen[k])
        for k in range(len(chosen) - 1)
    )
    noise = _noise_lags(chosen, exponents)
    pixel = surface.spacing if isinstance(surface, Profile) else math.sqrt(math.prod(surface.pixel_size))
    return ScaleFit(
        chosen,
        tuple(lag * pixel for lag in chosen),
        tuple(results),
        typical,
        exponents,
        noise,
        _notes(chosen, noise),
    )


def by_family(results: Sequence[Sequence[FitResult]]) -> list[dict[str, FitResult]]:
    """For each lag the families' fits, with the same symmetry of a family at all of them: two axes if they
    rank before the one roughness at any lag, since they hold it too.
    """
    axes = {one.family for at in results for one in one_a_family(at) if one.symmetry == ANISOTROPIC}
    kept = []
    for at in results:
        own = [one for one in at if one.family not in axes or one.symmetry == ANISOTROPIC]
        kept.append({one.family: one for one in own})
    return kept


def _default_lags(surface: Surface | Profile) -> list[int]:
    lags = [1]
    if isinstance(surface, Profile):
        size = max(trace.size for trace in surface.traces)
    else:
        size = min(surface.heights.shape)
    while 2 * 2 * lags[-1] * _FEWEST_BASELINES <= size:
        lags.append(2 * lags[-1])
    return lags


def _typical_slope(result: FitResult, candidates: list[Family]) -> float:
    """The median slope in standard space times the mean roughness, whatever the parameters are that
    express it.
    """
    family = next(candidate for candidate in candidates if candidate.name == result.family)
    shape = [result.params[parameter.name] for parameter in family.parameters[1:]]
    if not family.anisotropic:
        return float(family.kernels.sample_slope(0.5, result.params["alpha"], *shape))
    return math.sqrt(math.prod(result.roughness)) * float(family.kernels.sample_slope(0.5, 1.0, *shape))


def _noise_lags(lags: tuple[int, ...], exponents: tuple[float, ...]) -> tuple[int, ...]:
    count = 0
    while count < len(exponents) and exponents[count] < _NOISE_EXPONENT:
        count += 1
    return lags[: count + 1] if count else ()


def _notes(lags: tuple[int, ...], noise: tuple[int, ...]) -> tuple[str, ...]:
    if not noise:
        return ()
    reach = "at every lag" if noise == lags else f"from lag {noise[0]} to {noise[-1]}"
    advice = (
        "" if noise == lags else f"; a surface shows itself at lags above {noise[-1]} or behind an S-filter"
    )
    return (
        f"dominated by noise: alpha goes as 1/lag {reach}, as for heights that differ from pixel to pixel "
        f"whatever their distance, so that these fits describe the noise{advice}",
    )
