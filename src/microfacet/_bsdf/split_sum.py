"""The albedo with Schlick's reflectance F0 + (1 - F0) (1 - cos)^5: a part that F0 scales, and another."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet._bsdf.conductor import Conductor

__all__ = ["SchlickParts"]

Array = NDArray[Any]


class SchlickParts(Conductor):
    """A white metal whose light has two channels: 1 - (1 - wi . m)^5 of it, and (1 - wi . m)^5.

    The light of a metal of reflectance F0 is F0 times the first and the second.
    """

    __slots__ = ()

    @property
    def _channels(self) -> tuple[int, ...]:
        return (2,)

    def _of(
        self, operation: str, values: list[Array], wide: list[Array], cost: float = 1.0, white: bool = False
    ) -> Any:
        """Of `facets` alone, whose values are wi and m."""
        cosine = sum(i * m for i, m in zip(values[:3], values[3:6], strict=True))
        grazing = np.clip(1 - cosine, 0, 1) ** 5
        parts = np.stack((1 - grazing, grazing), -1)
        return [light[..., np.newaxis] * parts for light in super()._of(operation, values, wide, cost, white)]
