"""Results as JSON takes them: there is no infinity and no nan in JSON, so they become null."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

__all__ = ["families", "finite", "fit"]

_FIT = (
    "family", "params", "standard_errors", "log_likelihood", "log_likelihood_per_sample", "held_out",
    "held_out_error", "tied", "aic", "bic", "converged",
)  # fmt: skip


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


def fit(fitted: Any) -> dict[str, Any]:
    """One file: what was done to it, the ranked families, and what follows from them."""
    first = fitted.results[0]
    record = {
        "source": fitted.source,
        "steps": list(fitted.steps),
        "lag": first.lag,
        "lag_length": first.lag * fitted.pixel if first.lag and fitted.pixel else None,
        "n": first.n,
        "n_effective": first.n_effective,
        "mean_slope": first.mean_slope,
        "mean_slope_errors": first.mean_slope_errors,
        "ranking": [_ranked(result) for result in fitted.results],
        "prediction": [asdict(prediction) for prediction in fitted.predictions],
        "roughness": fitted.roughness._asdict() if fitted.roughness else None,
        "scales": _scales(fitted.scales) if fitted.scales else None,
        "notes": fitted.notes,
    }
    return dict(finite(record))


def _ranked(result: Any) -> dict[str, Any]:
    record = {name: getattr(result, name) for name in _FIT}
    return record | {"goodness": asdict(result.goodness), "notes": list(result.notes)}


def _scales(scales: Any) -> dict[str, Any]:
    """Against the lag, for every family; the details of each fit are those of a fit at that lag."""
    families = sorted(result.family for result in scales.results[0])
    by_lag = [{result.family: result for result in results} for results in scales.results]
    return {
        "lags": scales.lags,
        "lengths": scales.lengths,
        "best": [results[0].family for results in scales.results],
        "typical_slopes": scales.typical_slopes,
        "exponents": scales.exponents,
        "noise_lags": scales.noise_lags,
        "params": {name: [fits[name].params for fits in by_lag] for name in families},
        "standard_errors": {name: [fits[name].standard_errors for fits in by_lag] for name in families},
    }


def finite(value: Any) -> Any:
    """The same value with None for every number that JSON cannot express."""
    if isinstance(value, dict):
        return {name: finite(entry) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
