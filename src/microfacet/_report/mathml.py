"""LaTeX to MathML, mended where latex2mathml and the browsers' MathML Core disagree."""

from __future__ import annotations

import re
from functools import cache
from html import escape
from itertools import zip_longest
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from latex2mathml.converter import convert

__all__ = ["display", "display_pieces", "inline", "prose"]

_NAMESPACE = ' xmlns="http://www.w3.org/1998/Math/MathML"'  # implied inside HTML
_SCRIPTS = {"msup", "msub", "msubsup"}
_BEFORE_SIGN = {None, "(", "[", "{", ",", ";", "=", "<", ">", "≤", "≥", "→", "∈"}


@cache
def display(latex: str) -> str:
    """A displayed formula as a `math` element."""
    return _mend(convert(_sized(latex), display="block"))


@cache
def inline(latex: str) -> str:
    """A formula inside a line of text as a `math` element."""
    return _mend(convert(_sized(latex), display="inline"))


def display_pieces(latex: str) -> list[str]:
    """A displayed formula as one `math` element for each statement, so that narrow screens can stack them."""
    *pieces, last = re.split(r",\s*\\quad\s*", latex)
    return [display(piece + ",") for piece in pieces] + [display(last)]


def prose(text: str) -> str:
    """HTML of a text with inline formulas between dollar signs; the text itself is escaped.

    A bracket before a formula and punctuation after it stay on its line.
    """
    parts = text.split("$")
    for i in range(1, len(parts), 2):
        before = "(" if parts[i - 1].endswith("(") else ""
        close = re.match(r"[.,;:)]+", parts[i + 1])
        after = close.group() if close else ""
        parts[i - 1] = escape(parts[i - 1].removesuffix("("), quote=False)
        formula = before + inline(parts[i]) + after
        parts[i] = f'<span class="nb">{formula}</span>' if before or after else formula
        parts[i + 1] = parts[i + 1].removeprefix(after)
    parts[-1] = escape(parts[-1], quote=False)
    return "".join(parts)


def _sized(latex: str) -> str:
    """Delimiters of a fixed size, which latex2mathml does not read, as delimiters that grow."""
    latex = re.sub(r"\\[Bb]ig\s*(\(|\[|\\\{)", r"\\left\1", latex)
    return re.sub(r"\\[Bb]ig\s*(\)|\]|\\\})", r"\\right\1", latex)


def _mend(mathml: str) -> str:
    root = ElementTree.fromstring(mathml.replace(_NAMESPACE, ""))
    for element in list(root.iter()):
        _join_letters(element)
    for element in root.iter():
        _mend_identifier(element)
    for element in list(root.iter()):
        _mend_row(element)
    return ElementTree.tostring(root, encoding="unicode")


def _join_letters(row: Element) -> None:
    """A word in upright type arrives letter by letter; as one identifier it is set as a word."""
    letters = list(row)
    upright = all(e.tag == "mi" and e.attrib.get("mathvariant") == "normal" for e in letters)
    if row.tag == "mrow" and len(letters) > 1 and upright:
        word = "".join(letter.text or "" for letter in letters)
        row.clear()
        row.tag, row.text = "mi", word


def _mend_identifier(element: Element) -> None:
    text = element.text or ""
    if element.tag == "mo" and re.fullmatch(r"[A-Za-z]{2,}", text):
        element.tag = "mi"  # a named function is no operator, around which browsers put space
        element.attrib.clear()
    elif element.tag == "mi" and text in {";", ","}:
        element.tag, element.attrib["separator"] = "mo", "true"
    elif element.tag == "mi" and len(text) == 1 and "Α" <= text <= "Ω":
        element.attrib["mathvariant"] = "normal"  # as LaTeX sets capital Greek


def _mend_row(row: Element) -> None:
    """Put the thin spaces that TeX puts around named functions, and mark minus signs that are not binary."""
    if row.tag in _SCRIPTS or row.tag in {"mfrac", "mi", "mo", "mn", "mspace"}:
        return
    children = list(row)
    before: Element | None = None
    for child, after in zip_longest(children, children[1:]):
        if child.tag == "mo" and child.text in {"−", "-"} and _text(before) in _BEFORE_SIGN:
            child.attrib |= {"form": "prefix", "lspace": "0", "rspace": "0"}
        if _is_function(child):
            if before is not None and before.tag not in {"mo", "mspace"} and not _is_function(before):
                row.insert(list(row).index(child), _thin_space())
            if after is not None and after.tag not in {"mo", "mspace"} and not _is_fenced(after):
                row.insert(list(row).index(child) + 1, _thin_space())
        before = child


def _is_function(element: Element) -> bool:
    base = element[0] if element.tag in _SCRIPTS else element
    return base.tag == "mi" and bool(re.fullmatch(r"[A-Za-z]{2,}", base.text or ""))


def _is_fenced(element: Element) -> bool:
    return element.tag == "mrow" and len(element) > 0 and element[0].attrib.get("fence") == "true"


def _text(element: Element | None) -> str | None:
    if element is None:
        return None
    return element.text if element.tag == "mo" else ""


def _thin_space() -> Element:
    return Element("mspace", {"width": "0.167em"})
