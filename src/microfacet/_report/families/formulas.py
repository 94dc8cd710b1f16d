"""The formulas of `formulas.toml`: LaTeX for display, nothing that is evaluated."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

__all__ = ["FamilyText", "Formula", "Formulas", "load"]


@dataclass(frozen=True)
class Formula:
    """One line of a list of formulas: what it is, its LaTeX (a display each), a remark."""

    name: str
    latex: tuple[str, ...]
    remark: str = ""


@dataclass(frozen=True)
class FamilyText:
    """What a section says of its family before the numbers."""

    summary: str
    formulas: tuple[Formula, ...]


@dataclass(frozen=True)
class Formulas:
    """All of them: those common to the families, and each family's own by name."""

    common: tuple[Formula, ...]
    families: dict[str, FamilyText]


@cache
def load() -> Formulas:
    """Read the file that ships with the package."""
    data = tomllib.loads(files("microfacet._report").joinpath("formulas.toml").read_text("utf-8"))
    families = {
        name: FamilyText(text["summary"], _entries(text["formulas"]))
        for name, text in data["families"].items()
    }
    return Formulas(_entries(data["common"]), families)


def _entries(rows: list[dict[str, Any]]) -> tuple[Formula, ...]:
    return tuple(Formula(row["name"], tuple(row["latex"]), row.get("remark", "")) for row in rows)
