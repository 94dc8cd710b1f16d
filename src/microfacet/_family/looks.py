"""How families are drawn and parameters written: nothing of it is stated family by family."""

from __future__ import annotations

import unicodedata
from typing import Any

__all__ = ["PALETTE", "letter", "look", "symbol"]

#: Colours and dashes of curves, in the order of the families. Each reads on white and on near-black, and the
#: dashes tell curves apart without colour.
PALETTE: tuple[tuple[str, Any], ...] = (
    ("#3d7fc9", (0, (6, 2))),
    ("#d9662b", "-"),
    ("#9166c2", (0, (6, 1.5, 1.2, 1.5))),
    ("#2c9a76", (0, (3, 1.2))),
    ("#d6496f", (0, (1.4, 1.2))),
    ("#a88514", (0, (4, 1.2, 1.2, 1.2, 1.2, 1.2))),
    ("#1f93ab", (0, (10, 2))),
    ("#9c6b4f", (0, (6, 1.2, 3, 1.2))),
    ("#b94fb3", (0, (1.2, 2.4))),
    ("#6b9a2a", (0, (10, 1.5, 1.2, 1.5))),
    ("#5f6fd6", (0, (8, 1.2, 1.2, 1.2, 1.2, 1.2, 1.2, 1.2))),
    ("#7d8590", (0, (2, 2))),
)


def look(number: int) -> tuple[str, Any]:
    """The colour and the dashes of one of many curves: pairs differ from each other for 144 of them.

    >>> look(1), look(13)
    (('#d9662b', '-'), ('#d9662b', (0, (6, 1.5, 1.2, 1.5))))
    """
    size = len(PALETTE)
    return PALETTE[number % size][0], PALETTE[(number + number // size) % size][1]


def letter(name: str) -> str:
    """A parameter as formulas write it: the Greek letter of that name, or the name itself."""
    try:
        return unicodedata.lookup(f"GREEK SMALL LETTER {name}")
    except KeyError:
        return name


def symbol(name: str) -> str:
    r"""A parameter as mathtext.

    >>> symbol("alpha_x"), symbol("a"), symbol("weight")
    ('\\alpha_x', 'a', '\\mathrm{weight}')
    """
    if name == "rotation":
        return r"\rho"
    stem, _, axis = name.partition("_")
    text = stem if len(stem) == 1 else rf"\{stem}" if letter(stem) != stem else rf"\mathrm{{{stem}}}"
    return f"{text}_{axis}" if axis else text
