"""At the ends of what constructors accept all is computed in bounded time, or one sentence says why not."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import microfacet as mf

ALPHAS = (1e-160, 1e-97, 1e-31, 1e-8, 0.3, 1e7, 1e29, 1e97, 1e160)
SHAPES: dict[str, tuple[str, tuple[float, ...]]] = {
    "BesselK": ("a", (1e-97, 1e-9, 2e-3, 0.0301, 0.4999, 0.5003, 0.7, 399.5, 1e5, 1e13, 1e95)),
    "GTR": ("gamma", (1e-97, 1e-7, 0.3, 1.0, 1.0000001, 2.0, 13.0, 180.0)),
    "StudentT": ("gamma", (1.5 + 1e-12, 1.5001, 2.0, 3.0, 70.0, 1e6, 1e17, 1e60)),
}
SECONDS = 10.0  # of processor time; the slowest takes half of one


for _family in mf.families():
    for _own in _family.parameters[1:]:  # families that are not named above
        _ends = (_own.lower + 1e-7, min(_own.upper - 1e-7, 1e5))
        SHAPES.setdefault(_family.cls.__name__, (_own.name, (_ends[0], *_own.examples, _ends[1])))


def points() -> Iterator[tuple[str, dict[str, float]]]:
    for name, (shape, values) in SHAPES.items():
        for alpha, value in itertools.product(ALPHAS, values):
            yield name, {"alpha": alpha, shape: value}


def faults_of(ndf: Any, w: NDArray[np.float64], xi: NDArray[np.float64]) -> list[str]:
    seen = ndf.sigma(w) > 1e-270
    results = {
        "D": ndf.D(np.abs(w)),
        "sigma": ndf.sigma(w),
        "G1": ndf.G1(w),
        "sample": ndf.sample(xi[:, :2]),
        "continuous": ndf.sample_visible(w[seen][:, None], xi),
        "mixture": ndf.sample_visible(w[seen][:, None], xi, scheme="mixture"),
        "float32": ndf.sample_visible(np.float32(w[seen][:2, None]), np.float32(xi[1:])),
    }
    return [name for name, values in results.items() if np.isnan(values).any()]


@pytest.mark.parametrize("part", range(6))
def test_numbers_or_a_sentence_in_time(part: int) -> None:
    theta = np.radians([0.0, 45.0, 89.99, 90.06, 100.0])
    w = np.stack([np.sin(theta), np.zeros_like(theta), np.cos(theta)], axis=-1)
    xi = np.array([[1 - 2.0**-53, 0.2, 0.9, 0.3], [0.3, 0.5, 0.1, 0.4], [1e-9, 0.7, 0.0, 0.6]])
    sentences = []
    for name, parameters in list(points())[part::6]:
        start = time.process_time()
        try:
            ndf = getattr(mf, name)(**parameters)
        except ValueError as error:
            sentences.append(str(error))
            continue
        faults = faults_of(ndf, w, xi)
        assert time.process_time() - start < SECONDS, ndf
        assert not faults or not 1e-100 <= parameters["alpha"] <= 1e100, f"{ndf!r}: nan from {faults}"
    assert all("must lie in" in sentence and "\n" not in sentence for sentence in sentences)


def test_the_grid_is_wide() -> None:
    assert len(list(points())) >= 168
