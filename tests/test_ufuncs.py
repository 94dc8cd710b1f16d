"""What every ufunc of the families is: real, documented, picklable, silent, nan outside its domain.

test_numpy_behaviour.py has NumPy's own rules, for each kind of loop.
"""

from __future__ import annotations

import math
import pickle
import threading
import time
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from microfacet._docs import QUANTITIES

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
def test_pickles_by_name(family: Any, name: str) -> None:
    f = kernel(family, name)
    assert pickle.loads(pickle.dumps(f)) is f


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
