"""`fit`: the maximum of the likelihood of each family, and their ranking."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize

from microfacet._family import Family
from microfacet._family import families as all_families
from microfacet._fit.model import Model, model_of
from microfacet._fit.slopes import MAX_SLOPES, Slopes, prepare
from microfacet._surface import Surface

__all__ = ["FitResult", "fit"]

_SHAPE_STARTS = (0.1, 0.4, 1.0, 2.5, 6.0, 20.0)  # above the lower end of the parameter's interval
_FIRST_SEARCH = 4000  # slopes for the search from several starts


@dataclass(frozen=True)
class FitResult:
    """A family fitted to slopes by maximum likelihood.

    Attributes
    ----------
    family : str
        Name of the family.
    params : dict of str to float
        ``alpha_x``, ``alpha_y``, ``rotation`` (radians, counter-clockwise, in [-pi/4, pi/4]) and ``gamma`` or
        ``a`` if the family has one; for ``gtr`` ``alpha`` and ``gamma``.
    log_likelihood : float
        Natural logarithm of the likelihood, summed over the `n` slopes.
    n : int
        Number of slopes that were used.
    aic, bic : float
        Akaike's and Schwarz's criterion with ``len(params)`` parameters. The mean slope, which all families
        share, is not counted. Both take the slopes for independent; neighbouring slopes of a measured map are
        not, so differences between families are overstated.
    ndf : distribution
        The fitted distribution, for example a `StudentT`.
    mean_slope : (float, float)
        Mean slope of the sample (estimated by the median), subtracted before the fit.
    lag : int or None
        Lag in pixels at which the slopes of a surface were taken. alpha and shape depend on it.
    converged : bool
        Whether the search ended in a maximum.
    notes : tuple of str
        What a reader of the numbers should know: slopes left out, a parameter at the edge of its range.
    """

    family: str
    params: dict[str, float]
    log_likelihood: float
    n: int
    aic: float
    bic: float
    ndf: Any
    mean_slope: tuple[float, float]
    lag: int | None
    converged: bool
    notes: tuple[str, ...] = ()


def fit(
    slopes_or_surface: ArrayLike | Surface,
    families: str | Iterable[str] | None = None,
    lag: int | None = None,
    max_slopes: int | None = MAX_SLOPES,
) -> list[FitResult]:
    r"""Fit families of slope densities by maximum likelihood, best first.

    For each family the roughness, its axes and the shape parameter maximise

    .. math:: \sum_i \log P_{22}(p_i - \bar p, q_i - \bar q)

    where :math:`(\bar p, \bar q)` is the mean slope. A surface need not be levelled: a plane changes only the
    mean slope. Slopes of quantised heights that fall into the cell of quantisation around the mean slope
    count with the root mean square slope of that cell, because k0 and bessel_k are infinite at slope 0.

    Parameters
    ----------
    slopes_or_surface : array_like, shape (N, 2), or Surface
        Slopes ``(p, q)`` along x and y (dimensionless, N >= 20, in [-1e6, 1e6]), or a surface to take them
        from.
    families : str or iterable of str, optional
        Names of families; all six by default.
    lag : int, optional
        Lag in pixels at which slopes of a surface are taken; the surface's own `lag` by default. alpha and
        shape depend on it.
    max_slopes : int or None
        Of more slopes than this, so many are drawn at random, with a fixed seed (the result says so in
        `notes`). None uses all.

    Returns
    -------
    list of FitResult
        Ranked by the Bayesian information criterion, smallest (best) first. Between families with the same
        number of parameters that is the likelihood; a family that contains another, such as student_t and
        ggx, has to gain more than its extra parameter would by chance.

    Raises
    ------
    ValueError
        If the slopes are not finite numbers of shape (N, 2), are too few, constant, or on one line; if a name
        is unknown; if `lag` is given for slopes.

    References
    ----------
    G. Schwarz, Estimating the dimension of a model, Annals of Statistics 6, 1978.

    Examples
    --------
    >>> import numpy as np
    >>> import microfacet as mf
    >>> rng = np.random.default_rng(1)
    >>> radius, azimuth = mf.ggx.sample_slope(rng.random(5000), 1.0), 2 * np.pi * rng.random(5000)
    >>> slopes = np.column_stack((0.1 * radius * np.cos(azimuth), 0.4 * radius * np.sin(azimuth)))
    >>> best = mf.fit(slopes)[0]
    >>> best.family, round(best.params["alpha_x"], 1), round(best.params["alpha_y"], 1)
    ('ggx', 0.1, 0.4)
    """
    chosen = _chosen(families)
    if max_slopes is not None and not max_slopes >= 20:
        raise ValueError(f"max_slopes must lie in [20, inf) or be None, got {max_slopes}")
    if isinstance(slopes_or_surface, Surface):
        lag = slopes_or_surface.lag if lag is None else lag
        slopes = prepare(slopes_or_surface.slopes(lag), max_slopes)
    elif lag is not None:
        raise ValueError(f"lag applies to a Surface, not to slopes, got {lag}")
    else:
        slopes = prepare(slopes_or_surface, max_slopes)
    return sorted((_fit_family(family, slopes, lag) for family in chosen), key=lambda result: result.bic)


def _chosen(names: str | Iterable[str] | None) -> list[Family]:
    known = {family.name: family for family in all_families()}
    wanted = list(known) if names is None else [names] if isinstance(names, str) else list(names)
    for name in wanted:
        if name not in known:
            raise ValueError(f"families must be among {', '.join(known)}, got {name!r}")
    if not wanted:
        raise ValueError("families must name at least one family, got none")
    return [known[name] for name in dict.fromkeys(wanted)]


class _Maximum(NamedTuple):
    variables: NDArray[np.float64]
    mean_log_density: float
    gradient: NDArray[np.float64]


def _fit_family(family: Family, slopes: Slopes, lag: int | None) -> FitResult:
    model = model_of(family, slopes)
    found = _maximise(model, _first_search(family, slopes.part(_FIRST_SEARCH)))
    params = model.parameters(found.variables)
    log_likelihood = slopes.n * found.mean_log_density
    return FitResult(
        family=family.name,
        params=params,
        log_likelihood=log_likelihood,
        n=slopes.n,
        aic=2 * len(params) - 2 * log_likelihood,
        bic=len(params) * math.log(slopes.n) - 2 * log_likelihood,
        ndf=family.cls(**params),
        mean_slope=slopes.mean,
        lag=lag,
        converged=_is_maximum(found, model.bounds),
        notes=slopes.notes + _edge_notes(family, found, model.bounds),
    )


def _first_search(family: Family, part: Slopes) -> NDArray[np.float64]:
    """The best of the maxima that are reached from the two best starts, on a part of the slopes."""
    model = model_of(family, part)
    shapes: list[float | None] = [
        shape.lower + start for shape in family.parameters[1:] for start in _SHAPE_STARTS
    ]
    candidates = [model.start(shape) for shape in shapes or [None]]
    starts = sorted(candidates, key=model.mean_log_density, reverse=True)[:2]
    return max(
        (_maximise(model, start) for start in starts), key=lambda found: found.mean_log_density
    ).variables


def _maximise(model: Model, start: NDArray[np.float64]) -> _Maximum:
    def loss(variables: NDArray[np.float64]) -> float:
        return -model.mean_log_density(variables)

    def loss_gradient(variables: NDArray[np.float64]) -> NDArray[np.float64]:
        return -model.gradient(variables)

    found = minimize(
        loss,
        start,
        jac=loss_gradient,
        method="L-BFGS-B",
        bounds=model.bounds,
        options={"gtol": 1e-6, "ftol": 1e-13, "maxiter": 200},
    )
    return _Maximum(np.asarray(found.x), -float(found.fun), -np.asarray(found.jac))


def _is_maximum(found: _Maximum, bounds: list[tuple[float, float]]) -> bool:
    """Whether the gradient vanishes, but for components that push against a bound."""
    low, high = np.array(bounds).T
    pushed = np.clip(found.variables + found.gradient, low, high) - found.variables
    return bool(math.isfinite(found.mean_log_density) and np.abs(pushed).max() < 1e-4)


def _edge_notes(family: Family, found: _Maximum, bounds: list[tuple[float, float]]) -> tuple[str, ...]:
    low, high = bounds[-1]
    end = {low: "lower", high: "upper"}.get(float(found.variables[-1]))
    return tuple(
        f"{parameter.name} is at the {end} end of the range that is searched"
        for parameter in family.parameters[1:]
        if end is not None
    )
