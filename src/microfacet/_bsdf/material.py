"""What all materials offer besides `pdf` and `sample`: values, walks and albedos."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from microfacet._arrays import lifted, numbered
from microfacet._bsdf.albedo import albedo as albedo_of
from microfacet._bsdf.albedo import average_albedo as average_albedo_of
from microfacet._bsdf.arguments import Array, directions_of, flag, in_one_type, seed_of, uniforms_of, xyz
from microfacet._bsdf.kernels import NO_ORDER, WALK, MaterialKernels

__all__ = ["Material"]


class Material(MaterialKernels):
    """Base of the materials: f |cos|, its samples, random walks, and albedos."""

    __slots__ = ()

    correlated: bool

    def eval(
        self,
        wi: ArrayLike,
        wo: ArrayLike,
        *,
        n: int = 1,
        rng: Any = None,
        orders: tuple[float, float] = (1, NO_ORDER),
    ) -> Any:
        """f |cos theta_o|: the light per steradian towards `wo`, of light from `wi`.

        Parameters
        ----------
        wi, wo : array_like, shape (..., 3)
            Directions, away from the surface; reflection with both on one side, else transmission. Below
            an opaque surface nothing is scattered.
        n : int
            Where values are estimates, that is with multiple scattering and for `Diffuse`: how many walks
            they take. The error falls like 1/sqrt(n).
        rng : int or numpy.random.Generator, optional
            For estimates: the same seed gives every element the same walks, whatever the shape of the arrays
            and the number of threads. An element's walks depend on its place in the result.
        orders : (int, int)
            For estimates, the first and last number of facets met that count.

        Returns
        -------
        ndarray or scalar, shape (..., *channels)
        """
        given = directions_of(self, "eval", wi=wi, wo=wo)
        if self.scattering == "single":
            if self._closed:
                return lifted(self._eval, *given)
            orders = (max(1, orders[0]), min(1, orders[1]))
        if not (isinstance(n, int | np.integer) and n >= 1):
            raise ValueError(f"{type(self).__name__}.eval: n must be a whole number in [1, inf), got {n!r}")
        wide = [seed_of(type(self).__name__, rng), self._radiance, *map(np.array, map(float, (n, *orders)))]
        return lifted(partial(self._walk_eval, wide), *given, numbered(*given))

    def _eval(self, wi: Array, wo: Array) -> Any:
        i, o = in_one_type(wi, wo)
        return self._of("eval", [*xyz(i), *xyz(o)], [flag(self.correlated), self._radiance])

    def _walk_eval(self, wide: list[Array], wi: Array, wo: Array, elements: Array) -> Any:
        i, o = in_one_type(wi, wo)
        return self._of("walk_eval", [*xyz(i), *xyz(o)], [elements, *wide], WALK * float(wide[2]))

    def walk(self, wi: ArrayLike, *, rng: Any = None) -> tuple[Any, Any, Any]:
        """Walks from `wi`: directions out, what is left of the light, and how many facets it met.

        Parameters
        ----------
        wi : array_like, shape (..., 3)
            Directions, away from the surface.
        rng : int or numpy.random.Generator, optional
            As for `eval`.

        Returns
        -------
        wo : ndarray, shape (..., 3)
        weight : ndarray, shape (..., *channels)
        facets : ndarray of int, shape (...)

        Examples
        --------
        >>> import microfacet as mf
        >>> white = mf.Conductor(mf.GGX(alpha=1.0), scattering="multiple")
        >>> wo, weight, facets = white.walk([0.6, 0.0, 0.8], rng=1)
        >>> float(weight)
        1.0
        """
        given = directions_of(self, "walk", wi=wi)
        walk = partial(self._walk, seed_of(type(self).__name__, rng))
        wo, weight, facets = lifted(walk, *given, numbered(*given), results=("w", "", ""))
        return wo, weight, facets

    def _drawn(
        self, wi: ArrayLike, xi: ArrayLike | None, rng: Any, bounded: bool = False
    ) -> tuple[Any, Any, Any]:
        """What `sample` returns: directions, weights and densities, in closed form or by walks."""
        (given,) = directions_of(self, "sample", wi=wi)
        draw: Callable[..., Any]
        if self.scattering == "single" and self._closed:
            draw, numbers = partial(self._sample, bounded), uniforms_of(self, "sample", xi, self.sample_dims)
        else:
            draw, numbers = partial(self._sample_walk, seed_of(type(self).__name__, rng)), numbered(given)
        wo, weight, pdf = lifted(draw, given, numbers, results=("w", "", ""))
        return wo, weight, pdf

    def _sample(self, bounded: bool, wi: Array, xi: Array) -> tuple[Any, Any, Any]:
        (i,) = in_one_type(wi)
        values = [*xyz(i), *self._of_facet_and_choice(xi, i.dtype)]
        wo, weight, pdf = self._of("sample", values, [flag(self.correlated), self._radiance, flag(bounded)])
        for _ in self._channels:  # which share their directions
            wo, pdf = wo[..., 0, :], pdf[..., 0]
        return wo, weight, pdf

    def _sample_walk(self, seed: Array, wi: Array, elements: Array) -> tuple[Any, Any, Any]:
        """Samples by walks, of which one order alone may count."""
        (i,) = in_one_type(wi)
        wo, weight, facets = self._walk_sample(seed, i, elements)
        if self.scattering == "single":
            once = (facets == 1).reshape(facets.shape + (1,) * len(self._channels))
            weight = np.where(once, weight, 0 * weight)
        return wo, weight, self._pdf(i, wo)

    def _walk(self, seed: Array, wi: Array, elements: Array) -> tuple[Any, Any, Any]:
        (i,) = in_one_type(wi)
        return self._walk_sample(seed, i, elements)

    def albedo(
        self, wi: ArrayLike, *, n: int = 10_000, rng: Any = None, part: str = "all", with_error: bool = False
    ) -> Any:
        """Part of the light from `wi` that leaves again: the integral of `eval` over all wo.

        Parameters
        ----------
        wi : array_like, shape (..., 3)
            Directions, away from the surface.
        n, rng : int, int or numpy.random.Generator, optional
            How many random walks a direction takes, and their seed, with multiple scattering and for
            `Diffuse`. Single scattering of the others is an integral over the facets and needs neither.
        part : {"all", "reflected", "transmitted"}
            What leaves on the side of `wi`, or on the other one.
        with_error : bool
            Also return the error.

        Returns
        -------
        value : ndarray or scalar, shape (..., *channels)
            Never above 1, but for the radiance behind a surface into the thinner medium.
        error : ndarray or scalar
            Only `with_error`: the standard error of walks; of the integral, the difference of its last two
            refinements, 1e-7 at most but for extreme distributions.

        Examples
        --------
        >>> import numpy as np
        >>> import microfacet as mf
        >>> white = mf.Conductor(mf.GGX(alpha=1.0))
        >>> print(f"{white.albedo([0, 0, 1]):.6f} {1 - np.log(2):.6f}")
        0.306853 0.306853
        """
        return albedo_of(self, wi, n, seed_of(type(self).__name__, rng), part, with_error)

    def average_albedo(
        self,
        *,
        n: int = 100_000,
        rng: Any = None,
        side: str = "above",
        part: str = "all",
        with_error: bool = False,
    ) -> Any:
        """Part of the light that leaves again, of light from all sides: the mean of `albedo` over cos/pi.

        Parameters
        ----------
        n, rng, part, with_error
            As for `albedo`; `n` is the number of all walks.
        side : {"above", "below"}
            Where the light comes from.

        Examples
        --------
        >>> import microfacet as mf
        >>> print(f"{mf.Dielectric(mf.K0(alpha=0.5), 1.5, mode='importance').average_albedo():.5f}")
        0.97784
        """
        seed = seed_of(type(self).__name__, rng)
        return average_albedo_of(self, n, seed, side, part, with_error)
