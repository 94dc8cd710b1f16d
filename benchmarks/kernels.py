"""What is measured: the table of kernels, and how one is bound to arrays.

A kernel comes in one of five forms:

    u        the ufunc of the family on cosines, parameters constant
    x, y, z  the frozen distribution on separate arrays of a direction's components
    varying  as u, with every parameter an array
    xi       samples from uniform random numbers
    w, xi    samples of the normals that directions see, one for each
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property, partial
from typing import Any

import numpy as np

import microfacet as mf

Array = np.ndarray[Any, Any]
Call = Callable[[], object]

_CHOSEN = {"student_t": 2.5, "bessel_k": 1.7}  # where it is not the value of pictures
PARAMETERS: dict[str, dict[str, float]] = {
    family.name: {
        "alpha": 0.3,
        **{own.name: _CHOSEN.get(family.name, own.pictured) for own in family.parameters[1:]},
    }
    for family in mf.families()
}
#: Samplers of visible normals, by their scheme.
VISIBLE = {"sample_visible": "continuous", "sample_visible_mixture": "mixture"}
#: Where varying parameters are drawn from, evenly.
INTERVALS = {
    "alpha": (0.1, 1.0),
    "gtr": (0.5, 4.0),
    "student_t": (1.6, 10.0),
    "bessel_k": (0.3, 8.0),
}
for _family in mf.families():
    for _own in _family.parameters[1:]:
        INTERVALS.setdefault(_family.name, (_own.examples[0], _own.examples[-1]))


@dataclass(frozen=True)
class Kernel:
    """A quantity of a family in one of the forms above."""

    family: str
    quantity: str
    form: str = "u"

    @property
    def name(self) -> str:
        """As in ``beckmann.D(u)``."""
        return f"{self.family}.{self.quantity}({self.form})"

    def matches(self, pattern: str) -> bool:
        """Whether the name fits a shell pattern."""
        return fnmatchcase(self.name, pattern)


def _table() -> tuple[Kernel, ...]:
    families = tuple(PARAMETERS)
    shaped = tuple(family for family in families if len(PARAMETERS[family]) > 1)
    return (
        *(Kernel(family, quantity) for family in families for quantity in ("D", "Lambda", "sigma")),
        *(Kernel(family, "D", "x, y, z") for family in families),
        *(Kernel(family, "G1", "x, y, z") for family in ("beckmann", "ggx")),
        *(Kernel(family, quantity, "varying") for family in shaped for quantity in ("Lambda", "sigma")),
        *(Kernel(family, "sample_slope", "xi") for family in families),
        *(Kernel(family, "sample", "xi") for family in families),
        *(Kernel(family, quantity, "w, xi") for family in families for quantity in VISIBLE),
    )


KERNELS = _table()


class Inputs:
    """Random arguments of one length and precision, made when first asked for, and room for results.

    Directions are spread evenly over the hemisphere, for sigma over the sphere; so are their cosines.
    """

    def __init__(self, length: int, dtype: str) -> None:
        self.length = length
        self.dtype = np.dtype(dtype)

    def _random(self, seed: int) -> Array:
        rng = np.random.default_rng(seed)
        tiny = np.finfo(self.dtype).eps
        return rng.random(self.length, dtype=self.dtype.type) * (1 - 2 * tiny) + tiny

    @cached_property
    def u(self) -> Array:
        """Cosines in (0, 1)."""
        return self._random(1)

    @cached_property
    def signed_u(self) -> Array:
        """Cosines in (-1, 1)."""
        return 2 * self.u - 1

    @cached_property
    def xi(self) -> Array:
        """Uniform random numbers (4, length): what a distribution samples from, transposed."""
        return np.stack([self._random(seed) for seed in (2, 3, 9, 10)])

    @cached_property
    def direction(self) -> tuple[Array, Array, Array]:
        """Components of unit vectors."""
        azimuth, s = 2 * np.pi * self._random(4), np.sqrt(1 - self.u**2)
        x, y = s * np.cos(azimuth), s * np.sin(azimuth)
        return x.astype(self.dtype), y.astype(self.dtype), self.u

    @cached_property
    def directions(self) -> Array:
        """The same (3, length), in one piece."""
        return np.stack(self.direction)

    @cached_property
    def out(self) -> Array:
        """Room for results, in memory that has been touched."""
        return np.ones(self.length, self.dtype)

    @cached_property
    def normals(self) -> Array:
        """Room for sampled directions (3, length): each component in one piece."""
        return np.ones((3, self.length), self.dtype)

    def varying(self, family: str) -> tuple[Array, ...]:
        """Every parameter of `family`, elementwise."""
        drawn = []
        for seed, name in enumerate(PARAMETERS[family], start=5):
            low, high = INTERVALS["alpha" if name == "alpha" else family]
            drawn.append((low + (high - low) * self._random(seed)).astype(self.dtype))
        return tuple(drawn)


def distribution(family: str) -> Any:
    """The frozen distribution that the form x, y, z is measured on."""
    cls = next(entry.cls for entry in mf.families() if entry.name == family)
    return cls(**PARAMETERS[family])


def arguments(kernel: Kernel, inputs: Inputs) -> tuple[Any, ...]:
    """What the ufunc of `kernel` is called with; the first is an array."""
    first = inputs.signed_u if kernel.quantity == "sigma" else inputs.u
    if kernel.form == "varying":
        return first, *inputs.varying(kernel.family)
    if kernel.form == "x, y, z":
        return inputs.direction
    if kernel.form == "xi":
        first = inputs.xi[0]
    return first, *PARAMETERS[kernel.family].values()


def bind(kernel: Kernel, inputs: Inputs, part: slice = slice(None)) -> partial[Any]:
    """The call that evaluates `kernel` on a part of `inputs` and writes into arrays that exist."""
    if kernel.quantity == "sample":
        sample = distribution(kernel.family).sample
        return partial(sample, inputs.xi[:2, part].T, out=inputs.normals[:, part].T)
    if kernel.quantity in VISIBLE:
        visible = partial(distribution(kernel.family).sample_visible, scheme=VISIBLE[kernel.quantity])
        given = (inputs.directions[:, part].T, inputs.xi[:, part].T)
        return partial(visible, *given, out=inputs.normals[:, part].T)
    if kernel.form == "x, y, z":
        function = getattr(distribution(kernel.family), kernel.quantity)
    else:
        function = getattr(getattr(mf, kernel.family), kernel.quantity)
    given = (a[part] if isinstance(a, np.ndarray) else a for a in arguments(kernel, inputs))
    return partial(function, *given, out=inputs.out[part])
