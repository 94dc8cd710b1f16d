"""Whether anything fits, in one sentence."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from microfacet._fit.balance import Balance
from microfacet._fit.result import FitResult
from microfacet._value import Value

__all__ = ["Verdict", "verdict"]

#: Probability of slopes this far from the fit, below which a family does not describe them.
SIGNIFICANCE = 0.01
#: Largest difference in the share of slopes that hardly matters in practice.
CLOSE = 0.02


@dataclass(frozen=True, eq=False)
class Verdict(Value):
    """What a fit says of the slopes.

    Attributes
    ----------
    fits : bool
        Whether a family describes the slopes: the first one, or one that is tied with it, has a `p_value` of
        at least 0.01.
    family : str
        The family that is spoken of: the first that describes the slopes, otherwise the first of all.
    p_value : float
        The probability of slopes this far from the fit if the family were right: the smaller one of
        `Goodness.p_value` and that of slopes less balanced than these (every family has a slope and its
        opposite equally often), doubled, because there are two.
    deviation : float
        Largest difference between the measured and the fitted share of slopes: `Goodness.deviation`, or
        that between a half turn of azimuths and one half.
    sentence : str
        The same in words.
    """

    fits: bool
    family: str
    p_value: float
    deviation: float
    sentence: str


def verdict(results: Sequence[FitResult], sides: Balance) -> Verdict:
    """Of ranked results and of the balance of the slopes that they share."""
    tied = [result for result in results if result.tied] or list(results[:1])
    p_values = [_both(result.goodness.p_value, sides.p_value) for result in tied]
    good = [result for result, p in zip(tied, p_values, strict=True) if p >= SIGNIFICANCE]
    chosen = good[0] if good else results[0]
    p_value = _both(chosen.goodness.p_value, sides.p_value)
    deviation = max(chosen.goodness.deviation, sides.deviation)
    lopsided = not good and chosen.goodness.p_value >= SIGNIFICANCE / 2
    how = (
        f"{probability(p_value)} for {chosen.n_effective:.0f} independent slopes; measured and fitted shares "
        f"of slopes differ by up to {percent(deviation)}"
    )
    if good:
        instead = "" if chosen is results[0] else f", which is tied with {results[0].family},"
        said = f"{chosen.family}{instead} describes these slopes ({how})"
    elif math.isnan(p_value):
        said = f"whether {chosen.family} describes these slopes cannot be said: its likelihood is flat"
    else:
        said = _no_family(chosen.family, deviation <= CLOSE, lopsided, how)
    return Verdict(bool(good), chosen.family, p_value, deviation, said)


def _no_family(nearest: str, close: bool, lopsided: bool, how: str) -> str:
    why = (
        "slopes and their opposites are not equally frequent, as every family has them"
        if lopsided
        else f"{nearest} is only the nearest"
    )
    if close:
        why = f"yet {nearest} is close enough for most purposes" + (f" ({why})" if lopsided else "")
        return f"no family describes these slopes to within their errors, {why} ({how})"
    return f"no family describes these slopes: {why} ({how})"


def _both(first: float, second: float) -> float:
    """Of two tests; one that says nothing is left out."""
    known = [one for one in (first, second) if not math.isnan(one)]
    return min(len(known) * min(known), 1.0) if known and not math.isnan(first) else math.nan


def probability(p_value: float) -> str:
    """p = 0.43, or p < 1e-6 where more digits say nothing."""
    if math.isnan(p_value):
        return "p unknown"
    return f"p = {p_value:.2g}" if p_value >= 1e-6 else "p < 1e-6"


def percent(share: float) -> str:
    """A share in per cent, to two digits."""
    return f"{100 * share:.2g} %" if share < 0.995 else "100 %"
