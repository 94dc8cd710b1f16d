"""The builds of the compiled kernels that this machine can run, and arguments that reach everywhere."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet import _core

BUILDS: dict[str, ModuleType] = {name: import_module(f"microfacet._core.{name}") for name in _core.available}
FUSED = [name for name in BUILDS if name != "baseline"]  # round a * b + c once

MATERIALS = ("conductor_", "dielectric_", "diffuse_", "unit_direction")  # see test_bsdf.py, test_walks.py
FROZEN = ("isotropic_", "stretched_")  # prefixes of the ufuncs behind the frozen distributions
LONG = 8192  # from this length on a ufunc with constant shape parameters prepares tables
SPECIAL = (0.0, -0.0, 1.0, -1.0, 0.5, 1e-12, 1e6, np.inf, -np.inf, np.nan)
DIRECTIONS = ("D", "sigma", "Lambda", "G1", "G2", "G2_uncorrelated", "D_visible", "pdf")


def ufuncs(space: Any) -> dict[str, np.ufunc]:
    """All ufuncs of a family in one build: elementwise, isotropic_..., stretched_..."""
    found = {name: f for name, f in vars(space).items() if isinstance(f, np.ufunc)}
    return {name: f for name, f in found.items() if not name.startswith(MATERIALS)}


def loop_types(f: np.ufunc, dtype: type) -> list[np.dtype]:
    """What the loop for values of `dtype` reads; the parameters of frozen distributions are float64."""
    first = np.dtype(dtype).char
    return [np.dtype(c) for c in next(t for t in f.types if t[0] == first).partition("->")[0]]


def _values(name: str, n: int, rng: np.random.Generator, dtype: np.dtype) -> NDArray[Any]:
    quantity = name.removeprefix(FROZEN[0]).removeprefix(FROZEN[1])
    if quantity.startswith("sample"):
        x = rng.random(n)
    elif quantity in DIRECTIONS:
        x = rng.uniform(-1, 1, n)
    else:
        x = rng.choice((-1, 1), n) * 10 ** rng.uniform(-8, 2, n)
    info = np.finfo(dtype)
    special = (*SPECIAL, 1 - info.eps / 2, info.tiny, info.smallest_subnormal, info.max)
    return np.where(rng.random(n) < 0.25, rng.choice(special, n), x).astype(dtype)


def _parameter(lower: float, n: int, rng: np.random.Generator, dtype: np.dtype) -> NDArray[Any]:
    x = lower + 10 ** rng.uniform(-4 if lower < 1e-9 else -2, 1, n)
    return np.where(rng.random(n) < 0.05, rng.choice((lower, -1.0, np.inf, np.nan), n), x).astype(dtype)


def arguments(
    family: Any,
    name: str,
    f: np.ufunc,
    n: int,
    dtype: type = np.float64,
    constant: bool = False,
    seed: int = 1,
) -> list[NDArray[Any]]:
    """Columns of `n` arguments, random and special; `constant` parameters are ordinary and have no axis.

    So are those of the ufuncs behind the frozen distributions.
    """
    rng = np.random.default_rng(seed)
    lower = [p.lower for p in family.parameters]
    if name.startswith("stretched_"):
        lower = [0.0, 0.0, 0.0, *lower[1:]]
    types = loop_types(f, dtype)
    values = [_values(name, n, rng, t) for t in types[: f.nin - len(lower)]]
    if constant or name.startswith(FROZEN):
        return values + [np.array(low + 0.7, t) for low, t in zip(lower, types[len(values) :], strict=True)]
    return values + [_parameter(low, n, rng, t) for low, t in zip(lower, types[len(values) :], strict=True)]


def each(columns: list[NDArray[Any]], change: Callable[[NDArray[Any]], NDArray[Any]]) -> list[NDArray[Any]]:
    """The columns changed; constants have no axis and stay."""
    return [change(c) if c.ndim else c for c in columns]


def bits(x: NDArray[Any]) -> NDArray[Any]:
    """The bits of every number, all nans alike."""
    x = np.ascontiguousarray(x)
    return np.where(np.isnan(x), -1, x.view(np.int32 if x.dtype == np.float32 else np.int64))
