"""Graphs of free shapes and from tables alone, in single precision: accurate, and short enough to be used."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import microfacet as mf
from microfacet._graphs import exact_in_float32, record, shorter_from_tables

# Those whose kernels take tables or double precision instead.
FAMILIES = [family for family in mf.families() if shorter_from_tables[family.name]]
FREE = [family for family in FAMILIES if exact_in_float32[family.name]]
ALONE = [family for family in FAMILIES if not exact_in_float32[family.name]]
# Smaller values are left out: of others, as docs/export.md leaves them out.
LEAST = {"gtr": 1e-30, "bessel_k": 1e-30}
COUNT = 20_000

each_family = pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)

Array = np.ndarray[Any, Any]


def shapes(family: mf.Family, count: int, least: float) -> dict[str, Array]:
    """Roughness from 0.01 to 1, shapes from `least` inside their ends to 50 above the lower one."""
    rng = np.random.default_rng(1)
    found = {}
    for p in family.parameters:
        between = (0.01, 1.0) if p.name == "alpha" else (p.lower + least, min(p.lower + 50, p.upper - least))
        found[p.name] = np.exp(rng.uniform(*np.log(between), count)).astype(np.float32).astype(float)
    return found


def directions(u: Array) -> Array:
    """At these cosines, rounded to single precision."""
    s, turn = np.sqrt(1 - u * u), np.random.default_rng(2).uniform(0, 6.28, len(u))
    return np.stack([s * np.cos(turn), s * np.sin(turn), u], -1).astype(np.float32).astype(float)


def cosines(w: Array) -> Array:
    return np.asarray(w[:, 2] / np.linalg.norm(w, axis=1))


def relative(got: Array, want: Array, least: float) -> Array:
    """Where numbers of single precision can tell values from nothing, which is almost everywhere."""
    told = (want > least) & (want < 1e30)
    assert np.count_nonzero(told) > (0.85 if least < 1e-20 else 0.7) * len(want)
    return np.asarray(np.abs(got[told] / want[told] - 1))


def single(functions: Any, name: str, *arguments: Array, **parameters: Any) -> Array:
    """In float32."""
    narrow = {key: np.float32(value) for key, value in parameters.items()}
    found = getattr(functions, name)(*(a.astype(np.float32) for a in arguments), **narrow)
    assert found.dtype == np.float32
    return np.asarray(found, np.float64)


@each_family
def test_values_keep_their_digits_in_single_precision(family: mf.Family) -> None:
    """Directions down to 1e-3 above and below the horizon, normals from 1e-3 of the roughness to grazing."""
    rng, functions = np.random.default_rng(3), mf.array_functions(family.name)
    shape = shapes(family, COUNT, least=0.05)
    slope = shape["alpha"] * 10 ** rng.uniform(-3, 1.5, COUNT)
    grazing = rng.random(COUNT) < 0.1
    m = directions(np.where(grazing, 10 ** rng.uniform(-3, 0, COUNT), 1 / np.sqrt(1 + slope**2)))
    u = 10 ** rng.uniform(-3, 0, COUNT) * np.where(rng.random(COUNT) < 0.5, 1, -1)
    w, above = directions(u), directions(np.abs(u))
    for name, at in (("D", m), ("sigma", w), ("Lambda", above), ("G1", above)):
        want = getattr(family.kernels, name)(cosines(at), *shape.values())
        errors = relative(single(functions, name, at, **shape), want, LEAST.get(family.name, 1e-20))
        assert errors.max() < 2e-5, f"{name}: {errors.max():.1e}"


@each_family
@pytest.mark.parametrize("seed", range(8))
def test_normals_are_those_of_the_library(family: mf.Family, seed: int) -> None:
    """For one shape each, as far below the horizon as single precision sees anything."""
    rng = np.random.default_rng(seed)
    shape = {name: float(values[seed]) for name, values in shapes(family, 8, least=0.3).items()}
    ndf, functions = family.cls(**shape), mf.array_functions(family.name)
    w = directions(10 ** rng.uniform(-3, 0, 2000) * np.where(rng.random(2000) < 0.7, 1, -1))
    # Where tables in single precision see less, the one step that they take starts too far.
    w = w[ndf.sigma(w) > (1e-17 if family in ALONE else 1e-30)]
    xi = rng.uniform(1e-4, 1 - 1e-4, (len(w), 3)).astype(np.float32).astype(float)
    for name, arguments in (("sample", (xi[:, :2],)), ("sample_visible", (w, xi))):
        apart = np.linalg.norm(
            single(functions, name, *arguments, **shape) - getattr(ndf, name)(*arguments), axis=1
        )
        assert np.quantile(apart, 0.999, method="higher") < 1e-4, name
        assert not np.isnan(apart).any()


def test_slopes_across_are_found_where_tails_are_steep() -> None:
    """A step that starts far beyond the end of a density and one from the middle may not undo each other."""
    ndf, functions = (
        mf.GeneralisedExponential(alpha=0.02, g=4.1),
        mf.array_functions("generalised_exponential"),
    )
    rng = np.random.default_rng(3)
    w = directions(10 ** rng.uniform(-3, 0, 10_000))
    xi = rng.uniform(1e-4, 1 - 1e-4, (len(w), 3)).astype(np.float32).astype(float)
    want = ndf.sample_visible(w, xi)
    narrow = single(functions, "sample_visible", w, xi, alpha=0.02, g=4.1)
    assert np.quantile(np.linalg.norm(narrow - want, axis=1), 0.9998, method="higher") < 1e-4
    # An array, so that formulas are taken instead of tables.
    wide = functions.sample_visible(w, xi, alpha=0.02, g=np.array(4.1))
    assert np.linalg.norm(wide - want, axis=1).max() < 1e-9


def operations(graph: dict[str, Any]) -> int:
    return sum(
        op not in ("literal", "input", "state", "loop_result", "branch_result") for op in graph["operation"]
    )


@pytest.mark.parametrize("family", FREE, ids=lambda family: family.name)
def test_sums_are_loops_and_graphs_are_short(family: mf.Family) -> None:
    free = dict.fromkeys(p.name for p in family.parameters)
    most = {"D": 400, "P2": 450, "sigma": 1000, "Lambda": 1000, "sample": 500, "sample_visible": 9000}
    for name, size in most.items():
        count = operations(record(family.name, name, free))
        assert count <= size, f"{name}: {count}"
    assert record(family.name, "Lambda", free)["loops"]


@pytest.mark.parametrize("family", ALONE, ids=lambda family: family.name)
def test_graphs_from_tables_alone_are_short(family: mf.Family) -> None:
    """Without the tables there is no graph: no formula of these families is accurate in single precision."""
    tables = family.cls.kernels.tables(False)
    most = {"D": 60, "P2": 60, "sigma": 60, "Lambda": 60, "sample": 80, "sample_visible": 1500}
    for name, size in most.items():
        with pytest.raises(ValueError, match=f"^{family.name} is recorded from its tables"):
            record(family.name, name, {"alpha": None})
        count = operations(record(family.name, name, {"alpha": None}, tables=tables))
        assert count <= size, f"{name}: {count}"
