"""The same functions through `array_functions`: compiled by JAX, and on NumPy, beside the ufuncs.

All run on one thread. What JAX compiles takes arrays of its own; compiling is no part of the time.
"""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

import microfacet as mf
from microfacet._graphs import shorter_from_tables

from .kernels import PARAMETERS, Inputs, Kernel, arguments, bind
from .suite import DTYPES, Measurement
from .timing import Contender, interleave

ONE_THREAD = "--xla_cpu_multi_thread_eigen=false"
QUANTITIES = ("D", "Lambda")
# XLA takes long over the formulas that tables stand for, and for some more memory than there is.
MEASURED = tuple(
    Kernel(family, quantity, form)
    for family in PARAMETERS
    for quantity in QUANTITIES
    for form in (("u",) if shorter_from_tables[family] else ("u", "varying"))
)


def usable() -> str | None:
    """Why nothing can be measured here, or None."""
    return None if importlib.util.find_spec("jax") else "JAX is not installed (pip install jax)"


def evaluation(kernel: Kernel, library: str, given: tuple[Any, ...]) -> Any:
    """The function of `kernel` on arrays of a library, and what it is called with; parameters as in `given`.

    Numbers are numbers: tables stand for some families' formulas then, as they do for the ufuncs.
    """
    function = getattr(mf.array_functions(kernel.family, library).cosine, kernel.quantity)
    names = tuple(PARAMETERS[kernel.family])
    fixed = {name: value for name, value in zip(names, given[1:], strict=True) if isinstance(value, float)}
    arrays = tuple(value for value in given if isinstance(value, np.ndarray))
    free = tuple(name for name in names if name not in fixed)

    def evaluate(u: Any, *parameters: Any) -> Any:
        return function(u, **fixed, **dict(zip(free, parameters, strict=True)))

    return evaluate, arrays


def on_jax(kernel: Kernel, given: tuple[Any, ...]) -> Any:
    """A call of what JAX has compiled, which waits for its result."""
    import jax

    function, arrays = evaluation(kernel, "jax", given)
    compiled, own = jax.jit(function), [jax.numpy.asarray(array) for array in arrays]
    compiled(*own).block_until_ready()
    return lambda: compiled(*own).block_until_ready()


def on_numpy(kernel: Kernel, given: tuple[Any, ...]) -> Any:
    """The same on NumPy."""
    function, arrays = evaluation(kernel, "numpy", given)
    return partial(function, *arrays)


def measure(kernel: Kernel, inputs: Inputs, seconds: float) -> Measurement:
    """The ufunc and both of its counterparts, interleaved."""
    given = arguments(kernel, inputs)
    calls = {"ours": bind(kernel, inputs), "JAX": on_jax(kernel, given), "NumPy": on_numpy(kernel, given)}
    contenders = [Contender(name, call, inputs.length) for name, call in calls.items()]
    return Measurement.of(kernel.name, inputs, interleave(contenders, seconds))


def run(kernels: tuple[Kernel, ...], length: int, seconds: float) -> Iterator[Measurement]:
    """Measure `kernels` in both precisions."""
    os.environ.setdefault("XLA_FLAGS", ONE_THREAD)  # read when JAX first computes
    import jax

    with jax.enable_x64(True):
        for dtype in DTYPES:
            inputs = Inputs(length, dtype)
            for kernel in kernels:
                yield measure(kernel, inputs, seconds)
