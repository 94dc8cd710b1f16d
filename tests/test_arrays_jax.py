"""`array_functions` on JAX: values, `jit`, `vmap` and derivatives, those of samples among them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import microfacet as mf
from array_cases import CASES, METALS, Case, errors, inputs, shape_of, truth
from array_graphs import every_operation, nested_loops
from array_libraries import required
from gradients import POINTS, derivatives, function_of, parameters_of
from microfacet._export.evaluate import Evaluator
from microfacet._export.libraries import library_of
from microfacet._graphs import shorter_from_tables
from test_array_functions import tolerance
from test_array_graphs import check, numbers

jax = required("jax")
jnp = jax.numpy

FAMILIES = [family for family in mf.families() if not shorter_from_tables[family.name]]
each_family = pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)


@pytest.mark.parametrize("real", ["float32", "float64"])
@pytest.mark.parametrize("make", [every_operation, nested_loops], ids=lambda make: make.__name__)
def test_graphs(make: Any, real: str) -> None:
    """Traced, and mapped over single numbers."""
    built, (x, y, _) = make(real), numbers(real)
    with jax.enable_x64(real == "float64"):
        evaluate = Evaluator(built.graph(), library_of("jax"))
        x, y = jnp.asarray(x), jnp.asarray(y)
        check(built, jax.jit(lambda x, y: evaluate([x, y]))(x, y), x, y)
        mapped = jax.jit(jax.vmap(jax.vmap(lambda x, y: evaluate([x, y]), (None, 0)), (0, None)))
        check(built, mapped(x[:, 0], y), x, y)


# Materials are written once for all families, and samplers take seconds to compile.
PAIRS = [
    (family, case, dtype)
    for case in CASES
    for family in FAMILIES
    for dtype in ("float32", "float64")
    if family.name == "ggx" or not (case.material or (case.samples and dtype == "float64"))
]


@pytest.mark.parametrize(
    ("family", "case", "dtype"),
    PAIRS,
    ids=[f"{family.name}-{case}-{dtype}" for family, case, dtype in PAIRS],
)
def test_values_are_those_of_the_library(family: Any, case: Case, dtype: str) -> None:
    if family.singular and case.material:
        pytest.skip("what a ring scatters has a density that is 0 or infinite by rounding")
    shape = shape_of(family)
    given = inputs(1000, dtype, shape["alpha"])
    with jax.enable_x64(dtype == "float64"):
        function = case.of(mf.array_functions(family.name, jnp))
        arguments = [jnp.asarray(given[name]) for name in case.takes]
        found = function(*arguments, **shape, **METALS.get(case.material, {}))
    found = found if isinstance(found, tuple) else (found,)
    for got, want in zip(found, truth(case, family.cls(**shape), given), strict=True):
        assert got.dtype == dtype
        off = errors(case, np.asarray(got), want)
        part = 0.999 if (case.samples or family.singular) and dtype == "float32" else 1
        assert np.quantile(off, part, method="higher") < tolerance(case, dtype)


@pytest.mark.parametrize("name", [f.name for f in mf.families() if shorter_from_tables[f.name]])
def test_tables_serve_shapes_that_are_numbers(name: str) -> None:
    (family,) = (family for family in mf.families() if family.name == name)
    shape = shape_of(family)
    given = inputs(1000, "float32", shape["alpha"])
    functions = mf.array_functions(name, jnp)
    for case in CASES:
        if str(case) in ("D", "Lambda", "sample"):
            got = case.of(functions)(
                *(given[name] for name in case.takes), **shape, **METALS.get(case.material, {})
            )
            for one, want in zip(
                got if isinstance(got, tuple) else (got,),
                truth(case, family.cls(**shape), given),
                strict=True,
            ):
                off = errors(case, np.asarray(one), want)
                assert np.quantile(off, 0.999 if case.samples else 1) < tolerance(case, "float32")
    slopes = jax.vmap(jax.grad(lambda u: functions.cosine.Lambda(u, **shape)))
    u, step = np.linspace(0.3, 0.9, 7), 1e-4
    ends = [family.kernels.Lambda(u + sign * step, *shape.values()) for sign in (1, -1)]
    got, want = np.asarray(slopes(jnp.asarray(u, "float32"))), (ends[0] - ends[1]) / (2 * step)
    told = np.abs(want) > 1e-20  # less has fewer digits in single precision, as docs/export.md says
    assert told.sum() >= 6
    np.testing.assert_allclose(got[told], want[told], 1e-4)


# Derivatives


@pytest.mark.parametrize("quantity", POINTS)
@each_family
def test_derivatives_are_those_of_the_reference(family: Any, quantity: str) -> None:
    parameters = parameters_of(family)
    for dtype, most in (("float64", 1e-10), ("float32", 1e-5)):
        with jax.enable_x64(dtype == "float64"):
            function = function_of(mf.array_functions(family.name, jnp), family, quantity)
            for point in POINTS[quantity]:
                arguments = (*point, *parameters)
                value, want = derivatives(family.name, quantity, arguments)
                given = [jnp.asarray(x, dtype) for x in arguments]
                got = jax.grad(function, range(len(given)))(*given)
                assert float(function(*given)) == pytest.approx(value, rel=most)
                assert [x.dtype for x in got] == [dtype] * len(given)
                scale = abs(value) * 1e-2  # a derivative near 0 has the digits of what it is the rest of
                np.testing.assert_allclose(got, want, rtol=most, atol=scale * most)


@pytest.mark.parametrize(
    ("name", "case"), [("student_t", "sigma"), ("ggx", "sample_visible"), ("k0", "conductor.pdf")]
)
def test_forward_and_backward_derivatives_are_each_others(name: str, case: str) -> None:
    """By everything at once, along one direction: components of vectors, uniform numbers, parameters."""
    (family,) = (family for family in FAMILIES if family.name == name)
    (quantity,) = (quantity for quantity in CASES if str(quantity) == case)
    shape = {**shape_of(family), **METALS.get(quantity.material, {})}
    given = inputs(40, "float64", shape["alpha"], seed=2)
    with jax.enable_x64(True):
        functions = mf.array_functions(family.name, jnp)

        def function(arrays: list[Any], parameters: Any) -> Any:
            return quantity.of(functions)(*arrays, **dict(zip(shape, parameters, strict=True)))

        at = [jnp.asarray(given[name]) for name in quantity.takes], jnp.array([*shape.values()])
        rng = np.random.default_rng(3)
        along = jax.tree.map(lambda x: jnp.asarray(rng.normal(size=x.shape)), at)
        value, change = jax.jvp(function, at, along)
        weights = jnp.asarray(rng.normal(size=value.shape))
        back = jax.vjp(function, *at)[1](weights)
        products = jax.tree.map(lambda x, d: jnp.sum(x * d), back, along)
        assert float(sum(jax.tree.leaves(products))) == pytest.approx(
            float(jnp.sum(weights * change)), rel=1e-9
        )


def test_derivatives_of_arrays_that_broadcast_are_summed() -> None:
    functions = mf.array_functions("student_t", jnp)
    w = jnp.asarray(inputs(12, "float32", 0.3)["w"]).reshape(4, 3, 3)

    def total(alpha: Any, gamma: Any) -> Any:
        return functions.sigma(w, alpha=alpha, gamma=gamma).sum()

    alpha, gamma = jnp.full((4, 1), 0.3), jnp.array([2.0, 2.5, 3.0])
    by_alpha, by_gamma = jax.jit(jax.grad(total, (0, 1)))(alpha, gamma)
    assert by_alpha.shape == (4, 1)
    assert by_gamma.shape == (3,)
    one_by_one = jax.vmap(
        jax.vmap(jax.grad(lambda a, g, w: functions.sigma(w, alpha=a, gamma=g), (0, 1)), (None, 0, 0)),
        (0, None, 0),
    )(alpha[:, 0], gamma, w)
    np.testing.assert_allclose(by_alpha[:, 0], one_by_one[0].sum(1), 1e-5)
    np.testing.assert_allclose(by_gamma, one_by_one[1].sum(0), 1e-4)


def test_only_what_is_asked_for_is_differentiated() -> None:
    functions = mf.array_functions("student_t", jnp)
    w = jnp.array([0.6, 0.0, 0.8])
    whole = jax.make_jaxpr(jax.grad(lambda a, g, w: functions.Lambda(w, alpha=a, gamma=g), (0, 1, 2)))(
        0.3, 2.5, w
    )
    one = jax.make_jaxpr(jax.grad(lambda a: functions.Lambda(w, alpha=a, gamma=2.5)))(0.3)
    assert len(str(one)) < 0.7 * len(str(whole))


def test_an_element_outside_of_its_domain_is_nan_alone() -> None:
    functions = mf.array_functions("ggx", jnp)
    alpha = jnp.array([0.3, -1.0, 0.5])
    assert np.isnan(functions.cosine.D(0.5, alpha=alpha)).tolist() == [False, True, False]
    slope = jax.grad(lambda alpha: jnp.nansum(functions.cosine.D(0.5, alpha=alpha)))(alpha)
    assert np.isfinite(slope[jnp.array([0, 2])]).all()


def test_second_derivatives_are_refused() -> None:
    functions = mf.array_functions("ggx", jnp)
    with pytest.raises(NotImplementedError, match=r"^array_functions: D has first derivatives alone"):
        jax.hessian(lambda alpha: functions.cosine.D(0.5, alpha=alpha))(0.3)


def test_precision_follows_jax() -> None:
    functions = mf.array_functions("ggx", jnp).cosine
    assert functions.D(np.array([0.5]), alpha=0.3).dtype == np.float32
    assert functions.D(jnp.array([1]), alpha=0.3).dtype == np.float32
    assert functions.D(0.5, alpha=0.3).dtype == np.float32
    assert functions.D(jnp.array([0.5], jnp.bfloat16), alpha=0.3).dtype == np.float32
    with jax.enable_x64(True):
        assert functions.D(np.array([0.5]), alpha=0.3).dtype == np.float64
        assert functions.D(jnp.array([0.5], np.float32), alpha=0.3).dtype == np.float32
        assert functions.D(0.5, alpha=0.3).dtype == np.float64
    with pytest.raises(ValueError, match="alpha must be real numbers, got complex64"):
        functions.D(0.5, alpha=jnp.array(0.3j))
