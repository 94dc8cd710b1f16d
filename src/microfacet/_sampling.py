"""Drawing normals: from D cos(theta), and from the density that a direction sees."""

from __future__ import annotations

from functools import cache, partial
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._arrays import as_array, is_foreign, lifted
from microfacet._quantities import Call, Quantities

__all__ = ["Sampling"]

_AT_LEAST = {dims: tuple(range(dims, 5)) for dims in range(2, 5)}  # uniforms that may be given


def _array(owner: Any, method: str, name: str, values: ArrayLike, lengths: tuple[int, ...]) -> Any:
    """`values` as an array whose last axis has one of these lengths."""
    array = as_array(values)
    if array.ndim == 0 or array.shape[-1] not in lengths:
        wanted = " or ".join(f"(..., {length})" for length in lengths)
        raise ValueError(
            f"{type(owner).__name__}.{method}: {name} must have shape {wanted}, got {array.shape}"
        )
    return array


def _check_out(owner: Any, method: str, out: Any, *inputs: Any) -> None:
    if any(map(is_foreign, inputs)):
        raise ValueError(
            f"{type(owner).__name__}.{method}: out is for NumPy arrays; those of dask and xarray are results "
            "of their own"
        )
    shape = (*np.broadcast_shapes(*(array.shape[:-1] for array in inputs)), 3)
    if np.shape(out) != shape:
        raise ValueError(f"{type(owner).__name__}.{method}: out must have shape {shape}, got {np.shape(out)}")


@cache
def _precision(*dtypes: np.dtype[Any]) -> type:
    """The precision of results: float64 unless all inputs fit into float32."""
    return np.float32 if all(np.can_cast(dtype, np.float32) for dtype in dtypes) else np.float64


class Sampling(Quantities):
    """The samplers of a distribution, from uniform random numbers that the caller owns."""

    __slots__ = ()
    kernels: ClassVar[Any]

    def sample(self, xi: ArrayLike, *, out: NDArray[Any] | None = None) -> Any:
        """Normals drawn from D cos(theta), by inversion.

        Parameters
        ----------
        xi : array_like, shape (..., 2)
            Uniform random numbers in [0, 1): the first gives the slope (0 the macroscopic normal), the second
            times 2 pi the azimuth of the normal before the stretch. The caller owns the generator.
        out : ndarray, shape (..., 3), optional
            Where to write the normals.

        Returns
        -------
        ndarray, shape (..., 3)
            Unit normals; nan where `xi` lies outside [0, 1).

        Examples
        --------
        >>> import microfacet as mf
        >>> print(abs(mf.StudentT(alpha=0.3, gamma=2.5).sample([0.0, 0.25])))
        [0. 0. 1.]
        """
        uniforms = _array(self, "sample", "xi", xi, (2,))
        if out is not None:
            _check_out(self, "sample", out, uniforms)
        return lifted(partial(self._draw, self._call("sample"), out), (uniforms, "xi"), results=("w",))

    @staticmethod
    def _draw(call: Call, out: Any, *inputs: Any) -> Any:
        """Normals by a kernel from the components of its inputs, written to `out` or to a new array."""
        parts = [array[..., i] for array in inputs for i in range(array.shape[-1])]
        if out is None:
            shape = (*np.broadcast(*parts).shape, 3)
            out = np.empty(shape, _precision(*(array.dtype for array in inputs)))
        # A kernel takes as many uniforms as its longest scheme, and does not look at those left over.
        left_over = call.kernel.nin - len(parts) - len(call.arrays)
        left_overs = parts[-1:] * left_over
        call.kernel(*parts, *left_overs, *call.arrays, out[..., 0], out[..., 1], out[..., 2])
        return out

    @property
    def visible_dims(self) -> int:
        """How many uniforms `sample_visible` takes with its default scheme: 2 or 3."""
        return int(self.kernels.visible_dims)

    @property
    def mixture_dims(self) -> int:
        """How many uniforms `sample_visible` takes with the scheme "mixture": 2 to 4."""
        closed = self.visible_dims < self.kernels.visible_dims
        return self.visible_dims if closed else int(self.kernels.mixture_dims)

    def sample_visible(
        self,
        w: ArrayLike,
        xi: ArrayLike,
        *,
        scheme: str = "continuous",
        bounded: bool = False,
        out: NDArray[Any] | None = None,
    ) -> Any:
        """Normals drawn from `D_visible`, the density of the normals that `w` sees.

        Exact for every direction, above the horizon and below it, from a fixed number of uniforms, without
        rejection. A renderer that reflects or refracts about such a normal multiplies by F G2/G1 alone.

        Parameters
        ----------
        w : array_like, shape (..., 3)
            Unit directions on the whole sphere, pointing away from the surface.
        xi : array_like, shape (..., visible_dims), or (..., mixture_dims) with the scheme "mixture"
            Uniform random numbers in [0, 1). Their leading axes broadcast against those of `w`. More than are
            taken, up to four, are ignored.
        scheme : {"continuous", "mixture"}
            "continuous" gives a normal that is continuous in `xi`, where the family has such a scheme, for
            quasi-Monte Carlo points: the first uniform is the probability of a smaller slope in the plane of
            incidence. "mixture", for random walks, costs less: in float32 nothing iterates. Closed samplers
            have one scheme under both names.
        bounded : bool
            GGX alone, for reflection: leave out what would reflect `w` below the horizon, as far as a
            spherical cap can. The density is then ``pdf_visible(m, w, bounded=True)``.
        out : ndarray, shape (..., 3), optional
            Where to write the normals.

        Returns
        -------
        ndarray, shape (..., 3)
            Unit normals with m.z > 0 and, but for rounding, m . w >= 0; nan where `xi` lies outside [0, 1)
            and straight down, where sigma(w) = 0.

        Examples
        --------
        >>> import microfacet as mf
        >>> import numpy as np
        >>> ndf = mf.Beckmann(alpha=0.5)
        >>> xi = np.random.default_rng(1).random((1000, ndf.visible_dims))
        >>> m = ndf.sample_visible([0.96, 0.0, 0.28], xi)
        >>> m.shape, bool((m[:, 2] > 0).all())
        ((1000, 3), True)
        """
        quantity, dims = self._visible_scheme(scheme, bounded)
        directions = _array(self, "sample_visible", "w", w, (3,))
        uniforms = _array(self, "sample_visible", "xi", xi, _AT_LEAST[dims])
        if out is not None:
            _check_out(self, "sample_visible", out, directions, uniforms)
        draw = partial(self._draw, self._call(quantity), out)
        return lifted(draw, (directions, "w"), (uniforms[..., :dims], "xi"), results=("w",))

    def _visible_scheme(self, scheme: str, bounded: bool) -> tuple[str, int]:
        """The quantity that a scheme computes, and how many uniforms it takes."""
        if not hasattr(self.kernels, "visible_dims"):
            raise NotImplementedError(
                f"{type(self).__name__}.sample_visible: only the families have it; "
                "sample draws from D cos(theta)"
            )
        if scheme not in ("continuous", "mixture"):
            raise ValueError(
                f"{type(self).__name__}.sample_visible: scheme must be "
                f'"continuous" or "mixture", got {scheme!r}'
            )
        if bounded:
            self._require_bounded(f"{type(self).__name__}.sample_visible")
            return "sample_visible_bounded", self.visible_dims
        # A shape parameter may bring a closed sampler, which has fewer dimensions and no mixture.
        if scheme == "mixture" and self.mixture_dims != self.visible_dims:
            return "sample_visible_mixture", self.mixture_dims
        return "sample_visible", self.visible_dims

    def _require_bounded(self, owner: str) -> None:
        if not hasattr(self.kernels, "stretched_sample_visible_bounded"):
            raise ValueError(f"{owner}: bounded=True is for GGX alone")

    def pdf_visible(
        self,
        m: ArrayLike,
        w: ArrayLike,
        *components: ArrayLike,
        bounded: bool = False,
        out: Any = None,
        where: Any = True,
    ) -> Any:
        """Density per steradian of the normals that `sample_visible` draws.

        Parameters
        ----------
        m, w : array_like, shape (..., 3)
            Normals and directions; or six arrays, x, y and z of `m`, then of `w`.
        bounded : bool
            As in `sample_visible`.
        out, where
            As for `D`.

        Returns
        -------
        ndarray or scalar
            `D_visible`; with `bounded`, which is for GGX alone, the larger density on a part of its normals.

        Examples
        --------
        >>> import microfacet as mf
        >>> ndf, w = mf.GGX(alpha=0.5), [0.6, 0.0, 0.8]
        >>> bool(ndf.pdf_visible([0, 0, 1], w) == ndf.D_visible([0, 0, 1], w))
        True
        """
        if bounded:
            self._require_bounded(f"{type(self).__name__}.pdf_visible")
        quantity = "pdf_visible_bounded" if bounded else "D_visible"
        return self._of_directions(quantity, ("m", "w"), (m, w, *components), out, where)
