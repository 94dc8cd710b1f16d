"""Visible normals are the quantile of what a direction sees, for hostile uniforms and directions too.

In standard space a direction with x = cot(theta) sees slopes P, positive ones leaning towards it, with
density (x + P)_+ P2(P). The reference integrates that with P2 from arbitrary precision, from P22 alone.
"""

from __future__ import annotations

import itertools
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from numpy.typing import NDArray

import microfacet as mf
from shapes import one_shape

pytestmark = pytest.mark.filterwarnings("error")

CONTINUOUS = [
    mf.Beckmann(alpha=1.0),
    mf.StudentT(alpha=1.0, gamma=1.55),
    mf.StudentT(alpha=1.0, gamma=2.5),
    mf.StudentT(alpha=1.0, gamma=20.0),
]
ALL = [
    *CONTINUOUS,
    mf.GGX(alpha=1.0),
    mf.K0(alpha=1.0),
    mf.StudentT(alpha=1.0, gamma=3.0),
    mf.BesselK(alpha=1.0, a=0.3),
    mf.BesselK(alpha=1.0, a=1.3),
    mf.GTR(alpha=0.3, gamma=1.5),
    mf.GTR(alpha=3.0, gamma=3.0),
]
SHAPES = one_shape({})
XI = [1e-12, 1e-6, 0.03, 0.3, 0.5, 0.8, 0.97, 1 - 1e-6, 1 - 1e-12]
HOSTILE = [0.0, 5e-324, 1e-310, 1e-30, 2.0**-53, 0.25, 0.5, 1 - 2.0**-24, 1 - 2.0**-53]


def name_of(ndf: Any) -> str:
    return repr(ndf)


def direction(theta: float, phi: float = 0.0) -> NDArray[np.float64]:
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def marginal(ndf: Any, t: mp.mpf) -> mp.mpf:
    """P2 at alpha = 1, from the joint density."""
    if isinstance(ndf, mf.Beckmann):
        return mp.exp(-t * t) / mp.sqrt(mp.pi)
    k = mp.mpf(ndf.gamma) - 1
    norm = mp.gamma(k + mp.mpf(1) / 2) / (mp.sqrt(mp.pi * k) * mp.gamma(k))
    return norm * (1 + t * t / k) ** (-k - mp.mpf(1) / 2)


def seen(ndf: Any, x: mp.mpf, lower: mp.mpf, upper: mp.mpf) -> mp.mpf:
    """int (x + P) P2(P) dP, in a variable in which heavy tails are short."""
    if lower >= upper:
        return mp.mpf(0)
    ends = [mp.asinh(lower), mp.asinh(upper) if upper != mp.inf else mp.mpf(600)]
    inner = [z for z in mp.linspace(-4, 4, 9) if ends[0] < z < ends[1]]
    far = [z for z in (8, 16, 40, 100, 250) if ends[0] < z < ends[1]]
    return mp.quad(
        lambda z: (x + mp.sinh(z)) * marginal(ndf, mp.sinh(z)) * mp.cosh(z), [ends[0], *inner, *far, ends[1]]
    )


@pytest.mark.parametrize("ndf", CONTINUOUS, ids=name_of)
@pytest.mark.parametrize("degrees", [0.0, 60.0, 89.0, 100.0, 130.0])
def test_first_uniform_is_the_quantile(ndf: Any, degrees: float) -> None:
    w = direction(np.radians(degrees))
    m = ndf.sample_visible(w, np.column_stack([XI, np.full((len(XI), 2), 0.3)]))
    with mp.workdps(30):
        x = mp.mpf(min(w[2] / max(w[0], 1e-15), 1e15))
        start = -x
        total = seen(ndf, x, start, mp.inf)
        for (mx, _, mz), xi in zip(m, XI, strict=True):
            p = mx / mz
            above = seen(ndf, x, mp.mpf(p), mp.inf) / total
            below = seen(ndf, x, start, mp.mpf(p)) / total
            density = float((x + p) * marginal(ndf, mp.mpf(p)) / total)
            residual = abs(above - mp.mpf(xi)) if xi <= 0.5 else abs(below - (1 - mp.mpf(xi)))
            # The solver's part, and four roundings on the way from the slope to the normal and back.
            assert residual <= 1e-12 * min(xi, 1.0 - xi) + 4.0 * np.spacing(abs(p)) * density


@pytest.mark.parametrize("ndf", ALL, ids=name_of)
@pytest.mark.parametrize("scheme", ["continuous", "mixture"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_hostile_uniforms_and_directions(ndf: Any, scheme: str, dtype: type) -> None:
    w = np.array(
        [
            [0, 0, 1], [0, 0, 1 + 1e-7], [1, 0, 0], [0, -1, 0], [0.6, 0, 0.8], [1e-30, 0, 1], [1e-3, 1e-3, 1],
            [0.6, 0, -0.8], [1, 0, -1e-20], [1, 0, 1e-20], [1e-3, 0, -1], [0.8, 0.6000001, 0],
        ]
    )  # fmt: skip
    xi = np.array(list(itertools.product(HOSTILE, repeat=3)))
    xi = np.column_stack([xi, xi[::-1, 1]])
    xi = xi.astype(dtype)[(xi.astype(dtype) < 1).all(axis=1)]
    w = w.astype(dtype)
    m = ndf.sample_visible(w[:, None], xi, scheme=scheme)
    assert m.dtype == dtype
    assert not np.isnan(m).any()
    assert (m[..., 2] > 0).all()
    length = np.sqrt((m.astype(np.longdouble) ** 2).sum(axis=-1))
    assert np.max(np.abs(length - 1)) <= 4 * np.finfo(dtype).eps
    facing = (m.astype(np.longdouble) * w[:, None]).sum(axis=-1)
    assert np.min(facing) >= -8 * np.finfo(dtype).eps


@pytest.mark.parametrize(
    "ndf", [f.cls(alpha=0.3, **SHAPES[f.name]) for f in mf.families() if not f.singular], ids=name_of
)
def test_float32_where_next_to_nothing_is_seen(ndf: Any) -> None:
    """Far below the horizon the slope across agrees with that of float64, to the rounding of float32."""
    angles = np.linspace(np.pi / 2, np.pi, 20001)[:-1]
    areas = ndf.sigma(np.stack([np.sin(angles), 0 * angles, np.cos(angles)], axis=-1))
    xi = np.random.default_rng(1).random((2000, ndf.visible_dims), np.float32)
    for most in 10.0 ** np.array([-2, -10, -18, -24, -30]):
        if not areas[-1] < most:  # heavy tails
            break
        below = direction(angles[np.argmax(areas < most)]).astype(np.float32)
        slopes = []
        for dtype in (np.float32, np.float64):
            m = np.float64(ndf.sample_visible(below.astype(dtype), xi.astype(dtype), scheme="continuous"))
            slopes.append(m[:, 0] / m[:, 2])
        assert np.max(np.abs(slopes[0] / slopes[1] - 1)) < 5e-5, most


@pytest.mark.parametrize("ndf", ALL, ids=name_of)
def test_outside_the_domain(ndf: Any) -> None:
    w = [0.6, 0.0, 0.8]
    for bad in (-0.1, 1.0, np.nan, np.inf):
        assert np.isnan(ndf.sample_visible(w, [bad, 0.5, 0.5])).all()
        assert np.isnan(ndf.sample_visible(w, [0.5, bad, 0.5])).all()
    assert np.isnan(ndf.sample_visible([0.0, 0.0, -1.0], [0.5, 0.5, 0.5])).all()
    assert np.isnan(ndf.sample_visible([np.nan, 0.0, 1.0], [0.5, 0.5, 0.5])).all()


@pytest.mark.parametrize("ndf", ALL, ids=name_of)
def test_mean_of_a_smooth_function(ndf: Any) -> None:
    """Sample means of two functions are their integrals against D_visible, anisotropic, above and below."""
    if isinstance(ndf, mf.GTR):
        pytest.skip("isotropic")
    make = {k: v for k, v in ndf.parameters.items() if k not in ("alpha_x", "alpha_y", "rotation")}
    ndf = type(ndf)(alpha_x=0.1, alpha_y=0.6, rotation=0.3, **make)
    z, weights = np.polynomial.legendre.leggauss(400)
    z, weights = (z + 1) / 2, weights / 2
    t = np.arange(400) / 400 * 2 * np.pi
    # The grid is dense where normals are steep or near the pole, and reaches as far as the tail matters.
    reach = 150.0 if make.get("gamma", 3.0) < 1.6 else 20.0
    radius = 1e-4 * np.sinh(reach * z)
    measure = 1e-4 * reach * np.cosh(reach * z) * weights * radius * 2 * np.pi / 400
    p, q = radius[:, None] * np.cos(t), radius[:, None] * np.sin(t)
    c, s = np.cos(0.3), np.sin(0.3)
    p, q = 0.1 * c * p - 0.6 * s * q, 0.1 * s * p + 0.6 * c * q
    m = np.stack([p, q, np.ones_like(p)], axis=-1) / np.sqrt(1 + p**2 + q**2)[..., None]
    area = 0.06 * measure[:, None] * m[..., 2] ** 3
    rng = np.random.default_rng(5)
    for degrees, phi, scheme in itertools.product((20.0, 85.0, 100.0), (0.2, 1.4), ("continuous", "mixture")):
        w = direction(np.radians(degrees), phi)
        density = area * ndf.pdf_visible(m, w)
        samples = ndf.sample_visible(w, rng.random((100_000, 4)), scheme=scheme)
        for function in (lambda m: m[..., 0], lambda m: m[..., 1] * m[..., 2]):
            values = function(samples)
            expected = float((density * function(m)).sum())
            assert abs(values.mean() - expected) < 5 * values.std() / np.sqrt(values.size) + 1e-4


def test_bounded_caps() -> None:
    """The bounded density integrates to one, and its samples reflect upwards more often."""
    ndf, rng = mf.GGX(alpha_x=0.4, alpha_y=0.8, rotation=0.2), np.random.default_rng(3)
    for degrees in (10.0, 60.0, 85.0, 100.0):
        w = direction(np.radians(degrees), 0.7)
        # By importance: the mean of the ratio of densities over ordinary visible normals.
        m = ndf.sample_visible(w, rng.random((400_000, 2)))
        ratio = ndf.pdf_visible(m, w, bounded=True) / ndf.pdf_visible(m, w)
        assert abs(ratio.mean() - 1) < 5 * ratio.std() / np.sqrt(ratio.size) + 1e-9
        bounded = ndf.sample_visible(w, rng.random((400_000, 2)), bounded=True)
        assert (ndf.pdf_visible(bounded, w, bounded=True) > 0).mean() > 1 - 1e-5
        for axis in (0, 2):
            expected = (ratio * m[:, axis]).mean()
            error = np.hypot((ratio * m[:, axis]).std(), bounded[:, axis].std()) / np.sqrt(ratio.size)
            assert abs(bounded[:, axis].mean() - expected) < 5 * error
        reflected = [2 * (n @ w)[:, None] * n - w for n in (m, bounded)]
        assert (reflected[1][:, 2] > 0).mean() >= (reflected[0][:, 2] > 0).mean()
    with pytest.raises(ValueError, match="GGX alone"):
        mf.Beckmann(alpha=0.3).sample_visible([0, 0, 1], [0.5, 0.5], bounded=True)


@pytest.mark.parametrize("ndf", ALL, ids=name_of)
def test_arrays(ndf: Any) -> None:
    """Any length, stride and shape gives the same bits; directions and uniforms broadcast."""
    rng = np.random.default_rng(2)
    w, xi = rng.normal(size=(37, 3)), rng.random((37, 4))
    w /= np.linalg.norm(w, axis=1)[:, None]
    for dtype, scheme in itertools.product((np.float32, np.float64), ("continuous", "mixture")):
        v, u = w.astype(dtype), np.minimum(xi.astype(dtype), np.nextafter(dtype(1), dtype(0)))
        m = ndf.sample_visible(v, u, scheme=scheme)
        one_by_one = np.array([ndf.sample_visible(a, b, scheme=scheme) for a, b in zip(v, u, strict=True)])
        np.testing.assert_array_equal(m, one_by_one)
        grid = ndf.sample_visible(v[:, None], u, scheme=scheme)
        np.testing.assert_array_equal(grid[np.arange(37), np.arange(37)], m)
        out = np.zeros((37, 6), dtype)[:, ::2]
        assert ndf.sample_visible(v[::-1], u[::-1], scheme=scheme, out=out) is out
        np.testing.assert_array_equal(out, m[::-1])


def test_agrees_with_mitsuba() -> None:
    """Beckmann: the same normals for the same uniforms."""
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    theirs = mi.MicrofacetDistribution(mi.MicrofacetType.Beckmann, 0.3, 0.5, True)
    ours = mf.Beckmann(alpha_x=0.3, alpha_y=0.5)
    rng = np.random.default_rng(1)
    for xi in rng.uniform(0.01, 0.99, (200, 2)).astype(np.float32):
        w = direction(rng.uniform(0.05, 1.4), rng.uniform(0, 6.3)).astype(np.float32)
        m, _ = theirs.sample(mi.Vector3f(*map(float, w)), mi.Point2f(*map(float, xi)))
        np.testing.assert_allclose(ours.sample_visible(w, xi), np.array(m), atol=2e-4)
