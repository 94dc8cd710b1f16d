"""Values: objects that are what they hold, so that they compare, hash, copy and pickle by it."""

from __future__ import annotations

import math
from typing import Any, Self

import numpy as np

__all__ = ["Value"]

_HASHED = 64  # numbers of an array that its hash depends on: a height map has millions


def _same(a: Any, b: Any) -> bool:
    """Equality in which nan is nan, inside arrays, dictionaries and sequences too."""
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        if type(a) is not type(b) or a.shape != b.shape:
            return False
        return np.array_equal(a, b, equal_nan=a.dtype.kind in "fc" and b.dtype.kind in "fc")
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_same(a[name], b[name]) for name in a)
    if isinstance(a, list | tuple) and type(a) is type(b):
        return len(a) == len(b) and all(map(_same, a, b))
    return bool(a == b) or (isinstance(a, float) and isinstance(b, float) and a != a and b != b)


def _key(value: Any) -> Any:
    """Something that can be hashed, the same for values that are `_same`."""
    if isinstance(value, np.ndarray):
        return value.shape, _key(value.ravel()[:_HASHED].tolist())
    if isinstance(value, dict):
        return frozenset((name, _key(part)) for name, part in value.items())
    if isinstance(value, list | tuple):
        return tuple(map(_key, value))
    return "nan" if isinstance(value, float) and math.isnan(value) else value


def _read_only(value: Any) -> Any:
    """Views of arrays, so that a caller's own stays as it is."""
    if isinstance(value, np.ndarray):
        value = value.view()
        value.flags.writeable = False
    return tuple(map(_read_only, value)) if type(value) is tuple else value


class Value:
    """Base of frozen objects that compare, hash, copy and pickle by what they hold.

    They hold it in `__dict__` or `__slots__`. Their arrays are read-only, in copies too.
    """

    __slots__ = ()

    def _state(self) -> dict[str, Any]:
        """All that it holds, by name."""
        slots = [name for cls in type(self).__mro__ for name in getattr(cls, "__slots__", ())]
        return {**{name: getattr(self, name) for name in slots}, **getattr(self, "__dict__", {})}

    def _record(self, *without: str) -> dict[str, Any]:
        """What it holds but for these, with lists for arrays and tuples, as JSON has them."""
        return {
            name: value.tolist()
            if isinstance(value, np.ndarray)
            else list(value)
            if type(value) is tuple
            else value
            for name, value in self._state().items()
            if name not in without
        }

    def _keep(self, **state: Any) -> Self:
        """The only way to fill it."""
        for name, value in state.items():
            object.__setattr__(self, name, _read_only(value))
        return self

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__} is frozen: {name} cannot be set")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{type(self).__name__} is frozen: {name} cannot be deleted")

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self is other or _same(self._state(), other._state())

    def __hash__(self) -> int:
        return hash((type(self), _key(self._state())))

    def __reduce__(self) -> tuple[Any, ...]:
        return _revived, (type(self), self._state())


def _revived(cls: type[Value], state: dict[str, Any]) -> Value:
    return cls.__new__(cls)._keep(**state)
