"""Results as JSON takes them: there is no infinity and no nan in JSON, so they become null."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any

__all__ = ["families", "finite", "fits"]

_FIT = ("family", "params", "log_likelihood", "n", "aic", "bic", "mean_slope", "lag", "converged", "notes")


def families(entries: Iterable[Any]) -> list[dict[str, Any]]:
    """One object per family; null is an end of an interval that is open to infinity."""
    return [
        {
            "name": family.name,
            "title": family.title,
            "parameters": [finite(asdict(parameter)) for parameter in family.parameters],
            "anisotropic": family.anisotropic,
            "sources": list(family.sources),
        }
        for family in entries
    ]


def fits(surface: Any, results: Sequence[Any]) -> dict[str, Any]:
    """The surface, what was done to it, and the fitted families, best first."""
    rows = [{name: getattr(result, name) for name in _FIT} for result in results]
    return {"source": surface.source, "steps": list(surface.steps), "fits": [finite(row) for row in rows]}


def finite(value: Any) -> Any:
    """The same value with None for every number that JSON cannot express."""
    if isinstance(value, dict):
        return {name: finite(entry) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
