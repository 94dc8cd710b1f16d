"""`compare`: surfaces side by side, and how far their roughness differs beyond what chance explains."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike
from scipy import stats

from microfacet._fit.estimate import Candidates, Progress, chosen_families, fit
from microfacet._fit.mean_squares import Measured, rms_height, rms_slope
from microfacet._fit.result import FitResult
from microfacet._fit.results import FitResults
from microfacet._fit.slopes import MAX_SLOPES
from microfacet._profile import Profile
from microfacet._surface import SlopeSample, Surface
from microfacet._value import Value

__all__ = ["Comparison", "Difference", "compare"]

_SAME_LENGTH = 0.02  # lags that differ by less are one


@dataclass(frozen=True, eq=False)
class Difference(Value):
    """A quantity of one surface minus that of another.

    Attributes
    ----------
    quantity : str
        ``Sq`` (metres), ``rms_slope``, or a parameter of the fitted family.
    value, error : float
        The difference and its standard error: the root of the sum of the squares of both surfaces' errors,
        which holds for surfaces that were measured independently of each other.
    z : float
        Their quotient; nan where an error is unknown.
    p_value : float
        How often chance alone makes one of all the quantities compared differ by as many standard errors
        (two-sided normal, corrected by Sidak for the number of quantities).
    """

    quantity: str
    value: float
    error: float
    z: float
    p_value: float


@dataclass(frozen=True, eq=False)
class Comparison(Value):
    """Surfaces side by side.

    Attributes
    ----------
    names : tuple of str
        Of the surfaces.
    lag_lengths : tuple of (float or None)
        The lag at which the slopes of each were taken, in metres; None for slopes without positions.
    rankings : tuple of FitResults
        What `fit` returns for each.
    family, symmetry : str
        Of the one description under which all surfaces are compared: that with the largest held-out
        log-likelihood of all of them together, each counted with its effective number of slopes.
    fits : tuple of FitResult
        That description fitted to each surface. Axes of roughness are named as those of the first surface
        that they are nearest to, so that alpha_x is compared with alpha_x.
    quantities : tuple of dict of str to (float, float)
        For each surface every quantity with its standard error.
    differences : tuple of tuple of Difference
        For each surface but the first, its differences from the first.
    notes : tuple of str
        What a reader of the numbers should know.
    """

    names: tuple[str, ...]
    lag_lengths: tuple[float | None, ...]
    rankings: tuple[FitResults, ...]
    family: str
    symmetry: str
    fits: tuple[FitResult, ...]
    quantities: tuple[dict[str, tuple[float, float]], ...]
    differences: tuple[tuple[Difference, ...], ...]
    notes: tuple[str, ...]


def compare(
    surfaces: Sequence[Surface | SlopeSample | Profile | ArrayLike],
    families: Candidates = None,
    *,
    length: float | None = None,
    symmetry: str | None = None,
    names: Sequence[str] | None = None,
    max_slopes: int | None = MAX_SLOPES,
    progress: Progress | None = None,
) -> Comparison:
    r"""Compare the roughness of two or more surfaces, with errors of the differences.

    The families are fitted to every surface; the parameters compared are those of the one family and symmetry
    that describes all surfaces best. A difference d of two of them has the standard error

    .. math:: s = \sqrt{s_1^2 + s_2^2}

    and z = d/s. Roughness depends on the lag: slopes of all surfaces are taken at the same lag in metres.

    Parameters
    ----------
    surfaces : sequence of Surface, SlopeSample, Profile or array_like
        At least two, prepared alike. Slopes without positions have no Sq and no lag.
    families, symmetry, max_slopes, progress
        As in `fit`.
    length : float, optional
        The lag in metres. By default each surface has its own if these are equal within 2 %, else the longest
        of them is taken for all.
    names : sequence of str, optional
        What to call them; by default where they come from.

    Returns
    -------
    Comparison

    Raises
    ------
    ValueError
        If there are fewer than two surfaces, the names are not as many, or `length` is given for slopes; as
        in `fit`.

    References
    ----------
    Z. Sidak, Rectangular confidence regions for the means of multivariate normal distributions, JASA 62,
    1967.

    Examples
    --------
    >>> import microfacet as mf
    >>> smooth, rough = (mf.synthesize(mf.Beckmann(alpha=a), (128, 128)) for a in (0.2, 0.4))
    >>> found = mf.compare([smooth, rough], "beckmann", symmetry="isotropic")
    >>> alpha = next(d for d in found.differences[0] if d.quantity == "alpha")
    >>> round(alpha.value, 1), alpha.p_value < 0.001
    (0.2, True)
    """
    if isinstance(surfaces, Surface | SlopeSample | Profile) or len(surfaces) < 2:
        count = 1 if isinstance(surfaces, Surface | SlopeSample | Profile) else len(surfaces)
        raise ValueError(f"surfaces must be two or more to compare, got {count}")
    lines = sum(isinstance(one, Profile) for one in surfaces)
    if 0 < lines < len(surfaces):
        raise ValueError(f"profiles compare with profiles alone, got {lines} of them among {len(surfaces)}")
    if names is not None and len(names) != len(surfaces):
        raise ValueError(f"names must be as many as surfaces, {len(surfaces)}, got {len(names)}")
    chosen, told = chosen_families(families), progress or (lambda *_: None)
    at_lag, notes = _at_one_length(list(surfaces), length)
    called = tuple(map(str, names)) if names is not None else tuple(map(_name, at_lag, range(len(at_lag))))
    rankings: list[FitResults] = []
    for done, surface in enumerate(at_lag):
        told(called[done], done, len(at_lag))
        rankings.append(fit(surface, chosen, max_slopes=max_slopes, symmetry=symmetry))
    fits = _described_alike(rankings)
    quantities = [_quantities(surface, fits[0], one) for surface, one in zip(at_lag, fits, strict=True)]
    return Comparison(
        called,
        tuple(one.lag_length if isinstance(one, Surface | Profile) else None for one in at_lag),
        tuple(rankings),
        fits[0].family,
        fits[0].symmetry,
        tuple(fits),
        tuple(quantities),
        tuple(_differences(quantities[0], other) for other in quantities[1:]),
        notes + _doubts(called, rankings),
    )


def _doubts(names: Sequence[str], rankings: Sequence[FitResults]) -> tuple[str, ...]:
    """Which surfaces no family describes: their parameters describe a fit that misses."""
    pairs = zip(names, rankings, strict=True)
    return tuple(f"{name}: {own.verdict.sentence}" for name, own in pairs if not own.verdict.fits)


def _name(surface: Any, number: int) -> str:
    source = getattr(surface, "source", "array")
    return f"surface {number + 1}" if source == "array" else str(source)


def _at_one_length(surfaces: list[Any], length: float | None) -> tuple[list[Any], tuple[str, ...]]:
    """The surfaces with lags of one length, and a remark where lags had to be changed for that."""
    own = [surface.lag_length for surface in surfaces if isinstance(surface, Surface | Profile)]
    if length is not None and len(own) < len(surfaces):
        raise ValueError(f"length applies to surfaces, and one is slopes without positions, got {length:g}")
    notes: tuple[str, ...] = ()
    if length is None:
        if len(own) < 2 or max(own) <= (1 + _SAME_LENGTH) * min(own):
            return surfaces, notes
        length = max(own)
        notes = (f"slopes of all surfaces are taken at the longest of their lags, {length:.4g} m",)
    result = [one.at_lag(length=length) if isinstance(one, Surface | Profile) else one for one in surfaces]
    apart = [one.lag_length for one in result if isinstance(one, Surface | Profile)]
    if max(apart) > (1 + _SAME_LENGTH) * min(apart):
        notes += (
            f"whole numbers of pixels leave lags from {min(apart):.4g} to {max(apart):.4g} m: roughness may "
            "differ for that reason alone",
        )
    return result, notes


def _described_alike(rankings: Sequence[FitResults]) -> list[FitResult]:
    """The fits of the family and symmetry under which all surfaces together are likeliest."""

    def behind(family: str, symmetry: str) -> float:
        total = 0.0
        for ranking in rankings:
            own = _of(ranking, family, symmetry)
            total += own.n_effective * (max(one.held_out for one in ranking) - own.held_out)
        return total

    pairs = [(one.family, one.symmetry) for one in rankings[0]]
    best = min(pairs, key=lambda pair: behind(*pair))
    return [_of(ranking, *best) for ranking in rankings]


def _of(ranking: FitResults, family: str, symmetry: str) -> FitResult:
    return next(one for one in ranking if (one.family, one.symmetry) == (family, symmetry))


def _quantities(surface: Any, first: FitResult, own: FitResult) -> dict[str, tuple[float, float]]:
    measured: dict[str, Measured] = {}
    if isinstance(surface, Surface):
        measured = {"Sq": rms_height(surface), "rms_slope": rms_slope(surface)}
    params, errors = _named_alike(first.params, own.params, own.standard_errors)
    fitted = {name: (value, errors.get(name, math.nan)) for name, value in params.items()}
    return {name: (one.value, one.error) for name, one in measured.items()} | fitted


def _named_alike(
    first: dict[str, float], params: dict[str, float], errors: dict[str, float]
) -> tuple[dict[str, float], dict[str, float]]:
    """The same density with its two axes named as those of the first that they are nearest to."""
    if "rotation" not in params:
        return params, errors
    turn = math.copysign(math.pi / 2, first["rotation"] - params["rotation"])
    other = params | {
        "alpha_x": params["alpha_y"],
        "alpha_y": params["alpha_x"],
        "rotation": params["rotation"] + turn,
    }

    def distance(named: dict[str, float]) -> float:
        ratios = [math.log(named[name] / first[name]) for name in ("alpha_x", "alpha_y")]
        stretch = math.log(first["alpha_x"] / first["alpha_y"])
        return math.hypot(*ratios, stretch * _axis(named["rotation"] - first["rotation"]))

    if distance(params) <= distance(other):
        return params, errors
    swapped = errors | {"alpha_x": errors["alpha_y"], "alpha_y": errors["alpha_x"]}
    return other, swapped


def _axis(angle: float) -> float:
    """The angle between two axes, which have no sign: in (-pi/2, pi/2]."""
    return angle - math.pi * math.ceil(angle / math.pi - 0.5)


def _differences(
    first: dict[str, tuple[float, float]], other: dict[str, tuple[float, float]]
) -> tuple[Difference, ...]:
    shared = [name for name in first if name in other]
    found = []
    for name in shared:
        value = other[name][0] - first[name][0]
        value = _axis(value) if name == "rotation" else value
        error = math.hypot(first[name][1], other[name][1])
        z = value / error if error > 0 else math.nan
        chance = 2 * float(stats.norm.sf(abs(z)))
        corrected = -math.expm1(len(shared) * math.log1p(-chance)) if chance < 1 else chance
        found.append(Difference(name, value, error, z, corrected))
    return tuple(found)
