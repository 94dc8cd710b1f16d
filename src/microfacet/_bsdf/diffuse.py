"""Rough diffuse surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from microfacet._arrays import lifted
from microfacet._bsdf.arguments import Array, directions_of, lit, number
from microfacet._bsdf.material import Material
from microfacet._frozen import Distribution

__all__ = ["Diffuse"]


class Diffuse(Material):
    r"""A surface whose facets scatter by Lambert's law, of one order or of all.

    .. math:: f\,|\cos\theta_o| = \frac{\rho}{\pi} \int D_{\omega_i}(m)\, \langle\omega_o, m\rangle\,
              \frac{G_2(\omega_i, \omega_o)}{G_1(\omega_i)}\, dm

    has no closed form, so that its evaluation is a Monte Carlo estimate for both: each walk brings a facet.

    Parameters
    ----------
    ndf : distribution
        Of any family.
    albedo : array_like
        What a facet scatters of the light on it, rho in [0, 1]; an array for several wavelengths.
    scattering : {"single", "multiple"}
        One order, or all of them.

    Raises
    ------
    ValueError
        If an argument lies outside its domain; the message names it.

    Notes
    -----
    Directions may have any length but 0: methods normalise them, unless their length is 1 up to rounding.
    Results are nan for directions of length 0 and for those that are not finite.

    References
    ----------
    E. Heitz and J. Dupuy, Implementing a simple anisotropic rough diffuse material with stochastic
    evaluation, 2015; E. Heitz et al., Multiple-scattering microfacet BSDFs with the Smith model, SIGGRAPH
    2016.

    Examples
    --------
    >>> import microfacet as mf
    >>> clay = mf.Diffuse(mf.Beckmann(alpha=0.6), 0.8, scattering="multiple")
    >>> value = clay.eval([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], n=100_000, rng=1)
    >>> print(f"{value:.3f}")
    0.249
    """

    __slots__ = ()
    _name = "diffuse"
    _closed = False

    def __init__(self, ndf: Distribution, albedo: ArrayLike, *, scattering: str = "multiple") -> None:
        rho = number("Diffuse", "albedo", albedo, "in [0, 1]", lambda x: (x >= 0) & (x <= 1))
        self._freeze(ndf, scattering, (rho,))

    @property
    def albedo_of_facets(self) -> Any:
        """What a facet scatters of the light on it."""
        return self._constants[0][()]

    def __repr__(self) -> str:
        return f"Diffuse({self.ndf!r}, {self.albedo_of_facets!r}, scattering={self.scattering!r})"

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Any:
        """Density per steradian of a proposal for `wo`: that of a diffuse surface, cos/pi."""
        return lifted(self._pdf, *directions_of(self, "pdf", wi=wi, wo=wo))

    def _pdf(self, wi: Array, wo: Array) -> Any:
        i, o = self._cosines(wi, wo)
        return lit(i, o)[()] * i.dtype.type(1 / np.pi)

    def sample(self, wi: ArrayLike, xi: ArrayLike | None = None, *, rng: Any = None) -> tuple[Any, Any, Any]:
        """Directions drawn by walks from `wi`, their weights, and the densities that `pdf` gives.

        With single scattering, light that meets a second facet has weight 0.
        """
        if xi is not None:
            raise ValueError("Diffuse.sample: a walk takes rng, not xi")
        return self._drawn(wi, None, rng)
