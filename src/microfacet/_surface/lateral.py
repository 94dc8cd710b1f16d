"""Spectrum and autocorrelation of a map together, where both are wanted."""

from __future__ import annotations

from microfacet._surface.checks import SMALLEST_TRANSFORMED
from microfacet._surface.correlation import Autocorrelation, correlated
from microfacet._surface.height_map import HeightMap
from microfacet._surface.spectral import Spectrum, spectrum

__all__ = ["lateral"]


def lateral(surface: HeightMap) -> tuple[Spectrum, Autocorrelation] | None:
    """Both by default settings, for half a spectrum less; None of a map that is too small for them."""
    if min(surface.heights.shape) < SMALLEST_TRANSFORMED:
        return None
    found = spectrum(surface)
    return found, correlated(surface, found.Std)
