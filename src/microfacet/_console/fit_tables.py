"""Fits as tables for a terminal, or as tab-separated text."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from microfacet._console.fits import Failure, Fitted
from microfacet._console.tables import show

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["files", "prediction", "ranking", "roughness", "scales", "value"]


def ranking(out: Console, results: Sequence[Any]) -> None:
    """Fitted families, best first; likelihoods and criteria relative to the first."""
    best = results[0]
    rows = [
        [
            str(rank),
            fit.family
            + ("" if rank > 1 or len(results) == 1 or not results[1].tied else " (tied)")
            + (" (tied)" if rank > 1 and fit.tied else ""),
            _parameters(fit),
            f"{fit.held_out - best.held_out:.5f}",
            f"{fit.held_out_error:.5f}",
            f"{fit.aic - best.aic:.1f}",
            f"{fit.bic - best.bic:.1f}",
            f"{fit.goodness.anderson_darling:.2f}",
        ]
        for rank, fit in enumerate(results, start=1)
    ]
    headings = ["rank", "family", "parameters", "held out", "+-", "dAIC", "dBIC", "A2"]
    show(out, headings, rows, left=3)


def prediction(out: Console, predictions: Sequence[Any]) -> None:
    """G1 of every family, one row per direction."""
    names = list(predictions[0].G1)
    rows = [
        [f"{row.theta:g}", f"{row.azimuth:.0f}", *(f"{row.G1[name]:.4f}" for name in names)]
        for row in predictions
    ]
    show(out, ["theta", "azimuth", *(f"G1 {name}" for name in names)], rows, left=0)


def scales(out: Console, found: Any) -> None:
    """The first family at every lag."""
    rows = []
    for k, (lag, length, results) in enumerate(zip(found.lags, found.lengths, found.results, strict=True)):
        exponent = f"{found.exponents[k]:.2f}" if k < len(found.exponents) else ""
        noise = "noise" if lag in found.noise_lags else ""
        rows.append([str(lag), f"{length:.4g}", results[0].family, _parameters(results[0]), exponent, noise])
    show(out, ["lag", "metres", "family", "parameters", "exponent", ""], rows, left=0)


def roughness(out: Console, values: Any) -> None:
    """ISO 25178-2: lengths in metres."""
    show(out, list(values._fields), [[f"{number:.4g}" for number in values]], left=0)


def files(out: Console, names: Sequence[str], outcomes: Sequence[Fitted | Failure]) -> None:
    """One row per file: the first family, and how far behind the second is."""
    rows = []
    for name, outcome in zip(names, outcomes, strict=True):
        if isinstance(outcome, Failure):
            rows.append([name, "-", "-", "-", "-", outcome.error, "-", "-", ""])
            continue
        first, *others = outcome.results
        second = others[0] if others else first
        noise = "noise" if outcome.scales and first.lag in outcome.scales.noise_lags else ""
        rows.append(
            [
                name,
                str(first.lag or "-"),
                str(first.n),
                f"{first.n_effective:.0f}",
                first.family,
                _parameters(first),
                second.family if others else "-",
                f"{second.held_out - first.held_out:.5f}" if others else "-",
                noise,
            ]
        )
    headings = ["file", "lag", "n", "effective", "family", "parameters", "second", "held out", ""]
    show(out, headings, rows, left=1)


def value(number: float, error: float) -> str:
    """A number with its error, to two digits of the error: 0.1065(47) as 0.1065+-0.0047."""
    if not (math.isfinite(error) and error > 0):
        return f"{number:.4g}"
    digits = max(1 - math.floor(math.log10(error)), 0)
    return f"{number:.{digits}f}+-{error:.{digits}f}" if digits < 12 else f"{number:.6g}"


def _parameters(fit: Any) -> str:
    pairs = fit.params.items()
    return ", ".join(
        f"{name} {value(number, fit.standard_errors.get(name, math.nan))}" for name, number in pairs
    )
