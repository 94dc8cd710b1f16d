"""Operations as text: parentheses where they are needed, signs where they read well."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from microfacet._export.graph import Graph
from microfacet._export.language import Language

__all__ = ["ATOM", "Missing", "Text", "literal", "operation"]

# How tightly the outermost operator of an expression binds.
ATOM, UNARY, PRODUCT, SUM, COMPARISON, AND, OR, LOOSE = 7, 6, 5, 4, 3, 2, 1, 0
_COMPARISONS = {
    "less": "<",
    "less_equal": "<=",
    "greater": ">",
    "greater_equal": ">=",
    "equal": "==",
    "not_equal": "!=",
}
_LEAST_INTEGER = -(2**31)


class Missing(ValueError):
    """An operation that a language has not."""


class Text(NamedTuple):
    """An expression, how tightly it binds, and its opposite where that is as short."""

    text: str
    binds: int = ATOM
    opposite: str | None = None

    def at(self, least: int) -> str:
        """In parentheses, unless it binds at least so tightly."""
        return self.text if self.binds >= least else f"({self.text})"

    def logical(self, own: int) -> str:
        """As an operand of `and` or `or`: one of the other is put into parentheses."""
        return self.text if self.binds == own else self.at(COMPARISON)


def literal(language: Language, type_: str, value: float | int | bool) -> Text:
    """A number in the language, short and exact in single precision."""
    if type_ == "mask":
        return Text(language.true if value else language.false)
    if type_ == "integer":
        if int(value) == _LEAST_INTEGER:
            return Text(f"{_LEAST_INTEGER + 1} - 1", SUM)
        number = Text(str(abs(int(value))))
        return Text(f"-{number.text}", UNARY, number.text) if value < 0 else number
    with np.errstate(over="ignore"):
        real = np.float32(value)
    if math.isnan(real):
        return Text(language.nan)
    text = language.infinity if math.isinf(real) else language.number.format(_digits(abs(real)))
    return Text(f"-{text}", UNARY, text) if math.copysign(1.0, real) < 0 else Text(text)


def _digits(real: np.float32) -> str:
    """As few digits as single precision needs, with a point or an exponent."""
    if real == np.finfo(np.float32).max:  # rounded up it would be too large for strict compilers
        return "3.4028234e38"
    mantissa, e, exponent = str(real).partition("e")
    return f"{mantissa}e{int(exponent)}" if e else mantissa


def _sum(a: Text, b: Text) -> Text:
    if b.opposite is not None:
        return Text(f"{a.at(SUM)} - {b.opposite}", SUM)
    if a.opposite is not None:
        return Text(f"{b.at(SUM)} - {a.opposite}", SUM)
    return Text(f"{a.at(SUM)} + {b.at(PRODUCT)}", SUM)


def _difference(a: Text, b: Text) -> Text:
    if b.opposite is not None:
        return Text(f"{a.at(SUM)} + {b.opposite}", SUM)
    return Text(f"{a.at(SUM)} - {b.at(PRODUCT)}", SUM)


def _product(a: Text, b: Text) -> Text:
    if a.opposite is not None and a.binds == UNARY:  # (-a) b = -(a b)
        return Text(f"{a.text} * {b.at(ATOM)}", PRODUCT, f"{a.opposite} * {b.at(ATOM)}")
    return Text(f"{a.at(PRODUCT)} * {b.at(ATOM)}", PRODUCT)


def _negated(a: Text) -> Text:
    if a.opposite is not None:
        return Text(a.opposite, PRODUCT if a.binds == PRODUCT else ATOM)
    return Text(f"-{a.at(ATOM)}", UNARY, a.at(ATOM))


_ARITHMETIC = {"add": _sum, "subtract": _difference, "multiply": _product}


def operation(language: Language, graph: Graph, node: int, arguments: list[Text]) -> Text:
    """One operation on its arguments; Missing where the language has none."""
    name = graph.operation[node]
    if name in _ARITHMETIC:
        return _ARITHMETIC[name](*arguments)
    if name == "multiply_add":
        return _sum(_product(*arguments[:2]), arguments[2])
    if name == "divide":
        return Text(f"{arguments[0].at(PRODUCT)} / {arguments[1].at(ATOM)}", PRODUCT)
    if name == "negate":
        return _negated(*arguments)
    if name in _COMPARISONS:
        a, b = arguments
        return Text(f"{a.at(SUM)} {_COMPARISONS[name]} {b.at(SUM)}", COMPARISON)
    if graph.type[node] == "mask" and name in ("and", "or"):
        own, sign = (AND, "&&") if name == "and" else (OR, "||")
        return Text(f"{arguments[0].logical(own)} {sign} {arguments[1].logical(own)}", own)
    if name == "not":
        return Text(f"!{arguments[0].at(ATOM)}", UNARY)
    return _templated(language, graph, node, arguments)


def _templated(language: Language, graph: Graph, node: int, arguments: list[Text]) -> Text:
    name = graph.operation[node]
    name = f"integer {name}" if name in ("and", "or") else name
    if name in language.calls:
        return Text(language.calls[name].format(*(argument.text for argument in arguments)))
    if name in language.operators:
        return Text(language.operators[name].format(*(a.at(UNARY) for a in arguments)), LOOSE)
    reason = language.why_not.get(name, f"{language.title} has no {name}")
    raise Missing(reason)
