"""Maps whose spectrum or heights are known, for tests of what describes them."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import special

import microfacet as mf

DATA = Path(__file__).parents[2] / "shared" / "data"
MAPS = ("SkiInfiniteFocus.x3p", "di-3.di", "di-4.di")

Map = NDArray[np.float64]


def measured(name: str) -> mf.Surface:
    """A measured map, levelled; missing pixels have the mean height, which other libraries need."""
    return _measured(name, DATA)


@cache
def _measured(name: str, folder: Path) -> mf.Surface:
    if not (folder / name).exists():
        pytest.skip(f"{name} is not among the measured maps of this machine")
    if name.endswith(".di"):
        pytest.importorskip("SurfaceTopography")
    surface = mf.read_surface(folder / name).level()
    heights = np.where(surface.mask, surface.heights, np.mean(surface.heights, where=surface.mask))
    return mf.Surface(heights, surface.pixel_size).level()


def by_surfalize(heights: Map, dx: float, dy: float) -> Any:
    """The surface of that library, where it is installed."""
    return pytest.importorskip("surfalize").Surface(heights, dx, dy)


#: What that library says of every map whose pixels are not quite square.
NOT_SQUARE = "ignore:The surface has different pixel size in x and y:UserWarning"


def with_spectrum(
    density: Any, shape: tuple[int, int], pixel_size: tuple[float, float] = (1e-6, 1e-6), seed: int = 0
) -> Map:
    """A periodic Gaussian map with the two-sided density of (fx, fy) in m^4."""
    ny, nx = shape
    dx, dy = pixel_size
    fx, fy = np.fft.rfftfreq(nx, dx), np.fft.fftfreq(ny, dy)[:, np.newaxis]
    noise = np.fft.rfft2(np.random.default_rng(seed).standard_normal(shape))
    return np.asarray(np.fft.irfft2(noise * np.sqrt(density(fx, fy) / (dx * dy)), s=shape))


def normal_heights(count: int = 200, seed: int = 1) -> Map:
    """Heights whose quantiles are exactly those of the standard normal distribution, in random order."""
    quantiles = special.ndtri((np.arange(count * count) + 0.5) / (count * count))
    return np.random.default_rng(seed).permutation(quantiles).reshape(count, count)
