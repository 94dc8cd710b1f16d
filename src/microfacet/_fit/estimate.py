"""`fit`: the maximum of the likelihood of each family, what is known of it, and the families' ranking."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._family import Family
from microfacet._family import families as all_families
from microfacet._fit import blocks
from microfacet._fit.errors import Uncertainty, azimuth_of_x, parameters, uncertainty
from microfacet._fit.goodness import goodness
from microfacet._fit.model import Model, State
from microfacet._fit.newton import fold_state, maximise
from microfacet._fit.result import FitResult
from microfacet._fit.search import searches
from microfacet._fit.slopes import MAX_SLOPES, Slopes, prepare
from microfacet._radial import RadialNDF
from microfacet._surface import Surface
from microfacet._user_family import family_of

__all__ = ["Candidates", "Progress", "chosen_families", "fit"]

#: What is fitted: names of families, families of one's own, densities whose roughness alone is free.
Candidates = str | Family | RadialNDF | Iterable[str | Family | RadialNDF] | None
#: Told what begins, how many steps are done, and how many there are.
Progress = Callable[[str, int, int], None]


def fit(
    slopes_or_surface: ArrayLike | Surface,
    families: Candidates = None,
    lag: int | None = None,
    max_slopes: int | None = MAX_SLOPES,
    progress: Progress | None = None,
) -> list[FitResult]:
    r"""Fit families of slope densities by maximum likelihood, best first.

    For each family the roughness, its axes and the shape parameter maximise

    .. math:: \sum_i \log P_{22}(p_i - \bar p, q_i - \bar q)

    where :math:`(\bar p, \bar q)` is the mean slope. It is estimated by the median, for all families alike:
    the likelihood of k0 and bessel_k is infinite where the mean meets a slope of the sample, so their maximum
    does not exist; and as the densities are symmetric, the mean and the other parameters are estimated
    independently of each other. A surface need not be levelled: a plane changes only the mean slope. Slopes
    of quantised heights that fall into the cell of quantisation around the mean slope count with the root
    mean square slope of that cell, because k0 and bessel_k are infinite at slope 0.

    Parameters
    ----------
    slopes_or_surface : array_like, shape (N, 2), or Surface
        Slopes ``(p, q)`` along x and y (dimensionless, N >= 20, in [-1e6, 1e6]), or a surface to take them
        from. Slopes are taken for independent of each other; those of a surface are not.
    families : str, UserFamily, RadialNDF or iterable of them, optional
        Names of families; families of your own, whose parameters are fitted; densities of your own, of which
        the roughness is. All families of the library by default.
    lag : int, optional
        Lag in pixels at which slopes of a surface are taken; the surface's own `lag` by default. alpha and
        shape depend on it.
    max_slopes : int or None
        Of more slopes than this, so many are drawn at random, with a fixed seed (the result says so in
        `notes`). None uses all.
    progress : callable, optional
        Called with (what begins, steps done, steps in all).

    Returns
    -------
    list of FitResult
        Best first: by `held_out`, the log-likelihood of slopes that were left out of the fit. Families within
        two standard errors of the largest are tied, stand first, and are ordered by the Bayesian information
        criterion: of two that describe the slopes equally well, the one with fewer parameters is the better
        description.

    Raises
    ------
    ValueError
        If the slopes are not finite numbers of shape (N, 2), are too few, constant, or on one line; if a name
        is unknown; if `lag` is given for slopes.

    References
    ----------
    G. Schwarz, Estimating the dimension of a model, Annals of Statistics 6, 1978. M. Stone, Cross-validatory
    choice and assessment of statistical predictions, JRSS B 36, 1974. D. R. Roberts et al., Cross-validation
    strategies for data with temporal, spatial, hierarchical, or phylogenetic structure, Ecography 40, 2017.

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
    >>> abs(best.params["alpha_x"] - 0.1) < 3 * best.standard_errors["alpha_x"] < 0.01
    True
    """
    chosen, progress = chosen_families(families), progress or (lambda *_: None)
    if max_slopes is not None and not max_slopes >= 20:
        raise ValueError(f"max_slopes must lie in [20, inf) or be None, got {max_slopes}")
    if isinstance(slopes_or_surface, Surface):
        surface = slopes_or_surface
        lag = surface.lag if lag is None else lag
        slopes = prepare(surface.slopes(lag), max_slopes, blocks.cells_of_map(surface.mask, lag))
    elif lag is not None:
        raise ValueError(f"lag applies to a Surface, not to slopes, got {lag}")
    else:
        slopes = prepare(slopes_or_surface, max_slopes)
    found = []
    for done, family in enumerate(chosen):
        progress(family.title, done, len(chosen))
        found.append(_fit_family(family, slopes))
    return _ranked(found, slopes, lag)


def chosen_families(names: Candidates) -> list[Family]:
    """The families of these names, for None all that have a density; `ValueError` for another name."""
    known = {family.name: family for family in all_families() if not family.singular}
    one = isinstance(names, str | Family | RadialNDF)
    wanted: list[Any] = list(known) if names is None else [names] if one else list(names)  # type: ignore[arg-type]
    if not wanted:
        raise ValueError("families must name at least one family, got none")
    found: dict[str, Family] = {}
    for name in wanted:
        family = family_of(name) if isinstance(name, RadialNDF) else name
        if not isinstance(family, Family):
            if any(name == family.name for family in all_families() if family.singular):
                raise ValueError(f"families: {name} has no density to fit, its facets have one slope")
            if name not in known:
                raise ValueError(f"families must be among {', '.join(known)}, got {name!r}")
            family = known[name]
        if found.setdefault(family.name, family) != family:
            raise ValueError(f"families: two have the name {family.name}")
    return list(found.values())


class _Fitted(NamedTuple):
    model: Model
    state: State
    uncertainty: Uncertainty
    log_likelihood: float
    held_out: NDArray[np.float64]  # log-likelihood of each group under the fit without its fold
    converged: bool
    notes: tuple[str, ...]


def _fit_family(family: Family, slopes: Slopes) -> _Fitted:
    model, found = maximise(family, slopes)
    held_out = np.zeros(len(slopes.sizes))
    for fold in range(blocks.FOLDS):
        held_out += model.value(fold_state(model, found, fold), only=fold)
    known = uncertainty(model, found)
    return _Fitted(
        model,
        found.state,
        known,
        float(np.sum(found.sums.value)),
        held_out,
        found.converged,
        slopes.notes + _edge_notes(family, found.state) + known.notes,
    )


def _ranked(found: list[_Fitted], slopes: Slopes, lag: int | None) -> list[FitResult]:
    """One result per family; the effective number of slopes is that under the best family."""
    best = max(found, key=lambda fitted: float(np.sum(fitted.held_out)))
    share = best.uncertainty.independent_share
    results = [_result(fitted, best, share, slopes, lag) for fitted in found]
    order = sorted(
        results, key=lambda result: (not result.tied, result.bic if result.tied else -result.held_out)
    )
    first = next(fitted for fitted in found if fitted.model.family.name == order[0].family)
    errors = {fitted.model.family.name: _difference_error(first, fitted, slopes) for fitted in found}
    return [replace(result, held_out_error=errors[result.family]) for result in order]


def _result(fitted: _Fitted, best: _Fitted, share: float, slopes: Slopes, lag: int | None) -> FitResult:
    model, state, n = fitted.model, fitted.state, slopes.n
    params = parameters(model, state)
    effective, per_slope = max(share * n, 1.0), fitted.log_likelihood / n
    behind = float(np.sum(best.held_out - fitted.held_out)) / n
    return FitResult(
        family=model.family.name,
        params=params,
        standard_errors=fitted.uncertainty.errors,
        log_likelihood=fitted.log_likelihood,
        log_likelihood_per_sample=per_slope,
        held_out=float(np.sum(fitted.held_out)) / n,
        held_out_error=0.0,
        tied=behind <= 2 * _difference_error(best, fitted, slopes),
        n=n,
        n_effective=effective,
        aic=2 * len(params) - 2 * effective * per_slope,
        bic=len(params) * math.log(effective) - 2 * effective * per_slope,
        ndf=model.family.cls(**params),
        mean_slope=slopes.mean,
        mean_slope_errors=slopes.mean_errors,
        lag=lag,
        converged=fitted.converged,
        goodness=goodness(model, state, azimuth_of_x(model, state), share),
        notes=fitted.notes,
    )


def _difference_error(best: _Fitted, other: _Fitted, slopes: Slopes) -> float:
    """Standard error of the difference of their `held_out`, from how the groups differ."""
    difference = best.held_out - other.held_out
    rest = difference - difference.sum() / slopes.n * slopes.sizes
    return math.sqrt(float(blocks.scatter(rest, slopes.on_map)[0, 0])) / slopes.n


def _edge_notes(family: Family, state: State) -> tuple[str, ...]:
    notes = []
    for search, variable in zip(searches(family), state.shapes, strict=True):
        low, high = search.ends
        if not low < variable < high:
            end = "lower" if variable <= low else "upper"
            notes.append(f"{search.parameter.name} is at the {end} end of the range that is searched")
    return tuple(notes)
