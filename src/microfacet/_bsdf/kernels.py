"""Calls of the kernels of a material: one for every channel, on threads where there is enough to do."""

from __future__ import annotations

import math
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from microfacet._bsdf.arguments import flag, in_one_type, in_range, narrowed, xyz
from microfacet._calls import constructor
from microfacet._frozen import Distribution
from microfacet._threads import WORTH_THREADS, blocks, in_threads
from microfacet._value import Value

__all__ = ["NO_ORDER", "WALK", "MaterialKernels"]

Array = NDArray[Any]
NO_ORDER = float(2**31)
WALK = 8.0  # the cost of a walk, in evaluations of a closed form
_WHITE = (np.array(np.inf), np.array(0.0))


class _Call(NamedTuple):
    """A kernel, and what it takes beside directions, uniform numbers and options."""

    kernel: Any
    channels: tuple[int, ...]
    constants: tuple[Array, ...]  # of the shape of the channels
    parameters: tuple[Array, ...]

    def results(self, shape: tuple[int, ...], dtype: np.dtype[Any]) -> list[Array]:
        """New arrays for its results, the first three of which are one direction where there are several."""
        several = self.kernel.nout > 2
        first = np.empty((*shape, 3) if several else shape, dtype)
        return [first, *(np.empty(shape, dtype) for _ in range(self.kernel.nout - (3 if several else 1)))]


def _flat(arrays: list[Array], shape: tuple[int, ...]) -> list[Array]:
    return [array if array.ndim == 0 else np.broadcast_to(array, shape).reshape(-1) for array in arrays]


def _column(array: Array) -> Array:
    return array if array.ndim == 0 else array.reshape(-1, 1)


def _of_channels(call: _Call, values: list[Array], wide: list[Array], count: int, cost: float) -> list[Array]:
    """Results of shape (count, channels).

    Each run of a kernel's loop prepares the distribution: it runs over the elements for one channel after
    the other, or over the channels where these are more.
    """
    channels, dtype = math.prod(call.channels), values[0].dtype
    if count < channels:
        outs = call.results((count, channels), dtype)
        given = [*map(_column, values), *(constant.reshape(-1) for constant in call.constants)]
        _run(call, [*given, *map(_column, wide)], outs, 0.0)
        return outs
    outs = call.results((channels, count), dtype)
    _run(call, [*values, *map(_column, call.constants), *wide], outs, count * channels * cost)
    return [np.moveaxis(out, 0, 1) for out in outs]


def _run(call: _Call, given: list[Array], outs: list[Array], work: float) -> None:
    """Fill `outs`, along whose last axis the elements lie, on threads where there is enough `work`."""
    into = outs if call.kernel.nout < 3 else [*xyz(outs[0]), *outs[1:]]
    arguments = [*given, *call.parameters, *into]

    def part(elements: slice) -> None:
        call.kernel(*(x if x.ndim == 0 or x.shape[-1] == 1 else x[..., elements] for x in arguments))

    if work < WORTH_THREADS or outs[-1].ndim == 0:
        call.kernel(*arguments)
    else:
        in_threads(part, blocks(outs[-1].shape[-1]))


class MaterialKernels(Value):
    """A distribution and optical constants, and calls of their kernels."""

    __slots__ = ("_calls", "_constants", "ndf", "scattering")

    ndf: Distribution
    scattering: str
    _constants: tuple[Array, ...]  # of the material, as the kernels take them
    _calls: dict[tuple[str, np.dtype[Any], bool], _Call]  # made at their first use
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
            raise ValueError(f"{owner}: ndf must be a distribution, got {ndf!r:.80}")
        if scattering not in ("single", "multiple"):
            raise ValueError(f'{owner}: scattering must be "single" or "multiple", got {scattering!r}')
        try:
            np.broadcast_shapes(*(constant.shape for constant in constants))
        except ValueError:
            shapes = " and ".join(str(constant.shape) for constant in constants)
            raise ValueError(f"{owner}: eta and k must have shapes that broadcast, got {shapes}") from None
        self._keep(ndf=ndf, scattering=scattering, _constants=constants, **others)

    def _sample(self, bounded: bool, wi: Array, xi: Array) -> tuple[Any, Any, Any]:
        """`sample` of one order, of NumPy arrays."""
        raise NotImplementedError

    def _pdf(self, wi: Array, wo: Array) -> Any:
        """`pdf` of NumPy arrays."""
        raise NotImplementedError

    @property
    def _radiance(self) -> Array:
        """1 where transmitted light is scaled as radiance, else 0."""
        return flag(False)

    @property
    def sample_dims(self) -> int:
        """How many uniform numbers a sample of single scattering takes."""
        return self.ndf.visible_dims + (1 if self._transmits else 0)

    def _units(self, *directions: Array) -> list[Array]:
        """Normalise directions as the kernels do, for cosines that Python itself needs."""
        found = []
        for w in in_one_type(*directions):
            found.append(np.empty(w.shape, w.dtype))
            self.ndf.kernels.unit_direction(*xyz(w), *self.ndf._arguments, *xyz(found[-1]))
        return found

    def _height(self, w: Array) -> Array:
        """Cosine of a unit direction with the mean normal, which is +z but for a tilted slope table."""
        normal = getattr(self.ndf, "mean_normal", None)
        return w[..., 2] if normal is None else np.asarray(w @ normal, w.dtype)

    def _cosines(self, *directions: Array) -> list[Array]:
        return [self._height(w) for w in self._units(*directions)]

    @property
    def _channels(self) -> tuple[int, ...]:
        return np.broadcast(*self._constants).shape

    def _keep(self, **state: Any) -> Self:
        object.__setattr__(self, "_calls", {})
        return super()._keep(**state)

    def _state(self) -> dict[str, Any]:
        return {name: part for name, part in super()._state().items() if name != "_calls"}

    def _call(self, operation: str, dtype: np.dtype[Any], white: bool) -> _Call:
        """The call of a kernel, made at its first use with a type; a `white` one is of a perfect mirror."""
        key = operation, dtype, white
        call = self._calls.get(key)
        if call is None:
            constants = _WHITE if white else self._constants
            channels = np.broadcast(*constants).shape
            call = self._calls[key] = _Call(
                getattr(self.ndf.kernels, f"{self._name}_{operation}"),
                channels,
                tuple(np.broadcast_to(in_range(constant, dtype), channels) for constant in constants),
                tuple(map(np.array, self.ndf._arguments)),
            )
        return call

    def _of(
        self, operation: str, values: list[Array], wide: list[Array], cost: float = 1.0, white: bool = False
    ) -> Any:
        """A kernel at `values` (...), for every channel of the material: (..., *channels).

        The first three results of a kernel that has several are a direction: (..., *channels, 3). `values`
        have one type, `wide` are float64 always. `cost` is that of an element, in evaluations of a closed
        form.
        """
        call = self._call(operation, values[0].dtype, white)
        shape = np.broadcast(*values).shape
        count = math.prod(shape)
        if len(shape) > 1:  # views, where directions are contiguous
            values, wide = _flat(values, shape), _flat(wide, shape)
        if call.channels:
            outs = _of_channels(call, values, wide, count, cost)
        elif call.kernel.nout == 1 and len(shape) < 2 and count * cost < WORTH_THREADS:
            return call.kernel(*values, *call.constants, *wide, *call.parameters)
        else:
            outs = call.results((count,) if shape else (), values[0].dtype)
            _run(call, [*values, *call.constants, *wide], outs, count * cost)
        if call.channels or len(shape) > 1:
            own = outs[-1].ndim  # axes before the components of a direction
            outs = [out.reshape((*shape, *call.channels, *out.shape[own:])) for out in outs]
        return outs[0][()] if len(outs) == 1 else tuple([out[()] for out in outs])

    def _walk_sample(self, seed: Array, wi: Array, elements: Array) -> tuple[Array, Any, Array]:
        """Walks: directions out, their weights, and the number of facets that light met."""
        wo, weight, order = self._of("walk", xyz(wi), [elements, seed, self._radiance], WALK)
        # Channels share a walk; its end is that of the channel that was followed farthest.
        for _ in self._channels:
            last = np.expand_dims(np.argmax(order, axis=-1), -1)
            order = np.take_along_axis(order, last, axis=-1)[..., 0]
            wo = np.take_along_axis(wo, last[..., np.newaxis], axis=-2)[..., 0, :]
        return wo, weight, np.asarray(order).astype(np.int64)

    def _of_facet_and_choice(self, xi: Array, dtype: Any) -> list[Array]:
        """The four uniform numbers that kernels take: up to three for the facet, and one for the lobe."""
        given = narrowed(xi, dtype)
        parts = [given[..., k] for k in range(given.shape[-1])]
        choice = parts.pop() if self._transmits else parts[-1]
        return [*parts, *[parts[-1]] * (3 - len(parts)), choice]
