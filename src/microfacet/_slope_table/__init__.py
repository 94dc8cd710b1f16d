"""Densities on a grid of slopes, isotropic or not, with any mean slope."""

from microfacet._slope_table.table import SlopeTable

__all__ = ["SlopeTable"]
