"""Of a large map a fit takes so many slopes, drawn before they are computed: memory follows what is used."""

from __future__ import annotations

import tracemalloc
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from microfacet._fit import blocks
from microfacet._fit.draw import SEED, draw


def with_holes(shape: tuple[int, int], missing: float) -> mf.Surface:
    rng = np.random.default_rng(5)
    heights = 1e-7 * rng.normal(size=shape).cumsum(axis=0).cumsum(axis=1)
    return mf.Surface(heights, (2e-6, 3e-6), mask=rng.random(shape) >= missing)


@pytest.mark.parametrize("lag", [1, 3])
@pytest.mark.parametrize("missing", [0.0, 0.2])
@pytest.mark.parametrize("most", [20, 2000])
def test_drawn_slopes_are_some_of_the_slopes_of_the_map(lag: int, missing: float, most: int) -> None:
    surface = with_holes((90, 70), missing)
    every = surface.slopes(lag)
    drawn = draw(surface, lag, most)
    if len(every) <= most:
        np.testing.assert_array_equal(drawn.slopes, every)
        assert drawn.notes == ()
        return
    chosen = np.random.default_rng(SEED).choice(len(every), most, replace=False, shuffle=False)
    chosen.sort()
    np.testing.assert_allclose(drawn.slopes, every[chosen], rtol=1e-14)
    np.testing.assert_array_equal(drawn.cells, blocks.cells_of_map(surface.mask, lag)[chosen])
    assert drawn.notes == (f"fitted to {most} of {len(every)} slopes, drawn at random with seed 0",)


def test_a_draw_of_all_slopes_is_the_fit_without_a_draw() -> None:
    surface = with_holes((60, 80), 0.1)
    count = len(surface.slopes())
    assert mf.fit(surface, "beckmann", max_slopes=count)[0] == mf.fit(surface, "beckmann", max_slopes=None)[0]


def test_a_map_that_is_too_small_for_the_lag_says_so() -> None:
    with pytest.raises(mf.SurfaceError, match="too small for slopes at lag 30"):
        mf.fit(with_holes((60, 60), 0.0), "beckmann", lag=30, max_slopes=20)
    with pytest.raises(mf.SurfaceError, match="lag must be a whole number"):
        mf.fit(with_holes((60, 60), 0.0), "beckmann", lag=1.5, max_slopes=20)  # type: ignore[arg-type]


def test_a_large_map_takes_memory_for_the_slopes_that_are_used() -> None:
    """All slopes of a map take five times the memory of its heights, before anything is fitted to them."""
    surface = with_holes((1500, 1500), 0.05)
    tracemalloc.start()
    found: list[Any] = mf.fit(surface, "beckmann", max_slopes=2000)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert found[0].n == 2000
    assert peak < surface.heights.nbytes
