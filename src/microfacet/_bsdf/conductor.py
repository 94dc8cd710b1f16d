"""Rough metals."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from microfacet._arrays import lifted
from microfacet._bsdf.arguments import (
    Array,
    directions_of,
    flag,
    in_one_type,
    lit,
    number,
    xyz,
)
from microfacet._bsdf.material import Material
from microfacet._frozen import Distribution

__all__ = ["Conductor"]


class Conductor(Material):
    r"""A metal whose facets are smooth mirrors, with scattering of one order or of all.

    Of one order, with the half vector m:

    .. math:: f\,|\cos\theta_o| = \frac{F(\omega_i\cdot m)\, D(m)\, G_2(\omega_i, \omega_o)}{4\cos\theta_i}

    Light that a facet sends back to the surface is then lost, which can be more than half of it. With all
    orders it goes on as a random walk until it leaves.

    Parameters
    ----------
    ndf : distribution
        Of any family, such as `microfacet.StudentT`.
    eta, k : array_like
        The metal's index of refraction eta - i k over that of the medium above; arrays for several
        wavelengths, whose axes come last in every result. The default, eta = inf, is a perfect mirror.
    scattering : {"single", "multiple"}
        One order, in closed form; or all of them, whose evaluation is a Monte Carlo estimate.
    correlated : bool
        Heights of masking and shadowing facets are correlated (Heitz 2014); False is Smith's product
        G1(wi) G1(wo). Walks are always correlated.

    Raises
    ------
    ValueError
        If an argument lies outside its domain; the message names it.

    Notes
    -----
    Directions may have any length but 0: methods normalise them, unless their length is 1 up to rounding.
    Results are nan for directions of length 0 and for those that are not finite.

    K0 and Bessel K with a <= 1 are infinite at the macroscopic normal: `eval` and `pdf` are inf in the mirror
    direction then. No drawn direction is one of these, and weights are numbers always.
    Where `eta` or `k` is beyond the range of float32, and directions are float32, the metal is that of the
    nearest index inside it; both are as good as mirrors.

    References
    ----------
    B. Walter et al., Microfacet models for refraction through rough surfaces, EGSR 2007; E. Heitz,
    Understanding the masking-shadowing function, JCGT 2014; E. Heitz et al., Multiple-scattering microfacet
    BSDFs with the Smith model, SIGGRAPH 2016.

    Examples
    --------
    >>> import microfacet as mf
    >>> gold = mf.Conductor(mf.StudentT(alpha=0.4, gamma=2.5), [0.18, 0.42, 1.37], [3.42, 2.35, 1.77])
    >>> gold.eval([0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]).round(3)
    array([0.581, 0.478, 0.233])
    >>> white = mf.Conductor(mf.GGX(alpha=1.0), scattering="multiple")
    >>> wo, weight, facets = white.walk([0.6, 0.0, 0.8], rng=1)
    >>> float(weight)
    1.0
    """

    __slots__ = ("correlated",)
    _name = "conductor"
    correlated: bool

    def __init__(
        self,
        ndf: Distribution,
        eta: ArrayLike = np.inf,
        k: ArrayLike = 0.0,
        *,
        scattering: str = "single",
        correlated: bool = True,
    ) -> None:
        owner = type(self).__name__
        constants = (
            number(owner, "eta", eta, "in (0, inf]", lambda x: x > 0),
            number(owner, "k", k, "in [0, inf)", lambda x: (x >= 0) & (x < np.inf)),
        )
        self._freeze(ndf, scattering, constants, correlated=bool(correlated))

    @property
    def eta(self) -> Any:
        """Real part of the index of refraction."""
        return self._constants[0][()]

    @property
    def k(self) -> Any:
        """Imaginary part of the index of refraction."""
        return self._constants[1][()]

    def __repr__(self) -> str:
        return f"Conductor({self.ndf!r}, eta={self.eta!r}, k={self.k!r}, scattering={self.scattering!r})"

    def pdf(self, wi: ArrayLike, wo: ArrayLike, *, bounded: bool = False) -> Any:
        """Density per steradian of the directions that `sample` draws, D_visible(m)/(4 wi . m).

        It is normalised over the whole sphere: facets also mirror into the surface, where `eval` is 0 and
        samples have no weight. With multiple scattering `sample` draws by walks, whose density is unknown;
        then this is 3/4 of the density of one order and 1/4 of that of a diffuse surface, a proposal for
        multiple importance sampling.
        """
        return lifted(partial(self._pdf, bounded=bounded), *directions_of(self, "pdf", wi=wi, wo=wo))

    def _pdf(self, wi: Array, wo: Array, bounded: bool = False) -> Any:
        i, o = in_one_type(wi, wo)
        density = self._of("pdf", [*xyz(i), *xyz(o)], [flag(bounded)], white=True)
        if self.scattering == "multiple":
            diffuse = lit(*self._cosines(i, o)) * i.dtype.type(1 / np.pi)
            return (0.75 * density + 0.25 * diffuse).astype(i.dtype)[()]
        return density

    def sample(
        self, wi: ArrayLike, xi: ArrayLike | None = None, *, rng: Any = None, bounded: bool = False
    ) -> tuple[Any, Any, Any]:
        """Directions drawn for `wi`, their weights and densities.

        Parameters
        ----------
        wi : array_like, shape (..., 3)
            Directions, away from the surface.
        xi : array_like, shape (..., sample_dims)
            Uniform numbers in [0, 1), for single scattering.
        rng : int or numpy.random.Generator, optional
            For multiple scattering, in place of `xi`.
        bounded : bool
            GGX alone: fewer samples below the surface; then the density is ``pdf(wi, wo, bounded=True)``.

        Returns
        -------
        wo : ndarray, shape (..., 3)
        weight : ndarray, shape (..., *channels)
            ``eval/pdf`` of single scattering; of a walk, what is left of the light.
        pdf : ndarray, shape (...)
            What `pdf` says.
        """
        if bounded and self.scattering == "single":
            self.ndf._require_bounded("Conductor.sample")
        return self._drawn(wi, xi, rng, bounded)
