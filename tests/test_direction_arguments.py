"""How distributions take directions: arrays (..., 3) or components, of any layout, without copies."""

from __future__ import annotations

import inspect
import re
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import microfacet as mf

Array = NDArray[Any]

ONE_DIRECTION = ("D", "pdf", "sigma", "Lambda", "G1")
TWO_DIRECTIONS = ("G2", "D_visible")
each_quantity = pytest.mark.parametrize("name", ONE_DIRECTION + TWO_DIRECTIONS)
each_dtype = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def distributions() -> list[Any]:
    """Every family, and stretched where it can be."""
    found = []
    for family in mf.families():
        values = {p.name: p.lower + 0.8 for p in family.parameters}
        found.append(family.cls(**values))
        if family.anisotropic:
            del values["alpha"]
            found.append(family.cls(alpha_x=0.2, alpha_y=0.6, rotation=0.4, **values))
    return found


each_distribution = pytest.mark.parametrize("ndf", distributions(), ids=repr)


def directions(*shape: int, dtype: type = np.float64, seed: int = 1) -> Array:
    w = np.random.default_rng(seed).normal(size=(*shape, 3))
    return (w / np.linalg.norm(w, axis=-1, keepdims=True)).astype(dtype)


def count(name: str) -> int:
    return 2 if name in TWO_DIRECTIONS else 1


@each_distribution
@each_dtype
def test_components_are_the_same_numbers(ndf: Any, dtype: type) -> None:
    for name in ONE_DIRECTION + TWO_DIRECTIONS:
        method = getattr(ndf, name)
        given = [directions(5, 40, dtype=dtype, seed=i) for i in range(count(name))]
        expected = method(*given)
        assert expected.shape == (5, 40)
        assert expected.dtype == dtype
        components = [w[..., i] for w in given for i in range(3)]
        np.testing.assert_array_equal(method(*components), expected, err_msg=name)
        np.testing.assert_array_equal(method(*(c.copy() for c in components)), expected, err_msg=name)
        single = method(*(w[2, 3] for w in given))
        assert np.ndim(single) == 0
        assert single == expected[2, 3] or np.isnan(expected[2, 3])
        assert method(*(float(c[2, 3]) for c in components)).dtype == np.float64
        if dtype == np.float64:
            np.testing.assert_array_equal(method(*(w.tolist() for w in given)), expected)


@each_distribution
def test_directions_broadcast(ndf: Any) -> None:
    wi, wo = directions(7, 1, seed=2), directions(4, seed=3)
    for name in TWO_DIRECTIONS:
        table = getattr(ndf, name)(wi, wo)
        assert table.shape == (7, 4)
        for i, j in np.ndindex(table.shape):
            np.testing.assert_array_equal(table[i, j], getattr(ndf, name)(wi[i, 0], wo[j]))
    x, y, z = directions(7, seed=4).T
    grid = ndf.D(x[:, None], y[:4], z[:, None])
    assert grid.shape == (7, 4)
    assert grid[5, 2] == ndf.D(x[5], y[2], z[5])
    for name in ONE_DIRECTION:
        assert getattr(ndf, name)(np.empty((0, 3))).shape == (0,)
        assert getattr(ndf, name)(np.empty((2, 0, 3))).shape == (2, 0)


LAYOUTS: dict[str, Callable[[Array], Array]] = {
    "Fortran order": np.asfortranarray,
    "components apart": lambda w: np.ascontiguousarray(w.T).T,
    "padded to four": lambda w: np.concatenate([w, w[..., :1]], axis=-1)[..., :3],
    "reversed": lambda w: w[::-1].copy()[::-1],
    "byte-swapped": lambda w: w.astype(w.dtype.newbyteorder()),
    "unaligned": lambda w: np.frombuffer(b"_" + w.tobytes(), w.dtype, offset=1).reshape(w.shape),
    "read-only": lambda w: np.frombuffer(w.tobytes(), w.dtype).reshape(w.shape),
}


@each_distribution
@each_dtype
def test_layouts_of_directions(ndf: Any, dtype: type) -> None:
    for name in ONE_DIRECTION + TWO_DIRECTIONS:
        given = [directions(50, dtype=dtype, seed=i) for i in range(count(name))]
        expected = getattr(ndf, name)(*given)
        for label, layout in LAYOUTS.items():
            got = getattr(ndf, name)(*map(layout, given))
            np.testing.assert_array_equal(got, expected, err_msg=f"{name}, {label}")


@each_quantity
def test_out_and_where(name: str) -> None:
    for ndf in distributions():
        method = getattr(ndf, name)
        given = [directions(60, seed=i) for i in range(count(name))]
        expected = method(*given)
        out = np.full(180, -7.0)
        target = out[::3]
        assert method(*given, out=target) is target
        np.testing.assert_array_equal(target, expected)
        assert (np.delete(out, np.s_[::3]) == -7).all()
        chosen = given[0][:, 0] > 0
        partial = method(*given, out=np.full(60, -7.0), where=chosen)
        np.testing.assert_array_equal(partial, np.where(chosen, expected, -7))
        components = [w[:, i].copy() for w in given for i in range(3)]
        assert method(*components, out=components[0]) is components[0]
        np.testing.assert_array_equal(components[0], expected)


def test_out_and_where_of_slopes() -> None:
    p, q = np.random.default_rng(5).normal(size=(2, 60))
    for ndf in distributions():
        for name, given in (("P22", (p, q)), ("P2", (p,)), ("slope_cdf", (p,))):
            expected, out = getattr(ndf, name)(*given), np.full(60, -7.0)
            assert getattr(ndf, name)(*given, out=out, where=p > 0) is out
            np.testing.assert_array_equal(out, np.where(p > 0, expected, -7))
            assert getattr(ndf, name)(*(s.astype(np.float32) for s in given)).dtype == np.float32


@each_distribution
def test_samples(ndf: Any) -> None:
    xi = np.random.default_rng(6).random((5, 8, 2))
    m = ndf.sample(xi)
    assert m.shape == (5, 8, 3)
    assert ndf.sample(xi.astype(np.float32)).dtype == np.float32
    out = np.full((8, 5, 6), -7.0)
    target = out.transpose(1, 0, 2)[..., ::2]
    assert ndf.sample(xi, out=target) is target
    np.testing.assert_array_equal(target, m)
    assert (out[..., 1::2] == -7).all()
    assert ndf.sample(xi[0, 0]).shape == (3,)
    assert ndf.sample(np.empty((0, 2))).shape == (0, 3)


# No copies


def peak(call: Callable[[], object]) -> int:
    """Bytes that a call held at most at one time, beyond those that it returned."""
    call()
    tracemalloc.start()
    try:
        result = call()
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    return most - sum(r.nbytes for r in (result if isinstance(result, tuple) else (result,)))


@each_quantity
@each_dtype
def test_nothing_is_copied(name: str, dtype: type) -> None:
    """Results aside, a call holds no more than a block, of arrays, views and broadcasts."""
    n = 200_000
    given = [directions(n, dtype=dtype, seed=i) for i in range(count(name))]
    components = [w[:, i] for w in given for i in range(3)]
    out = np.empty(n, dtype)
    for ndf in (mf.GGX(alpha=0.3), mf.StudentT(alpha_x=0.2, alpha_y=0.5, gamma=2.5)):
        method = getattr(ndf, name)
        for call in (
            lambda method=method: method(*given),
            lambda method=method: method(*components),
            lambda method=method: method(*(w[::-2] for w in given)),
            lambda method=method: method(*(np.broadcast_to(w[0], (n, 3)) for w in given)),
        ):
            assert peak(call) < 100_000
        tracemalloc.start()
        try:
            method(*given, out=out)
            assert tracemalloc.get_traced_memory()[1] < 100_000
        finally:
            tracemalloc.stop()


# Blocks of dask


def test_dask_directions_stay_lazy() -> None:
    da = pytest.importorskip("dask.array")
    w = directions(5000)
    lazy = da.from_array(w, chunks=(700, 3))
    for ndf in distributions():
        expected = ndf.sigma(w)
        parts = ndf.sigma(lazy[:, 0], lazy[:, 1], lazy[:, 2])
        assert isinstance(parts, da.Array)
        np.testing.assert_array_equal(parts.compute(scheduler="threads"), expected)
        whole = ndf.sigma(lazy)
        assert isinstance(whole, da.Array)
        np.testing.assert_array_equal(whole.compute(scheduler="threads"), expected)


# Errors are one sentence


@each_quantity
def test_wrong_shapes_and_counts(name: str) -> None:
    ndf = mf.GGX(alpha=0.3)
    names = list(inspect.signature(getattr(ndf, name)).parameters)[: count(name)]
    good = [[0.0, 0.6, 0.8]] * (count(name) - 1)
    for bad in ([0.0, 1.0], 0.5, np.empty((3, 2)), "up"):
        shape = re.escape(str(np.shape(bad)))
        with pytest.raises(
            ValueError, match=rf"^GGX\.{name}: {names[0]} must have shape \(\.\.\., 3\), got {shape}$"
        ):
            getattr(ndf, name)(bad, *good)
    wanted = rf"^GGX\.{name}: give {' and '.join(names)} as arrays \(\.\.\., 3\), or x, y and z of each; got"
    for given in (2 * count(name), 4 * count(name) + 1):
        if name in TWO_DIRECTIONS or given == 2:
            with pytest.raises(TypeError, match=f"{wanted} {given} arguments$"):
                getattr(ndf, name)(*(0.5,) * given)
    with pytest.raises(ValueError, match="broadcast"):
        getattr(ndf, name)(*(np.ones(3), np.ones(4), np.ones(3)) * count(name))
    with pytest.raises(TypeError):
        getattr(ndf, name)(*([[0.0, 0.6, 0.8j]] * count(name)))


def test_wrong_samples() -> None:
    ndf = mf.GGX(alpha=0.3)
    for bad in (0.5, [0.5], np.empty((2, 3))):
        shape = re.escape(str(np.shape(bad)))
        with pytest.raises(
            ValueError, match=rf"^GGX\.sample: xi must have shape \(\.\.\., 2\), got {shape}$"
        ):
            ndf.sample(bad)
    for out in (np.empty((4, 2)), np.empty((4, 4)), np.empty((5, 3)), np.empty(3)):
        shape = re.escape(str(out.shape))
        with pytest.raises(ValueError, match=rf"^GGX\.sample: out must have shape \(4, 3\), got {shape}$"):
            ndf.sample(np.full((4, 2), 0.5), out=out)
