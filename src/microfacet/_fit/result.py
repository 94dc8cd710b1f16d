"""What a fit returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from microfacet._value import Value

__all__ = ["FitResult", "Goodness", "TableFit", "one_a_family", "remarks"]


@dataclass(frozen=True, eq=False)
class Goodness(Value):
    """How well the fitted family describes the slopes, in standard space where the family is isotropic.

    Attributes
    ----------
    probabilities : tuple of float
        At which the quantiles are given.
    observed, expected : tuple of float
        Quantiles of the radius ``|A^-1 (slope - mean)|`` of the sample and of the family (for gtr: of the
        slope's length). Equal where the family is right; the last ones show the tail.
    anderson_darling : float
        Anderson and Darling's A^2 of the radial distribution, for `FitResult.n_effective` independent slopes:
        A^2 of the sample times n_effective/n. About 1 where the family is right. The parameters were fitted
        to the same slopes, so its tabulated critical values (2.5 at 5 %) are too large: a larger value does
        reject the family.
    sectors : tuple of float
        The same statistic for eight sectors of azimuth (22.5 degrees wide, opposite ones together, from the
        axis of alpha_x counter-clockwise; in standard space), each for its share of the slopes: where the
        radial density depends on direction, which no family of one radial density can follow.
    p_value : float
        The probability, if the family were right, of slopes further from the fit than these: of the counts in
        rings of standard space and of the azimuths there, by a test that knows that neighbouring slopes
        depend on each other and that parameters were fitted. Below 0.01 the family does not describe the
        slopes; with many slopes that happens to families that are good enough, so look at `deviation` too.
    deviation : float
        Largest difference between the measured and the fitted share of slopes, below any steepness or within
        any range of azimuths.
    """

    probabilities: tuple[float, ...]
    observed: tuple[float, ...]
    expected: tuple[float, ...]
    anderson_darling: float
    sectors: tuple[float, ...]
    p_value: float
    deviation: float


@dataclass(frozen=True, eq=False)
class FitResult(Value):
    """A family fitted to slopes by maximum likelihood.

    Attributes
    ----------
    family : str
        Name of the family.
    symmetry : str
        "isotropic": one roughness in every direction; "anisotropic": one along each of two axes; "profile":
        one along the line of a profile, fitted by P2.
    params : dict of str to float
        ``alpha``, or ``alpha_x``, ``alpha_y`` and ``rotation`` (radians, counter-clockwise, in [-pi/4, pi/4])
        where the symmetry is anisotropic; then the shape parameter if the family has one. For either symmetry
        `roughness` is (alpha_x, alpha_y).
    standard_errors : dict of str to float
        Of each parameter: the square roots of the diagonal of H^-1 J H^-1, with the observed information H
        and the covariance J of the score, from the longest waves over the map with Student's factor for their
        number, so that 1.96 of them make an interval of 95 % (slopes without positions:
        taken for independent). They hold also for a family that is not the true one. nan for a parameter at
        the end of its range.
    log_likelihood : float
        Natural logarithm of the likelihood, summed over the `n` slopes.
    log_likelihood_per_sample : float
        The same divided by `n`.
    held_out : float
        Log-likelihood per slope of slopes that the fit has not seen: five-fold cross-validation; on a map,
        whole blocks are left out.
    held_out_error : float
        Standard error of the difference between the first fit's `held_out` and this one's, from how parts of
        the sample differ, and at least what the chance of the parameters makes; 0 for the first.
    tied : bool
        Whether this fit's `held_out` is within two such standard errors of the best. Where the difference is
        larger than the chance of the parameters, it has to be so too once the largest contributions of single
        slopes, as many as 30 independent ones, are cut to the smallest of them: the tail of a density that is
        too light makes a difference that a few slopes decide, and its standard error is as large as itself.
    n : int
        Number of slopes that were used.
    n_effective : float
        How many independent slopes would tell as much: n times the trace of the information's inverse with
        the scores' covariance as if they were independent, over that with the covariance from the longest
        waves over the map. One number for all families, that of the family with the largest `held_out`.
    aic, bic : float
        Akaike's and Schwarz's criterion of `n_effective` independent slopes: ``2 k - 2 n_effective
        log_likelihood_per_sample`` and ``k log(n_effective) - ...``, k = ``len(params)``. The mean slope,
        which all families share, is not counted. For slopes without positions the usual ones.
    ndf : distribution
        The fitted distribution, for example a `StudentT`.
    mean_slope, mean_slope_errors : (float, float), of a profile (float,)
        Mean slope of the sample (estimated by the median), subtracted before the fit, and its standard
        errors.
    lag : int or None
        Lag in pixels at which the slopes of a surface were taken. alpha and shape depend on it.
    converged : bool
        Whether the search ended in a maximum.
    goodness : Goodness
        Quantiles and Anderson-Darling statistics.
    notes : tuple of str
        What a reader of the numbers should know: slopes left out, a parameter at the edge of its range.
    """

    family: str
    symmetry: str
    params: dict[str, float]
    standard_errors: dict[str, float]
    log_likelihood: float
    log_likelihood_per_sample: float
    held_out: float
    held_out_error: float
    tied: bool
    n: int
    n_effective: float
    aic: float
    bic: float
    ndf: Any
    mean_slope: tuple[float, ...]
    mean_slope_errors: tuple[float, ...]
    lag: int | None
    converged: bool
    goodness: Goodness
    notes: tuple[str, ...] = ()

    @property
    def roughness(self) -> tuple[float, float]:
        """(alpha_x, alpha_y) of either symmetry: twice alpha where it is isotropic."""
        if "alpha" in self.params:
            return self.params["alpha"], self.params["alpha"]
        return self.params["alpha_x"], self.params["alpha_y"]


@dataclass(frozen=True, eq=False)
class TableFit(Value):
    """A family fitted to a table.

    Attributes
    ----------
    family : str
        Name of the family.
    params : dict of str to float
        ``alpha`` (``alpha_x`` and ``alpha_y`` for two mean square slopes) and the shape parameter. For a
        histogram also ``mean``, the slope about which it is symmetric; for a table of D also ``scale``, its
        factor.
    standard_errors : dict of str to float
        Of the same, from the curvature of the objective; empty for mean square slopes, which are met exactly.
    objective : float
        What is smallest for the best family. Histogram: minus the multinomial log-likelihood, per count.
        Table of D: root mean square of log(table/fit). Mean square slopes: 0.
    ndf : distribution
        The fitted distribution.
    """

    family: str
    params: dict[str, float]
    standard_errors: dict[str, float]
    objective: float
    ndf: Any


def one_a_family(results: Sequence[FitResult]) -> list[FitResult]:
    """Of each family the symmetry that ranks first, in the order of the ranking."""
    found: dict[str, FitResult] = {}
    for result in results:
        found.setdefault(result.family, result)
    return list(found.values())


def remarks(results: Sequence[FitResult]) -> list[str]:
    """What fits remark, each remark once, with the families it is about unless it is all of them, and their
    symmetry where it is not about both.
    """
    about: dict[str, dict[str, list[str]]] = {}
    fitted: dict[str, list[str]] = {}
    for result in results:
        fitted.setdefault(result.family, []).append(result.symmetry)
        for note in result.notes:
            about.setdefault(note, {}).setdefault(result.family, []).append(result.symmetry)
    found = []
    for note, families in about.items():
        names = [
            name if len(own) == len(fitted[name]) else f"{name} ({own[0]})" for name, own in families.items()
        ]
        everything = sum(map(len, families.values())) == len(results)
        found.append(note if everything else f"{', '.join(names)}: {note}")
    return found
