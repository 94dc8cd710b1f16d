"""What every command prints: sentences on stderr, tables, records as JSON takes them, a line of progress."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microfacet._files import is_stdout
from microfacet._optional import needed
from microfacet._text import printable

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["announce", "console", "finite", "progress_line", "say", "show", "value", "where"]

LONGEST_CELL = 1000


def say(message: str) -> None:
    """One sentence on stderr, whatever of files and arguments it quotes; without a stderr, none."""
    with suppress(OSError):
        click.echo("microfacet: " + printable(" ".join(message.split()), 1000), err=True)


def where(path: str | Path) -> str:
    """The file that a command has written, as all of them print it: an absolute path."""
    return str(Path(path).absolute())


def announce(line: str, *written: str | Path) -> None:
    """Print what a command says of the files it has written; on stderr, where one of them is stdout."""
    click.echo(line, err=any(map(is_stdout, written)))


def finite(value: Any) -> Any:
    """The same value with None for every number that JSON cannot express."""
    if isinstance(value, dict):
        return {name: finite(entry) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def console() -> Console:
    """Standard output: as wide as the terminal, or wide enough for the tables where it is none."""
    with needed("tables need"):
        from rich.console import Console
    return Console(width=None if sys.stdout.isatty() else 160)


def show(out: Console, headings: Sequence[str], rows: Sequence[Sequence[str]], left: int) -> None:
    """A table on a terminal; elsewhere tab-separated lines, which tools read. `left` columns are text."""
    if not out.is_terminal:
        for line in (headings, *rows):
            cells = (printable(cell, LONGEST_CELL) for cell in line)
            out.file.write("\t".join(cells) + "\n")  # rich would expand the tabs
        return
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for i, heading in enumerate(headings):
        table.add_column(heading, justify="left" if i < left else "right", overflow="fold")
    for row in rows:
        table.add_row(*(Text(printable(cell, LONGEST_CELL)) for cell in row))  # names of files are no markup
    out.print(table)


@contextmanager
def progress_line() -> Iterator[Callable[[str, int, int], None]]:
    """A line on stderr that says what is going on, where stderr is a terminal."""
    if not sys.stderr.isatty():
        yield lambda *_: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.description}", markup=False),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=None)
        yield lambda what, done, total: bar.update(
            task, description=printable(what), completed=done, total=total or None
        )


def value(number: float, error: float) -> str:
    """A number with its error, to two digits of the error: 0.1065(47) as 0.1065+-0.0047."""
    if not (math.isfinite(error) and error > 0):
        return f"{number:.4g}"
    digits = max(1 - math.floor(math.log10(error)), 0)
    if digits > 6 and abs(number) < 1e-3:  # as lengths in metres are
        power = math.floor(math.log10(max(abs(number), error)))
        scaled, digits = number / 10.0**power, max(1 - math.floor(math.log10(error / 10.0**power)), 0)
        return f"{scaled:.{digits}f}+-{error / 10.0**power:.{digits}f}e{power}"
    return f"{number:.{digits}f}+-{error:.{digits}f}" if digits < 12 else f"{number:.6g}"
