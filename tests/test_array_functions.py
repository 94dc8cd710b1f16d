"""`array_functions` on NumPy: the library's own values, broadcasting, domains, wrong arguments."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import mutually_broadcastable_shapes

import microfacet as mf
from array_cases import CASES, METALS, QUANTITIES, Case, errors, inputs, shape_of, truth
from microfacet._graphs import shorter_from_tables

COUNT = 4000

each_family = pytest.mark.parametrize("family", mf.families(), ids=lambda family: family.name)
each_stretched = pytest.mark.parametrize(
    "family", [family for family in mf.families() if family.anisotropic], ids=lambda family: family.name
)
each_case = pytest.mark.parametrize("case", CASES, ids=str)

# Directions in single precision know their slopes to some digits: what compares two of them has fewer.
TOLERANCE = {"float64": 1e-12, "float32": 2e-5}
CONDITION = {"P2": 2, "slope_cdf": 2, "G2": 3, "D_visible": 10}
OF_MATERIALS = {"eval": 100, "pdf": 100, "sample": 300}


def tolerance(case: Case, dtype: str) -> float:
    return TOLERANCE[dtype] * (OF_MATERIALS if case.material else CONDITION).get(case.name, 1)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@each_case
@each_family
def test_values_are_those_of_the_library(family: Any, case: Case, dtype: str) -> None:
    if family.singular and case.material:
        pytest.skip("what a ring scatters has a density that is 0 or infinite by rounding")
    shape = shape_of(family)
    given = inputs(COUNT, dtype, shape["alpha"])
    parameters = {**shape, **METALS.get(case.material, {})}
    found = case.of(mf.array_functions(family.name))(*(given[name] for name in case.takes), **parameters)
    found = found if isinstance(found, tuple) else (found,)
    for got, want in zip(found, truth(case, family.cls(**shape), given), strict=True):
        assert got.dtype == dtype
        assert got.shape == want.shape
        off = errors(case, got, want)
        # Where two formats take two ways, a sample is another one; a ring's end has no digits in float32.
        part = 0.999 if (case.samples or family.singular) and dtype == "float32" else 1
        assert np.quantile(off, part, method="higher") < tolerance(case, dtype)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("case", QUANTITIES, ids=str)
@pytest.mark.parametrize(
    "family", [f for f in mf.families() if shorter_from_tables[f.name]], ids=lambda family: family.name
)
def test_shapes_that_vary_take_formulas(family: Any, case: Case, dtype: str) -> None:
    """Where single numbers take tables."""
    shape = shape_of(family)
    given = inputs(500, dtype, shape["alpha"])
    varying = {name: np.full(500, value, dtype) for name, value in shape.items()}
    got = case.of(mf.array_functions(family.name))(*(given[name] for name in case.takes), **varying)
    assert got.dtype == dtype
    shape = {name: float(values[0]) for name, values in varying.items()}
    (want,) = truth(case, family.cls(**shape), given)
    part = 0.999 if case.samples and dtype == "float32" else 1
    assert np.quantile(errors(case, got, want), part) < tolerance(case, dtype)


def test_densities_of_the_users_own() -> None:
    ndf = mf.RadialNDF(lambda r: np.exp(-(r**4)), alpha=0.3)
    functions, given = mf.array_functions(ndf), inputs(1000, "float64", 0.3)
    for case in QUANTITIES:
        arguments = [given[name] for name in case.takes]
        (want,) = truth(case, ndf, given)
        off = errors(case, case.of(functions)(*arguments), want)
        if case.name == "sample_visible":  # beyond the end of the density nothing is seen
            off = off[ndf.sigma(arguments[0]) > 1e-80]
        assert off.max() < 1e-11, case
    wider = mf.RadialNDF(lambda r: np.exp(-(r**4)), alpha=0.5)
    assert functions.D(given["m"], alpha=0.5) == pytest.approx(wider.D(given["m"]), rel=1e-11)
    assert "RadialNDF" in repr(functions)


@each_family
def test_functions_of_a_cosine_are_the_ufuncs(family: Any) -> None:
    shape = shape_of(family)
    u = np.concatenate([-np.geomspace(1e-3, 1, 50), [0.0], np.geomspace(1e-3, 1, 50)])
    functions = mf.array_functions(family.name)
    for name in ("D", "sigma", "Lambda", "G1"):
        got = getattr(functions.cosine, name)(u, **shape)
        want = getattr(family.kernels, name)(u, *shape.values())
        assert errors(Case(name, ()), got, want).max() < 1e-12, name
    r = np.geomspace(1e-3, 1e3, 99)
    off = errors(
        Case("survival", ()), functions.survival(r, **shape), family.kernels.survival(r, *shape.values())
    )
    assert off.max() < 1e-12


@each_stretched
def test_anisotropic_ones_are_the_frozen_distributions(family: Any) -> None:
    shape = {name: value for name, value in shape_of(family).items() if name != "alpha"}
    ndf = family.cls(alpha_x=0.15, alpha_y=0.4, rotation=0.7, **shape)
    given = inputs(500, "float64", 0.3)
    own, free = mf.array_functions(ndf), mf.array_functions(family.name, anisotropic=True)
    for case in QUANTITIES:
        arguments = [given[name] for name in case.takes]
        (want,) = truth(case, ndf, given)
        for got in (
            case.of(own)(*arguments),
            case.of(own)(*arguments, rotation=0.7),
            case.of(free)(*arguments, alpha_x=0.15, alpha_y=np.full(500, 0.4), rotation=0.7, **shape),
        ):
            assert errors(case, got, want).max() < 1e-11, case
    with pytest.raises(ValueError, match="functions of a cosine are those of isotropic distributions"):
        _ = own.cosine


@each_family
def test_a_distribution_brings_its_parameters(family: Any) -> None:
    shape = shape_of(family)
    ndf = family.cls(**shape)
    w = np.array([0.6, 0.0, 0.8])
    functions = mf.array_functions(ndf)
    assert functions.Lambda(w) == pytest.approx(ndf.Lambda(w), rel=1e-13)
    assert functions.Lambda(w, alpha=0.5) == pytest.approx(
        family.cls(**{**shape, "alpha": 0.5}).Lambda(w), rel=1e-13
    )
    assert functions.visible_dims == ndf.visible_dims
    assert functions.mixture_dims == ndf.mixture_dims
    assert functions.dielectric.sample_dims == mf.Dielectric(ndf, 1.5).sample_dims
    assert functions.conductor.sample_dims == mf.Conductor(ndf).sample_dims


def test_families_by_any_of_their_names() -> None:
    (ggx,) = (family for family in mf.families() if family.name == "ggx")
    for thing in ("ggx", ggx, mf.GGX, mf.ggx):
        assert mf.array_functions(thing).cosine.D(0.5, alpha=0.3) == pytest.approx(mf.ggx.D(0.5, 0.3))


def test_a_mirror_is_a_conductor_without_metal() -> None:
    given = inputs(500, "float64", 0.3)
    functions, mirror = mf.array_functions(mf.GGX(alpha=0.3)), mf.Conductor(mf.GGX(alpha=0.3))
    np.testing.assert_allclose(
        functions.conductor.eval(given["wi"], given["wo"]), mirror.eval(given["wi"], given["wo"]), 1e-12
    )


def test_the_mixture_draws_the_same_density() -> None:
    """Its normals differ from the continuous scheme's; that of Beckmann takes one uniform more."""
    rng = np.random.default_rng(1)
    functions = mf.array_functions("beckmann")
    w, xi = np.array([0.8, 0.0, 0.6]), rng.random((200_000, 3))
    m = functions.sample_visible(w, xi, scheme="mixture", alpha=0.4)
    other = functions.sample_visible(w, xi, alpha=0.4)
    assert not np.allclose(m, other)
    assert np.abs(np.mean(m - other, axis=0)).max() < 4e-3


# Types and shapes


def test_precision_is_that_of_the_arrays() -> None:
    f = mf.array_functions("ggx").cosine
    single, double = np.array([0.5], np.float32), np.array([0.5])
    assert f.D(single, alpha=0.3).dtype == np.float32
    assert f.D(single.astype(np.float16), alpha=0.3).dtype == np.float32
    assert f.D(single, alpha=np.float32(0.3)).dtype == np.float32
    assert f.D(double, alpha=0.3).dtype == np.float64
    assert f.D(single, alpha=np.array(0.3)).dtype == np.float64
    assert f.D(single, alpha=np.float64(0.3)).dtype == np.float64
    assert f.D(np.array([1]), alpha=0.3).dtype == np.float64
    assert f.D(0.5, alpha=0.3).dtype == np.float64
    assert f.D([0.5, 1], alpha=0.3).dtype == np.float64


@given(
    shapes=mutually_broadcastable_shapes(num_shapes=3, max_dims=3, max_side=3, min_side=0),
    block=st.sampled_from([None, 1, 4]),
)
def test_arguments_broadcast(shapes: Any, block: int | None) -> None:
    """In blocks too, single elements and empty arrays among them."""
    from microfacet._export.libraries import NumPy

    rng = np.random.default_rng(1)
    of_m, of_alpha, of_gamma = shapes.input_shapes
    m = rng.normal(size=(*of_m, 3))
    m /= np.linalg.norm(m, axis=-1, keepdims=True)
    alpha, gamma = rng.uniform(0.1, 1, of_alpha), rng.uniform(1.6, 4, of_gamma)
    before, NumPy.block = NumPy.block, block
    try:
        found = mf.array_functions("student_t").D(m, alpha=alpha, gamma=gamma)
        normals = mf.array_functions("student_t").sample(np.abs(np.sin(m)), alpha=alpha, gamma=gamma)
    finally:
        NumPy.block = before
    assert found.shape == shapes.result_shape
    assert normals.shape == (*shapes.result_shape, 3)
    u = np.broadcast_to(m[..., 2], found.shape)
    np.testing.assert_allclose(found, mf.student_t.D(u, alpha, gamma), 1e-10)


def test_arguments_stay_as_they_are() -> None:
    m, alpha = np.array([[0.0, 0.6, 0.8]] * 3), np.array([0.1, 0.2, 0.3])
    m.flags.writeable = alpha.flags.writeable = False
    mf.array_functions("k0").D(m, alpha=alpha)
    assert (alpha == [0.1, 0.2, 0.3]).all()


# Domains


@each_family
def test_what_lies_outside_of_domains_is_nan(family: Any) -> None:
    shape, functions = shape_of(family), mf.array_functions(family.name)
    m = np.array([0.0, 0.6, 0.8])
    for parameter in family.parameters:
        edge = [0.0, -1.0, parameter.upper, math.nan]
        found = functions.Lambda(m, **{**shape, parameter.name: np.array([*edge, parameter.lower])})
        assert np.isnan(found).all(), parameter
    for place in range(3):
        broken = m.copy()
        broken[place] = math.nan
        for name in ("sigma", "Lambda", "G1", *(() if family.singular else ("D",))):
            assert np.isnan(getattr(functions, name)(broken, **shape)), name
        assert np.isnan(functions.G2(m, broken, **shape))
    u = np.array([-1.1, 1.1, 1 + 1e-12, math.nan])
    assert np.isnan(functions.cosine.sigma(u, **shape)).all()
    assert family.singular or np.isnan(functions.cosine.D(u, **shape)).all()
    assert np.isfinite(functions.cosine.sigma(np.nextafter(1, [-2, 2]), **shape)).all()
    xi = np.array([[1.0, 0.5], [-0.1, 0.5], [0.5, 1.0], [0.5, math.nan]])
    assert np.isnan(functions.sample(xi if not family.singular else xi[2:], **shape)).all()
    assert np.isfinite(
        functions.sample([[0.0, 0.0], [np.nextafter(1, 0), np.nextafter(1, 0)]], **shape)
    ).all()


def test_domains_of_materials() -> None:
    functions, w = mf.array_functions(mf.GGX(alpha=0.3)), [0.0, 0.6, 0.8]
    assert np.isnan(functions.conductor.eval(w, w, eta=[0.0, -1.0, math.nan])).all()
    assert np.isnan(functions.conductor.eval(w, w, eta=1.0, k=[-1.0, math.inf])).all()
    assert np.isnan(functions.dielectric.eval(w, w, eta=[0.0, -1.0, math.inf])).all()
    assert np.isfinite(functions.conductor.eval(w, w, eta=[1e-3, 1e3], k=0.0)).all()


def test_densities_of_slopes_exist_where_sigma_does_not() -> None:
    functions = mf.array_functions("student_t")
    assert functions.P22(0.1, 0.2, alpha=0.3, gamma=1.2) == pytest.approx(
        mf.student_t.P22(0.1, 0.2, 0.3, 1.2)
    )
    assert np.isnan(functions.cosine.sigma(0.5, alpha=0.3, gamma=1.2))
    assert np.isnan(functions.P22(0.1, 0.2, alpha=0.3, gamma=1.0))


# Wrong arguments


WRONG = {
    r"array_functions\.D: m must have shape \(\.\.\., 3\), got \(2,\)": lambda f: f.D([0.0, 1.0], alpha=0.3),
    r"array_functions\.D: m must have shape \(\.\.\., 3\), got \(\)": lambda f: f.D(1.0, alpha=0.3),
    r"sample: xi must have shape \(\.\.\., 2\), got \(1,\)": lambda f: f.sample([0.5], alpha=0.3),
    r"these shapes do not broadcast: m \(2,\), alpha \(3,\)": lambda f: f.D(
        np.ones((2, 3)), alpha=np.ones(3)
    ),
    r"m must be real numbers, got complex128": lambda f: f.D(np.ones(3) * 1j, alpha=0.3),
    r"alpha must be real numbers, got <U1": lambda f: f.D(np.ones(3), alpha="a"),
    r'scheme must be "continuous" or "mixture", got \'best\'': lambda f: f.sample_visible(
        [0.0, 0.0, 1.0], [0.5, 0.5], scheme="best", alpha=0.3
    ),
}


@pytest.mark.parametrize("said", WRONG)
def test_wrong_arguments_are_named(said: str) -> None:
    with pytest.raises(ValueError, match=said) as raised:
        WRONG[said](mf.array_functions("ggx"))
    assert "\n" not in str(raised.value)


def test_wrong_parameters_are_named() -> None:
    functions = mf.array_functions("student_t")
    with pytest.raises(TypeError, match=r"D of student_t has no parameter 'beta'; it has alpha, gamma"):
        functions.D([0.0, 0.0, 1.0], alpha=0.3, beta=2)
    with pytest.raises(TypeError, match=r"D of student_t needs alpha and gamma"):
        functions.D([0.0, 0.0, 1.0])
    with pytest.raises(TypeError, match=r"dielectric_eval of student_t needs eta"):
        functions.dielectric.eval([0.0, 0.0, 1.0], [0.0, 0.0, 1.0], alpha=0.3, gamma=2)
    with pytest.raises(ValueError, match=r"give a family \(beckmann, .*\) or a distribution, got 'phong'"):
        mf.array_functions("phong")
    with pytest.raises(ValueError, match=r"gtr has no anisotropic form"):
        mf.array_functions("gtr", anisotropic=True)
    with pytest.raises(ValueError, match=r"is anisotropic, got anisotropic=False"):
        mf.array_functions(mf.GGX(alpha_x=0.1, alpha_y=0.2), anisotropic=False)
    with pytest.raises(ValueError, match=r"xp must be one of numpy, cupy, jax, torch, got 'tensorflow'"):
        mf.array_functions("ggx", "tensorflow")


def test_cupy_is_said_to_be_missing() -> None:
    with pytest.raises(ImportError, match=r"^functions on arrays of CuPy need cupy, which is not installed$"):
        mf.array_functions("ggx", "cupy")


def test_they_say_what_they_are() -> None:
    assert repr(mf.array_functions("ggx")) == "<array_functions of ggx, on numpy>"
    assert (
        repr(mf.array_functions("ggx", anisotropic=True)) == "<array_functions of ggx, anisotropic, on numpy>"
    )
    own = mf.array_functions(mf.K0(alpha=0.3))
    assert repr(own) == "<array_functions of K0(alpha_x=0.3, alpha_y=0.3, rotation=0.0), on numpy>"
    assert "conductor" in repr(own.conductor)
