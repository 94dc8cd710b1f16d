"""What materials are given, as their kernels take it: constants, directions, uniform numbers, seeds."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._arrays import Argument, as_array

__all__ = [
    "directions_of",
    "flag",
    "in_one_type",
    "in_range",
    "lit",
    "narrowed",
    "number",
    "seed_of",
    "uniforms_of",
    "xyz",
]

Array = NDArray[Any]
_FLAGS = (np.array(0.0), np.array(1.0))
_SINGLE, _DOUBLE = np.dtype(np.float32), np.dtype(np.float64)


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


def flag(option: bool) -> Array:
    """An option as kernels take it."""
    return _FLAGS[option]


def in_one_type(*directions: Array) -> list[Array]:
    """float64 unless all are float32."""
    for array in directions:
        if array.dtype is not _DOUBLE:
            break
    else:
        return [*directions]
    single = all(array.dtype == _SINGLE for array in directions)
    return [np.asarray(array, _SINGLE if single else _DOUBLE) for array in directions]


def directions_of(owner: Any, method: str, **directions: ArrayLike) -> list[Argument]:
    """Arrays (..., 3) of real numbers, for `lifted`."""
    found = []
    for name, given in directions.items():
        array = as_array(given)
        if array.shape[-1:] != (3,) or array.dtype.kind not in "fiu":
            raise _not_real(owner, method, name, array, 3)
        found.append((array, "w"))
    return found


def uniforms_of(owner: Any, method: str, xi: ArrayLike | None, dims: int) -> Argument:
    """An array (..., dims) of uniform numbers, of which there may be more, for `lifted`."""
    if xi is None:
        raise ValueError(f"{type(owner).__name__}.{method}: give xi, of shape (..., {dims})")
    array = as_array(xi)
    if array.ndim == 0 or array.shape[-1] < dims or array.dtype.kind not in "fiu":
        raise _not_real(owner, method, "xi", array, dims)
    return array[..., :dims], "xi"


def _not_real(owner: Any, method: str, name: str, array: Any, length: int) -> ValueError:
    return ValueError(
        f"{type(owner).__name__}.{method}: {name} must be real numbers of shape (..., {length}), "
        f"got {array.dtype} of shape {array.shape}"
    )


def narrowed(xi: Array, dtype: Any) -> Array:
    """Uniform numbers in another type, in which those below 1 stay below 1."""
    result = np.asarray(xi, dtype)
    if np.can_cast(xi.dtype, dtype):
        return result
    rounded = (result == 1) & (xi < 1)
    return np.where(rounded, np.nextafter(result.dtype.type(1), 0), result) if rounded.any() else result


def in_range(constant: Array, dtype: Any) -> Array:
    """An optical constant in the type of a kernel that holds its reciprocal too: beyond, nothing changes."""
    most = 2.0 ** (np.finfo(dtype).maxexp - 3)
    inside = (constant > 0) & (constant < np.inf)
    return np.where(inside, np.clip(constant, 1 / most, most), constant).astype(dtype)


def xyz(w: Array) -> list[Array]:
    return [w[..., 0], w[..., 1], w[..., 2]]


def lit(i: Array, o: Array) -> Array:
    """The cosine `o` of a direction out where it and that of light are positive, else 0; nan for nan."""
    return np.asarray(np.where(i > 0, np.maximum(o, 0), 0) + 0 * (i + o))


def seed_of(owner: str, rng: Any) -> Array:
    """A seed that a double holds, from a seed, a generator, or the operating system's entropy."""
    if isinstance(rng, int | np.integer) and not isinstance(rng, bool):
        if not 0 <= rng < 2**53:
            raise ValueError(f"{owner}: a seed must lie in [0, 2**53), got {rng}")
        return np.array(float(rng))
    try:
        return np.array(float(np.random.default_rng(rng).integers(2**53)))
    except (TypeError, ValueError):
        raise ValueError(f"{owner}: rng must be a seed or a numpy.random.Generator, got {rng!r}") from None
