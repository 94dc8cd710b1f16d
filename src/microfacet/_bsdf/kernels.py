"""What the kernels of a material are given: unit directions, uniform numbers, constants, seeds of walks."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._arrays import Argument, as_array
from microfacet._calls import constructor
from microfacet._frozen import Distribution
from microfacet._value import Value

__all__ = [
    "NO_ORDER",
    "MaterialKernels",
    "directions_of",
    "in_one_type",
    "lit",
    "number",
    "seed_of",
    "uniforms_of",
    "xyz",
]

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
    array.flags.writeable = False
    return array


def in_one_type(*directions: Array) -> list[Array]:
    """float64 unless all are float32."""
    single = all(array.dtype == np.float32 for array in directions)
    return [np.asarray(array, np.float32 if single else np.float64) for array in directions]


class MaterialKernels(Value):
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

    def _freeze(
        self, ndf: Distribution, scattering: str, constants: tuple[Array, ...], **others: object
    ) -> None:
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
        self._keep(ndf=ndf, scattering=scattering, _constants=constants, **others)

    def _pdf(self, wi: Array, wo: Array) -> Any:
        """`pdf` of NumPy arrays."""
        raise NotImplementedError

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

    def _directions(self, method: str, **directions: ArrayLike) -> list[Argument]:
        return directions_of(f"{type(self).__name__}.{method}", **directions)

    def _units(self, *directions: Array) -> list[Array]:
        """Of unit length, as the kernels make all directions: where Python itself looks at cosines."""
        found = []
        for w in in_one_type(*directions):
            found.append(np.empty(w.shape, w.dtype))
            self.ndf.kernels.unit_direction(*xyz(w), *self.ndf._values, out=tuple(xyz(found[-1])))
        return found

    @property
    def _channels(self) -> tuple[int, ...]:
        return np.broadcast_shapes(*(constant.shape for constant in self._constants))

    def _of(
        self,
        operation: str,
        values: list[Array],
        wide: tuple[Any, ...],
        constants: tuple[Array, ...] | None = None,
    ) -> Any:
        """A kernel at values (...), for every channel of the material: (..., *channels).

        Of a kernel with several results the first three are a direction: (..., *channels, 3). Each run of its
        loop prepares the distribution: it runs over the elements for one channel after the other, or over the
        channels where these are more.
        """
        constants = self._constants if constants is None else constants
        channels = np.broadcast_shapes(*(constant.shape for constant in constants))
        shape = np.broadcast_shapes(*(np.shape(value) for value in (*values, *wide)))
        dtype, counts = values[0].dtype, (math.prod(shape), math.prod(channels))
        over_channels = counts[0] < counts[1]

        def of_elements(value: Any) -> Any:
            if np.ndim(value) == 0 and not isinstance(value, np.ndarray):
                return value
            flat = np.broadcast_to(value, shape).reshape(-1)
            return flat[:, np.newaxis] if over_channels else flat

        def of_channels(constant: Array) -> Array:
            flat = np.broadcast_to(_within(constant, dtype), channels).reshape(-1)
            return flat if over_channels else flat[:, np.newaxis]

        def result(out: Array, *own: int) -> Any:
            ordered = out if over_channels else np.moveaxis(out, 0, 1)
            return ordered.reshape((*shape, *channels, *own))[()]

        kernel, ordered = self._kernel(operation), counts if over_channels else counts[::-1]
        inputs = (*map(of_elements, values), *map(of_channels, constants), *map(of_elements, wide))
        outs = [np.empty(ordered, dtype) for _ in range(kernel.nout)]
        if kernel.nout < 3:
            kernel(*inputs, *self.ndf._values, out=tuple(outs))
            return result(outs[0]) if kernel.nout == 1 else tuple(map(result, outs))
        wo = np.empty((*ordered, 3), dtype)
        kernel(*inputs, *self.ndf._values, out=(*xyz(wo), *outs[3:]))
        return result(wo, 3), *map(result, outs[3:])

    def _walk_sample(
        self, wi: Array, elements: Array, *, seed: float, radiance: float
    ) -> tuple[Array, Any, Array]:
        """Directions out, their weights, and how many facets light met."""
        wo, weight, order = self._of("walk", xyz(wi), (elements, seed, radiance))
        # Of the channels, which share a walk, the one that went farthest has its end.
        for _ in self._channels:
            last = np.expand_dims(np.argmax(order, axis=-1), -1)
            order = np.take_along_axis(order, last, axis=-1)[..., 0]
            wo = np.take_along_axis(wo, last[..., np.newaxis], axis=-2)[..., 0, :]
        return wo, weight, np.asarray(order).astype(np.int64)

    def _of_facet_and_choice(self, xi: Array, dtype: Any) -> list[Array]:
        """The four uniform numbers of kernels, which do not look at more than they need."""
        given = narrowed(xi, dtype)
        parts = [given[..., k] for k in range(given.shape[-1])]
        choice = parts.pop() if self._transmits else parts[-1]
        return [*parts, *[parts[-1]] * (3 - len(parts)), choice]


def directions_of(owner: str, **directions: ArrayLike) -> list[Argument]:
    """Arrays (..., 3) of real numbers, for `lifted`."""
    return [(_real(owner, name, given, 3, exactly=True), "w") for name, given in directions.items()]


def uniforms_of(owner: str, xi: ArrayLike | None, dims: int) -> Argument:
    """An array (..., dims) of uniform numbers, of which there may be more, for `lifted`."""
    if xi is None:
        raise ValueError(f"{owner}: give xi, of shape (..., {dims})")
    return _real(owner, "xi", xi, dims, exactly=False)[..., :dims], "xi"


def _real(owner: str, name: str, given: ArrayLike, length: int, *, exactly: bool) -> Any:
    array = as_array(given)
    last = array.shape[-1] if array.ndim else 0
    if last < length or (exactly and last != length) or array.dtype.kind not in "iuf":
        raise ValueError(
            f"{owner}: {name} must be real numbers of shape (..., {length}), "
            f"got {array.dtype} of shape {array.shape}"
        )
    return array


def narrowed(xi: Array, dtype: Any) -> Array:
    """Uniform numbers in another type, in which those below 1 stay below 1."""
    result = np.asarray(xi, dtype)
    if np.can_cast(xi.dtype, dtype):
        return result
    rounded = (result == 1) & (xi < 1)
    return np.where(rounded, np.nextafter(result.dtype.type(1), 0), result) if rounded.any() else result


def _within(constant: Array, dtype: Any) -> Array:
    """An optical constant in the type of a kernel that holds its reciprocal too: beyond, nothing changes."""
    most = 2.0 ** (np.finfo(dtype).maxexp - 3)
    inside = (constant > 0) & (constant < np.inf)
    return np.where(inside, np.clip(constant, 1 / most, most), constant).astype(dtype)


def xyz(w: Array) -> list[Array]:
    return [w[..., 0], w[..., 1], w[..., 2]]


def lit(wi: Array, wo: Array) -> Array:
    """Cosine of `wo` where both are above the surface, else 0; nan for nan."""
    i, o = wi[..., 2], wo[..., 2]
    return np.asarray(np.where(i > 0, np.maximum(o, 0), 0) + 0 * (i + o))


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
