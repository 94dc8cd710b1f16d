"""Frozen distributions: a family with its parameters fixed, checked once and for all."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from microfacet import _core
from microfacet._calls import constructor
from microfacet._sampling import Sampling

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


class Distribution(Sampling):
    """Base of the frozen distributions: immutable, hashable, comparable, picklable."""

    family: ClassVar[str]
    kernels: ClassVar[Any]
    _names: ClassVar[tuple[str, ...]]
    _values: tuple[float, ...]

    __slots__ = ("_calls", "_values")

    def __init_subclass__(cls) -> None:
        if "kernels" in vars(cls):
            cls.family = cls.kernels.__name__.rpartition(".")[2]
        if "__init__" in vars(cls):
            cls.__init__ = constructor(cls.__init__)  # type: ignore[method-assign]

    def _freeze(self, values: tuple[float, ...]) -> None:
        object.__setattr__(self, "_values", values)
        object.__setattr__(self, "_calls", {})

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters by name, as the constructor takes them."""
        return dict(zip(self._names, self._values, strict=True))

    @property
    def _identity(self) -> str:
        """What tells the density at roughness 1 from those of other families, as tables note it."""
        return self.family

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

    @property
    def _arguments(self) -> tuple[float, ...]:
        """What the kernels take for this distribution."""
        return self._values

    def _kernel(self, quantity: str) -> tuple[Any, tuple[float, ...]]:
        return getattr(self.kernels, f"isotropic_{quantity}"), self._arguments


def _rebuild(cls: type[Distribution], values: tuple[float, ...]) -> Distribution:
    new = cls.__new__(cls)
    new._freeze(values)
    return new


class StretchedDistribution(Distribution):
    """A shape-invariant family: alpha_x and alpha_y along axes rotated by `rotation`."""

    __slots__ = ()

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls._names = ("alpha_x", "alpha_y", "rotation", *(name for name, *_ in cls.kernels.parameters))

    def _kernel(self, quantity: str) -> tuple[Any, tuple[float, ...]]:
        x, y, rotation, *shape = self._arguments
        isotropic = getattr(self.kernels, f"isotropic_{quantity}", None)
        # A rotation that changes no density still changes samples.
        if isotropic is not None and x == y and (rotation == 0.0 or quantity != "sample"):
            return isotropic, (x, *shape)
        return getattr(self.kernels, f"stretched_{quantity}"), self._arguments

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
            x = y = _number(owner, "alpha", alpha, *_core.roughness)
        else:
            x = _number(owner, "alpha_x", alpha_x, *_core.roughness)
            y = _number(owner, "alpha_y", alpha_y, *_core.roughness)
        turn = _number(owner, "rotation", rotation, -math.inf, math.inf)
        own = (_number(owner, name, shape[name], lo, hi) for name, lo, hi, _ in self.kernels.parameters)
        self._freeze((x, y, turn, *own))


class IsotropicDistribution(Distribution):
    """A family whose alpha is no stretch: it has alpha alone and no anisotropic form."""

    __slots__ = ()

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls._names = ("alpha", *(name for name, *_ in cls.kernels.parameters))

    def _set(self, alpha: float, **shape: float | None) -> None:
        owner = type(self).__name__
        own = (_number(owner, name, shape[name], lo, hi) for name, lo, hi, _ in self.kernels.parameters)
        self._freeze((_number(owner, "alpha", alpha, *_core.roughness), *own))
