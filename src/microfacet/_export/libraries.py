"""The operations of graphs in NumPy, CuPy, JAX and PyTorch, by the names that each of these gives them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, cached_property
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np

from microfacet._optional import installed, needed

__all__ = ["NAMES", "Library", "library_of"]

Turn = Callable[[list[Any]], tuple[list[Any], Any]]

# As NumPy, CuPy and JAX call them; another library says what it calls otherwise.
_FUNCTIONS = {
    **{name: name for name in ("add", "subtract", "multiply", "divide", "minimum", "maximum", "absolute")},
    **{name: name for name in ("sqrt", "floor", "exp", "log", "expm1", "log1p", "sin", "cos")},
    **{name: name for name in ("less", "less_equal", "greater", "greater_equal", "equal", "not_equal")},
    "negate": "negative",
    "pow": "power",
    "select": "where",
    "and": "bitwise_and",
    "or": "bitwise_or",
    "not": "logical_not",
    "shift_left": "left_shift",
    "shift_right": "right_shift",
}


def _multiply_add(a: Any, b: Any, c: Any) -> Any:
    return a * b + c


class Library:
    """A library of the interface of NumPy, such as CuPy.

    Parameters
    ----------
    name : str
    xp : module
        Its functions.
    """

    functions = _FUNCTIONS
    block: int | None = None  # how many elements are evaluated at a time
    native = True  # whether it computes log1p, expm1, sin and cos of float32 quickly; else they are spelt out
    differentiates = ""  # whose rules its derivatives follow

    def __init__(self, name: str, xp: ModuleType) -> None:
        self.name = name
        self.xp: Any = xp

    @cached_property
    def operations(self) -> dict[str, Callable[..., Any]]:
        """What a graph's operations are that take values alone."""
        return {
            **{name: getattr(self.xp, function) for name, function in self.functions.items()},
            "multiply_add": _multiply_add,
            "shift_right_logical": self.shift_right_logical,
            "bits": self.bits,
            "from_bits": self.from_bits,
        }

    def shift_right_logical(self, a: Any, by: Any) -> Any:
        """A shift that brings zeros, of integers that have a sign."""
        width = 8 * a.dtype.itemsize
        return (a >> by) & ~((~(a ^ a) << (width - 1 - by)) << 1)

    def bits(self, x: Any) -> Any:
        """Real numbers as integers of the same bits."""
        return x.view(f"i{x.dtype.itemsize}")

    def from_bits(self, i: Any) -> Any:
        """The inverse of `bits`."""
        return i.view(f"f{i.dtype.itemsize}")

    def place_of(self, arrays: Sequence[Any]) -> str:
        """Where arrays lie, if constants must lie there, too."""
        return ""

    def literal(self, value: Any, dtype: str, place: str) -> Any:
        """A number of that type."""
        return np.dtype(dtype).type(value)

    def table(self, values: Any, place: str) -> Any:
        """A table as an array."""
        return self.xp.asarray(values)

    def take(self, table: Any, index: Any) -> Any:
        """Elements of a table; any where the index lies outside, which only lanes do that do not count."""
        return self.xp.take(table, index, mode="clip")

    def broadcast(self, value: Any, shape: tuple[int, ...]) -> Any:
        """A value in a shape."""
        return value if tuple(value.shape) == shape else self.xp.broadcast_to(value, shape)

    def loop(self, most: int, moving: Any, states: list[Any], turn: Turn) -> list[Any]:
        """Turns of the lanes that move, until none does or `most` were made."""
        for _ in range(most):
            if not bool(moving.any()):
                break
            following, unsettled = turn(states)
            pairs = zip(following, states, strict=True)
            states = [self.xp.where(moving, new, old) for new, old in pairs]
            moving = moving & unsettled
        return states

    def is_array(self, values: Any) -> bool:
        """Whether values have a precision of their own; Python's numbers take that of the arrays."""
        return hasattr(values, "dtype")

    def precision(self, arrays: Sequence[Any]) -> str:
        """The precision of results: that of the arrays or, without any, of the library's own numbers."""
        found = self.xp.result_type(*(array.dtype for array in arrays)) if arrays else np.dtype(float)
        return "float32" if found in (np.float16, np.float32) else "float64"

    def from_values(self, values: Any) -> Any:
        """An array of what is not yet one, such as a list."""
        return self.xp.asarray(values)

    def asarray(self, values: Any, dtype: str, place: str) -> Any:
        """Numbers as an array of that precision."""
        return self.xp.asarray(values, dtype=dtype)

    def stack(self, parts: Sequence[Any]) -> Any:
        """Arrays of one shape as the components of one array."""
        return self.xp.stack(tuple(parts), axis=-1)


class NumPy(Library):
    """Evaluated in blocks whose intermediate values stay in the cache."""

    block = 1 << 15


class Jax(Library):
    """Loops that `jit` and `vmap` understand."""

    native = False  # on the processor XLA calls the C library's sine for one number after the other
    differentiates = "jax"

    @cached_property
    def _lax(self) -> Any:
        return import_module("jax").lax

    def bits(self, x: Any) -> Any:
        """Real numbers as integers of the same bits."""
        return self._lax.bitcast_convert_type(x, f"i{x.dtype.itemsize}")

    def from_bits(self, i: Any) -> Any:
        """The inverse of `bits`."""
        return self._lax.bitcast_convert_type(i, f"f{i.dtype.itemsize}")

    def table(self, values: Any, place: str) -> Any:
        """A table as it is: an array of JAX would belong to the function that is just being traced."""
        return values

    def loop(self, most: int, moving: Any, states: list[Any], turn: Turn) -> list[Any]:
        """As of `Library`, in one operation."""

        def goes_on(carried: Any) -> Any:
            count, moving, _ = carried
            return (count < most) & self.xp.any(moving)

        def turned(carried: Any) -> Any:
            count, moving, states = carried
            following, unsettled = turn(states)
            pairs = zip(following, states, strict=True)
            return count + 1, moving & unsettled, [self.xp.where(moving, new, old) for new, old in pairs]

        begin = (0, self.xp.asarray(moving), [self.xp.asarray(state) for state in states])
        return list(self._lax.while_loop(goes_on, turned, begin)[2])

    def precision(self, arrays: Sequence[Any]) -> str:
        """By JAX's own rules; double only where it is switched on."""
        found = self.xp.result_type(*arrays, float) if arrays else self.xp.result_type(float)
        return "float64" if found == np.float64 else "float32"


class Torch(Library):
    """On the device of the arguments."""

    differentiates = "torch"

    functions = {  # noqa: RUF012
        **_FUNCTIONS,
        "pow": "pow",
        "equal": "eq",
        "shift_left": "bitwise_left_shift",
        "shift_right": "bitwise_right_shift",
    }

    def shift_right_logical(self, a: Any, by: Any) -> Any:
        """A shift that brings zeros, of integers that have a sign."""
        width = 8 * a.element_size()
        return (a >> by) & ~((~(a ^ a) << (width - 1 - by)) << 1)

    def bits(self, x: Any) -> Any:
        """Real numbers as integers of the same bits."""
        return x.view(self.xp.int32 if x.dtype == self.xp.float32 else self.xp.int64)

    def from_bits(self, i: Any) -> Any:
        """The inverse of `bits`."""
        return i.view(self.xp.float32 if i.dtype == self.xp.int32 else self.xp.float64)

    def place_of(self, arrays: Sequence[Any]) -> str:
        """The device of the tensors."""
        return next((str(array.device) for array in arrays if self.is_array(array)), "cpu")

    def literal(self, value: Any, dtype: str, place: str) -> Any:
        """A tensor without dimensions."""
        return self.xp.tensor(value, dtype=getattr(self.xp, dtype), device=place)

    def table(self, values: Any, place: str) -> Any:
        """A table as a tensor."""
        return self.literal(values.tolist(), values.dtype.name, place)

    def take(self, table: Any, index: Any) -> Any:
        """Elements of a table."""
        return table[index.clamp(0, len(table) - 1).long()]

    def broadcast(self, value: Any, shape: tuple[int, ...]) -> Any:
        """A value in a shape."""
        return value.expand(shape)

    def is_array(self, values: Any) -> bool:
        """Whether it is a tensor."""
        return isinstance(values, self.xp.Tensor)

    def precision(self, arrays: Sequence[Any]) -> str:
        """By PyTorch's own rules."""
        real = [array for array in arrays if array.dtype.is_floating_point]
        types = {array.dtype for array in real if array.ndim > 0} or {array.dtype for array in real}
        found = self.xp.get_default_dtype() if not types else types.pop()
        for other in types:
            found = self.xp.promote_types(found, other)
        return "float64" if found == self.xp.float64 else "float32"

    def from_values(self, values: Any) -> Any:
        """A tensor of what is not yet one, such as a list."""
        return self.xp.as_tensor(values)

    def asarray(self, values: Any, dtype: str, place: str) -> Any:
        """Numbers as a tensor of that precision on that device."""
        return self.xp.as_tensor(values, dtype=getattr(self.xp, dtype), device=place)

    def stack(self, parts: Sequence[Any]) -> Any:
        """Arrays of one shape as the components of one array."""
        return self.xp.stack(tuple(parts), dim=-1)


_LIBRARIES: dict[str, tuple[str, type[Library]]] = {
    "numpy": ("numpy", NumPy),
    "cupy": ("cupy", Library),
    "jax": ("jax.numpy", Jax),
    "torch": ("torch", Torch),
}
NAMES = tuple(_LIBRARIES)


@cache
def _library(name: str) -> Library:
    module, kind = _LIBRARIES[name]
    if name == "cupy" and not installed(name):  # no extra brings it: its wheels are named by CUDA's version
        raise ImportError("functions on arrays of CuPy need cupy, which is not installed", name=name)
    with needed(f"functions on arrays of {name} need"):
        return kind(name, import_module(module))


def library_of(xp: Any) -> Library:
    """The library of that name, or which a module belongs to.

    Raises
    ------
    ValueError
        If it is none of them.
    ImportError
        If it is not installed.
    """
    name = xp if isinstance(xp, str) else getattr(xp, "__name__", "")
    top = name.removeprefix("array_api_compat.").partition(".")[0]
    if top not in _LIBRARIES:
        raise ValueError(f"array_functions: xp must be one of {', '.join(NAMES)}, got {xp!r}")
    return _library(top)
