"""The laws of laws.py for every family, limits between families, and properties at random arguments."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import laws
import microfacet as mf

ALPHAS = (0.05, 0.6, 3.0)


def parameter_sets(family: Any) -> list[tuple[float, ...]]:
    """alpha, and a shape parameter near the lower end of its domain, in the middle, and larger."""
    shapes = [
        [p.lower + min(1.0, (p.upper - p.lower) / 5) * offset for offset in (0.3, 1.0, 4.2)]
        for p in family.parameters[1:]
    ]
    return list(itertools.product(ALPHAS, *shapes))


DENSITIES = [
    pytest.param(family, parameters, id="-".join([family.name, *map(str, parameters)]))
    for family in mf.families()
    for parameters in parameter_sets(family)
]
FAMILIES = [pytest.param(family, id=family.name) for family in mf.families()]


@pytest.mark.parametrize("law", laws.ALL, ids=lambda law: law.__name__)
@pytest.mark.parametrize(("family", "parameters"), DENSITIES)
def test_law(family: Any, parameters: tuple[float, ...], law: Callable[[laws.Density], None]) -> None:
    if family.singular and law in laws.OF_A_DENSITY:
        pytest.skip("on a ring there is nothing to integrate")
    law(laws.Density(family.kernels, parameters))


@pytest.mark.parametrize("family", FAMILIES)
def test_shape_invariance(family: Any) -> None:
    density = laws.Density(family.kernels, parameter_sets(family)[-1])
    if family.anisotropic:
        laws.shape_invariant(density)
    else:  # gtr: the alpha of its density is not a stretch of the slopes
        with pytest.raises(AssertionError):
            laws.shape_invariant(density)


# Limits: one family at the edge of another.


def curves(kernels: Any, *parameters: float) -> np.ndarray:
    """Every function over a range of slopes and cosines, in one row."""
    f = laws.Density(kernels, parameters)
    p = 0.7 * laws.MU
    u = p / np.hypot(1.0, p)
    xi = np.array([0.1, 0.5, 0.99])
    return np.concatenate([
        f.D(u), f.P22(p, 0.3), f.P2(p), f.slope_cdf(-p), f.sigma(u), f.sigma(-u), f.Lambda(u), f.G1(u),
        f.survival(p), f.sample_slope(xi),
    ])  # fmt: skip


@pytest.mark.parametrize("alpha", ALPHAS)
def test_ggx_is_student_t_and_gtr_of_gamma_2(alpha: float) -> None:
    assert_allclose(curves(mf.student_t, alpha, 2.0), curves(mf.ggx, alpha), rtol=2e-13)
    assert_allclose(curves(mf.gtr, alpha, 2.0), curves(mf.ggx, alpha), rtol=2e-13)


@pytest.mark.parametrize("alpha", ALPHAS)
def test_k0_is_bessel_k_of_a_1(alpha: float) -> None:
    assert_allclose(curves(mf.bessel_k, alpha, 1.0), curves(mf.k0, alpha), rtol=2e-13)


def test_student_t_tends_to_beckmann() -> None:
    """Like 1/gamma, whence Richardson's extrapolation from two large gamma."""
    expected = curves(mf.beckmann, 0.6)
    coarse, fine = (curves(mf.student_t, 0.6, gamma) for gamma in (1e5, 2e5))
    bulk = expected > 1e-12  # far tails converge later
    assert_allclose(fine[bulk], expected[bulk], rtol=1e-2)
    assert_allclose((2 * fine - coarse)[bulk], expected[bulk], rtol=2e-6)


@pytest.mark.parametrize("gamma", [1.0, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("alpha", [0.05, 0.6, 1.0, 3.0])
def test_gtr_is_smooth_in_gamma(alpha: float, gamma: float) -> None:
    """Singularities of its formulas are removable: value = mean of neighbours + O(distance^2)."""
    centre = curves(mf.gtr, alpha, gamma)
    for distance, rtol in ((1e-4, 1e-6), (1e-7, 1e-12), (1e-10, 1e-12), (1e-13, 1e-12)):
        mean = (curves(mf.gtr, alpha, gamma - distance) + curves(mf.gtr, alpha, gamma + distance)) / 2
        assert_allclose(mean, centre, rtol=rtol)


@pytest.mark.parametrize("gamma", [0.4, 1.0, 1.5, 2.0, 7.0])
def test_gtr_is_smooth_through_alpha_1(gamma: float) -> None:
    centre = curves(mf.gtr, 1.0, gamma)
    for distance, rtol in ((1e-4, 1e-6), (1e-7, 1e-12), (1e-10, 1e-12), (1e-13, 1e-12)):
        mean = (curves(mf.gtr, 1 - distance, gamma) + curves(mf.gtr, 1 + distance, gamma)) / 2
        assert_allclose(mean, centre, rtol=rtol)
    assert_allclose(mf.gtr.D(np.linspace(0.1, 1, 10), 1.0, gamma), 1 / np.pi, rtol=1e-15)


# Properties at random arguments.

RANGES = {"gtr": (0.25, 15.0), "student_t": (1.51, 1e6), "bessel_k": (0.05, 150.0)}  # of shape parameters
EXPONENTS = st.floats(-12, 6)
SIGNS = st.sampled_from([-1.0, 1.0])
DTYPES = st.sampled_from([np.float32, np.float64])


def contract_range(family: str, parameter: Any) -> tuple[float, float]:
    if parameter.name == "alpha":
        return 1e-4, 10.0
    size = min(parameter.upper - parameter.lower, 100.0)
    return RANGES.get(family, (parameter.lower + 0.02 * size, parameter.lower + 0.98 * size))


@pytest.mark.parametrize("family", FAMILIES)
@settings(max_examples=60)
@given(data=st.data(), dtype=DTYPES, u=st.floats(0, 1), size=EXPONENTS, other=EXPONENTS, sign=SIGNS)
def test_bounds_and_symmetry(
    family: Any,
    data: st.DataObject,
    dtype: type[np.floating],
    u: float,
    size: float,
    other: float,
    sign: float,
) -> None:
    """Finite, nonnegative, within bounds, even in the slopes, everywhere in the domain."""
    parameters = tuple(
        dtype(np.exp(data.draw(st.floats(*np.log(contract_range(family.name, p))), label=p.name)))
        for p in family.parameters
    )
    f = laws.Density(family.kernels, parameters)
    u, p, q = dtype(max(u, 1e-12)), dtype(sign * 10**size), dtype(10**other)
    assert min(f.D(u), f.P2(p), f.P22(p, q)) >= 0
    assert f.P22(p, q) == f.P22(-p, q) == f.P22(q, p)
    assert f.P2(p) == f.P2(-p)
    for probability in (f.slope_cdf(p), f.survival(q), f.G1(u), f.sample_u(min(u, dtype(0.9)))):
        assert 0 <= probability <= 1
    assert f.slope_cdf(abs(p)) >= 0.5 >= f.slope_cdf(-abs(p))
    assert 0 <= f.sigma(-u) <= f.sigma(u) >= u
    assert f.Lambda(u) >= 0
    assert f.Lambda(-u) <= -1
    assert np.isfinite([f.sigma(u), f.Lambda(u)]).all()
    assert family.singular or np.isfinite([f.P2(p), f.P22(p, q)]).all()
    xi = dtype(min(u, 1 - np.finfo(dtype).epsneg))
    assert 0 <= f.sample_slope(xi) < np.inf
