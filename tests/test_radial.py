"""Densities of the user's own: they become what the library's families are, by another route."""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import mpmath
import numpy as np
import pytest
from scipy import stats

import microfacet as mf

FAMILIES: dict[str, tuple[Any, dict[str, float]]] = {
    "beckmann": (mf.Beckmann, {}),
    "ggx": (mf.GGX, {}),
    "student_t": (mf.StudentT, {"gamma": 1.7}),
    "bessel_k": (mf.BesselK, {"a": 1.5}),
}
_made: dict[str, mf.RadialNDF] = {}


def of_family(name: str) -> Callable[[Any], Any]:
    cls, shape = FAMILIES[name]
    ndf = cls(alpha=1.0, **shape)
    return lambda r: 3.0 * ndf.P22(r, 0.0)


def made(name: str, **roughness: float) -> mf.RadialNDF:
    """Tables are built once; another roughness is another view of them."""
    if name not in _made:
        _made[name] = mf.RadialNDF(of_family(name))
    one = _made[name]
    again = mf.Beckmann(**roughness)
    new = type(one).__new__(type(one))
    new._freeze((again.alpha_x, again.alpha_y, again.rotation))
    for slot in type(one).__slots__:
        object.__setattr__(new, slot, getattr(one, slot))
    return new


def directions(n: int) -> np.ndarray:
    rng = np.random.default_rng(3)
    z = rng.uniform(0.02, 1.0, n)
    azimuth = rng.uniform(0.0, 2.0 * np.pi, n)
    s = np.sqrt(1.0 - z * z)
    return np.stack((s * np.cos(azimuth), s * np.sin(azimuth), z), -1)


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.parametrize("roughness", [{"alpha": 0.3}, {"alpha_x": 0.2, "alpha_y": 0.7, "rotation": 0.4}])
@pytest.mark.parametrize(("dtype", "tolerance"), [(np.float64, 2e-13), (np.float32, 5e-6)])
def test_agrees_with_family(name: str, roughness: dict[str, float], dtype: Any, tolerance: float) -> None:
    cls, shape = FAMILIES[name]
    ndf, family = made(name, **roughness), cls(**roughness, **shape)
    w = directions(2000).astype(dtype)
    p, q = np.random.default_rng(4).normal(0.0, 0.5, (2, 1000)).astype(dtype)
    xi = np.random.default_rng(5).uniform(0.001, 0.999, (1000, 2)).astype(dtype)
    pairs = {
        "D": (ndf.D(w), family.D(w)),
        "pdf": (ndf.pdf(w), family.pdf(w)),
        "sigma": (ndf.sigma(w), family.sigma(w)),
        "Lambda": (ndf.Lambda(w), family.Lambda(w)),
        "G1": (ndf.G1(w), family.G1(w)),
        "G2": (ndf.G2(w, w[::-1]), family.G2(w, w[::-1])),
        "D_visible": (ndf.D_visible(w, w[::-1]), family.D_visible(w, w[::-1])),
        "P22": (ndf.P22(p, q), family.P22(p, q)),
        "P2": (ndf.P2(p), family.P2(p)),
        "slope_cdf": (ndf.slope_cdf(p), family.slope_cdf(p)),
    }
    for quantity, (ours, theirs) in pairs.items():
        assert ours.dtype == dtype
        near = np.abs(np.log(np.maximum(theirs, 1e-37))) < (20 if dtype is np.float32 else 30)
        np.testing.assert_allclose(ours[near], theirs[near], rtol=tolerance, err_msg=quantity)
    np.testing.assert_allclose(ndf.sample(xi), family.sample(xi), atol=tolerance)
    assert ndf.norm == pytest.approx(3.0, rel=1e-13)
    assert ndf.error < 2e-13


def test_new_density() -> None:
    """exp(-r^4): every quantity is an integral that mpmath knows otherwise."""
    ndf = mf.RadialNDF(lambda r: np.exp(-(r**4)))
    norm = mpmath.pi ** mpmath.mpf(1.5) / 2
    assert ndf.norm == pytest.approx(float(norm), rel=1e-14)
    p = mpmath.mpf(0.7)
    P2 = 2 * mpmath.quad(lambda q: mpmath.exp(-((p * p + q * q) ** 2)), [0, 1, 3]) / norm
    assert ndf.P2(0.7) == pytest.approx(float(P2), rel=1e-13)
    # Over the disc: E[(slope - t)_+] = int_t^inf P22 (2 sqrt(r^2 - t^2) - 2 t acos(t/r)) r dr.
    t = mpmath.mpf(0.8) / mpmath.mpf(0.6)
    excess = mpmath.quad(
        lambda r: mpmath.exp(-(r**4)) * 2 * (mpmath.sqrt(r * r - t * t) - t * mpmath.acos(t / r)) * r,
        [t, 1.5, 2, 3, 4],
    )
    assert ndf.Lambda([0.6, 0.0, 0.8]) == pytest.approx(float(excess / norm / t), rel=1e-12)


def test_sum_of_two() -> None:
    """A sum of densities has the sum of their areas."""
    ndf = mf.RadialNDF(lambda r: np.exp(-(r**2)) + 40.0 * np.exp(-((r / 0.05) ** 2)))
    weights = np.array([1.0, 40.0 * 0.05**2])
    w = directions(500)
    parts = np.stack([mf.Beckmann(alpha=1.0).sigma(w), mf.Beckmann(alpha=0.05).sigma(w)])
    np.testing.assert_allclose(ndf.sigma(w), weights @ parts / weights.sum(), rtol=1e-12)


def test_known_survival_agrees() -> None:
    ndf = mf.RadialNDF(lambda r: np.exp(-(r**2)), lambda r: np.exp(-(r**2)), 0.4)
    xi = np.random.default_rng(1).uniform(size=(100, 2))
    np.testing.assert_allclose(ndf.sample(xi), mf.Beckmann(0.4).sample(xi), atol=1e-13)
    with pytest.raises(ValueError, match="survival must be Pr"):
        mf.RadialNDF(lambda r: np.exp(-(r**2)), lambda r: np.exp(-2.0 * r**2))


def test_from_samples() -> None:
    r = np.geomspace(1e-3, 6.0, 200)
    ndf, exact = mf.RadialNDF((r, np.exp(-(r**2))), alpha=0.5), mf.Beckmann(0.5)
    w = directions(500)
    np.testing.assert_allclose(ndf.sigma(w), exact.sigma(w), rtol=1e-5)
    p = np.linspace(-1.0, 1.0, 101)
    np.testing.assert_allclose(ndf.P22(p, 0.1), exact.P22(p, 0.1), rtol=1e-3)
    np.testing.assert_allclose(ndf.P2(p), exact.P2(p), rtol=1e-3)


def test_samples_follow_density() -> None:
    ndf = made("student_t", alpha=0.3)
    m = ndf.sample(np.random.default_rng(7).uniform(size=(20000, 2)))
    slope = -m[:, 0] / m[:, 2]
    assert stats.kstest(slope, ndf.slope_cdf).pvalue > 1e-3


def test_infinite_mean_has_no_area() -> None:
    ndf = mf.RadialNDF(lambda r: (1.0 + r * r) ** -1.3, alpha=0.3)
    for dtype in (np.float32, np.float64):
        w = directions(20).astype(dtype)
        assert np.all(np.isnan(ndf.sigma(w)))
        assert np.all(ndf.D(w) > 0.0)


@pytest.mark.parametrize(
    ("density", "message"),
    [
        (lambda r: -np.exp(-r), "P22 must be finite and not negative, got"),
        (lambda r: np.exp(-r) * np.where(abs(r - 1.0) < 0.5, np.nan, 1.0), "got nan at r = "),
        (lambda r: np.exp(-r)[:1], "real numbers of the shape of its argument"),
        (lambda r: "text", "real numbers of the shape"),
        (lambda r: 1.0 / (1.0 + r), "P22 must be integrable over the plane; r P22 is not towards infinity"),
        (lambda r: np.exp(-r) * r**-2.0, "integrable over the plane; r P22 is not towards 0"),
        (lambda r: np.zeros_like(r), "nowhere positive"),
        (([1.0, 2.0], [1.0, 2.0]), "8 at least"),
        ((np.arange(10.0), np.ones(10)), "strictly increasing"),
        ((np.arange(1.0, 11.0), -np.ones(10)), "the values of P22 must be finite and positive"),
        ((np.arange(1.0, 11.0), np.arange(1.0, 11.0) ** -1.0), "integrable over the plane"),
        (3.0, "P22 must be a callable or samples"),
    ],
)
def test_nonsense_gets_one_sentence(density: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message) as caught:
        mf.RadialNDF(density)
    assert "\n" not in str(caught.value)


def test_exceptions_of_density_come_through() -> None:
    def late(r: Any) -> Any:
        if len(r) < 100:
            raise KeyError("mine")
        return np.exp(-r)

    with pytest.raises(KeyError, match="mine"):
        mf.RadialNDF(late)
    with pytest.raises(ValueError, match="alpha must lie in"):
        mf.RadialNDF(np.exp, alpha=-1.0)


def test_is_a_value() -> None:
    ndf = made("ggx", alpha=0.3)
    w = directions(100)
    for again in (pickle.loads(pickle.dumps(ndf)), copy.copy(ndf), copy.deepcopy(ndf)):
        assert again == ndf
        assert hash(again) == hash(ndf)
        np.testing.assert_array_equal(again.D(w), ndf.D(w))
        np.testing.assert_array_equal(again.D(w.astype("f4")), ndf.D(w.astype("f4")))
    assert made("beckmann", alpha=0.3) != ndf
    assert "alpha_x=0.3" in repr(ndf)
    with pytest.raises(AttributeError):
        ndf.norm = 2.0
    table = mf.RadialNDF.kernels.dump(ndf._handle)
    for bad in (table[:-1], b"x" + table[1:], b""):
        with pytest.raises(ValueError, match="no density of this version"):
            mf.RadialNDF.kernels.load(bad)


def test_unknown_handle_is_nan() -> None:
    for handle in (0.0, -1.0, 1e300, math.nan, math.inf, 1e9):
        assert math.isnan(mf.RadialNDF.kernels.stretched_D(0.1, 0.0, 1.0, 0.3, 0.3, 0.0, handle))


def test_threads_share_one_density() -> None:
    ndf = made("bessel_k", alpha=0.3)
    w = directions(20000)
    expected = ndf.sigma(w)
    with ThreadPoolExecutor(4) as pool:
        for result in pool.map(lambda _: ndf.sigma(w), range(8)):
            np.testing.assert_array_equal(result, expected)


def test_the_density_of_horizontal_normals_is_no_nan() -> None:
    """Far beyond the last piece of its tables."""
    z = 10.0 ** -np.arange(1.0, 160.0)
    for ndf in (mf.RadialNDF(lambda r: np.exp(-(r**4))), mf.RadialNDF(lambda r: (1.0 + r * r) ** -3.0)):
        assert np.isfinite(ndf.D(np.ones_like(z), np.zeros_like(z), z)).all()


@pytest.mark.parametrize("radius", [0.013, 0.7, 1.0, 3.3])
@pytest.mark.parametrize("width", [0.3, 0.02, 0.01])
def test_a_ring_is_found_wherever_it_lies(radius: float, width: float) -> None:
    """Towards a ring of one slope; all moments of a ring of width w differ from its by w^2 at most."""
    ring = mf.RadialNDF(lambda r: np.exp(-(((r / radius - 1.0) / width) ** 2)))
    # int 2 pi r exp(-((r/R - 1)/w)^2) dr = pi R^2 (w^2 exp(-1/w^2) + sqrt(pi) w (1 + erf(1/w)))
    norm = width**2 * math.exp(-(width**-2)) + math.sqrt(math.pi) * width * (1 + math.erf(1 / width))
    np.testing.assert_allclose(ring.norm, math.pi * radius**2 * norm, rtol=1e-11)
    w = directions(200)
    np.testing.assert_allclose(ring.sigma(w), mf.Dirac(alpha=radius).sigma(w), rtol=width**2)
