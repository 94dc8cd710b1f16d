"""The documented domain: outside it, and for nan, nan; inside it a number, which is the right one.

Every elementwise function of every family, in every build and both precisions.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hostile_numbers as hostile
import microfacet as mf
from accuracy_points import QUANTITIES
from builds import BUILDS, LONG
from shapes import several_shapes

each_family = pytest.mark.parametrize("family", mf.families(), ids=lambda family: family.name)
each_dtype = pytest.mark.parametrize("dtype", [np.float32, np.float64])
each_build = pytest.mark.parametrize("build", BUILDS)
each_quantity = pytest.mark.parametrize("quantity", QUANTITIES)


def function(build: str, family: Any, quantity: str) -> np.ufunc:
    found: np.ufunc = getattr(getattr(BUILDS[build], family.name), quantity)
    return found


def first(quantity: str) -> int:
    """How many arguments stand before the parameters."""
    return 2 if quantity == "P22" else 1


def assert_follows_the_rule(family: Any, quantity: str, columns: list[Any], result: Any) -> None:
    inside, outside = hostile.domain(family, quantity, [*np.broadcast_arrays(*columns)])
    wrong = (inside & ~hostile.possible(quantity, result)) | (outside & ~np.isnan(result))
    rows = [
        ([float(c[i]) for c in np.broadcast_arrays(*columns)], float(result[i]))
        for i in np.flatnonzero(wrong)
    ]
    assert not rows, f"{len(rows)} of {len(result)}, {inside.sum()} of them inside: {rows[:5]}"


# Numbers inside, nan outside


@each_family
@each_dtype
@each_build
def test_any_bits(family: Any, dtype: type, build: str) -> None:
    n = 3000
    for k, quantity in enumerate(QUANTITIES):
        rng = np.random.default_rng([17, k])
        alpha = hostile.roughness(family, rng, n, dtype)
        columns = [hostile.values(quantity, rng, alpha) for _ in range(first(quantity))]
        columns += [alpha, *hostile.shapes(family, rng, n, dtype)]
        assert_follows_the_rule(family, quantity, columns, function(build, family, quantity)(*columns))


SHAPES = several_shapes(
    {"gtr": (0.4, 1.0, 7.3, 1e4), "student_t": (1.6, 30.0, 1e20), "bessel_k": (0.3, 1.7, 2e3)}
)


@each_family
@each_dtype
def test_any_bits_in_long_arrays(family: Any, dtype: type) -> None:
    """Of constant parameters, for which tables are prepared."""
    build, rng = list(BUILDS)[-1], np.random.default_rng(3)
    for shape in SHAPES.get(family.name, (None,)):
        for alpha in (0.3, 1e-12, 1e12, -1.0, math.nan):
            parameters = [dtype(x) for x in (alpha, shape) if x is not None]
            for quantity in QUANTITIES:
                near = np.full(LONG + 5, abs(parameters[0]))
                columns = [hostile.values(quantity, rng, near) for _ in range(first(quantity))]
                result = function(build, family, quantity)(*columns, *parameters)
                assert_follows_the_rule(family, quantity, [*columns, *parameters], result)


@each_family
@each_quantity
@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_any_numbers(family: Any, quantity: str, data: st.DataObject) -> None:
    dtype = data.draw(st.sampled_from([np.float32, np.float64]))
    bits = st.floats(width=8 * np.dtype(dtype).itemsize)
    near = st.floats(1e-9, 1e9) if quantity not in hostile.COSINES else st.floats(-1, 1)
    count = first(quantity)
    row = [data.draw(st.one_of(bits, near)) for _ in range(count)]
    for parameter in family.parameters:
        ends = (max(parameter.lower, -1e3), min(parameter.upper, 1e300))
        row.append(data.draw(st.one_of(bits, st.floats(*ends), st.floats(0.1, 10))))
    with np.errstate(over="ignore", under="ignore"):
        columns = [np.array([x], dtype=dtype) for x in row]
    result = getattr(family.kernels, quantity)(*columns)
    assert_follows_the_rule(family, quantity, columns, result)


@each_family
@each_quantity
@each_dtype
def test_nan_in_any_argument(family: Any, quantity: str, dtype: type) -> None:
    """Also where a branch would skip it: at the normal, on the horizon and below, at slope 0, xi 0, inf."""
    f = getattr(family.kernels, quantity)
    own = [2.4 if shape.lower < 2.4 < shape.upper else shape.pictured for shape in family.parameters[1:]]
    good = [dtype(x) for x in (0.3, *own)]
    if quantity in hostile.COSINES:
        rims = (1.0, 0.0, -0.0, -1.0, -0.4, 0.7)
    elif quantity.startswith("sample"):
        rims = (0.0, 0.5)
    else:
        rims = (0.0, -0.0, 0.5, math.inf) + ((-0.5, -math.inf) if quantity != "survival" else ())
    for x in rims:
        row = [dtype(x)] * first(quantity) + good
        assert not np.isnan(f(*row))
        for i in range(len(row)):
            bad = (math.nan,) if i < first(quantity) else (math.nan, -0.2, 0.0, math.inf)
            for value in bad:
                changed = [dtype(value) if i == j else y for j, y in enumerate(row)]
                assert np.isnan(f(*changed)), changed
                assert np.isnan(f(np.full(LONG, changed[0]), *changed[1:])).all(), changed


# Cosines that rounding takes beyond 1


@each_family
@pytest.mark.parametrize("quantity", hostile.COSINES)
@each_dtype
@each_build
def test_cosines_above_1(family: Any, quantity: str, dtype: type, build: str) -> None:
    f, eps = function(build, family, quantity), np.finfo(dtype).eps
    for alpha in (0.3, 1e-9, 1e9):  # in the arithmetic of either precision
        parameters = [dtype(x) for x in (alpha, 2.4)][: len(family.parameters)]
        for sign in (1, -1):
            inside = (sign * (1 + np.arange(9) * eps)).astype(dtype)
            beyond = (sign * (1 + np.array([9, 20, 1e3, 1e6]) * eps)).astype(dtype)
            for length in (9, LONG):
                values = f(np.resize(inside, length), *parameters)
                np.testing.assert_array_equal(values, f(np.full(length, inside[0]), *parameters))
                assert np.isnan(f(np.resize(beyond, length), *parameters)).all()


@each_dtype
def test_normalised_vectors_are_inside(dtype: type) -> None:
    v = np.random.default_rng(5).standard_normal((100_000, 3)).astype(dtype)
    v /= np.sqrt((v * v).sum(-1, keepdims=True, dtype=dtype))
    squares = np.einsum("ij,ij->i", v, v)
    assert (squares > 1).any()
    for family in mf.families():
        parameters = [dtype(x) for x in (0.3, 2.4)][: len(family.parameters)]
        assert not np.isnan(family.kernels.D(squares, *parameters)).any()
    assert not np.isnan(mf.fresnel_dielectric(squares, dtype(1.5))).any()


@each_dtype
def test_reflectances_know_the_same_cosines(dtype: type) -> None:
    eps = np.finfo(dtype).eps
    inside, beyond = (1 + np.arange(9) * eps).astype(dtype), (1 + np.array([9, 1e3]) * eps).astype(dtype)
    outside = np.concatenate([beyond, -beyond, [60, np.inf, -np.inf, np.nan]]).astype(dtype)
    for f in (
        lambda c: mf.fresnel_dielectric(c, dtype(1.5)),
        lambda c: mf.fresnel_dielectric(c, dtype(0.6)),
        lambda c: mf.fresnel_conductor(c, dtype(0.2), dtype(3)),
        lambda c: mf.fresnel_conductor(c, dtype(np.inf), dtype(0)),
    ):
        np.testing.assert_array_equal(f(inside), f(dtype(1)))
        np.testing.assert_array_equal(f(-inside), f(dtype(1)))
        assert np.isnan(f(outside)).all()
    assert np.isnan(mf.fresnel_conductor(dtype(0.5), dtype(np.inf), dtype(np.nan)))
