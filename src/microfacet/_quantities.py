"""What every distribution computes, as methods on directions and slopes.

Nothing is computed here: every method calls a ufunc of the compiled core with the parameters as its last
arguments. Directions are arrays (..., 3) in the local frame (n = +z, away from the surface), or their
components as three arrays. They broadcast against each other, nothing is copied, float32 in is float32 out.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Call", "Quantities"]


class Call(NamedTuple):
    """A ufunc and the parameters that it takes last."""

    kernel: Any
    numbers: tuple[float, ...]  # for arrays of any library
    arrays: tuple[NDArray[np.float64], ...]  # the same without dimensions, which NumPy need not convert


def _components(owner: str, names: tuple[str, ...], given: list[Any]) -> list[Any]:
    """The x, y, z of every direction: views of arrays (..., 3), or three separate arrays for each."""
    if len(given) == 3 * len(names):
        return given
    if len(given) != len(names):
        raise TypeError(
            f"{owner}: give {' and '.join(names)} as arrays (..., 3), or x, y and z of each; "
            f"got {len(given)} arguments"
        )
    parts: list[Any] = []
    for name, argument in zip(names, given, strict=True):
        # An array with ufuncs of its own, such as dask's, stays as it is; pandas' cannot be indexed by axis.
        own = hasattr(argument, "__array_ufunc__") and hasattr(argument, "ndim")
        array: Any = argument if own and not hasattr(argument, "iloc") else np.asanyarray(argument)
        if array.ndim == 0 or array.shape[-1] != 3:
            raise ValueError(f"{owner}: {name} must have shape (..., 3), got {array.shape}")
        parts += (array[..., 0], array[..., 1], array[..., 2])
    return parts


def _applied(kernel: Any, variables: Sequence[Any], parameters: Sequence[Any], out: Any, where: Any) -> Any:
    if out is None and where is True:  # options cost NumPy as much as a short calculation
        return kernel(*variables, *parameters)
    return kernel(*variables, *parameters, out=out, where=where)


class Quantities:
    """The quantities of a distribution of normals; a subclass says which kernels compute them."""

    __slots__ = ()
    _calls: dict[str, Call]  # those that were asked for

    def _kernel(self, quantity: str) -> tuple[Any, tuple[float, ...]]:
        """The ufunc of a quantity of directions or slopes, and the parameters that it takes last."""
        raise NotImplementedError

    def _call(self, quantity: str) -> Call:
        """The call of a quantity, made at its first use."""
        call = self._calls.get(quantity)
        if call is None:
            kernel, numbers = self._kernel(quantity)
            call = self._calls[quantity] = Call(kernel, numbers, tuple(map(np.array, numbers)))
        return call

    def _of_slopes(self, quantity: str, slopes: tuple[ArrayLike, ...], out: Any, where: Any) -> Any:
        kernel, numbers, _ = self._call(quantity)
        return _applied(kernel, slopes, numbers, out, where)

    def _of_directions(
        self, quantity: str, names: tuple[str, ...], given: tuple[ArrayLike | None, ...], out: Any, where: Any
    ) -> Any:
        kernel, numbers, arrays = self._call(quantity)
        parts: list[Any] = []
        for w in given:
            if type(w) is not np.ndarray or w.shape[-1:] != (3,) or len(given) != len(names):
                listed = [argument for argument in given if argument is not None]
                parts = _components(f"{type(self).__name__}.{quantity}", names, listed)
                return _applied(kernel, parts, numbers, out, where)
            parts += (w[..., 0], w[..., 1], w[..., 2])
        return _applied(kernel, parts, arrays, out, where)

    def D(
        self,
        m: ArrayLike,
        y: ArrayLike | None = None,
        z: ArrayLike | None = None,
        *,
        out: Any = None,
        where: Any = True,
    ) -> Any:
        """Density of microfacet normals at `m`, per steradian.

        Parameters
        ----------
        m : array_like, shape (..., 3)
            Normals in the local frame, of any length.
        y, z : array_like, optional
            Given both, `m` is the x component alone: three arrays that broadcast. Every function of
            directions takes them so, without copies.
        out, where
            As of any `numpy.ufunc`; every function of directions or slopes takes them.

        Returns
        -------
        ndarray or scalar, shape (...)
            P22 of the slopes (-x/z, -y/z) over cos(theta)^4; 0 for z <= 0, nan for nan.

        Examples
        --------
        >>> import microfacet as mf
        >>> round(float(mf.GGX(alpha=0.5).D([0, 0, 1])), 6)  # 1/(pi alpha^2)
        1.27324
        >>> round(float(mf.GGX(alpha=0.5).D(0, 0, 1)), 6)  # the same from components
        1.27324
        """
        return self._of_directions("D", ("m",), (m,) if y is z is None else (m, y, z), out, where)

    def P22(self, p: ArrayLike, q: ArrayLike, *, out: Any = None, where: Any = True) -> Any:
        """Joint density of the slopes `p` (along x) and `q` (along y); integrates to 1 over the plane."""
        return self._of_slopes("P22", (p, q), out, where)

    def P2(self, p: ArrayLike, *, out: Any = None, where: Any = True) -> Any:
        """Density of the slope `p` along x; integrates to 1 over the line."""
        return self._of_slopes("P2", (p,), out, where)

    def slope_cdf(self, p: ArrayLike, *, out: Any = None, where: Any = True) -> Any:
        """Probability that the slope along x is at most `p`, accurate in the lower tail."""
        return self._of_slopes("slope_cdf", (p,), out, where)

    def sigma(
        self,
        w: ArrayLike,
        y: ArrayLike | None = None,
        z: ArrayLike | None = None,
        *,
        out: Any = None,
        where: Any = True,
    ) -> Any:
        """Projected area of the microfacets towards `w`, per unit area of surface.

        Parameters
        ----------
        w : array_like, shape (..., 3)
            Unit directions on the whole sphere. sigma is homogeneous of degree one, so that a `w` of length 2
            doubles the result.
        y, z, out, where
            As for `D`.

        Returns
        -------
        ndarray or scalar, shape (...)
            int D(m) max(0, w . m) dm: 1 along +z, 0 along -z.

        Examples
        --------
        >>> import microfacet as mf
        >>> mf.Beckmann(alpha=0.5).sigma([[0, 0, 1], [0, 0, -1]])
        array([1., 0.])
        """
        return self._of_directions("sigma", ("w",), (w,) if y is z is None else (w, y, z), out, where)

    def Lambda(
        self,
        w: ArrayLike,
        y: ArrayLike | None = None,
        z: ArrayLike | None = None,
        *,
        out: Any = None,
        where: Any = True,
    ) -> Any:
        """Smith's Lambda towards `w` (..., 3): sigma(w) = w.z (1 + Lambda(w)); inf at w.z = 0."""
        return self._of_directions("Lambda", ("w",), (w,) if y is z is None else (w, y, z), out, where)

    def G1(
        self,
        w: ArrayLike,
        y: ArrayLike | None = None,
        z: ArrayLike | None = None,
        *,
        out: Any = None,
        where: Any = True,
    ) -> Any:
        """Smith's masking towards `w` (..., 3): w.z/sigma(w) for w.z > 0, else 0."""
        return self._of_directions("G1", ("w",), (w,) if y is z is None else (w, y, z), out, where)

    def G2(
        self,
        wi: ArrayLike,
        wo: ArrayLike,
        *components: ArrayLike,
        correlated: bool = True,
        out: Any = None,
        where: Any = True,
    ) -> Any:
        """Masking and shadowing of the pair `wi`, `wo`.

        Parameters
        ----------
        wi, wo : array_like, shape (..., 3)
            Directions pointing away from the surface; or six arrays, x, y and z of `wi`, then of `wo`.
        correlated : bool
            Whether masking and shadowing share the height of the facet (Heitz 2014); otherwise the product
            G1(wi) G1(wo), each on its own side.
        out, where
            As for `D`.

        Returns
        -------
        ndarray or scalar
            0 for wi.z <= 0. Reflection (wo.z > 0): 1/(1 + Lambda(wi) + Lambda(wo)). Transmission (wo.z < 0):
            the Beta function B(1 + Lambda(wi), 1 + Lambda(-wo)).
        """
        quantity = "G2" if correlated else "G2_uncorrelated"
        return self._of_directions(quantity, ("wi", "wo"), (wi, wo, *components), out, where)

    def D_visible(
        self, m: ArrayLike, w: ArrayLike, *components: ArrayLike, out: Any = None, where: Any = True
    ) -> Any:
        """Density per steradian of the normals `m` seen from `w`: max(0, w . m) D(m)/sigma(w).

        Instead of two arrays (..., 3) it takes six: x, y and z of `m`, then of `w`.
        """
        return self._of_directions("D_visible", ("m", "w"), (m, w, *components), out, where)

    def pdf(
        self,
        m: ArrayLike,
        y: ArrayLike | None = None,
        z: ArrayLike | None = None,
        *,
        out: Any = None,
        where: Any = True,
    ) -> Any:
        """Density per steradian of the normals that `sample` draws: D(m) cos(theta)."""
        return self._of_directions("pdf", ("m",), (m,) if y is z is None else (m, y, z), out, where)
