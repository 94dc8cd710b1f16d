"""Profiles as text: one column of heights, positions and heights, several profiles in one file.

A profile is recognised by what the text holds, not by the ending of its name: a heading that names columns
and units, columns of positions that rise evenly. Memory is bounded.
"""

from __future__ import annotations

import io
import math
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import SurfaceError, short
from microfacet._surface.read.profile_columns import is_abscissa, rises, traces_of
from microfacet._surface.read.profile_headings import Heading, heading_of
from microfacet._surface.read.text_files import lines

__all__ = ["MAX_POINTS", "TextProfile", "holds_profile", "read"]

#: Points of a profile that come as text; a stylus writes some ten thousand.
MAX_POINTS = 2**23
_MAX_LINE = 2**16
_MAX_BYTES = 2**28
_MAX_COLUMNS = 1000
_MAX_HEADING = 200  # lines
_HEAD = 2**20  # bytes by which a file is recognised
#: What stands for a missing point.
_MISSING = frozenset(
    (
        "",
        "nan",
        "-nan",
        "inf",
        "-inf",
        "+inf",
        "bad",
        "na",
        "n/a",
        "null",
        "none",
        "-",
        "--",
        "---",
        "*",
        "**",
    )
) | frozenset(("***", "****", "invalid", "missing", "void", "#n/a"))
_COMMA = re.compile(r"[-+]?\d*,\d+([eE][-+]?\d+)?")

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class TextProfile:
    """Positions (None where the text has none) and heights of each trace, in units that are named or not."""

    traces: tuple[tuple[Vector | None, Vector], ...]
    position_unit: str | None
    height_unit: str | None
    spacing: float | None = None  # metres, of a heading
    remarks: tuple[str, ...] = ()


@dataclass
class _Block:
    """Lines of numbers that belong together, and the lines of words before them."""

    heading: list[str] = field(default_factory=list)
    rows: list[list[float]] = field(default_factory=list)


def holds_profile(file: Path) -> bool:
    """Whether the text is a profile beyond doubt, by its first megabyte: a single column, or positions that
    rise in every line beside heights. Two columns of slopes or three of points are none.
    """
    try:
        with file.open("rb") as stream:
            head = stream.read(_HEAD)
        found = list(lines(io.BytesIO(head)))
        blocks, heading = _parsed(found if len(head) < _HEAD else found[:-1])
        width = max(len(row) for block in blocks for row in block.rows)
        if width > 2 and not heading.of_profiles:
            return False
        traces = traces_of(map(_table, blocks), heading, False)
    except (SurfaceError, ValueError, OSError):
        return False
    if all(x is None for x, _ in traces):
        return width == 1 or heading.heights_alone
    return all(x is not None and is_abscissa(x) for x, _ in traces)


def read(file: Path, sized: bool) -> TextProfile:
    """The traces of the text; `SurfaceError` says what it holds instead. Columns that do not rise are heights
    where the caller knows the distance of the points (`sized`).
    """
    if file.stat().st_size > _MAX_BYTES:
        raise SurfaceError(f"a profile as text may have {_MAX_BYTES} bytes, this has {file.stat().st_size}")
    with file.open("rb") as stream:
        blocks, heading = _parsed(list(lines(stream)))
    traces = traces_of(map(_table, blocks), heading, sized)
    return TextProfile(
        tuple(traces), heading.position_unit, heading.height_unit, heading.spacing, heading.remarks
    )


def _parsed(text: list[str]) -> tuple[list[_Block], Heading]:
    """Blocks as wide as the longest one, and what stands above it."""
    if any(len(line) > _MAX_LINE for line in text):
        raise SurfaceError(f"a line is longer than {_MAX_LINE} characters, which no profile needs")
    blocks = _blocks(text, False)
    first = [row[0] for block in blocks for row in block.rows if len(row) == 2]
    if first and _whole(first) and not rises(np.array(first)):
        blocks = _blocks(text, True)
    longest = max(range(len(blocks)), key=lambda k: len(blocks[k].rows))
    width = max(map(len, blocks[longest].rows), default=0)
    if not width:
        raise SurfaceError("the file holds no numbers")
    above = [line for block in blocks[: longest + 1] for line in block.heading]
    kept = [block for block in blocks if max(map(len, block.rows)) == width]
    return kept, heading_of(above, width)


def _blocks(text: list[str], decimal_commas: bool) -> list[_Block]:
    """Numbers in blocks, which words or empty lines part."""
    empty = sum(1 for line in text if not line.strip())
    blocks, cut = [_Block()], False
    delimiter: str | None = None
    count = 0
    for number, line in enumerate(text, start=1):
        content = line.strip()
        words = content.lstrip("#%!").strip() if content[:1] in ("#", "%", "!") else None
        if words is None and not content:
            cut = empty < len(text) // 3
            continue
        if words is None:
            content = content.split("#")[0].strip()
            if not blocks[-1].rows:
                delimiter = _separator(content, decimal_commas)
        row = _numbers(content, delimiter, decimal_commas) if words is None else None
        if row is None:
            if blocks[-1].rows:
                if words is None and not _heads(content, delimiter):
                    raise SurfaceError(f"line {number}: {short(content[:40])} is not a number")
                blocks.append(_Block())
            blocks[-1].heading = [*blocks[-1].heading[-_MAX_HEADING:], content if words is None else words]
            continue
        if cut and blocks[-1].rows:
            blocks.append(_Block())
        cut = False
        count += 1
        if count > MAX_POINTS:
            raise SurfaceError(f"the text holds more than {MAX_POINTS} lines of numbers, which is the limit")
        blocks[-1].rows.append(row)
    return [block for block in blocks if block.rows] or [_Block()]


def _separator(line: str, decimal_commas: bool) -> str | None:
    """What stands between the cells of a line; None for white space."""
    if ";" in line:
        return ";"
    if "\t" in line.strip():
        return "\t"
    words = line.split()
    if decimal_commas:
        return None
    if len(words) > 1 and all(_COMMA.fullmatch(word) or _is_number(word) for word in words):
        return None  # decimal commas
    return "," if "," in line else None


def cells(line: str, delimiter: str | None) -> list[str]:
    """The cells of a line, without the empty one after a trailing separator."""
    found = [cell.strip() for cell in line.split(delimiter)]
    return found[:-1] if len(found) > 1 and not found[-1] else found


def _numbers(line: str, delimiter: str | None, decimal_commas: bool) -> list[float] | None:
    """The numbers of a line, nan for what is missing; None where a cell is a word, or all are missing."""
    row = []
    found = cells(line, delimiter)
    if len(found) > _MAX_COLUMNS:
        raise SurfaceError(f"a line holds {len(found)} numbers, which is a map and no profile")
    for cell in found:
        word = cell.strip("\"'")
        if (decimal_commas or delimiter != ",") and _COMMA.fullmatch(word):
            word = word.replace(",", ".")
        try:
            row.append(float(word))
        except ValueError:
            if word.lower() not in _MISSING:
                return None
            row.append(math.nan)
    known = any(map(math.isfinite, row))
    return row if known or len(row) == 1 else None


def _whole(values: list[float]) -> bool:
    return all(value == int(value) for value in values if math.isfinite(value))


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _heads(line: str, delimiter: str | None) -> bool:
    """Whether a line between numbers begins a further profile: it holds no number at all."""
    return not any(_is_number(cell) for cell in cells(line, delimiter))


def _table(block: _Block) -> Vector:
    width = max(map(len, block.rows))
    table = np.full((len(block.rows), width), math.nan)
    for line, row in zip(table, block.rows, strict=True):
        line[: len(row)] = row
    return table
