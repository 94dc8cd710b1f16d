"""Polynomials of two variables: weighted least squares in arbitrary precision, and their C++ text."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from flint import arb, arb_mat, ctx
from mpmath import mpf
from remez import FORMATS, Real, array, header

Surface = Callable[[arb, arb], tuple[arb, arb]]  # the value at (x, y), and the weight of an error there
Shape = tuple[int, ...]  # for each power of y, the number of powers of x
Interval = tuple[arb, arb]


def relative(function: Callable[[arb, arb], arb]) -> Surface:
    """Weigh the relative error."""

    def surface(x: arb, y: arb) -> tuple[arb, arb]:
        value = function(x, y).mid()
        return value, 1 / value

    return surface


def middle(interval: Interval) -> arb:
    return (interval[0] + interval[1]) / 2


def zeros(count: int, interval: Interval) -> list[arb]:
    """Of Chebyshev's polynomial."""
    half = (interval[1] - interval[0]) / 2
    angles = (arb.pi() * (2 * i + 1) / (2 * count) for i in range(count))
    return [(middle(interval) - half * angle.cos()).mid() for angle in angles]


def fitted(surface: Surface, x: Interval, y: Interval, shape: Shape) -> tuple[list[mpf], float]:
    """Coefficients in powers of x less its middle and of y, row by row, and the largest weighted error.

    The points are where products of Chebyshev's polynomials vanish.
    """
    matrix, right = [], []
    for b in zeros(2 * len(shape) + 4, y):
        for a in zeros(2 * max(shape) + 10, x):
            value, weight = (v.mid() for v in surface(a, b))
            terms = [b**j * (a - middle(x)) ** i for j, count in enumerate(shape) for i in range(count)]
            matrix.append([(weight * term).mid() for term in terms])
            right.append([(weight * value).mid()])
    m, r = arb_mat(matrix), arb_mat(right)
    with ctx.workprec(5 * ctx.prec):  # powers are nearly dependent, and the normal equations square that
        solution = (m.transpose() * m).solve(m.transpose() * r)
        error = max(float(abs(e)) for e in (m * solution - r).entries())
    return [mpf(c.mid().str(50, radius=False)) for c in solution.entries()], error


def both_formats(
    name: str, comment: str, surface: Surface, x: Interval, y: Interval, shapes: dict[int, Shape]
) -> list[str]:
    """C++ text of a fit in float32 and one in float64."""
    parts = []
    for bits, kind in FORMATS:
        coefficients, error = fitted(surface, x, y, shapes[bits])
        text = f"{comment}: error {error:.1e}"
        parts.append(bivariate(f"{name}_{bits}", text, shapes[bits], coefficients, kind))
    return parts


def bivariate(name: str, comment: str, shape: Shape, values: Sequence[mpf], kind: Real) -> str:
    """C++ text of a polynomial of special/bivariate.hpp."""
    rows = ", ".join(map(str, shape))
    text = array(name, comment, values, kind)
    text = text.replace("std::array<", "bivariate<", 1).replace(f", {len(values)}>", f", {rows}>", 1)
    return text.replace(f"{name}{{\n", f"{name}{{{{\n").replace("};\n", "}};\n")


def bivariate_header(tool: str, parts: Sequence[str]) -> str:
    """C++ text of a header with polynomials of two variables."""
    include = "#include <array>\n"
    return header(tool, parts).replace(
        include, f'{include}\n#include "microfacet/special/bivariate.hpp"\n', 1
    )
