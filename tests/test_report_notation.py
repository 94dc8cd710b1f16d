"""Symbols of the report, of the families' pages and docstrings have one meaning; formulas are MathML."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import microfacet as mf
from microfacet import _checks
from microfacet._report import mathml
from microfacet._report.families import formulas

ROOT = Path(__file__).parent.parent
ITEMS = _checks.catalogue()
FAMILIES = [family.name for family in mf.families()]

#: What x and y stand for, in LaTeX or ASCII.
MEANING = {
    "x": re.compile(
        r"\\frac\{\\cot\\theta\}\{\\alpha\}|\\mu/\\alpha|\\cot\\theta/\\alpha|cot\(theta\)/alpha"
    ),
    "y": re.compile(
        r"\\frac\{(\\tan\\theta|r)\}\{\\alpha\}|\\tan\\theta/\\alpha|r/\\?alpha|tan\(theta\)/alpha"
    ),
}
DEFINITION = re.compile(r"(?<![\w\\^{(])([xy])\s*=(?!=)\s*([^,;$]+)")


def entries() -> list[tuple[str, str]]:
    """Each formula with the words around it: what a reader has before him."""
    shown = formulas.load()
    rows = [("common", row) for row in shown.common]
    rows += [(name, row) for name, text in shown.families.items() for row in text.formulas]
    found = [(f"{name}: {row.name}", "; ".join((*row.latex, row.remark))) for name, row in rows]
    return found + [(item.id, f"{item.latex}; {item.statement}") for item in ITEMS]


def symbols(latex: str) -> set[str]:
    """Single letters that stand for something: commands and words in upright type are left out."""
    bare = re.sub(r"\\(text|mathrm|operatorname)\{[^}]*\}", " ", latex)
    return set(re.findall(r"(?<![A-Za-z])[A-Za-z](?![A-Za-z])", re.sub(r"\\[A-Za-z]+", " ", bare)))


@pytest.mark.parametrize(("name", "text"), entries(), ids=lambda value: str(value)[:40])
def test_x_and_y_mean_one_thing_and_are_defined_where_they_are_used(name: str, text: str) -> None:
    formulas = text.split("; ")[0] if "." in name else "; ".join(text.split("; ")[:-1])
    defined = dict(DEFINITION.findall(text))
    for symbol, meaning in defined.items():
        assert MEANING[symbol].match(meaning.strip()), (name, symbol, meaning)
    for symbol in ("x", "y"):
        if symbol in symbols(formulas):
            assert symbol in defined, (name, symbol)


@pytest.mark.parametrize("family", FAMILIES)
def test_docs_and_docstrings_mean_the_same(family: str) -> None:
    page = (ROOT / "docs" / "family" / f"{family}.md").read_text("utf-8")
    prose = re.sub(r"```.*?```", "", page, flags=re.DOTALL)
    math = "; ".join(re.findall(r"\$+([^$]+)\$+", prose))
    texts = [math, *(getattr(getattr(mf, family), name).__doc__ for name in ("D", "sigma", "Lambda"))]
    for text in texts:
        for symbol, meaning in DEFINITION.findall(text):
            assert MEANING[symbol].match(meaning.strip()), (symbol, meaning)
    for formula in re.findall(r"\$\$(.*?)\$\$", prose, re.DOTALL):
        for symbol in {"x", "y"} & symbols(formula):
            assert symbol in dict(DEFINITION.findall(math)), (family, symbol)


# MathML

ASCII_FORMULA = re.compile(
    r"[\\^_=]|\b(alpha|gamma|sigma|Lambda|theta|sqrt|exp|log|xi|pi|P22|P2|cot|tan|sin|cos)\b|\b[a-zA-Z]\("
)


def outside(text: str) -> str:
    """A text without its formulas."""
    assert text.count("$") % 2 == 0, text
    return " ".join(text.split("$")[::2])


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.id)
def test_statements_have_their_formulas_in_mathml(item: _checks.CheckItem) -> None:
    assert not ASCII_FORMULA.search(outside(item.statement)), item.statement
    html = mathml.prose(item.statement)
    assert html.count("<math") == item.statement.count("$") // 2
    assert "$" not in html
    assert "merror" not in html
    assert mathml.display(item.latex).startswith("<math")


def test_texts_of_formulas_have_theirs_too() -> None:
    shown = formulas.load()
    texts = [text.summary for text in shown.families.values()]
    for entry in (*shown.common, *(f for text in shown.families.values() for f in text.formulas)):
        texts += [entry.name, entry.remark]
    for text in texts:
        assert not ASCII_FORMULA.search(outside(text)), text
