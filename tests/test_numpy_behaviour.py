"""What NumPy users expect of the ufuncs.

Nothing here asks whether a value is right (test_laws.py does): only that it does not depend on dtype,
layout, threads or the way in which it is asked for, and that bad input is met as NumPy meets it.
"""

from __future__ import annotations

import math
import pickle
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import microfacet as mf

QUANTITIES = ("D", "P22", "P2", "slope_cdf", "sigma", "Lambda", "G1", "survival", "sample_slope", "sample_u")
KERNELS = [(family, name) for family in mf.families() for name in QUANTITIES]
X = np.array([0.05, 0.21, 0.34, 0.5, 0.62, 0.78, 0.97])  # a valid u, slope, radius and xi alike

each_kernel = pytest.mark.parametrize(
    ("family", "name"), KERNELS, ids=[f"{family.name}.{name}" for family, name in KERNELS]
)
each_family = pytest.mark.parametrize("family", mf.families(), ids=lambda family: family.name)


def kernel(family: Any, name: str) -> np.ufunc:
    return getattr(family.kernels, name)


def parameters(family: Any) -> tuple[float, ...]:
    """A typical value of each parameter, inside its open interval."""
    return tuple(
        0.3 if p.name == "alpha" else min(p.lower + 1.25, (p.lower + p.upper) / 2) for p in family.parameters
    )


def arguments(family: Any, name: str, x: Any = X) -> tuple[Any, ...]:
    """`x` in place of the variable (of both slopes for P22), then the parameters."""
    return (x,) * (2 if name == "P22" else 1) + parameters(family)


# Types


@each_kernel
def test_is_a_real_ufunc(family: Any, name: str) -> None:
    f = kernel(family, name)
    assert isinstance(f, np.ufunc)
    assert f.__name__ == name
    assert (f.nin, f.nout) == (len(arguments(family, name)), 1)
    assert f.types == ["f" * f.nin + "->f", "d" * f.nin + "->d"]
    assert f.signature is None
    assert "Examples" in (f.__doc__ or "")


@each_kernel
@pytest.mark.parametrize(
    ("given", "result"),
    [
        (np.float16, np.float32),
        (np.float32, np.float32),
        (np.float64, np.float64),
        (np.bool_, np.float64),  # with a Python float, as in np.add
        (np.int8, np.float64),
        (np.int32, np.float64),
        (np.uint64, np.float64),
    ],
)
def test_dtype_of_result(family: Any, name: str, given: type, result: type) -> None:
    f = kernel(family, name)
    x = np.array([0, 1, 1], dtype=given)
    values = f(*arguments(family, name, x))  # the parameters are Python floats: they widen no float
    assert values.dtype == result
    alone = np.float32 if np.dtype(given).itemsize <= 2 else result
    assert f(x, *(np.ones(1, given),) * (f.nin - 1)).dtype == alone
    same = f(*arguments(family, name, x.astype(result)))
    np.testing.assert_array_equal(values, same)


@each_kernel
def test_python_numbers_and_mixed_precision(family: Any, name: str) -> None:
    f = kernel(family, name)
    value = f(*arguments(family, name, 0.5))
    assert type(value) is np.float64
    assert type(f(*arguments(family, name, np.float32(0.5)))) is np.float32
    wide = (np.float32(0.5),) * (f.nin - len(family.parameters)) + tuple(map(np.float64, parameters(family)))
    assert type(f(*wide)) is np.float64
    assert f(*wide) == value
    assert f(*arguments(family, name, [0.5]), dtype=np.float32).dtype == np.float32


@each_kernel
@pytest.mark.parametrize(
    "x",
    [
        np.array([0.5], dtype=object),
        np.array([0.5 + 0j]),
        0.5j,
        "0.5",
        None,
        np.array(["2026-01-01"], dtype="datetime64[D]"),
        np.zeros(1, dtype=[("u", float)]),
    ],
    ids=["object", "complex array", "complex", "str", "None", "datetime", "structured"],
)
def test_other_types_are_refused(family: Any, name: str, x: Any) -> None:
    with pytest.raises(TypeError):
        kernel(family, name)(*arguments(family, name, x))


@each_kernel
def test_wrong_number_of_arguments(family: Any, name: str) -> None:
    f = kernel(family, name)
    with pytest.raises(TypeError):
        f(*arguments(family, name)[:-1])
    with pytest.raises(TypeError):
        f(*arguments(family, name), 1.0, 1.0)


# Shapes


@each_kernel
def test_every_argument_broadcasts(family: Any, name: str) -> None:
    f = kernel(family, name)
    centre = arguments(family, name, 0.5)
    axes = [np.array([0.9, 1.0, 1.07]) * value for value in centre]
    values = f(*np.ix_(*axes))
    assert values.shape == (3,) * f.nin
    for index in np.ndindex(values.shape):
        one = f(*(axis[i] for axis, i in zip(axes, index, strict=True)))
        assert values[index] == one


@each_kernel
def test_empty_and_zero_dimensional(family: Any, name: str) -> None:
    f = kernel(family, name)
    for shape in ((0,), (3, 0), (0, 2, 1)):
        assert f(*arguments(family, name, np.empty(shape))).shape == shape
    zero_d = f(*arguments(family, name, np.array(0.5)))
    assert np.ndim(zero_d) == 0
    assert zero_d == f(*arguments(family, name, np.array([0.5])))[0]


@each_kernel
def test_shapes_that_do_not_match(family: Any, name: str) -> None:
    with pytest.raises(ValueError, match="broadcast"):
        kernel(family, name)(*arguments(family, name)[:-1], np.ones(X.size + 1))


# Layouts: the same bits, whatever the memory looks like


def unaligned(x: np.ndarray) -> np.ndarray:
    buffer = np.zeros(x.nbytes + 1, dtype=np.uint8)
    view = buffer[1:].view(x.dtype).reshape(x.shape)
    view[...] = x
    assert not view.flags.aligned
    return view


def read_only(x: np.ndarray) -> np.ndarray:
    frozen = x.copy()
    frozen.flags.writeable = False
    return frozen


LAYOUTS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "strided": lambda x: np.repeat(x, 3, axis=-1)[..., ::3],
    "reversed": lambda x: x[..., ::-1].copy()[..., ::-1],
    "fortran": np.asfortranarray,
    "transposed": lambda x: x.T.copy().T,
    "read-only": read_only,
    "byte-swapped": lambda x: x.astype(x.dtype.newbyteorder()),
    "unaligned": unaligned,
    "row of a record": lambda x: np.rec.fromarrays([np.zeros(x.shape, np.int8), x], names="pad,x").x,
}


@each_kernel
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_layouts(family: Any, name: str, dtype: type) -> None:
    f = kernel(family, name)
    x = np.tile(X, (4, 5)).astype(dtype) * np.linspace(0.2, 1, 4, dtype=dtype)[:, None]
    expected = f(*arguments(family, name, x))
    for label, layout in LAYOUTS.items():
        given = layout(x)
        np.testing.assert_array_equal(f(*arguments(family, name, given)), expected, err_msg=label)
        np.testing.assert_array_equal(given, x, err_msg=f"{label}: the input changed")
    for length in range(x.shape[1]):
        short = f(*arguments(family, name, x[0, :length]))
        np.testing.assert_array_equal(short, expected[0, :length], err_msg=f"length {length}")


@each_kernel
def test_parameter_arrays_in_any_layout(family: Any, name: str) -> None:
    f = kernel(family, name)
    variables = (X,) * (f.nin - len(family.parameters))
    varied = tuple(p * np.linspace(0.95, 1.05, X.size) for p in parameters(family))
    expected = f(*variables, *varied)
    for label in ("strided", "reversed", "byte-swapped", "unaligned"):
        changed = tuple(LAYOUTS[label](p) for p in varied)
        np.testing.assert_array_equal(f(*variables, *changed), expected, err_msg=label)


# Where the results go


@each_kernel
def test_out_where_in_place(family: Any, name: str) -> None:
    f = kernel(family, name)
    expected = f(*arguments(family, name))

    out = np.full(2 * X.size, -7.0)
    assert f(*arguments(family, name), out=out[::2]) is not None
    np.testing.assert_array_equal(out[::2], expected)
    assert (out[1::2] == -7).all()

    chosen = X > 0.4
    partial = f(*arguments(family, name), out=np.full(X.shape, -7.0), where=chosen)
    np.testing.assert_array_equal(partial, np.where(chosen, expected, -7))

    x = X.copy()
    assert f(*arguments(family, name, x), out=x) is x
    np.testing.assert_array_equal(x, expected)

    overlapping = np.concatenate([X, [0.0]])
    f(*arguments(family, name, overlapping[:-1]), out=overlapping[1:])
    np.testing.assert_array_equal(overlapping[1:], expected)


@each_kernel
def test_out_must_fit(family: Any, name: str) -> None:
    f = kernel(family, name)
    with pytest.raises(TypeError):
        f(*arguments(family, name), out=np.empty(X.shape, dtype=np.int64))
    with pytest.raises(ValueError, match="broadcast"):
        f(*arguments(family, name), out=np.empty(X.size + 1))
    with pytest.raises(ValueError, match="read-only"):
        f(*arguments(family, name), out=read_only(X))
    with pytest.raises(TypeError):
        f(*arguments(family, name), dtype=np.float32, casting="no")
    narrow = np.empty(X.shape, dtype=np.float32)
    f(*arguments(family, name), out=narrow)  # same_kind: computed in float64, stored in float32
    np.testing.assert_array_equal(narrow, f(*arguments(family, name)).astype(np.float32))


# Outside the domain, and at its rim: silent, whatever errstate says


@each_kernel
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_bad_values_give_nan_silently(family: Any, name: str, dtype: type) -> None:
    f = kernel(family, name)
    good = arguments(family, name, 0.5)
    first_parameter = f.nin - len(family.parameters)
    with np.errstate(all="raise"):
        for i in range(f.nin):
            bad = [math.nan] if i < first_parameter else [math.nan, 0.0, -0.0, -1.0, math.inf, -math.inf]
            for value in bad:
                # an array longer than a SIMD register, with one good neighbour on each side
                column = np.array([good[i], value, good[i]] * 3, dtype=dtype)
                given = [column if j == i else dtype(v) for j, v in enumerate(good)]
                result = f(*given)
                assert np.isnan(result[1::3]).all(), (i, value)
                assert np.isfinite(np.delete(result, np.s_[1::3])).all(), (i, value)


@each_family
@pytest.mark.parametrize("name", ["sigma", "Lambda", "G1"])
def test_parameter_intervals_are_open(family: Any, name: str) -> None:
    f = kernel(family, name)
    good = parameters(family)
    for i, parameter in enumerate(family.parameters):
        for bound in (parameter.lower, parameter.upper):
            assert np.isnan(f(0.5, *good[:i], bound, *good[i + 1 :])), (parameter.name, bound)


@each_family
def test_cosines_and_xi_outside_their_domain(family: Any) -> None:
    good = parameters(family)
    with np.errstate(all="raise"):
        for name in ("D", "sigma", "Lambda", "G1"):
            for u in (-1.0000001, 1.0000001, -5.0, 5.0, math.inf, -math.inf):
                assert np.isnan(kernel(family, name)(u, *good)), (name, u)
        for name in ("sample_slope", "sample_u"):
            for xi in (-1e-9, 1.0, 1.5, -math.inf, math.inf):
                value = kernel(family, name)(xi, *good)
                # xi = 1 may be read as the limit, the infinite slope; nothing else has a meaning
                limit = {"sample_slope": math.inf, "sample_u": 0.0}[name]
                assert np.isnan(value) or (xi == 1 and value == limit), (name, xi)


@each_family
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_infinite_slopes_have_limits(family: Any, dtype: type) -> None:
    good = tuple(map(dtype, parameters(family)))
    infinity = dtype(math.inf)
    with np.errstate(all="raise"):
        assert kernel(family, "P22")(infinity, dtype(0.5), *good) == 0
        assert kernel(family, "P2")(-infinity, *good) == 0
        assert kernel(family, "survival")(infinity, *good) == 0
        assert kernel(family, "slope_cdf")(infinity, *good) == 1
        assert kernel(family, "slope_cdf")(-infinity, *good) == 0


@each_kernel
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_subnormals_and_huge_values_are_silent(family: Any, name: str, dtype: type) -> None:
    f = kernel(family, name)
    info = np.finfo(dtype)
    extremes = np.array([0, info.smallest_subnormal, info.tiny / 4, info.tiny], dtype=dtype)
    if name in ("P22", "P2", "slope_cdf", "survival"):
        extremes = np.append(extremes, [info.max / 2, info.max]).astype(dtype)
    small = np.array([info.smallest_subnormal, info.tiny, info.max], dtype=dtype)
    with np.errstate(all="raise"):
        values = f(*arguments(family, name, extremes))
        assert not np.isnan(values).any(), values
        f(*(dtype(0.5),) * (f.nin - len(family.parameters)), small, *parameters(family)[1:])
    # The loops may flush subnormals to zero inside; the processor's mode outside must be as before.
    assert (np.array([info.smallest_subnormal], dtype=dtype) * dtype(1))[0] > 0
    assert info.tiny / dtype(2) > 0


def test_errstate_of_the_caller_survives() -> None:
    with np.errstate(all="raise"):
        mf.ggx.D(0.5, -1.0)
        with pytest.raises(FloatingPointError):
            np.divide(1.0, 0.0)


# Ufunc machinery


@each_kernel
def test_pickles_by_name(family: Any, name: str) -> None:
    f = kernel(family, name)
    assert pickle.loads(pickle.dumps(f)) is f


def test_outer_and_subclasses() -> None:
    table = np.array([[mf.k0.P2(p, alpha) for alpha in (0.1, 0.2)] for p in X])
    np.testing.assert_array_equal(mf.k0.P2.outer(X, [0.1, 0.2]), table)
    masked = mf.k0.P2(np.ma.masked_greater(X, 0.5), 0.3)
    assert isinstance(masked, np.ma.MaskedArray)
    assert masked.mask.sum() == (X > 0.5).sum()


def test_the_lock_is_released_while_a_loop_runs() -> None:
    """A second thread makes progress while the first sits in one long call, or in a longer one."""
    x = np.linspace(0.01, 0.99, 4_000)
    begin = time.thread_time()
    mf.bessel_k.Lambda(x, 0.3, np.full(x.shape, 1.3))  # an array, or else a long call is prepared and short
    seconds = time.thread_time() - begin
    half = max(1, int(0.5 / max(seconds, 1e-6)))  # times x for about half a second
    found = [ticks_inside(np.resize(x, half * x.size))]
    while found[-1] < 5 and len(found) < 5:
        found.append(ticks_inside(np.resize(x, half * x.size * 2 ** len(found))))
    assert found[-1] >= 5, f"{found} ticks in calls of half a second and more"


def ticks_inside(x: Any) -> int:
    """How often another thread ran in the middle of one call."""
    ticks: list[float] = []
    done = threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    a = np.full(x.shape, 1.3)
    begin = time.perf_counter()
    mf.bessel_k.Lambda(x, 0.3, a)
    end = time.perf_counter()
    done.set()
    thread.join()
    # With the lock held the other thread could not tick at all between begin and end.
    return sum(begin + 0.1 * (end - begin) < t < begin + 0.9 * (end - begin) for t in ticks)


def test_threads_agree() -> None:
    x = np.linspace(-0.99, 0.99, 20_000)
    expected = mf.student_t.sigma(x, 0.3, 2.5)
    results: dict[int, np.ndarray] = {}

    def work(i: int) -> None:
        results[i] = mf.student_t.sigma(x, 0.3, 2.5)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for i in range(4):
        np.testing.assert_array_equal(results[i], expected)
