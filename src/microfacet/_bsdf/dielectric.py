"""Rough transparent surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from microfacet._arrays import lifted
from microfacet._bsdf.arguments import (
    Array,
    directions_of,
    flag,
    in_one_type,
    number,
    xyz,
)
from microfacet._bsdf.material import Material
from microfacet._frozen import Distribution

__all__ = ["Dielectric"]


class Dielectric(Material):
    r"""A transparent surface whose facets reflect and refract, seen from either side.

    Of one order, reflection is that of `Conductor`; transmission, with the facet m that refracts wi into wo:

    .. math:: f\,|\cos\theta_o| = \frac{(1 - F)\, D(m)\, G_2(\omega_i, \omega_o)\,
              |\omega_i\cdot m|\, \eta^2 |\omega_o\cdot m|}
              {|\cos\theta_i|\, (\omega_i\cdot m + \eta\, \omega_o\cdot m)^2}

    Parameters
    ----------
    ndf : distribution
        Of any family.
    eta : float
        Index of refraction below the surface over that above, in (0, inf), whatever side wi is on.
    scattering : {"single", "multiple"}
        One order, in closed form; or all of them, whose evaluation is a Monte Carlo estimate.
    mode : {"radiance", "importance"}
        What wi carries backwards: radiance, as from a camera, is scaled by the square of the relative index
        where light passes; importance is energy, of which nothing is lost.
    correlated : bool
        As for `Conductor`.

    Raises
    ------
    ValueError
        If an argument lies outside its domain; the message names it.

    Notes
    -----
    Directions may have any length but 0: methods normalise them, unless their length is 1 up to rounding.
    Results are nan for directions of length 0 and for those that are not finite.

    K0 and Bessel K with a <= 1 are infinite at the macroscopic normal: `eval` and `pdf` are inf then in the
    mirror direction, and in the direction that a flat surface refracts to. No drawn direction is one of
    these, and weights are numbers always.

    With ``eta=1`` there is no surface: samples go straight on with weight 1. That is a delta distribution, so
    `eval` and `pdf` are inf for wo = -wi exactly, and 0 elsewhere. Close to 1, a pair of directions knows its
    facet to their rounding over ``eta - 1``; `sample` returns what `pdf` says of its direction.

    References
    ----------
    B. Walter et al., Microfacet models for refraction through rough surfaces, EGSR 2007; E. Heitz et al.,
    Multiple-scattering microfacet BSDFs with the Smith model, SIGGRAPH 2016.

    Examples
    --------
    >>> import microfacet as mf
    >>> glass = mf.Dielectric(mf.K0(alpha=0.3), 1.5, mode="importance")
    >>> print(f"{glass.eval([0.6, 0.0, 0.8], [0.0, 0.0, -1.0]):.3f}")
    0.014
    >>> wo, weight, facets = glass.walk([0.6, 0.0, 0.8], rng=1)
    >>> float(weight)
    1.0
    """

    __slots__ = ("correlated", "mode")
    _name = "dielectric"
    _transmits = True
    correlated: bool
    mode: str

    def __init__(
        self,
        ndf: Distribution,
        eta: float,
        *,
        scattering: str = "single",
        mode: str = "radiance",
        correlated: bool = True,
    ) -> None:
        index = number("Dielectric", "eta", eta, "in (0, inf)", lambda x: (x > 0) & (x < np.inf))
        if index.ndim != 0:
            raise ValueError(f"Dielectric: eta must be one number, got an array of shape {index.shape}")
        if mode not in ("radiance", "importance"):
            raise ValueError(f'Dielectric: mode must be "radiance" or "importance", got {mode!r}')
        self._freeze(ndf, scattering, (index,), mode=mode, correlated=bool(correlated))

    @property
    def eta(self) -> float:
        """Index of refraction below the surface over that above."""
        return float(self._constants[0])

    def __repr__(self) -> str:
        return (
            f"Dielectric({self.ndf!r}, eta={self.eta!r}, scattering={self.scattering!r}, mode={self.mode!r})"
        )

    @property
    def _radiance(self) -> Array:
        return flag(self.mode == "radiance")

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Any:
        """Density per steradian of the directions that `sample` draws, normalised over the whole sphere.

        It counts what facets mirror downwards or refract upwards too, though no light leaves so at once.
        With multiple scattering, 3/4 of that density and 1/4 of a cosine on both sides, a proposal.
        """
        return lifted(self._pdf, *directions_of(self, "pdf", wi=wi, wo=wo))

    def _pdf(self, wi: Array, wo: Array) -> Any:
        i, o = in_one_type(wi, wo)
        density = self._of("pdf", [*xyz(i), *xyz(o)], [flag(False)])
        if self.scattering == "multiple":
            cosine = np.abs(self._cosines(o)[0]) * i.dtype.type(0.5 / np.pi)
            return (0.75 * density + 0.25 * cosine).astype(i.dtype)[()]
        return density

    def sample(self, wi: ArrayLike, xi: ArrayLike | None = None, *, rng: Any = None) -> tuple[Any, Any, Any]:
        """Directions drawn for `wi`, their weights and densities, as `Conductor.sample`.

        The last of the uniform numbers chooses between reflection and transmission.
        """
        return self._drawn(wi, xi, rng)
