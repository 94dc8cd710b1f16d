"""Calls of functions on arrays, beside the library's own, for the tests of each array library."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import microfacet as mf

Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class Case:
    """A quantity: what it takes, and the method of frozen distributions or materials that says what it is."""

    name: str
    takes: tuple[str, ...]
    material: str = ""

    @property
    def samples(self) -> bool:
        """Whether it draws directions."""
        return self.name.startswith("sample")

    def of(self, functions: Any) -> Callable[..., Any]:
        """The function on arrays."""
        return getattr(getattr(functions, self.material) if self.material else functions, self.name)

    def __str__(self) -> str:
        return f"{self.material}.{self.name}" if self.material else self.name


QUANTITIES = (
    Case("D", ("m",)),
    Case("P22", ("p", "q")),
    Case("P2", ("p",)),
    Case("slope_cdf", ("p",)),
    Case("sigma", ("w",)),
    Case("Lambda", ("w",)),
    Case("G1", ("w",)),
    Case("G2", ("wi", "wo")),
    Case("D_visible", ("m", "w")),
    Case("pdf", ("m",)),
    Case("sample", ("xi",)),
    Case("sample_visible", ("w", "xi")),
)
MATERIALS = tuple(
    Case(name, ("wi", "xi") if name == "sample" else ("wi", "wo"), material)
    for material in ("conductor", "dielectric")
    for name in ("eval", "pdf", "sample")
)
CASES = QUANTITIES + MATERIALS
METALS = {"conductor": {"eta": 0.8, "k": 2.5}, "dielectric": {"eta": 1.5}}


def shape_of(family: mf.Family) -> dict[str, float]:
    """Parameters in the middle of their domains."""
    return {
        p.name: 0.3 if p.name == "alpha" else min(p.lower + 1.25, (p.lower + p.upper) / 2)
        for p in family.parameters
    }


def directions(count: int, rng: np.random.Generator, *, lowest: float = 1e-3) -> Array:
    """On the whole sphere, many near the horizon, none closer to it than `lowest`."""
    z = np.where(rng.random(count) < 0.7, rng.uniform(lowest, 1, count), lowest ** rng.random(count))
    z *= np.where(rng.random(count) < 0.5, 1, -1)
    azimuth, s = rng.uniform(0, 2 * np.pi, count), np.sqrt(1 - z * z)
    return np.stack([s * np.cos(azimuth), s * np.sin(azimuth), z], -1)


def inputs(count: int, dtype: str, alpha: float, seed: int = 1) -> dict[str, Array]:
    """Arguments for all cases: slopes into the tails, directions above and below the horizon."""
    rng = np.random.default_rng(seed)
    found = {name: directions(count, rng) for name in ("m", "w", "wi", "wo")}
    found["w"][found["w"][:, 2] < -0.8] *= -1  # straight down sigma leaves the range of float32
    found |= {name: alpha * np.tan(rng.uniform(-1.5, 1.5, count)) for name in ("p", "q")}
    found["xi"] = rng.uniform(1e-4, 1 - 1e-4, (count, 4))
    return {name: values.astype(dtype) for name, values in found.items()}


def truth(case: Case, ndf: Any, given: dict[str, Array]) -> list[Array]:
    """What the library says in double precision, as a list of its results."""
    own = ndf
    if case.material:
        own = getattr(mf, case.material.capitalize())(ndf, *METALS[case.material].values())
    arguments = [given[name].astype(np.float64) for name in case.takes]
    if case.name == "sample":
        arguments[-1] = arguments[-1][:, : own.sample_dims if case.material else 2]
    with np.errstate(invalid="ignore"):  # where nothing is seen
        result = getattr(own, case.name)(*arguments)
    return list(result) if isinstance(result, tuple) else [result]


def errors(case: Case, got: Array, want: Array) -> Array:
    """Between directions their distance; else relative, where values are in the range of both formats."""
    if want.ndim == 2:
        off = np.linalg.norm(got - want, axis=-1)
        off[np.isnan(want).all(axis=-1)] = 0  # graphs have no guards against directions that see nothing
        return np.where(np.isnan(off), np.inf, off)
    with np.errstate(all="ignore"):
        found = np.abs(got / want - 1)
    found[(np.abs(want) < 1e-30) & (np.abs(got) < 1e-29)] = 0  # sums of what is subnormal
    if got.dtype == np.float32:  # whose tails have fewer digits: 5e-5 where what is near 1 has 2e-5
        with np.errstate(all="ignore"):
            found[np.abs(np.log(np.abs(want))) > 20] *= 0.4
    found[(got == want) | (np.isnan(got) & np.isnan(want))] = 0
    return np.where(np.isnan(found), np.inf, found)
