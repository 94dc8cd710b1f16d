"""What functions on arrays are given, as the inputs of graphs: components of one precision, checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from microfacet._export.libraries import Library

__all__ = ["UNIFORMS", "Arguments"]

#: How graphs call uniform numbers.
UNIFORMS = ("xi.x", "xi.y", "xi.z", "xi.w", "choice")

_REAL = ("float", "bfloat", "int", "uint", "bool")  # how the types are called whose numbers are real
_COMPONENTS = "xyzw"


class Arguments:
    """The arguments of a call, by their names.

    Parameters
    ----------
    owner : str
        The function that is called, for messages.
    library : Library
    vectors : mapping
        Directions and uniform numbers, whose last axis holds components.
    numbers : mapping
        All other arguments: they broadcast against the leading axes of the vectors.
    """

    def __init__(
        self, owner: str, library: Library, vectors: Mapping[str, Any], numbers: Mapping[str, Any]
    ) -> None:
        self._owner, self._library = owner, library
        self._vectors = {name: self._array(name, value) for name, value in vectors.items()}
        self._numbers = {name: self._array(name, value) for name, value in numbers.items()}
        given = [a for a in (*self._vectors.values(), *self._numbers.values()) if library.is_array(a)]
        self.precision = library.precision(given)
        self._place = library.place_of(given)

    def _array(self, name: str, value: Any) -> Any:
        """An array of real numbers, or one of Python's numbers as it is."""
        if isinstance(value, bool | int | float) and not self._library.is_array(value):
            return value
        if not self._library.is_array(value):
            try:
                value = self._library.from_values(value)
            except (TypeError, ValueError, RuntimeError):
                raise self._not_real(name, repr(value)) from None
        dtype = str(value.dtype).removeprefix("torch.")
        if not dtype.startswith(_REAL):
            raise self._not_real(name, dtype)
        return value

    def _not_real(self, name: str, got: str) -> ValueError:
        return ValueError(f"{self._owner}: {name} must be real numbers, got {got}")

    def inputs(self, names: Sequence[str], precision: str) -> list[Any]:
        """The inputs of a graph with these names, in its precision.

        Raises
        ------
        ValueError
            If a vector has not the components that the graph takes, or shapes do not broadcast, or the
            library has no double precision.
        """
        found = [self.converted(self._input(name, names), precision) for name in names]
        if any(self._library.precision([array]) != precision for array in found):
            raise ValueError(
                f"{self._owner}: the formulas of this family need double precision; switch it on with "
                'jax.config.update("jax_enable_x64", True), or give the parameters as numbers'
            )
        try:
            np.broadcast_shapes(*(tuple(array.shape) for array in found))
        except ValueError:
            shapes = {name: tuple(np.shape(value)[:-1]) for name, value in self._vectors.items()}
            shapes |= {name: tuple(np.shape(value)) for name, value in self._numbers.items()}
            listed = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
            raise ValueError(f"{self._owner}: these shapes do not broadcast: {listed}") from None
        return found

    def _input(self, name: str, names: Sequence[str]) -> Any:
        vector, dot, component = name.partition(".")
        if name in self._numbers:
            return self._numbers[name]
        counted = sum(other.startswith(f"{vector}.") for other in names)
        if not dot:  # the last of the uniform numbers, by which a material chooses
            vector, counted = "xi", sum(other in UNIFORMS for other in names)
        place = _COMPONENTS.index(component) if dot else counted - 1
        array = self._vectors[vector]
        length = array.shape[-1] if np.ndim(array) else 0
        if length < counted or (length > counted and vector != "xi"):
            raise ValueError(
                f"{self._owner}: {vector} must have shape (..., {counted}), got {tuple(np.shape(array))}"
            )
        return array[..., place]

    def converted(self, value: Any, precision: str) -> Any:
        """A value in a precision."""
        return self._library.asarray(value, precision, self._place)
