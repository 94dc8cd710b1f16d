"""What a check is: an identity, and the two independent routes by which its sides are computed.

Conventions, the same for every check. ``lhs`` and ``rhs`` are the two sides at the worst of the points that
the check evaluates, ``lhs`` being what the library's ufuncs give. ``residual`` is ``|lhs - rhs| / |rhs|``, or
``|lhs|`` where ``rhs`` is 0, and the check passes when ``residual <= tolerance``. A side that is nan has the
residual inf. The tolerance belongs to the route (`Route`), never to a single check.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._checks.symbolic import REFUTED, Algebra

__all__ = [
    "CLOSED_FORM",
    "HISTOGRAM",
    "LIMIT",
    "QUADRATURE",
    "QUADRATURE_OVER_U",
    "SIGNIFICANCE",
    "Check",
    "CheckItem",
    "CheckResult",
    "Route",
    "Sides",
    "Tally",
    "both",
    "notebook",
    "p_value",
]

Array = NDArray[np.float64]
Sides = tuple[ArrayLike, ArrayLike]

SIGNIFICANCE = 1e-4  # the p-value below which a histogram is rejected
UNDERFLOW = 1e-290  # below this a result may be flushed to 0 (accuracy contract), so such points say nothing


@dataclass(frozen=True)
class Route:
    """How the second side is computed, and the tolerance this allows, as a function of alpha and ``rhs``."""

    name: str
    reason: str
    tolerance: Callable[[float, Array], Array]


def _contract(alpha: float, rhs: Array) -> Array:
    """Twice the accuracy contract of the ufuncs: the statement's own arithmetic takes the second half."""
    with np.errstate(all="ignore"):
        return np.where(np.abs(np.log(np.abs(rhs))) < 50, 2e-13, 2e-12)


CLOSED_FORM = Route(
    "arbitrary precision",
    "The other side is rounded once, from 18 digits; what remains is the library's accuracy contract.",
    _contract,
)
QUADRATURE = Route(
    "quadrature",
    "The quadrature converges beyond rounding; what remains is the library's accuracy contract.",
    _contract,
)
QUADRATURE_OVER_U = Route(
    "quadrature over u",
    "As quadrature, but D is read at a rounded cosine. Near 1 that moves the squared slope by eps/2, and so"
    " the integrand by a few eps/alpha^2, the scale of the squared slopes being alpha^2.",
    lambda alpha, rhs: _contract(alpha, rhs) + 8 * np.finfo(float).eps / alpha**2,
)
LIMIT = Route(
    "limit",
    "Three values extrapolated to the limit: their rounding grows fivefold, and the rest of the series is of"
    " order (100 h)^3/8 with h = 4e-6.",
    lambda alpha, rhs: np.full_like(rhs, 1e-11),
)


def _chi_square_bound(alpha: float, dof: Array) -> Array:
    from scipy.special import gammainccinv

    return np.asarray(2 * gammainccinv(dof / 2, SIGNIFICANCE) / dof - 1, dtype=np.float64)


HISTOGRAM = Route(
    "chi-square",
    "lhs is the statistic, rhs its degrees of freedom, which it equals on average; the residual reaches the"
    " tolerance where the p-value is `SIGNIFICANCE`. The seed is fixed.",
    _chi_square_bound,
)


def p_value(result: CheckResult) -> float:
    """The probability of a statistic as large as that of this result, whose route is `HISTOGRAM`."""
    from scipy.special import gammaincc

    return float(gammaincc(result.rhs / 2, result.lhs / 2))


@dataclass(frozen=True)
class CheckItem:
    """One line of the catalogue.

    `statement` is prose with formulas between dollar signs, `latex` the identity that it is about.
    `notebook` tells what the family's notebook states from what the library adds; `parameters` are the values
    at which the check runs unless others are given (the notebook's own where it names any).
    """

    id: str
    family: str
    statement: str
    latex: str
    source: str
    notebook: bool
    parameters: dict[str, float]
    route: str


@dataclass(frozen=True)
class CheckResult:
    """The outcome of one check at one set of parameters; the conventions are those of this module.

    `symbolic` is what computer algebra says of it: "confirmed", "refuted", or "not run", for want of SymPy or
    because the proof is not of these parameters. None: the statement has no such proof.
    """

    id: str
    family: str
    parameters: dict[str, float]
    lhs: float
    rhs: float
    residual: float
    tolerance: float
    passed: bool
    source: str
    symbolic: str | None = None

    def as_dict(self) -> dict[str, Any]:
        """The fields as JSON takes them: a number that is not finite, which JSON cannot express, is None."""
        numbers = {name: getattr(self, name) for name in ("lhs", "rhs", "residual", "tolerance")}
        finite = {name: value if math.isfinite(value) else None for name, value in numbers.items()}
        head = {"id": self.id, "family": self.family, "parameters": dict(self.parameters)}
        return {**head, **finite, "passed": self.passed, "source": self.source, "symbolic": self.symbolic}


class Tally(NamedTuple):
    """Of the statements of a family's notebook, or of our own: how many there are, were checked, and hold."""

    stated: int
    checked: int
    held: int


@dataclass(frozen=True)
class Check:
    """One entry in a family's table.

    Parameters
    ----------
    name
        Second half of the id; the first is the family.
    statement, latex
        The identity in words, with LaTeX between dollar signs, and as a displayed formula.
    sides
        ``sides(kernels, alpha, shape) -> (lhs, rhs)``, two arrays of one value per point. ``kernels`` holds
        the family's ufuncs; the left side calls them, the right side comes by `route`.
    route
        How the right side is computed; fixes the tolerance.
    parameters
        The parameters of the default run, in the order of the ufuncs.
    fixed
        Those of `parameters` that belong to the statement and cannot be overridden.
    notebook, source
        Whether the statement is one of the family's notebook, by which `microfacet verify` and the report
        count, and where it is from: for either, name the notebook with `notebook` below if there is one.
    unless
        ``unless(alpha, shape)`` gives the reason why the statement cannot be evaluated there, or "".
    symbolic
        A proof of the statement by computer algebra, beside the numbers.
    """

    name: str
    statement: str
    latex: str
    sides: Callable[..., Sides]
    route: Route
    parameters: Mapping[str, float]
    source: str
    notebook: bool = True
    fixed: frozenset[str] = field(default_factory=frozenset)
    unless: Callable[..., str] = lambda *parameters: ""
    symbolic: Algebra | None = None

    def item(self, family: str) -> CheckItem:
        return CheckItem(
            id=f"{family}.{self.name}",
            family=family,
            statement=self.statement,
            latex=self.latex,
            source=self.source,
            notebook=self.notebook,
            parameters=dict(self.parameters),
            route=self.route.name,
        )

    def at(self, overrides: Mapping[str, float]) -> dict[str, float]:
        """The parameters with `overrides` put in, save for the fixed ones."""
        return {
            name: value if name in self.fixed else overrides.get(name, value)
            for name, value in self.parameters.items()
        }

    def run(self, family: str, kernels: object, parameters: Mapping[str, float]) -> CheckResult:
        """Evaluate both sides at `parameters` and judge the worst point."""
        with np.errstate(all="ignore"):
            sides = self.sides(kernels, *parameters.values())
            lhs, rhs, residual, tolerance = worst(*sides, self.route, parameters["alpha"])
        algebra = None if self.symbolic is None else self.symbolic.verdict(parameters)
        if algebra == REFUTED:
            residual = math.inf
        return CheckResult(
            id=f"{family}.{self.name}",
            family=family,
            parameters=dict(parameters),
            lhs=lhs,
            rhs=rhs,
            residual=residual,
            tolerance=tolerance,
            passed=bool(residual <= tolerance),
            source=self.source,
            symbolic=algebra,
        )


def both(*pairs: Sides) -> Sides:
    """Several comparisons as one."""
    lefts, rights = zip(*(np.broadcast_arrays(left, right) for left, right in pairs), strict=True)
    return np.concatenate(lefts, axis=None), np.concatenate(rights, axis=None)


def notebook(title: str) -> str:
    """The source of a notebook's statement."""
    return f"d'Eon 2020, A Hitchhiker's Guide to Multiple Scattering, notebook {title} NDF"


def worst(lhs: ArrayLike, rhs: ArrayLike, route: Route, alpha: float) -> tuple[float, float, float, float]:
    """Both sides, residual and tolerance where the residual is largest in units of the tolerance.

    Points where both sides underflow are left out; if no other point remains nothing was shown and the
    residual is inf.
    """
    left, right = (np.ravel(side) for side in np.broadcast_arrays(_doubles(lhs), _doubles(rhs)))
    flushed = (np.abs(left) < UNDERFLOW) & (np.abs(right) < UNDERFLOW) & (right != 0)
    left, right = left[~flushed], right[~flushed]
    if left.size == 0:
        return math.nan, math.nan, math.inf, 0.0
    residual = np.abs(left - right) / np.where(right == 0, 1.0, np.abs(right))
    residual = np.where(np.isnan(residual), math.inf, residual)
    tolerance = route.tolerance(alpha, right)
    at = int(np.argmax(residual / tolerance))
    return float(left[at]), float(right[at]), float(residual[at]), float(tolerance[at])


def _doubles(side: ArrayLike) -> Array:
    return np.asarray(side, dtype=np.float64)
