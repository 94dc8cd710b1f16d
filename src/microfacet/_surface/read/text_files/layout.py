"""How a table of numbers is laid out: its heading, what separates its cells, the names of its columns."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass

from microfacet._surface.checks import METRES_PER_UNIT, SurfaceError, short
from microfacet._surface.read.text_files.numbers import is_missing, is_row, split
from microfacet._surface.read.units import unit_in_brackets, unit_name

__all__ = ["Layout", "NoTable", "comment", "find", "without_comment"]

# A heading may be long, what is looked at is not.
_MOST_LINES, _MOST_CHARACTERS = 1000, 2**22
# What may stand between cells and whether the decimal mark is then a comma: certain marks first.
_CANDIDATES = (
    ("\t", False), (";", False), ("|", False), (",", False), (None, False),
    ("\t", True), (";", True), ("|", True), (None, True),
)  # fmt: skip
_COMMENT = re.compile(r"\s*(#(?!N/A|NUM!|VALUE!|DIV/0!|REF!)|%|//|!|\*(?=\s*[A-Za-z])|>)\s*")
_INLINE = re.compile(r"\s#(?!N/A|NUM!|VALUE!|DIV/0!|REF!).*")


class NoTable(SurfaceError):
    """A text without a line of numbers."""


@dataclass(frozen=True)
class Layout:
    """The layout of a table.

    `delimiter` is None for white space; `trailing` says that every row ends with one; `names` and `units` are
    those of the columns, where the heading states them; `empty` rows without any number come first.
    """

    delimiter: str | None
    decimal_comma: bool
    trailing: bool
    columns: int
    heading: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    units: tuple[str | None, ...] = ()
    empty: int = 0


def find(rows: Iterable[str]) -> Layout:
    """The layout of the text that begins with these lines; no more of them are taken than it needs."""
    heading: list[str] = []
    seen = 0
    first_words = ""
    for line in itertools.islice(rows, _MOST_LINES):
        seen += len(line)
        if seen > _MOST_CHARACTERS:
            break
        remark = comment(line)
        bare = without_comment(line)
        if remark is None and bare.strip():
            for delimiter, decimal_comma in _CANDIDATES:
                if (delimiter is None or delimiter in bare) and is_row(bare, delimiter, decimal_comma):
                    return _layout(bare, delimiter, decimal_comma, heading)
            first_words = first_words or bare
        if line.strip():
            heading.append(line if remark is None else remark)
    if first_words:
        raise NoTable(f"this is not a table of numbers: it begins with {short(first_words.strip())}")
    raise NoTable("the file holds no numbers")


def comment(line: str) -> str | None:
    """What a line of comment says; None for any other line."""
    start = _COMMENT.match(line)
    return None if start is None else line[start.end() :]


def without_comment(line: str) -> str:
    """The line without a comment at its end."""
    return _INLINE.sub("", line) if "#" in line else line


def _layout(row: str, delimiter: str | None, decimal_comma: bool, heading: list[str]) -> Layout:
    cells = split(row, delimiter)
    trailing = len(cells) > 1 and not cells[-1].strip()
    columns = len(cells) - trailing
    empty = 0
    while heading and columns > 1 and _is_empty_row(heading[-1], delimiter, columns):
        heading.pop()
        empty += 1
    names, units = _names(heading, delimiter, columns)
    return Layout(delimiter, decimal_comma, trailing, columns, tuple(heading), names, units, empty)


def _is_empty_row(line: str, delimiter: str | None, columns: int) -> bool:
    """Whether a line above the first numbers is a row in which all of them are missing."""
    cells = split(line, delimiter)
    return len(cells) in (columns, columns + 1) and all(map(is_missing, cells))


def _names(
    heading: list[str], delimiter: str | None, columns: int
) -> tuple[tuple[str, ...], tuple[str | None, ...]]:
    """The names of the columns and their units, from the last lines of the heading."""
    last = _cells(heading[-1], delimiter, columns) if heading else None
    if last is None:
        return (), ()
    units: tuple[str | None, ...] = tuple(unit_name(cell) or None for cell in last)
    above = _cells(heading[-2], delimiter, columns) if len(heading) > 1 else None
    if above is not None and any(unit in METRES_PER_UNIT for unit in units) and all(map(_may_be_unit, last)):
        return tuple(unit_in_brackets(cell)[0] for cell in above), units
    pairs = [unit_in_brackets(cell) for cell in last]
    return tuple(name for name, _ in pairs), tuple(unit for _, unit in pairs)


def _may_be_unit(cell: str) -> bool:
    bare = cell.strip()
    return len(bare) < 12 and (not bare or bare[0] in "[(" or unit_name(bare) in METRES_PER_UNIT)


def _cells(line: str, delimiter: str | None, columns: int) -> list[str] | None:
    """The cells of a line of the heading, if there are as many as columns."""
    ways = [line]
    if delimiter is None:  # names may have a unit behind them, or commas between them
        line = line.replace(",", " ").replace(";", " ")
        ways = [line, re.sub(r"\s+(?=[\[(])", "", line)]
    for way in ways:
        cells = [cell.strip().strip("\"'").strip() for cell in split(way, delimiter)]
        if len(cells) == columns + 1 and not cells[-1]:
            cells.pop()
        if len(cells) == columns and any(cells):
            return cells
    return None
