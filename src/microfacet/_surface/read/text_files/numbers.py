"""Cells of a table: numbers, words for missing ones, and what is neither."""

from __future__ import annotations

import math
import re

__all__ = ["is_missing", "is_row", "number", "split"]

_LONGEST = 100

# Words for a pixel without a height, in lower case. Numbers that stand for one are not among them: a file
# must state those.
_MISSING = frozenset((
    "", "nan", "-nan", "+nan", "nanq", "n/a", "na", "#n/a", "n.a.", "nd", "n.d.", "none", "null", "nil",
    "nodata", "no_data", "no data", "baddata", "bad data", "bad", "badpixel", "bad pixel", "invalid",
    "invalidated", "missing", "masked", "void", "undefined", "undef", "unmeasured", "not measured",
    "not a number", "lost", "off", "inf", "-inf", "+inf", "infinity", "-infinity", "infinite",
    "nan(ind)", "-nan(ind)", "nan(snan)",
    "#num!", "#value!", "#div/0!", "#ref!", "?", "*", ".", "x",
))  # fmt: skip
_DASHES = re.compile(r"[-\u2013\u2014_*.?#]{2,}|[-\u2013\u2014]")
_TWO_WORDS = re.compile(r"\b(no|bad) data\b", re.IGNORECASE)
_MICROSOFT = re.compile(r"[-+]?\d+\.#(QNAN|SNAN|IND|INF|NAN|INF00|QNAN0|IND00|QNB|J)\d*", re.IGNORECASE)
_NUMBER = re.compile(r"[-+\u2212]?(\d+\.?\d*|\.\d+)([eEdD][-+\u2212]?\d+)?")


def number(cell: str, decimal_comma: bool = False) -> float:
    """The number in a cell, nan where a word or nothing says that there is none; else ValueError."""
    text = cell.strip().strip("\"'").strip()
    if len(text) > _LONGEST:
        raise ValueError(cell)
    if decimal_comma:
        if "." in text and "," in text:
            raise ValueError(cell)
        text = text.replace(",", ".")
    if _NUMBER.fullmatch(text):
        return float(text.replace("\u2212", "-").replace("d", "e").replace("D", "e"))
    if text.lower() in _MISSING or _DASHES.fullmatch(text) or _MICROSOFT.fullmatch(text):
        return math.nan
    raise ValueError(cell)


def is_missing(cell: str) -> bool:
    """Whether the cell holds a word for a missing number, or nothing."""
    try:
        return math.isnan(number(cell))
    except ValueError:
        return False


def split(line: str, delimiter: str | None) -> list[str]:
    """The cells of a line; None separates at any white space, but within a mark of two words."""
    if delimiter is None and "ata" in line:
        line = _TWO_WORDS.sub("nan", line)
    return line.split(delimiter)


def is_row(line: str, delimiter: str | None, decimal_comma: bool) -> bool:
    """Whether the line holds numbers, at least one of them, and words for missing ones."""
    try:
        values = [number(cell, decimal_comma) for cell in split(line, delimiter)]
    except ValueError:
        return False
    return not all(map(math.isnan, values))
