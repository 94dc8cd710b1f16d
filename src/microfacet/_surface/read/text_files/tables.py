"""Tables of numbers under a heading, whatever separates the cells and stands for missing ones."""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import MAX_PIXELS, SurfaceError, short
from microfacet._surface.read.text_files import headers, layout
from microfacet._surface.read.text_files.encoding import lines
from microfacet._surface.read.text_files.layout import Layout
from microfacet._surface.read.text_files.numbers import number, split

__all__ = ["Table", "blocks", "read_table"]

# Characters that are turned into numbers at once.
_CHUNK = 2**20
# Lines that are looked at cell by cell where one of them holds more than numbers.
_FEW = 4


@dataclass(frozen=True)
class Table:
    """Numbers, nan where one is missing, and what the heading above them says.

    `words` counts the cells that hold a word, or nothing, instead of a number.
    """

    values: NDArray[np.float64]
    layout: Layout
    header: headers.Header
    words: int = 0

    @property
    def remarks(self) -> tuple[str, ...]:
        """What a reader should know about how the text was taken."""
        found = []
        if self.layout.decimal_comma:
            found.append("commas taken for decimal marks")
        if self.words:
            plural = "cells that hold" if self.words > 1 else "cell that holds"
            found.append(f"{self.words} {plural} no number taken for missing")
        return tuple(found)


def read_table(file: Path, most: int = MAX_PIXELS) -> Table:
    """The only table of a text file, of at most so many numbers."""
    tables = blocks(file, most)
    first = next(tables)
    if next(tables, None) is not None:
        raise SurfaceError("the text holds several tables, one is needed")
    return first


def blocks(file: Path, most: int = MAX_PIXELS) -> Iterator[Table]:
    """The tables of a text, one after another; a heading that names a channel begins the next one."""
    with file.open("rb") as stream:
        rows = _Numbered(lines(stream))
        while True:
            first, form = _begin(rows)
            size = _stated_size(first, form, rows)
            if size is not None:
                first, form = _begin(rows)
            table = _read(itertools.chain((first,), rows), rows, form, most)
            if size is not None and sorted(size) != sorted(table.values.shape):
                raise SurfaceError(
                    f"the first line of numbers, {size[0]} and {size[1]}, is neither a row nor the size of "
                    f"the {len(table.values)} rows of {form.columns} below: this is not a table of numbers"
                )
            yield table
            if rows.pending is None:
                return


class _Numbered:
    """Lines that know their number; `pending` is the line of a heading that ended a table."""

    def __init__(self, rows: Iterator[str]) -> None:
        self._rows = rows
        self.count = 0
        self.pending: str | None = None

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        if self.pending is not None:
            line, self.pending = self.pending, None
            return line
        self.count += 1
        return next(self._rows)


def _begin(rows: _Numbered) -> tuple[str, Layout]:
    """The first line of numbers, and the layout of the table that begins there."""
    head: list[str] = []
    form = layout.find(_kept(rows, head))
    return head[-1], form


def _stated_size(first: str, form: Layout, rows: _Numbered) -> tuple[int, int] | None:
    """Two whole numbers above longer rows, which may be the size of the map; else None."""
    cells = split(first, form.delimiter)[: form.columns]
    if len(cells) != 2 or not all(cell.strip().isdecimal() and len(cell) < 9 for cell in cells):
        return None
    after = (line for line in rows if line.strip() and layout.comment(line) is None)
    rows.pending = next(after, None)
    if rows.pending is None:
        return None
    longer = len(split(rows.pending, form.delimiter)) > 3 or len(rows.pending.split()) > 3
    return (int(cells[0]), int(cells[1])) if longer else None


def _kept(rows: Iterator[str], kept: list[str]) -> Iterator[str]:
    """The same lines, the last of which stays at hand."""
    for line in rows:
        kept[:] = [line]
        yield line


def _read(rows: Iterator[str], source: _Numbered, form: Layout, most: int) -> Table:
    parts: list[NDArray[np.float64]] = []
    done = words = 0
    for chunk in _chunks(rows, source):
        values, found = _numbers(chunk, form)
        words += found
        done += values.size
        if done > most:
            raise SurfaceError(f"the text holds more than {most} numbers, which is the limit")
        parts.append(values)
    if form.empty:
        parts.insert(0, np.full((form.empty, form.columns), math.nan))
        words += form.empty * form.columns
    values = parts[0] if len(parts) == 1 else np.concatenate(parts)
    return Table(values, form, headers.parse(form.heading), words)


def _chunks(rows: Iterator[str], source: _Numbered) -> Iterator[list[tuple[int, str]]]:
    """Lines of numbers with the numbers of these lines, some at a time; comments and empty lines go."""
    chunk: list[tuple[int, str]] = []
    size = 0
    for line in rows:
        if (remark := layout.comment(line)) is not None:
            if headers.starts_a_channel(remark):
                source.pending = line
                break
            continue
        bare = layout.without_comment(line)
        if not bare.strip():
            continue
        if ":" in bare and headers.starts_a_channel(bare):
            source.pending = line
            break
        chunk.append((source.count, bare))
        size += len(bare)
        if size > _CHUNK:
            yield chunk
            chunk, size = [], 0
    if chunk:
        yield chunk


def _numbers(chunk: Sequence[tuple[int, str]], form: Layout) -> tuple[NDArray[np.float64], int]:
    """The numbers of the lines, and how many cells hold none: only such lines are looked at cell by cell."""
    values = _quick(chunk, form)
    if values is not None:
        return values, 0
    if len(chunk) <= _FEW:
        return _careful(chunk, form)
    middle = len(chunk) // 2
    (first, some), (last, more) = _numbers(chunk[:middle], form), _numbers(chunk[middle:], form)
    return np.concatenate((first, last)), some + more


def _quick(chunk: Sequence[tuple[int, str]], form: Layout) -> NDArray[np.float64] | None:
    """The numbers of lines that hold nothing else, or None."""
    rows: Iterator[str] = (line for _, line in chunk)
    if form.decimal_comma:
        if any("." in line for _, line in chunk):
            return None
        rows = (line.replace(",", ".") for line in rows)
    if form.trailing and form.delimiter:
        mark = form.delimiter
        rows = (line.rstrip(" ").removesuffix(mark) for line in rows)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # With max_rows NumPy would begin with room for all of them.
            values = np.loadtxt(rows, delimiter=form.delimiter, ndmin=2, comments=None)
    except ValueError:
        return None
    return values if values.shape == (len(chunk), form.columns) else None


def _careful(chunk: Sequence[tuple[int, str]], form: Layout) -> tuple[NDArray[np.float64], int]:
    """The same cell by cell, and how many cells hold no number."""
    values = np.empty((len(chunk), form.columns))
    words = 0
    for row, (place, line) in enumerate(chunk):
        cells = split(line, form.delimiter)
        if len(cells) == form.columns + 1 and not cells[-1].strip():
            cells.pop()
        if len(cells) != form.columns:
            raise SurfaceError(
                f"line {place} holds {len(cells)} cells and the first row {form.columns}: "
                "this is not a table of numbers with equally many in every line"
            )
        for column, cell in enumerate(cells):
            try:
                values[row, column] = value = number(cell, form.decimal_comma)
            except ValueError:
                raise SurfaceError(
                    f"line {place} holds {short(cell.strip())}, which is neither a number nor a word for a "
                    "missing one: this is not a table of numbers"
                ) from None
            words += math.isnan(value)
    return values, words
