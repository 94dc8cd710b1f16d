"""What `fit` returns: results, best first, with a verdict and warnings."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from microfacet._fit.halves import Halves
from microfacet._fit.result import FitResult
from microfacet._fit.verdict import Verdict

__all__ = ["FitResults"]


class FitResults(list[FitResult]):
    """A list of `FitResult`, best first.

    Attributes
    ----------
    verdict : Verdict
        Whether anything fits: `fits`, `p_value`, and a `sentence`.
    warnings : tuple of str
        What speaks against the numbers, one sentence with figures each: missing data that is not random,
        halves of the map that disagree, units that cannot be right, quantised heights, slopes beyond the
        range of the instrument.
    halves : Halves or None
        How the halves of a map differ under the first family, and how much its regions do; None for slopes
        without positions, and for maps of few slopes.
    """

    def __init__(
        self,
        results: Iterable[FitResult],
        verdict: Verdict,
        warnings: tuple[str, ...] = (),
        halves: Halves | None = None,
    ) -> None:
        super().__init__(results)
        self.verdict, self.warnings, self.halves = verdict, warnings, halves

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (list(self), self.verdict, self.warnings, self.halves)
