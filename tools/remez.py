"""Minimax fits (Remez exchange) in arbitrary precision, their rounding, and their C++ text.

A fit is a quotient of sums of basis functions, most often powers of x. The exchange runs on a fixed grid, so
that each function is evaluated once per point; between the points the error exceeds the largest one on the
grid by a relative 1e-2 at most.
"""

from __future__ import annotations

import itertools
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import mpmath
import numpy as np
from mpmath import mpf

Function = Callable[[mpf], mpf]
Vector = np.ndarray[Any, np.dtype[np.float64]]
Real = type[np.floating[Any]]
FORMATS: tuple[tuple[int, Real], ...] = ((32, np.float32), (64, np.float64))


def power(k: int) -> Function:
    return lambda x: x**k


def powers(first: int, last: int) -> list[Function]:
    """The basis x^first, ..., x^last."""
    return [power(k) for k in range(first, last + 1)]


@dataclass(frozen=True)
class Fit:
    """Coefficients in the order of the bases, and the largest weighted error."""

    numerator: list[mpf]
    denominator: list[mpf]
    error: mpf


@dataclass(frozen=True)
class Point:
    """What a fit needs to know of one point of the grid."""

    target: mpf
    weight: mpf
    numerator: list[mpf]
    denominator: list[mpf]

    def parts(self, fit: Fit) -> tuple[mpf, mpf]:
        """N and D."""
        return mpmath.fdot(fit.numerator, self.numerator), mpmath.fdot(fit.denominator, self.denominator)

    def error(self, fit: Fit) -> mpf:
        top, bottom = self.parts(fit)
        return self.weight * (top / bottom - self.target)


@dataclass(frozen=True)
class Problem:
    """Make the largest ``weight * abs(target - N/D)`` least.

    Parameters
    ----------
    target, weight : callable
        The function and its weight, which may vanish at isolated points but must not change its sign.
    lower, upper : mpf
        The interval.
    numerator, denominator : sequence of callables
        The bases of N and of D; that of D begins with 1, or is 1 alone for a linear fit.
    scale : mpf, optional
        Where given, the grid is even in x/(x + scale) rather than in x: for long intervals.
    """

    target: Function
    weight: Function
    lower: mpf
    upper: mpf
    numerator: Sequence[Function]
    denominator: Sequence[Function] = tuple(powers(0, 0))
    scale: mpf | None = None

    @property
    def unknowns(self) -> int:
        return len(self.numerator) + len(self.denominator) - 1

    @cached_property
    def grid(self) -> list[Point]:
        """16 points for each unknown, that crowd at both ends as the extrema of Chebyshev polynomials do."""
        count = 16 * (self.unknowns + 1)
        lower, upper = mpf(self.lower), mpf(self.upper)
        if self.scale is not None:
            lower, upper = lower / (lower + self.scale), upper / (upper + self.scale)
        middle, half = (upper + lower) / 2, (upper - lower) / 2
        y = [middle - half * mpmath.cos(mpmath.pi * j / (count - 1)) for j in range(count)]
        return [self.point(v if self.scale is None else self.scale * v / (1 - v)) for v in y]

    def point(self, x: mpf) -> Point:
        bases = [[b(x) for b in basis] for basis in (self.numerator, self.denominator)]
        return Point(self.target(x), self.weight(x), *bases)


def minimax(problem: Problem) -> Fit:
    """The best fit, with denominator[0] = 1.

    Raises
    ------
    ArithmeticError
        Where the exchange does not settle: a degenerate problem, or a pole inside the interval.
    """
    size, grid = problem.unknowns + 1, problem.grid
    # Interpolation at Chebyshev's zeros is close to the best already.
    last = len(grid) - 1
    fit = _through([grid[round(last * (2 * i + 1) / (2 * size - 2))] for i in range(size - 1)])
    for _ in range(60):
        errors = [point.error(fit) for point in grid]
        largest = max(abs(e) for e in errors)
        if largest <= fit.error * (1 + mpf("1e-6")):
            return Fit(fit.numerator, fit.denominator, largest)
        extrema = _alternation(errors, size)
        if len(extrema) < size:
            break
        fit = _levelled([grid[i] for i in extrema])
    raise ArithmeticError("the exchange did not settle")


def _through(points: list[Point]) -> Fit:
    """The quotient through all points: as many as unknowns."""
    rows = [p.numerator + [-p.target * d for d in p.denominator[1:]] for p in points]
    solution = list(mpmath.lu_solve(mpmath.matrix(rows), mpmath.matrix([p.target for p in points])))
    count = len(points[0].numerator)
    return Fit(solution[:count], [mpf(1), *solution[count:]], mpf(0))


def _levelled(points: list[Point]) -> Fit:
    """The quotient with error +E, -E, +E, ... at the points: one more than unknowns.

    w (N - f D) - s E D = 0, s = +-1, is linear but for E D; Newton's iteration for the rest.
    """
    count = len(points[0].numerator)
    error, denominator = mpf(0), [mpf(1)] + [mpf(0)] * (len(points[0].denominator) - 1)
    for _ in range(60):
        rows, right = [], []
        for i, p in enumerate(points):
            slope = (-1) ** i * mpmath.fdot(denominator, p.denominator)  # d(s E D)/dE
            factor = p.weight * p.target + (-1) ** i * error
            rows.append(
                [p.weight * b for b in p.numerator] + [-factor * d for d in p.denominator[1:]] + [-slope]
            )
            right.append(factor - slope * error)
        solution = list(mpmath.lu_solve(mpmath.matrix(rows), mpmath.matrix(right)))
        previous, error = error, solution.pop()
        denominator = [mpf(1), *solution[count:]]
        if len(denominator) == 1 or abs(error - previous) <= mpf("1e-12") * abs(error):
            return Fit(solution[:count], denominator, abs(error))
    raise ArithmeticError("the levelled quotient was not found")


def _alternation(errors: list[mpf], count: int) -> list[int]:
    """Indices of the largest errors of alternating sign."""
    peaks: list[int] = []
    for i, e in enumerate(errors):
        if e and (not peaks or (errors[peaks[-1]] > 0) != (e > 0)):
            peaks.append(i)
        elif e and abs(e) > abs(errors[peaks[-1]]):
            peaks[-1] = i
    while len(peaks) > count + 1:  # drop two neighbours, so that the signs still alternate
        height = [max(abs(errors[a]), abs(errors[b])) for a, b in itertools.pairwise(peaks)]
        smallest = height.index(min(height))
        del peaks[smallest : smallest + 2]
    if len(peaks) == count + 1:
        peaks.pop(0 if abs(errors[peaks[0]]) < abs(errors[peaks[-1]]) else -1)
    return peaks


def rounded(problem: Problem, fit: Fit, kind: Real) -> Fit:
    """Round the coefficients to a floating-point type, then move them by last places while that helps.

    To first order the error is linear in such changes (the second order is below 1e-14 in float32), so that
    trying one costs no evaluation. A quotient is first tried at several scales of both its parts.
    """
    count = len(fit.numerator)
    quotient = len(fit.denominator) > 1
    exact = np.array(fit.numerator + (fit.denominator if quotient else []))
    grid = problem.grid
    errors, effects = np.empty(len(grid)), np.empty((len(exact), len(grid)))
    for i, p in enumerate(grid):
        top, bottom = p.parts(fit)
        errors[i] = p.error(fit)
        effects[:count, i] = [p.weight * b / bottom for b in p.numerator]
        effects[count:, i] = [-p.weight * top * d / bottom**2 for d in p.denominator] if quotient else []

    def change(moves: Vector) -> Vector:
        """Effect of moves of the coefficients, added up in a fixed order."""
        total = np.zeros(len(grid))
        for k in np.flatnonzero(moves):
            total += moves[k] * effects[k]
        return total

    def nearest(scale: mpf) -> tuple[float, mpf, Vector, Vector]:
        values = np.array([float(kind(c * scale)) for c in exact])
        off = np.array([float(mpf(v) / scale - c) for v, c in zip(values, exact, strict=True)])
        e = errors + change(off)
        return float(np.abs(e).max()), scale, values, e

    scales = [1 + mpf(j) / 64 for j in range(64 if quotient else 1)]
    best, scale, values, errors = min(map(nearest, scales), key=lambda found: found[0])
    places = np.array([float(np.spacing(kind(abs(v)))) for v in values])
    effects *= (places / float(scale))[:, None]
    single = [np.eye(len(exact))[k] * sign for k in range(len(exact)) for sign in (-1, 1)]
    trials = single + [a + b for i, a in enumerate(single) for b in single[:i]]
    while True:
        largest = [float(np.abs(errors + change(trial)).max()) for trial in trials]
        choice = largest.index(min(largest))
        if largest[choice] >= best * (1 - 1e-6):
            break
        best = largest[choice]
        errors = errors + change(trials[choice])
        values = values + trials[choice] * places
    final = [mpf(float(kind(v))) for v in values]
    result = Fit(final[:count], final[count:] or [mpf(1)], mpf(0))
    return replace(result, error=max(abs(p.error(result)) for p in grid))


def array(name: str, comment: str, values: Sequence[mpf | int], kind: Real = np.float64) -> str:
    """C++ text of an array, in the shortest digits that give its numbers back."""
    cpp, suffix = ("float", "F") if kind is np.float32 else ("double", "")
    body = textwrap.fill(", ".join(f"{kind(float(v))!s}{suffix}" for v in values), 106)
    start = f"// {comment}\n" if comment else ""
    return (
        f"{start}inline constexpr std::array<{cpp}, {len(values)}> {name}{{\n"
        + textwrap.indent(body, "    ")
        + "};\n"
    )


def header(tool: str, parts: Sequence[str]) -> str:
    """C++ text of a header of coefficients."""
    return (
        f"// Derived by tools/{tool} in 60 digits; do not edit by hand. Lowest power first.\n#pragma once\n\n"
        "#include <array>\n\nnamespace microfacet::coefficients {\n\n"
        + "\n".join(parts)
        + "\n}  // namespace microfacet::coefficients\n"
    )
