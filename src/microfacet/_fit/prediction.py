"""What the fitted surfaces would do: masking at given angles, for every family side by side."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from microfacet._fit.result import FitResult, one_a_family

__all__ = ["ANGLES", "Prediction", "predict"]

#: Angles from the macronormal, degrees.
ANGLES = (30.0, 60.0, 75.0, 85.0)


@dataclass(frozen=True)
class Prediction:
    """Smith's Lambda and G1 of each family (in the order of the results) for one direction. Of a family's two
    symmetries it is the one that ranks first.

    Attributes
    ----------
    theta, azimuth : float
        Degrees, from the macronormal and from +x counter-clockwise.
    Lambda, G1 : dict of str to float
        By family.
    """

    theta: float
    azimuth: float
    Lambda: dict[str, float]
    G1: dict[str, float]


def predict(results: Sequence[FitResult], angles: Iterable[float] = ANGLES) -> list[Prediction]:
    """Lambda and G1 of every fitted family, for light along both axes of the first one.

    Parameters
    ----------
    results : sequence of FitResult
        What `fit` returned.
    angles : iterable of float
        From the macronormal, degrees, in [0, 90).

    Returns
    -------
    list of Prediction

    Examples
    --------
    >>> import microfacet as mf
    >>> results = mf.fit(mf.sample_terrain(), ["student_t", "beckmann"], lag=8)
    >>> grazing = predict(results, [85.0])[0]
    >>> sorted(grazing.G1) == ["beckmann", "student_t"]
    True
    """
    chosen = [float(angle) for angle in angles]
    if not all(0 <= angle < 90 for angle in chosen):
        raise ValueError(
            f"angles must lie in [0, 90) degrees, got {', '.join(f'{angle:g}' for angle in chosen)}"
        )
    first = results[0].params.get("rotation", 0.0)
    shown, found = one_a_family(results), []
    for azimuth in (first, first + math.pi / 2):
        for angle in chosen:
            theta = math.radians(angle)
            w = np.array(
                [math.sin(theta) * math.cos(azimuth), math.sin(theta) * math.sin(azimuth), math.cos(theta)]
            )
            found.append(
                Prediction(
                    angle,
                    math.degrees(azimuth),
                    {result.family: float(result.ndf.Lambda(w)) for result in shown},
                    {result.family: float(result.ndf.G1(w)) for result in shown},
                )
            )
    return found
