"""`fit`: the maximum of the likelihood of each family, what is known of it, and the families' ranking."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from microfacet._family import Family
from microfacet._family import families as all_families
from microfacet._fit.along import cautions_along
from microfacet._fit.balance import balance, balance_along
from microfacet._fit.cautions import cautions
from microfacet._fit.errors import Uncertainty, azimuth_of_x, parameters, uncertainty
from microfacet._fit.goodness import goodness
from microfacet._fit.halves import halves
from microfacet._fit.line import prepare_line
from microfacet._fit.misfit import Misfit, misfit
from microfacet._fit.model import ANISOTROPIC, ISOTROPIC, PROFILE, Model, symmetries
from microfacet._fit.nested import containment
from microfacet._fit.newton import Maximum, maximise
from microfacet._fit.result import FitResult
from microfacet._fit.results import FitResults
from microfacet._fit.search import edge_notes
from microfacet._fit.slopes import MAX_SLOPES, Slopes, prepare
from microfacet._fit.source import source_of
from microfacet._fit.ties import Validation, are_tied, difference_error, validation
from microfacet._fit.verdict import verdict
from microfacet._profile import Profile
from microfacet._radial import RadialNDF
from microfacet._surface import SlopeSample, Surface
from microfacet._surface.checks import checked_lag
from microfacet._user_family import family_of

__all__ = ["Candidates", "Progress", "chosen_families", "fit"]

#: What is fitted: names of families, families of one's own, densities whose roughness alone is free.
Candidates = str | Family | RadialNDF | Iterable[str | Family | RadialNDF] | None
#: Told what begins, how many steps are done, and how many there are.
Progress = Callable[[str, int, int], None]


def fit(
    slopes_or_surface: ArrayLike | Surface | SlopeSample | Profile,
    families: Candidates = None,
    lag: int | None = None,
    max_slopes: int | None = MAX_SLOPES,
    progress: Progress | None = None,
    *,
    symmetry: str | None = None,
    max_slope: float | None = None,
) -> FitResults:
    r"""Fit families of slope densities by maximum likelihood, best first.

    Each family is fitted twice, with one roughness and with two along axes of their own, unless it is
    isotropic by nature, as gtr is. Roughness, axes and the shape parameter maximise

    .. math:: \sum_i \log P_{22}(p_i - \bar p, q_i - \bar q)

    where :math:`(\bar p, \bar q)` is the mean slope. It is estimated by the median, for all families alike:
    the likelihood of k0 and bessel_k is infinite where the mean meets a slope of the sample, so their maximum
    does not exist; and as the densities are symmetric, the mean and the other parameters are estimated
    independently of each other. A surface need not be levelled: a plane changes only the mean slope. Slopes
    of quantised heights that fall into the cell of quantisation around the mean slope count with the root
    mean square slope of that cell, because k0 and bessel_k are infinite at slope 0.

    Parameters
    ----------
    slopes_or_surface : array_like, shape (N, 2), or Surface or Profile
        Slopes ``(p, q)`` along x and y (dimensionless, N >= 20, in [-1e6, 1e6]), or a surface or a profile to
        take them from. Slopes are taken for independent of each other; those of a surface, a normal map or a
        profile are not. Of a profile the slopes along its line are fitted by the families' densities of the
        slope along one axis: it says alpha along the line, for a surface that is isotropic.
    families : str, UserFamily, RadialNDF or iterable of them, optional
        Names of families; families of your own, whose parameters are fitted; densities of your own, of which
        the roughness is. All families of the library by default.
    lag : int, optional
        Lag in pixels at which slopes of a surface or a normal map are taken; its own `lag` by default. alpha
        and shape depend on it.
    max_slopes : int or None
        Of more slopes than this, so many are drawn at random, with a fixed seed (the result says so in
        `notes`). None uses all.
    progress : callable, optional
        Called with (what begins, steps done, steps in all).
    symmetry : {"isotropic", "anisotropic"}, optional
        Fit this symmetry alone; both by default. Where all families are fitted, the anisotropic ones are
        without those that are isotropic by nature.
    max_slope : float, optional
        The steepest slope that the instrument measures, of a numerical aperture NA about tan(arcsin(NA)):
        `warnings` tell of slopes beyond it.

    Returns
    -------
    FitResults
        A list of `FitResult` with a `verdict`, which says whether any family describes the slopes, and
        `warnings`.
        One for each family and symmetry, best first: by `held_out`, the log-likelihood of slopes that were
        left out of the fit. Those within two standard errors of the largest are tied, stand first, and are
        ordered by the Bayesian information criterion: of two that describe the slopes equally well, the one
        with fewer parameters is the better description. Where a few slopes make that error, they count for
        no more than others do (see `FitResult.tied`).

    Raises
    ------
    ValueError
        If the slopes are not finite numbers of shape (N, 2), are too few, constant, or on one line; if a name
        is unknown; if `lag` is given for slopes; if `symmetry` is none of the two, or a family that is named
        cannot have it.

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
    >>> best.family, best.symmetry, round(best.params["alpha_x"], 1), round(best.params["alpha_y"], 1)
    ('ggx', 'anisotropic', 0.1, 0.4)
    >>> abs(best.params["alpha_x"] - 0.1) < 3 * best.standard_errors["alpha_x"] < 0.01
    True
    """
    profile = slopes_or_surface if isinstance(slopes_or_surface, Profile) else None
    wanted, progress = _wanted(families, symmetry, profile is not None), progress or (lambda *_: None)
    if max_slopes is not None and not max_slopes >= 20:
        raise ValueError(f"max_slopes must lie in [20, inf) or be None, got {max_slopes}")
    if max_slope is not None and not max_slope > 0:
        raise ValueError(f"max_slope must be positive, got {max_slope}")
    if profile is not None:
        lag = profile.lag if lag is None else checked_lag(lag)
        line = prepare_line(profile, lag, max_slopes)
        slopes = line.slopes
    else:
        source, raw, cells, lag, notes = source_of(slopes_or_surface, lag, max_slopes)
        slopes = prepare(raw, max_slopes, cells, notes)
    found = []
    for done, (family, own) in enumerate(wanted):
        progress(f"{family.title}, {own}", done, len(wanted))
        found.append(_fit_family(family, slopes, own))
    ranked = _ranked(found, slopes, lag)
    results = [result for result, _ in ranked]
    first = ranked[0][1]
    if profile is not None:
        warnings = cautions_along(profile, line, (first.model, first.maximum), max_slope)
        sides = balance_along(slopes, line.raw, line.cells, slopes.shape)
        return FitResults(results, verdict(results, sides), warnings, None)
    regions = halves(first.model, first.maximum)
    raw = np.asarray(raw, dtype=np.float64)
    warnings = cautions(source, raw, lag, (first.model, first.maximum.state), regions, max_slope)
    return FitResults(results, verdict(results, balance(slopes, raw, cells)), warnings, regions)


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


def _wanted(families: Candidates, symmetry: str | None, along_line: bool) -> list[tuple[Family, str]]:
    """What is fitted: each family with the symmetries that it can have and that are asked for."""
    if along_line:
        if symmetry is not None:
            raise ValueError(
                f"symmetry: a profile knows one direction, none is to choose, got {symmetry!r:.60}"
            )
        return [(family, PROFILE) for family in chosen_families(families)]
    if symmetry not in (None, ISOTROPIC, ANISOTROPIC):
        raise ValueError(f'symmetry must be "{ISOTROPIC}", "{ANISOTROPIC}" or None, got {symmetry!r:.60}')
    chosen = chosen_families(families)
    for family in chosen if families is not None else ():
        if symmetry not in (None, *symmetries(family)):
            raise ValueError(f"symmetry: {family.name} can only be {ISOTROPIC}, got {symmetry!r}")
    return [(family, own) for family in chosen for own in symmetries(family) if symmetry in (None, own)]


class _Fitted(NamedTuple):
    model: Model
    maximum: Maximum
    uncertainty: Uncertainty
    misfit: Misfit
    log_likelihood: float
    held_out: Validation
    converged: bool
    notes: tuple[str, ...]


def _fit_family(family: Family, slopes: Slopes, symmetry: str) -> _Fitted:
    model, found = maximise(family, slopes, symmetry)
    known = uncertainty(model, found)
    return _Fitted(
        model,
        found,
        known,
        misfit(model, found, known.independent_share),
        float(np.sum(found.sums.value)),
        validation(model, found),
        found.converged,
        slopes.notes + edge_notes(family, found.state.shapes) + known.notes,
    )


def _ranked(found: list[_Fitted], slopes: Slopes, lag: int | None) -> list[tuple[FitResult, _Fitted]]:
    """One result per family, best first; the effective number of slopes is that under the best family."""
    best = max(found, key=lambda fitted: float(np.sum(fitted.held_out.groups)))
    share = best.uncertainty.independent_share
    results = [_result(fitted, best, share, slopes, lag) for fitted in found]
    order = sorted(
        results, key=lambda result: (not result.tied, result.bic if result.tied else -result.held_out)
    )
    by_name = {(fitted.model.family.name, fitted.model.symmetry): fitted for fitted in found}
    first, *_ = ranked = [by_name[result.family, result.symmetry] for result in order]
    errors = [difference_error(first.held_out, fitted.held_out, share) for fitted in ranked]
    best_of_all = order[0]
    return [
        (
            replace(one, held_out_error=error, notes=one.notes + _contains(one, fitted, best_of_all, first)),
            fitted,
        )
        for one, error, fitted in zip(order, errors, ranked, strict=True)
    ]


def _contains(one: FitResult, fitted: _Fitted, best: FitResult, first: _Fitted) -> tuple[str, ...]:
    return containment(one, fitted.model.family, best, first.model.family) if one.tied else ()


def _result(fitted: _Fitted, best: _Fitted, share: float, slopes: Slopes, lag: int | None) -> FitResult:
    model, state, n = fitted.model, fitted.maximum.state, slopes.n
    params = parameters(model, state)
    effective, per_slope = max(share * n, 1.0), fitted.log_likelihood / n
    return FitResult(
        family=model.family.name,
        symmetry=model.symmetry,
        params=params,
        standard_errors=fitted.uncertainty.errors,
        log_likelihood=fitted.log_likelihood,
        log_likelihood_per_sample=per_slope,
        held_out=float(np.sum(fitted.held_out.groups)) / n,
        held_out_error=0.0,
        tied=are_tied(best.held_out, fitted.held_out, share),
        n=n,
        n_effective=effective,
        aic=2 * len(params) - 2 * effective * per_slope,
        bic=len(params) * math.log(effective) - 2 * effective * per_slope,
        ndf=model.family.cls(**params),
        mean_slope=slopes.mean,
        mean_slope_errors=slopes.mean_errors,
        lag=lag,
        converged=fitted.converged,
        goodness=goodness(model, state, azimuth_of_x(model, state), share, fitted.misfit),
        notes=fitted.notes,
    )
