"""Numbers that look like marks of missing data which the file does not declare."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["suspicious_mark"]

# A mark lies this many ranges of the other heights away from them, and more than one pixel holds it, or it
# is one that many programs write.
_FAR = 3.0
_USUAL = (-9999.0, -99999.0, -999.0, -32768.0, -32767.0, 32767.0, 65535.0, 9999.0, 99999.0, 1e20, -1e20)


def suspicious_mark(heights: NDArray[np.float64], mask: NDArray[np.bool_]) -> tuple[str, ...]:
    """A warning where several pixels hold one number that is far from all others, as -9999 is."""
    lowest = float(np.min(heights, where=mask, initial=np.inf))
    highest = float(np.max(heights, where=mask, initial=-np.inf))
    warnings = []
    for extreme in (lowest, highest):
        rest = mask & (heights != extreme)
        count = int(np.count_nonzero(mask) - np.count_nonzero(rest))
        if not rest.any() or (count < 2 and extreme not in _USUAL):
            continue
        low = float(np.min(heights, where=rest, initial=np.inf))
        high = float(np.max(heights, where=rest, initial=-np.inf))
        gap = low - extreme if extreme == lowest else extreme - high
        if high > low and gap > _FAR * (high - low):
            pixels = "1 pixel holds" if count == 1 else f"{count} pixels hold"
            warnings.append(
                f"{pixels} {extreme:g}, far from all other heights: if that marks missing data, mask it"
            )
    return tuple(warnings)
