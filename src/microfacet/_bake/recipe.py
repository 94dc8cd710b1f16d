"""What a table is: its kind, its grids, and everything else that its numbers depend on."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import microfacet as mf
from microfacet._radial import RadialNDF
from microfacet._user_family import UserFamily, family_of

__all__ = ["KINDS", "Recipe", "entry_of", "grid", "names_of", "one_of", "recipe", "shape_name"]

KINDS = ("albedo", "energy", "split_sum", "bsdf")
MATERIALS = ("conductor", "dielectric")
PROVENANCE = ("command", "date", "version", "numpy")  # recorded besides the recipe
Grid = tuple[float, ...]


@dataclass(frozen=True)
class Recipe:
    """All that the numbers of a table depend on; grids are tuples of float64."""

    kind: str
    family: str
    material: str
    alpha: Grid
    shape_name: str  # of the family's shape parameter, or empty
    shape: Grid
    eta: Grid  # of a dielectric; of a conductor its one value
    k: float
    cos_theta: Grid
    azimuth: Grid
    scattering: str
    walks: int
    seed: int
    density: str = ""  # which one of one's own, by its tables
    entry: Any = field(default=None, compare=False, repr=False)  # the record of the family

    @property
    def outer(self) -> dict[str, Grid]:
        """The grids whose points are cells: computed, and kept, one by one."""
        axes = {"alpha": self.alpha}
        if self.shape_name:
            axes[self.shape_name] = self.shape
        if self.material == "dielectric":
            axes["eta"] = self.eta
        return axes

    @property
    def inner(self) -> dict[str, Grid]:
        """The grids of directions."""
        if self.kind != "bsdf":
            return {"cos_theta": self.cos_theta}
        below = tuple(-c for c in reversed(self.cos_theta)) if self.material == "dielectric" else ()
        return {"cos_theta_i": self.cos_theta, "cos_theta_o": below + self.cos_theta, "azimuth": self.azimuth}

    @property
    def variables(self) -> dict[str, bool]:
        """Names of the results, and whether they depend on the direction."""
        if self.kind == "energy":
            return {"missing": True, "missing_average": False}
        if self.kind == "split_sum":
            return {"scale": True, "bias": True}
        if self.kind == "bsdf":
            return {"f": True}
        if self.material == "conductor":
            return {"single": True, "multiple": True, "multiple_error": True}
        parts = ("reflected", "transmitted")
        names = [f"{order}_{part}" for order in ("single", "multiple") for part in parts]
        return dict.fromkeys([*names, "multiple_error"], True)

    @property
    def attributes(self) -> dict[str, Any]:
        """What is stated with the results, besides the grids."""
        stated: dict[str, Any] = {"kind": self.kind, "family": self.family, "material": self.material}
        if self.material == "conductor":
            stated |= {"eta": next(iter(self.eta), None), "k": self.k}
        if self.scattering:
            stated["scattering"] = self.scattering
        if self.density:
            stated["density"] = self.density
        return stated | {"walks": self.walks, "seed": self.seed}

    @property
    def cells(self) -> int:
        """How many there are."""
        return math.prod(len(axis) for axis in self.outer.values())

    @property
    def cell_shape(self) -> tuple[int, ...]:
        """Of the arrays in a cell."""
        return tuple(len(axis) for axis in self.inner.values())

    @property
    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Of all arrays in a cell, by name."""
        return {name: self.cell_shape if directional else () for name, directional in self.variables.items()}

    @property
    def bytes(self) -> int:
        """Of the table, and a copy of it that is being written."""
        return 2 * 8 * self.cells * math.prod(self.cell_shape) * len(self.variables)

    def cell_parameters(self, cell: int) -> dict[str, float]:
        """Roughness, shape and eta of a cell."""
        axes = self.outer
        at = np.unravel_index(cell, [len(axis) for axis in axes.values()])
        return {name: axis[int(i)] for (name, axis), i in zip(axes.items(), at, strict=True)}

    def ndf(self, cell: int) -> Any:
        """The distribution of a cell."""
        return self.entry.cls(
            **{name: value for name, value in self.cell_parameters(cell).items() if name != "eta"}
        )

    def optics(self, cell: int, scattering: str) -> Any:
        """The material of a cell."""
        if self.material == "dielectric":
            eta = self.cell_parameters(cell)["eta"]
            return mf.Dielectric(self.ndf(cell), eta, mode="importance", scattering=scattering)
        return mf.Conductor(self.ndf(cell), self.eta[0], self.k, scattering=scattering)

    def as_dict(self) -> dict[str, Any]:
        """For a file: equal where the tables are."""
        left_out = {"entry"} if self.density else {"entry", "density"}
        stated = {one.name: getattr(self, one.name) for one in fields(self) if one.name not in left_out}
        return {key: list(v) if isinstance(v, tuple) else v for key, v in stated.items()}


def names_of(kind: str, family: str, material: str, density: str) -> tuple[set[str], set[str]]:
    """The arrays and the attributes of a table of this kind."""
    own = "" if density else shape_name(entry_of("bake", family))
    what = Recipe(
        one_of("bake", "kind", kind, KINDS), family, one_of("bake", "material", material, MATERIALS),
        alpha=(), shape_name=own, shape=(), eta=(), k=0.0, cos_theta=(), azimuth=(),
        scattering="single" if kind == "bsdf" else "", walks=1, seed=0, density=density,
    )  # fmt: skip
    return {*what.variables, *what.outer, *what.inner}, {*what.attributes, *PROVENANCE}


def grid(name: str, values: ArrayLike, owner: str = "bake") -> Grid:
    """Increasing, finite numbers; or one sentence that says what is wrong."""
    try:
        array = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError):
        raise ValueError(f"{owner}: {name} must be numbers, got {values!r:.80}") from None
    if array.ndim != 1 or not array.size or np.isnan(array).any() or not np.all(np.diff(array) > 0):
        raise ValueError(f"{owner}: {name} must be increasing numbers, at least one, got {values!r:.80}")
    return tuple(array.tolist())


def recipe(
    kind: str,
    family: str | UserFamily | RadialNDF,
    *,
    alpha: ArrayLike,
    shape: ArrayLike | None,
    material: str,
    eta: ArrayLike | None,
    k: float,
    cos_theta: ArrayLike | int,
    azimuth: ArrayLike | int,
    scattering: str,
    walks: int,
    seed: int,
) -> Recipe:
    """The recipe of these arguments, or one sentence that says which of them is wrong."""
    entry = entry_of("bake", family)
    own = shape_name(entry)
    one_of("bake", "kind", kind, KINDS)
    one_of("bake", "material", material, MATERIALS)
    one_of("bake", "scattering", scattering, ("single", "multiple"))
    for name, value, lowest in (("walks", walks, 1), ("seed", seed, 0)):
        if not isinstance(value, int | np.integer) or isinstance(value, bool) or not lowest <= value < 2**32:
            raise ValueError(f"bake: {name} must be a whole number in [{lowest}, 2**32), got {value!r}")
    if bool(own) != (shape is not None):
        text = f"needs {own}, its shape" if own else "has no shape parameter"
        raise ValueError(f"bake: {entry.name} {text}")
    if kind == "split_sum" and (material != "conductor" or eta is not None or k != 0):
        raise ValueError(
            "bake: split_sum takes no material, eta or k: it is for the reflectance of any metal"
        )
    if material == "dielectric" and eta is None:
        raise ValueError("bake: a dielectric needs eta")
    if isinstance(cos_theta, int | np.integer):
        cos_theta = np.arange(1, cos_theta + 1) / cos_theta
    if isinstance(azimuth, int | np.integer):
        azimuth = np.linspace(0, np.pi, azimuth)
    result = Recipe(
        kind, entry.name, material,
        alpha=grid("alpha", alpha),
        shape_name=own,
        shape=() if shape is None else grid(own, shape),
        eta=grid("eta", np.inf if eta is None else eta),
        k=float(k),
        cos_theta=grid("cos_theta", cos_theta),
        azimuth=grid("azimuth", azimuth) if kind == "bsdf" else (),
        scattering=scattering if kind == "bsdf" else "",
        walks=int(walks),
        seed=int(seed),
        density=entry.ndf._identity if isinstance(entry, UserFamily) and entry.ndf else "",
        entry=entry,
    )  # fmt: skip
    if not 0 < result.cos_theta[0] <= result.cos_theta[-1] <= 1:
        ends = f"{result.cos_theta[0]:g} to {result.cos_theta[-1]:g}"
        raise ValueError(f"bake: cos_theta must lie in (0, 1], got {ends}")
    if material == "conductor" and len(result.eta) > 1:
        raise ValueError("bake: a conductor takes one eta")
    for cell in (0, result.cells - 1):  # the ends of every grid: constructors say what lies outside
        result.optics(cell, "single")
    return result


def entry_of(owner: str, family: str | UserFamily | RadialNDF) -> Any:
    """The record of a family by its name, or of a density of one's own; ValueError for anything else."""
    if isinstance(family, UserFamily | RadialNDF):
        entry = family if isinstance(family, UserFamily) else family_of(family)
        if entry.ndf is None:
            raise ValueError(f"{owner}: give a RadialNDF, {entry.name} has free parameters")
        return entry
    known = {entry.name: entry for entry in mf.families()}
    return known[one_of(owner, "family", family, known)]


def shape_name(entry: Any) -> str:
    """Of the family's shape parameter, or empty."""
    return next((parameter.name for parameter in entry.parameters if parameter.name != "alpha"), "")


def one_of(owner: str, name: str, value: str, allowed: Iterable[str]) -> str:
    """The value; ValueError where it is none of those."""
    names = list(allowed)
    if value not in names:
        raise ValueError(f"{owner}: {name} must be one of {', '.join(names)}, got {value!r}")
    return value
