"""What NumPy users expect of ufuncs, for every kind of loop that there is.

NumPy's rules of types, shapes and layouts hold for a kind of loop. What each kernel is asked for is in
test_ufuncs.py, its bits in any layout in test_instruction_sets.py. Nothing here asks whether a value is right
(test_laws.py does): only that it does not depend on dtype, layout or the way in which it is asked for, and
that bad input is met as NumPy meets it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from microfacet import _core

X = np.array([0.05, 0.21, 0.34, 0.5, 0.62, 0.78, 0.97])  # a valid u, slope, radius, xi and component alike


@dataclass(frozen=True)
class Loop:
    """A ufunc, how many variables it takes, and the parameters that it takes then, inside their domain."""

    f: np.ufunc
    variables: int
    parameters: tuple[float, ...]

    def arguments(self, x: Any = X) -> tuple[Any, ...]:
        """`x` in place of every variable, then the parameters."""
        return (x,) * self.variables + self.parameters

    def __call__(self, *arguments: Any) -> Any:
        """All results as one array, whose last axes are those of the result."""
        return np.stack(self.f(*arguments)) if self.f.nout > 1 else self.f(*arguments)


STRETCHED, TABLES = mf.GGX(alpha_x=0.2, alpha_y=0.5, rotation=0.4), mf.BesselK(alpha=0.3, a=1.25)
PUBLIC = {
    "float32 arithmetic": Loop(mf.ggx.D, 1, (0.3,)),
    "float32 arithmetic, two variables": Loop(mf.beckmann.P22, 2, (0.3,)),
    "float32 arithmetic, an inverse": Loop(mf.k0.sample_slope, 1, (0.3,)),
    "float64 arithmetic": Loop(mf.student_t.sigma, 1, (0.3, 2.75)),
    "float64 arithmetic, two variables": Loop(mf.gtr.P22, 2, (0.3, 1.25)),
    "float64 arithmetic, an inverse": Loop(mf.bessel_k.sample_u, 1, (0.3, 1.25)),
    "optics": Loop(_core.fresnel_conductor, 1, (0.2, 3.0)),
}
FROZEN = {
    "directions": Loop(STRETCHED.kernels.stretched_D, 3, STRETCHED._values),
    "directions from tables": Loop(TABLES.kernels.stretched_Lambda, 3, TABLES._values),
    "slopes": Loop(TABLES.kernels.stretched_slope_cdf, 1, TABLES._values),
    "samples": Loop(STRETCHED.kernels.stretched_sample_visible, 6, STRETCHED._values),
    "samples from tables": Loop(TABLES.kernels.stretched_sample_visible, 6, TABLES._values),
    "a material": Loop(STRETCHED.kernels.conductor_eval, 6, (0.2, 3.0, 1.0, 0.0, *STRETCHED._values)),
}
LOOPS = PUBLIC | FROZEN

each_public = pytest.mark.parametrize("loop", PUBLIC.values(), ids=PUBLIC)
each_loop = pytest.mark.parametrize("loop", LOOPS.values(), ids=LOOPS)
each_dtype = pytest.mark.parametrize("dtype", [np.float32, np.float64])


# Types


@each_public
def test_dtype_of_result(loop: Loop) -> None:
    for given, result in (
        (np.float16, np.float32),
        (np.float32, np.float32),
        (np.float64, np.float64),
        (np.bool_, np.float64),  # with a Python float, as in np.add
        (np.int8, np.float64),
        (np.int32, np.float64),
        (np.uint64, np.float64),
    ):
        x = np.array([0, 1, 1], dtype=given)
        values = loop(*loop.arguments(x))  # the parameters are Python floats: they widen no float
        assert values.dtype == result
        alone = np.float32 if np.dtype(given).itemsize <= 2 else result
        assert loop(x, *(np.ones(1, given),) * (loop.f.nin - 1)).dtype == alone
        np.testing.assert_array_equal(values, loop(*loop.arguments(x.astype(result))))


@each_public
def test_python_numbers_and_mixed_precision(loop: Loop) -> None:
    value = loop(*loop.arguments(0.5))
    assert type(value) is np.float64
    assert type(loop(*loop.arguments(np.float32(0.5)))) is np.float32
    wide = (np.float32(0.5),) * loop.variables + tuple(map(np.float64, loop.parameters))
    assert type(loop(*wide)) is np.float64
    assert loop(*wide) == value
    assert loop.f(*loop.arguments([0.5]), dtype=np.float32).dtype == np.float32


@each_loop
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
def test_other_types_are_refused(loop: Loop, x: Any) -> None:
    with pytest.raises(TypeError):
        loop.f(*loop.arguments(x))


@each_loop
def test_wrong_number_of_arguments(loop: Loop) -> None:
    with pytest.raises(TypeError):
        loop.f(*loop.arguments()[:-1])
    with pytest.raises(TypeError):
        loop.f(*loop.arguments(), *(1.0,) * (loop.f.nout + 1))


# Shapes


@each_loop
def test_every_argument_broadcasts(loop: Loop) -> None:
    steps = np.array([0.9, 1.0, 1.07]) if loop.f.nin < 5 else np.array([0.9, 1.07])
    many = loop.f.nin if loop.f.nin < 5 else loop.variables
    axes = [value * (steps if i < many else steps[:1]) for i, value in enumerate(loop.arguments(0.5))]
    values = loop(*np.ix_(*axes))
    shape = tuple(map(len, axes))
    assert values.shape[-len(shape) :] == shape
    for index in np.ndindex(shape):
        one = loop(*(axis[i] for axis, i in zip(axes, index, strict=True)))
        np.testing.assert_array_equal(values[(..., *index)], one)


@each_loop
def test_empty_and_zero_dimensional(loop: Loop) -> None:
    for shape in ((0,), (3, 0), (0, 2, 1)):
        assert loop(*loop.arguments(np.empty(shape))).shape[-len(shape) :] == shape
    zero_d = loop(*loop.arguments(np.array(0.5)))
    assert np.ndim(zero_d) == (loop.f.nout > 1)
    np.testing.assert_array_equal(zero_d, loop(*loop.arguments(np.array([0.5])))[..., 0])


@each_loop
def test_shapes_that_do_not_match(loop: Loop) -> None:
    with pytest.raises(ValueError, match="broadcast"):
        loop.f(*loop.arguments()[:-1], np.ones(X.size + 1))


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


@each_loop
@each_dtype
def test_layouts(loop: Loop, dtype: type) -> None:
    x = np.tile(X, (4, 5)).astype(dtype) * np.linspace(0.2, 1, 4, dtype=dtype)[:, None]
    expected = loop(*loop.arguments(x))
    for label, layout in LAYOUTS.items():
        given = layout(x)
        np.testing.assert_array_equal(loop(*loop.arguments(given)), expected, err_msg=label)
        np.testing.assert_array_equal(given, x, err_msg=f"{label}: the input changed")
    for length in range(x.shape[1]):
        short = loop(*loop.arguments(x[0, :length]))
        np.testing.assert_array_equal(short, expected[..., 0, :length], err_msg=f"length {length}")


@each_public
def test_parameter_arrays_in_any_layout(loop: Loop) -> None:
    variables = (X,) * loop.variables
    varied = tuple(p * np.linspace(0.95, 1.05, X.size) for p in loop.parameters)
    expected = loop(*variables, *varied)
    for label in ("strided", "reversed", "byte-swapped", "unaligned"):
        changed = tuple(LAYOUTS[label](p) for p in varied)
        np.testing.assert_array_equal(loop(*variables, *changed), expected, err_msg=label)


# Where the results go


@each_loop
def test_out_where_in_place(loop: Loop) -> None:
    f, arguments = loop.f, loop.arguments()
    expected = loop(*arguments).reshape(f.nout, -1)

    out = np.full((f.nout, 2 * X.size), -7.0)
    assert f(*arguments, out=tuple(out[:, ::2])) is not None
    np.testing.assert_array_equal(out[:, ::2], expected)
    assert (out[:, 1::2] == -7).all()

    chosen = X > 0.4
    partial = np.full((f.nout, X.size), -7.0)
    f(*arguments, out=tuple(partial), where=chosen)
    np.testing.assert_array_equal(partial, np.where(chosen, expected, -7))

    if f.nout == 1:
        x = X.copy()
        assert f(*loop.arguments(x), out=x) is x
        np.testing.assert_array_equal(x, expected[0])
    overlapping = np.concatenate([X, [0.0]])
    others = [np.empty(X.size) for _ in range(f.nout - 1)]
    f(*loop.arguments(overlapping[:-1]), out=(overlapping[1:], *others))
    np.testing.assert_array_equal(overlapping[1:], expected[0])


@each_loop
def test_out_must_fit(loop: Loop) -> None:
    f, arguments = loop.f, loop.arguments()
    expected = loop(*arguments).reshape(f.nout, -1)

    def outs(like: Any) -> tuple[Any, ...]:
        return (like, *(np.empty(X.shape) for _ in range(f.nout - 1)))

    with pytest.raises(TypeError):
        f(*arguments, out=outs(np.empty(X.shape, dtype=np.int64)))
    with pytest.raises(ValueError, match="broadcast"):
        f(*arguments, out=outs(np.empty(X.size + 1)))
    with pytest.raises(ValueError, match="read-only"):
        f(*arguments, out=outs(read_only(X)))
    with pytest.raises(TypeError):
        f(*arguments, dtype=np.float32, casting="no")
    narrow = np.empty((f.nout, X.size), dtype=np.float32)
    f(*arguments, out=tuple(narrow))  # same_kind: computed in float64, stored in float32
    np.testing.assert_array_equal(narrow, expected.astype(np.float32))


def test_outer_and_subclasses() -> None:
    table = np.array([[mf.k0.P2(p, alpha) for alpha in (0.1, 0.2)] for p in X])
    np.testing.assert_array_equal(mf.k0.P2.outer(X, [0.1, 0.2]), table)
    masked = mf.k0.P2(np.ma.masked_greater(X, 0.5), 0.3)
    assert isinstance(masked, np.ma.MaskedArray)
    assert masked.mask.sum() == (X > 0.5).sum()
