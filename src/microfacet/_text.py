"""Text of others (files, arguments) as part of our own: one line, of sensible length, without effects."""

from __future__ import annotations

from collections.abc import Iterable

__all__ = ["listed", "printable"]


def printable(text: object, most: int = 60) -> str:
    """`text` on one line of at most so many characters, with what is not printable escaped as in Python.

    A terminal obeys control characters, and some of Unicode's turn the reading direction.
    """
    start = str(text)[: most + 1]
    line = "".join(
        character if character.isprintable() else character.encode("unicode_escape").decode("ascii")
        for character in start
    )
    return line if len(line) <= most else line[: most - 3] + "..."


def listed(names: Iterable[object], most: int = 8) -> str:
    """The first few names, separated by commas."""
    shown = [printable(name, 24) for name, _ in zip(names, range(most + 1), strict=False)]
    return ", ".join(shown[:most]) + (", ..." if len(shown) > most else "")
