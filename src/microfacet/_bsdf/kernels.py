"""What the kernels of a material are given: directions and their shapes, uniform numbers, seeds of walks."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._calls import constructor
from microfacet._frozen import Distribution

__all__ = ["NO_ORDER", "MaterialKernels", "number", "seed_of", "xyz"]

Array = NDArray[Any]
NO_ORDER = float(2**31)


def number(owner: str, name: str, value: object, allowed: str, valid: Any) -> Array:
    """`value` as float64, one number or an array of them, or one sentence that says what is wrong."""
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "iuf":
            raise TypeError
    except (TypeError, ValueError):
        raise ValueError(f"{owner}: {name} must be a number {allowed}, got {value!r}") from None
    array = array.astype(np.float64)
    bad = ~valid(array)
    if bad.any():
        raise ValueError(f"{owner}: {name} must lie {allowed}, got {array[bad].flat[0]:g}")
    return array


class MaterialKernels:
    """A distribution and optical constants, and calls of their kernels."""

    __slots__ = ("_constants", "ndf", "scattering")

    ndf: Distribution
    scattering: str
    _constants: tuple[Array, ...]  # of the material, as the kernels take them
    _name: str
    _transmits = False
    _closed = True  # whether scattering of one order has a closed form

    def __init_subclass__(cls) -> None:
        if "__init__" in vars(cls):
            cls.__init__ = constructor(cls.__init__)  # type: ignore[method-assign]

    def _freeze(self, ndf: Distribution, scattering: str, constants: tuple[Array, ...]) -> None:
        owner = type(self).__name__
        if not isinstance(ndf, Distribution) or not hasattr(ndf.kernels, "conductor_eval"):
            raise ValueError(f"{owner}: ndf must be a distribution of one of the families, got {ndf!r:.80}")
        if scattering not in ("single", "multiple"):
            raise ValueError(f'{owner}: scattering must be "single" or "multiple", got {scattering!r}')
        try:
            np.broadcast_shapes(*(constant.shape for constant in constants))
        except ValueError:
            shapes = " and ".join(str(constant.shape) for constant in constants)
            raise ValueError(f"{owner}: eta and k must have shapes that broadcast, got {shapes}") from None
        for name, value in (("ndf", ndf), ("scattering", scattering), ("_constants", constants)):
            object.__setattr__(self, name, value)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__} is frozen: {name} cannot be set")

    @property
    def _radiance(self) -> float:
        """1 where light that passes is scaled as radiance is."""
        return 0.0

    @property
    def sample_dims(self) -> int:
        """How many uniform numbers a sample of single scattering takes."""
        return self.ndf.visible_dims + (1 if self._transmits else 0)

    def _kernel(self, operation: str) -> Any:
        return getattr(self.ndf.kernels, f"{self._name}_{operation}")

    def _directions(self, method: str, **directions: ArrayLike) -> list[Array]:
        """Arrays (..., 3) of one precision; float64 unless all are float32."""
        arrays = []
        for name, given in directions.items():
            array = np.asarray(given)
            if array.ndim == 0 or array.shape[-1] != 3 or array.dtype.kind not in "iuf":
                raise ValueError(
                    f"{type(self).__name__}.{method}: {name} must be real numbers of shape (..., 3), "
                    f"got {array.dtype} of shape {array.shape}"
                )
            arrays.append(array)
        single = all(array.dtype == np.float32 for array in arrays)
        return [np.asarray(array, np.float32 if single else np.float64) for array in arrays]

    @property
    def _channels(self) -> tuple[int, ...]:
        return np.broadcast_shapes(*(constant.shape for constant in self._constants))

    def _of(self, operation: str, values: list[Array], wide: tuple[Any, ...]) -> Any:
        """A kernel at values (...), for every channel of the material: (..., *channels).

        Of a kernel with several results the first three are a direction: (..., *channels, 3).
        """
        behind = (np.newaxis,) * len(self._channels)
        lifted = [value[(..., *behind)] for value in values]
        constants = [constant.astype(values[0].dtype) for constant in self._constants]
        places = [
            place[(..., *behind)] if isinstance(place, np.ndarray) and place.ndim else place for place in wide
        ]
        kernel, inputs = self._kernel(operation), (*lifted, *constants, *places, *self.ndf._values)
        if kernel.nout < 3:
            return kernel(*inputs)
        shape = np.broadcast_shapes(*(np.shape(x) for x in inputs))
        wo = np.empty((*shape, 3), values[0].dtype)
        rest = kernel(*inputs, out=(*(wo[..., k] for k in range(3)), *[None] * (kernel.nout - 3)))[3:]
        return wo, *rest

    def _walk_eval(
        self, wi: Array, wo: Array, rng: Any, n: int, orders: tuple[float, float], radiance: float
    ) -> Any:
        if not (isinstance(n, int | np.integer) and n >= 1):
            raise ValueError(f"{type(self).__name__}.eval: n must be a whole number in [1, inf), got {n!r}")
        shape = np.broadcast_shapes(wi.shape[:-1], wo.shape[:-1])
        elements = np.arange(float(np.prod(shape, dtype=np.int64))).reshape(shape)
        wide = (elements, seed_of(type(self).__name__, rng), radiance, float(n), *orders)
        return self._of("walk_eval", [*xyz(wi), *xyz(wo)], wide)

    def _walk_sample(self, wi: Array, rng: Any, radiance: float) -> tuple[Array, Any, Array]:
        """Directions out, their weights, and how many facets light met."""
        elements = np.arange(float(np.prod(wi.shape[:-1], dtype=np.int64))).reshape(wi.shape[:-1])
        wide = (elements, seed_of(type(self).__name__, rng), radiance)
        wo, weight, order = self._of("walk", xyz(wi), wide)
        # Of the channels, which share a walk, the one that went farthest has its end.
        for _ in self._channels:
            last = np.expand_dims(np.argmax(order, axis=-1), -1)
            order = np.take_along_axis(order, last, axis=-1)[..., 0]
            wo = np.take_along_axis(wo, last[..., np.newaxis], axis=-2)[..., 0, :]
        return wo, weight, np.asarray(order).astype(np.int64)

    def _uniforms(self, xi: ArrayLike, dtype: Any) -> list[Array]:
        array = np.asarray(xi)
        dims = self.sample_dims
        if array.ndim == 0 or array.shape[-1] < dims or array.dtype.kind not in "iuf":
            raise ValueError(
                f"{type(self).__name__}.sample: xi must be real numbers of shape (..., {dims}), "
                f"got {array.dtype} of shape {array.shape}"
            )
        parts = [np.asarray(array[..., k], dtype) for k in range(dims)]
        choice = parts.pop() if self._transmits else parts[-1]
        while len(parts) < 3:  # kernels do not look at more than they need
            parts.append(parts[-1])
        return [*parts, choice]


def xyz(w: Array) -> list[Array]:
    return [w[..., 0], w[..., 1], w[..., 2]]


def seed_of(owner: str, rng: Any) -> float:
    """A seed that a double holds, from a seed, a generator, or the operating system's entropy."""
    if isinstance(rng, int | np.integer) and not isinstance(rng, bool):
        if not 0 <= rng < 2**53:
            raise ValueError(f"{owner}: a seed must lie in [0, 2**53), got {rng}")
        return float(rng)
    try:
        return float(np.random.default_rng(rng).integers(2**53))
    except (TypeError, ValueError):
        raise ValueError(f"{owner}: rng must be a seed or a numpy.random.Generator, got {rng!r}") from None
