"""Frozen distributions: a family with its parameters fixed, on directions.

Nothing is computed here: every method calls a ufunc of the compiled core with the parameters as its last
arguments. Directions are arrays (..., 3) in the local frame (n = +z, away from the surface), or their
components as three arrays. They broadcast against each other, nothing is copied, float32 in is float32 out.
"""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Distribution", "IsotropicDistribution", "StretchedDistribution"]


def _number(owner: str, name: str, value: object, lower: float, upper: float) -> float:
    """`value` as a float inside the open interval, or one sentence that says what is wrong with it."""
    try:
        if isinstance(value, str | bytes):
            raise TypeError
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise ValueError(
            f"{owner}: {name} must be a number in ({lower:g}, {upper:g}), got {value!r}"
        ) from None
    if not lower < number < upper:
        raise ValueError(f"{owner}: {name} must lie in ({lower:g}, {upper:g}), got {number:g}")
    return number


def _components(owner: str, names: tuple[str, ...], arguments: tuple[ArrayLike | None, ...]) -> list[Any]:
    """The x, y, z of every direction: views of arrays (..., 3), or three separate arrays for each."""
    given = [argument for argument in arguments if argument is not None]
    if len(given) == 3 * len(names):
        return given
    if len(given) != len(names):
        raise TypeError(
            f"{owner}: give {' and '.join(names)} as arrays (..., 3), or x, y and z of each; "
            f"got {len(given)} arguments"
        )
    parts: list[Any] = []
    for name, argument in zip(names, given, strict=True):
        array = np.asanyarray(argument)
        if array.ndim == 0 or array.shape[-1] != 3:
            raise ValueError(f"{owner}: {name} must have shape (..., 3), got {array.shape}")
        parts += (array[..., 0], array[..., 1], array[..., 2])
    return parts


class Distribution:
    """Base of the frozen distributions: immutable, hashable, comparable, picklable."""

    family: ClassVar[str]
    kernels: ClassVar[Any]
    _names: ClassVar[tuple[str, ...]]
    _values: tuple[float, ...]

    __slots__ = ("_values",)

    def _freeze(self, values: tuple[float, ...]) -> None:
        object.__setattr__(self, "_values", values)

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters by name, as the constructor takes them."""
        return dict(zip(self._names, self._values, strict=True))

    def __getattr__(self, name: str) -> float:
        if name in type(self)._names:
            return self._values[type(self)._names.index(name)]
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__} is frozen: {name} cannot be set")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{type(self).__name__} is frozen: {name} cannot be deleted")

    def __eq__(self, other: object) -> bool:
        return self._values == other._values if type(other) is type(self) else NotImplemented

    def __hash__(self) -> int:
        return hash((type(self), self._values))

    def __repr__(self) -> str:
        inside = ", ".join(f"{name}={value!r}" for name, value in self.parameters.items())
        return f"{type(self).__name__}({inside})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (type(self), self._values)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._names]

    def _kernel(self, quantity: str) -> tuple[Any, tuple[float, ...]]:
        """The ufunc of a quantity of directions or slopes, and the parameters that it takes last."""
        return getattr(self.kernels, f"isotropic_{quantity}"), self._values

    def _of_slopes(self, quantity: str, slopes: tuple[ArrayLike, ...], out: Any, where: Any) -> Any:
        kernel, parameters = self._kernel(quantity)
        return kernel(*slopes, *parameters, out=out, where=where)

    def _of_directions(
        self, quantity: str, names: tuple[str, ...], given: tuple[ArrayLike | None, ...], out: Any, where: Any
    ) -> Any:
        kernel, parameters = self._kernel(quantity)
        parts = _components(f"{type(self).__name__}.{quantity}", names, given)
        return kernel(*parts, *parameters, out=out, where=where)

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
        return self._of_directions("D", ("m",), (m, y, z), out, where)

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
        return self._of_directions("sigma", ("w",), (w, y, z), out, where)

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
        return self._of_directions("Lambda", ("w",), (w, y, z), out, where)

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
        return self._of_directions("G1", ("w",), (w, y, z), out, where)

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
        return self._of_directions("pdf", ("m",), (m, y, z), out, where)

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
        xi = np.asanyarray(xi)
        if xi.ndim == 0 or xi.shape[-1] != 2:
            raise ValueError(f"{type(self).__name__}.sample: xi must have shape (..., 2), got {xi.shape}")
        if out is None:
            dtype = np.float32 if np.can_cast(xi.dtype, np.float32) else np.float64
            out = np.empty((*xi.shape[:-1], 3), dtype)
        kernel, parameters = self._kernel("sample")
        kernel(xi[..., 0], xi[..., 1], *parameters, out=(out[..., 0], out[..., 1], out[..., 2]))
        return out


def _rebuild(cls: type[Distribution], values: tuple[float, ...]) -> Distribution:
    new = cls.__new__(cls)
    new._freeze(values)
    return new


class StretchedDistribution(Distribution):
    """A shape-invariant family: alpha_x and alpha_y along axes turned by `rotation`."""

    __slots__ = ()

    def __init_subclass__(cls) -> None:
        cls._names = ("alpha_x", "alpha_y", "rotation", *(name for name, *_ in cls.kernels.parameters))

    def _kernel(self, quantity: str) -> tuple[Any, tuple[float, ...]]:
        x, y, rotation, *shape = self._values
        # A turn that changes no density changes where a sample lies.
        if x == y and (rotation == 0.0 or quantity != "sample"):
            return getattr(self.kernels, f"isotropic_{quantity}"), (x, *shape)
        return getattr(self.kernels, f"stretched_{quantity}"), self._values

    # A family with a shape parameter has a constructor of its own.
    def __init__(
        self,
        alpha: float | None = None,
        *,
        alpha_x: float | None = None,
        alpha_y: float | None = None,
        rotation: float = 0.0,
    ) -> None:
        self._set(alpha, alpha_x, alpha_y, rotation)

    def _set(
        self,
        alpha: float | None,
        alpha_x: float | None,
        alpha_y: float | None,
        rotation: float,
        **shape: float | None,
    ) -> None:
        owner = type(self).__name__
        if (alpha is None) == (alpha_x is None) or (alpha_x is None) != (alpha_y is None):
            raise ValueError(f"{owner}: give either alpha, or both alpha_x and alpha_y")
        if alpha is not None:
            x = y = _number(owner, "alpha", alpha, 0.0, math.inf)
        else:
            x = _number(owner, "alpha_x", alpha_x, 0.0, math.inf)
            y = _number(owner, "alpha_y", alpha_y, 0.0, math.inf)
        turn = _number(owner, "rotation", rotation, -math.inf, math.inf)
        own = (_number(owner, name, shape[name], lo, hi) for name, lo, hi, _ in self.kernels.parameters)
        self._freeze((x, y, turn, *own))


class IsotropicDistribution(Distribution):
    """A family whose alpha is no stretch: it has alpha alone and no anisotropic form."""

    __slots__ = ()

    def __init_subclass__(cls) -> None:
        cls._names = ("alpha", *(name for name, *_ in cls.kernels.parameters))

    def _set(self, alpha: float, **shape: float | None) -> None:
        owner = type(self).__name__
        own = (_number(owner, name, shape[name], lo, hi) for name, lo, hi, _ in self.kernels.parameters)
        self._freeze((_number(owner, "alpha", alpha, 0.0, math.inf), *own))
