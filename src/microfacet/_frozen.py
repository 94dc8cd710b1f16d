"""Frozen distributions: a family with its parameters fixed, on directions.

Nothing is computed here: every method calls a ufunc of the compiled core with the parameters as its last
arguments. Directions are arrays (..., 3) in the local frame (n = +z, pointing away from the surface) and
broadcast against each other; float32 in, float32 out.
"""

from __future__ import annotations

import math
from typing import Any, ClassVar

from numpy.typing import ArrayLike

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

    def D(self, m: ArrayLike) -> Any:
        """Density of microfacet normals at `m`, per steradian.

        Parameters
        ----------
        m : array_like, shape (..., 3)
            Normals in the local frame, of any length.

        Returns
        -------
        ndarray or scalar, shape (...)
            P22 of the slopes (-x/z, -y/z) over cos(theta)^4; 0 for z <= 0, nan for nan.

        Examples
        --------
        >>> import microfacet as mf
        >>> round(float(mf.GGX(alpha=0.5).D([0, 0, 1])), 6)  # 1/(pi alpha^2)
        1.27324
        """
        return self.kernels.direction_D(m, *self._values)

    def P22(self, p: ArrayLike, q: ArrayLike) -> Any:
        """Joint density of the slopes `p` (along x) and `q` (along y); integrates to 1 over the plane."""
        return self.kernels.direction_P22(p, q, *self._values)

    def P2(self, p: ArrayLike) -> Any:
        """Density of the slope `p` along x; integrates to 1 over the line."""
        return self.kernels.direction_P2(p, *self._values)

    def slope_cdf(self, p: ArrayLike) -> Any:
        """Probability that the slope along x is at most `p`, accurate in the lower tail."""
        return self.kernels.direction_slope_cdf(p, *self._values)

    def sigma(self, w: ArrayLike) -> Any:
        """Projected area of the microfacets towards `w`, per unit area of surface.

        Parameters
        ----------
        w : array_like, shape (..., 3)
            Unit directions on the whole sphere. sigma is homogeneous of degree one, so that a `w` of length 2
            doubles the result.

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
        return self.kernels.direction_sigma(w, *self._values)

    def Lambda(self, w: ArrayLike) -> Any:
        """Smith's Lambda towards `w` (..., 3): sigma(w) = w.z (1 + Lambda(w)); inf at w.z = 0."""
        return self.kernels.direction_Lambda(w, *self._values)

    def G1(self, w: ArrayLike) -> Any:
        """Smith's masking towards `w` (..., 3): w.z/sigma(w) for w.z > 0, else 0."""
        return self.kernels.direction_G1(w, *self._values)

    def G2(self, wi: ArrayLike, wo: ArrayLike, *, correlated: bool = True) -> Any:
        """Masking and shadowing of the pair `wi`, `wo`.

        Parameters
        ----------
        wi, wo : array_like, shape (..., 3)
            Directions pointing away from the surface.
        correlated : bool
            Whether masking and shadowing share the height of the facet (Heitz 2014); otherwise the product
            G1(wi) G1(wo), each on its own side.

        Returns
        -------
        ndarray or scalar
            0 for wi.z <= 0. Reflection (wo.z > 0): 1/(1 + Lambda(wi) + Lambda(wo)). Transmission (wo.z < 0):
            the Beta function B(1 + Lambda(wi), 1 + Lambda(-wo)).
        """
        kernel = self.kernels.direction_G2 if correlated else self.kernels.direction_G2_uncorrelated
        return kernel(wi, wo, *self._values)

    def D_visible(self, m: ArrayLike, w: ArrayLike) -> Any:
        """Density per steradian of the normals `m` seen from `w`: max(0, w . m) D(m)/sigma(w)."""
        return self.kernels.direction_D_visible(m, w, *self._values)

    def pdf(self, m: ArrayLike) -> Any:
        """Density per steradian of the normals that `sample` draws: D(m) cos(theta)."""
        return self.kernels.direction_pdf(m, *self._values)

    def sample(self, xi: ArrayLike) -> Any:
        """Normals drawn from D cos(theta), by inversion.

        Parameters
        ----------
        xi : array_like, shape (..., 2)
            Uniform random numbers in [0, 1): the first gives the slope (0 the macroscopic normal), the second
            times 2 pi the azimuth of the normal before the stretch. The caller owns the generator.

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
        return self.kernels.direction_sample(xi, *self._values)


def _rebuild(cls: type[Distribution], values: tuple[float, ...]) -> Distribution:
    new = cls.__new__(cls)
    new._freeze(values)
    return new


class StretchedDistribution(Distribution):
    """A shape-invariant family: alpha_x and alpha_y along axes turned by `rotation`."""

    __slots__ = ()

    def __init_subclass__(cls) -> None:
        cls._names = ("alpha_x", "alpha_y", "rotation", *(name for name, *_ in cls.kernels.parameters))

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
