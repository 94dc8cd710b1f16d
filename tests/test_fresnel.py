"""Fresnel's equations against complex arithmetic in many digits, and their averages against quadrature."""

from __future__ import annotations

from typing import Any

import mpmath as mp
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad

import microfacet as mf

Array = NDArray[Any]
DIGITS = 60
CONTRACT = {np.float64: 1e-13, np.float32: 4e-6}
METALS = [(0.18, 3.42), (1.37, 1.77), (0.02, 8.0), (3.0, 40.0), (1.5, 0.0), (0.6, 0.0), (np.inf, 0.0)]

NARROW = {"epsabs": 1e-11, "epsrel": 1e-11, "limit": 400}

each_dtype = pytest.mark.parametrize("dtype", [np.float64, np.float32])


def interface(cosine: float, index: complex) -> mp.mpf:
    """The mean of |r_s|^2 and |r_p|^2, from the amplitudes as every book has them."""
    with mp.workdps(DIGITS):
        c, n2 = abs(mp.mpf(cosine)), mp.mpc(index) ** 2
        root = mp.sqrt(n2 - 1 + c**2)
        amplitudes = (c - root) / (c + root), (n2 * c - root) / (n2 * c + root)
        return sum(abs(r) ** 2 for r in amplitudes) / 2


def relative_error(values: Array, cosine: Array, eta: Array, k: Array | None = None) -> float:
    absorbed = np.zeros_like(eta) if k is None else k
    with mp.workdps(DIGITS):
        exact = (
            interface(float(c), complex(n, -kappa)) for c, n, kappa in zip(cosine, eta, absorbed, strict=True)
        )
        return max(float(abs(mp.mpf(float(v)) / e - 1)) for v, e in zip(values, exact, strict=True))


def log_uniform(rng: np.random.Generator, lower: float, upper: float, n: int) -> Array:
    return np.exp(rng.uniform(np.log(lower), np.log(upper), n))


def cosines(rng: np.random.Generator, n: int) -> Array:
    """All of them, many grazing, and some close to the normal."""
    kinds = [rng.random(n), log_uniform(rng, 1e-12, 1.0, n), 1.0 - log_uniform(rng, 1e-6, 0.1, n), np.ones(n)]
    return np.asarray(rng.permutation(np.concatenate(kinds))[:n])


def around_the_critical_angle(rng: np.random.Generator, n: int, closest: float) -> tuple[Array, Array]:
    eta = log_uniform(rng, 0.1, 0.95, n)
    side = rng.choice([-1.0, 1.0], n)
    return np.minimum(np.sqrt(1.0 - eta**2) * (1.0 + side * log_uniform(rng, closest, 0.05, n)), 1.0), eta


@each_dtype
def test_dielectric(dtype: type) -> None:
    rng = np.random.default_rng(1)
    eta = log_uniform(rng, 0.1, 10.0, 1200).astype(dtype)
    cosine = cosines(rng, len(eta)).astype(dtype)
    assert relative_error(mf.fresnel_dielectric(cosine, eta), cosine, eta) < CONTRACT[dtype]


@each_dtype
def test_dielectric_around_the_critical_angle(dtype: type) -> None:
    given = around_the_critical_angle(np.random.default_rng(2), 600, 1e-12)
    cosine, eta = (x.astype(dtype) for x in given)
    values = mf.fresnel_dielectric(cosine, eta)
    assert np.any(values < 0.9)
    assert np.any(values == 1.0)
    assert relative_error(values, cosine, eta) < CONTRACT[dtype]
    assert relative_error(mf.fresnel_conductor(cosine, eta, 0 * eta), cosine, eta) < CONTRACT[dtype]


@each_dtype
def test_media_that_hardly_differ(dtype: type) -> None:
    rng = np.random.default_rng(3)
    eta = (1.0 + rng.choice([-1.0, 1.0], 400) * log_uniform(rng, 1e-6, 0.1, 400)).astype(dtype)
    cosine, k = cosines(rng, 400).astype(dtype), log_uniform(rng, 1e-6, 0.1, 400).astype(dtype)
    assert relative_error(mf.fresnel_dielectric(cosine, eta), cosine, eta) < CONTRACT[dtype]
    assert relative_error(mf.fresnel_conductor(cosine, eta, k), cosine, eta, k) < CONTRACT[dtype]


@each_dtype
def test_conductor(dtype: type) -> None:
    rng = np.random.default_rng(4)
    eta = log_uniform(rng, 0.01, 20.0, 1200).astype(dtype)
    k = np.where(rng.random(1200) < 0.2, 0.0, log_uniform(rng, 1e-3, 100.0, 1200)).astype(dtype)
    cosine = cosines(rng, 1200).astype(dtype)
    assert relative_error(mf.fresnel_conductor(cosine, eta, k), cosine, eta, k) < CONTRACT[dtype]


def test_a_metal_that_absorbs_nothing_is_a_dielectric() -> None:
    cosine = np.linspace(0.0, 1.0, 101)
    for eta in (0.4, 0.9, 1.5, 7.0):
        metal, glass = mf.fresnel_conductor(cosine, eta, 0.0), mf.fresnel_dielectric(cosine, eta)
        np.testing.assert_allclose(metal, glass, rtol=1e-13)


def test_exact_values() -> None:
    cosine = np.array([1e-150, 1e-9, 0.3, 1.0])
    assert np.all(mf.fresnel_dielectric(cosine, 1.0) == 0.0), "equal media"
    assert np.all(mf.fresnel_dielectric(0.0, [0.3, 0.999, 1.0, 1.5, 10.0]) == 1.0), "along the surface"
    assert np.all(mf.fresnel_conductor(0.0, [0.2, 1.0, 5.0], [3.0, 0.1, 0.0]) == 1.0)
    assert np.all(mf.fresnel_dielectric([0.1, 0.5, 0.74], 1 / 1.5) == 1.0), "beyond the critical angle"
    assert np.all(mf.fresnel_conductor(cosine, np.inf, 0.0) == 1.0), "a perfect mirror"
    np.testing.assert_allclose(mf.fresnel_dielectric(1.0, 1.5), 0.04, rtol=1e-14)


def test_reflectance_is_the_same_from_both_sides() -> None:
    """Along one ray, from above and from below."""
    rng = np.random.default_rng(5)
    eta, cosine = log_uniform(rng, 1.05, 10.0, 500), rng.uniform(0.05, 1.0, 500)
    behind = np.sqrt(1.0 - (1.0 - cosine**2) / eta**2)
    there, back = mf.fresnel_dielectric(cosine, eta), mf.fresnel_dielectric(behind, 1.0 / eta)
    np.testing.assert_allclose(there, back, rtol=1e-11)


@pytest.mark.parametrize("cosine", [-0.0, -0.5, -1.0, 5e-324, 1.0 + 1e-15])
def test_reflectances_are_shares_whatever_the_cosine(cosine: float) -> None:
    for value in (
        mf.fresnel_dielectric(cosine, np.array([0.1, 1.0, 10.0])),
        mf.fresnel_conductor(cosine, *np.transpose(METALS)),
    ):
        assert np.all((value >= 0.0) & (value <= 1.0))
    assert mf.fresnel_dielectric(cosine, 1.5) == mf.fresnel_dielectric(min(abs(cosine), 1.0), 1.5)


@pytest.mark.parametrize("eta", [0.0, -1.5, np.nan, np.inf])
def test_nan_outside_the_domain_of_a_dielectric(eta: float) -> None:
    assert np.isnan(mf.fresnel_dielectric([0.0, 0.5, 1.0], eta)).all()


@pytest.mark.parametrize(("eta", "k"), [(0.0, 1.0), (-1.0, 1.0), (np.nan, 1.0), (1.0, -0.1), (1.0, np.nan)])
def test_nan_outside_the_domain_of_a_metal(eta: float, k: float) -> None:
    assert np.isnan(mf.fresnel_conductor([0.0, 0.5, 1.0], eta, k)).all()


@pytest.mark.parametrize("eta", [0.1, 0.5, 1 / 1.5, 0.999, 1.0, 1.001, 1.33, 1.5, 3.0, 10.0])
def test_average_of_a_dielectric(eta: float) -> None:
    critical = [np.sqrt(1.0 - eta**2)] if eta < 1.0 else None
    exact, error = quad(lambda c: 2 * c * mf.fresnel_dielectric(c, eta), 0, 1, points=critical, **NARROW)
    assert error < 3e-10
    assert mf.fresnel_average(eta) == pytest.approx(exact, abs=2e-9)


@pytest.mark.parametrize(("eta", "k"), [*METALS, (0.3, 1e-6), (0.6, 1e-3), (1.0, 0.01)])
def test_average_of_a_metal(eta: float, k: float) -> None:
    critical = [np.sqrt(1.0 - eta**2 + k**2)] if eta**2 - k**2 < 1.0 and k < 0.1 else None
    exact, error = quad(lambda c: 2 * c * mf.fresnel_conductor(c, eta, k), 0, 1, points=critical, **NARROW)
    assert error < 3e-10
    assert mf.fresnel_average(eta, k) == pytest.approx(exact, abs=2e-9)


def test_averages_of_arrays() -> None:
    eta, k = np.array([[0.2], [1.5]]), np.array([3.0, 4.0, 0.5])
    average = mf.fresnel_average(eta, k)
    assert average.shape == (2, 3)
    assert average[1, 2] == mf.fresnel_average(1.5, 0.5)
