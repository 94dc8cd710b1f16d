"""Constructors that are called wrongly name their own class and say what it takes."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any

__all__ = ["constructor"]


def constructor(init: Callable[..., None]) -> Callable[..., None]:
    """Wrap `__init__` so that the TypeError for wrong arguments names the class of the object.

    Python would name the function, which a family inherits from a class that no user has heard of.
    """
    signature = inspect.signature(init)
    _, *own = signature.parameters.values()
    bare = [parameter.replace(annotation=inspect.Parameter.empty) for parameter in own]
    takes = str(inspect.Signature(bare))

    @functools.wraps(init)
    def checked(self: Any, /, *args: Any, **kwargs: Any) -> None:
        try:
            init(self, *args, **kwargs)
        except TypeError:
            try:
                signature.bind(self, *args, **kwargs)
            except TypeError as error:
                name = type(self).__name__
                raise TypeError(f"{name}: {error}; it is called as {name}{takes}") from None
            raise

    return checked
