"""How small a p-value has to be, where several tests are made at once."""

from __future__ import annotations

import math

__all__ = ["sidak"]


def sidak(significance: float, tests: int) -> float:
    """Threshold for each of `tests` independent tests, so that all pass with probability 1 - significance.

    Examples
    --------
    >>> from microfacet.testing import sidak
    >>> sidak(0.01, 1)
    0.01
    >>> print(f"{sidak(0.01, 1000):.4g}")
    1.005e-05
    """
    if not 0.0 < significance < 1.0:
        raise ValueError(f"significance must lie in (0, 1), got {significance:g}")
    if tests < 1:
        raise ValueError(f"tests must be at least 1, got {tests}")
    if tests == 1:
        return significance  # without the rounding of what follows
    return -math.expm1(math.log1p(-significance) / tests)
