"""Samples follow their densities: all normals, visible ones by every scheme, in both precisions.

Some of the grid; `make docs-sampling` runs all of it, with a million samples, for docs/sampling_tests.md.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import microfacet as mf
import sampling_cases
from microfacet.testing._cells import DOMAINS, Cells
from microfacet.testing._quadrature import integrate
from sampling_cases import Case

Array = NDArray[np.float64]
SELECTION = sampling_cases.selection()
SAMPLES = 100_000
TESTS = 2 * len(SELECTION)


def towards(degrees: float, azimuth: float = 0.0) -> Array:
    s, phi = np.sin(np.radians(degrees)), np.radians(azimuth)
    return np.array([s * np.cos(phi), s * np.sin(phi), np.sin(np.radians(90.0 - degrees))])


def test_the_selection_meets_every_value_of_the_grid() -> None:
    everything = list(sampling_cases.cases())
    values: tuple[Callable[[Case], object], ...] = (
        lambda case: case.family,
        lambda case: case.scheme,
        lambda case: case.incidence,
        lambda case: case.azimuth,
        lambda case: case.dtype,
        lambda case: dict(case.parameters).get("alpha"),
        lambda case: (case.family, case.parameters[-1]),
        lambda case: (case.family, case.scheme),
    )
    for value in values:
        assert {value(case) for case in SELECTION} == {value(case) for case in everything}


@pytest.mark.parametrize("case", SELECTION, ids=str)
def test_samples_follow_the_density(case: Case) -> None:
    result = case.chi2(SAMPLES, TESTS, (16, 16))
    assert result, result
    assert abs(result.mass - 1.0) < 1e-4, "the density integrates to 1"


@pytest.mark.parametrize("case", [case for case in SELECTION if case.has_slope], ids=str)
def test_visible_slopes_follow_their_distribution(case: Case) -> None:
    result = case.slope(SAMPLES, TESTS)
    assert result, result


WHITE = [
    mf.Beckmann(alpha_x=0.1, alpha_y=0.6, rotation=0.3),
    mf.GGX(alpha=0.8),
    mf.GTR(alpha=0.3, gamma=1.5),
    mf.StudentT(alpha=0.5, gamma=1.6),
    mf.K0(alpha=0.4),
    mf.BesselK(alpha_x=0.5, alpha_y=0.2, a=0.7),
]


@pytest.mark.parametrize("ndf", WHITE, ids=repr)
@pytest.mark.parametrize("degrees", [0, 60, 88])
def test_the_weight_of_a_sample_is_g2_over_g1(ndf: Any, degrees: float) -> None:
    """The albedo of a white conductor: its mean over visible normals, and its integral over all of them."""
    w = towards(degrees, 25)
    rng = np.random.default_rng(11)

    def reflected(m: Array) -> Array:
        return np.asarray(2.0 * (m @ w)[..., None] * m - w)

    def integrand(m: Array) -> Array:
        seen = np.maximum(m @ w, 0.0) * ndf.D(m) / w[2]
        return np.asarray(np.where(seen > 0.0, seen * ndf.G2(w, reflected(m)) * upwards(m), 0.0))

    def upwards(m: Array) -> NDArray[np.bool_]:
        return np.asarray(reflected(m)[..., 2] > 0.0)

    m = ndf.sample_visible(w, rng.random((400_000, ndf.visible_dims)))
    weights = np.where(upwards(m), ndf.G2(w, reflected(m)) / ndf.G1(w), 0.0)
    assert weights.max() <= 1.0 + 1e-12, "no sample weighs more than one"
    cells = Cells.around(m[:50_000], DOMAINS["hemisphere"], 32, 32)
    albedo = float(integrate(integrand, cells, 1e-7).sum())
    deviation = weights.std() / np.sqrt(len(weights))
    assert abs(weights.mean() - albedo) < 4.5 * deviation + 1e-6
    assert deviation < 2e-3, "so that a wrong weight would show"


DEEP = [
    (mf.StudentT(alpha=0.01, gamma=20.0), 130),
    (mf.StudentT(alpha=0.1, gamma=20.0), 170),
    (mf.BesselK(alpha=0.01, a=1.3), 130),
    (mf.BesselK(alpha=0.1, a=10.0), 170),
    (mf.Beckmann(alpha=0.1), 150),
]


@pytest.mark.parametrize("scheme", ["continuous", "mixture"])
@pytest.mark.parametrize(("ndf", "degrees"), DEEP, ids=str)
def test_float32_reaches_directions_whose_area_it_cannot_hold(ndf: Any, degrees: int, scheme: str) -> None:
    w = towards(degrees)
    assert 0 < ndf.sigma(w) < 1e-30
    dims = ndf.visible_dims if scheme == "continuous" else ndf.mixture_dims
    xi = np.random.default_rng(3).random((4000, dims))

    def slopes(dtype: type, in_place: bool = False) -> Array:
        uniforms = xi.astype(dtype)
        room = uniforms[:, :3] if in_place else None
        x, y, z = ndf.sample_visible(w.astype(dtype), uniforms, scheme=scheme, out=room).T.astype(np.float64)
        return np.abs(np.stack((x / z, y / z)))

    double, single = slopes(np.float64), slopes(np.float32)
    if scheme == "continuous":
        assert np.all(np.abs(double - single).mean(axis=1) < 1e-6 * double.mean(axis=1))
    else:
        spread = 5 * double.std(axis=1) * np.sqrt(2 / 4000)
        assert np.all(np.abs(double.mean(axis=1) - single.mean(axis=1)) < spread)
    if dims >= 3:  # where results replace the uniform numbers
        np.testing.assert_allclose(slopes(np.float32, in_place=True)[0], single[0], rtol=1e-5)


@pytest.mark.parametrize("ndf", [mf.GTR(alpha=0.3, gamma=1.5), mf.BesselK(alpha=0.3, a=1.3)], ids=repr)
def test_mixture_is_a_scheme_of_its_own(ndf: Any) -> None:
    xi = np.random.default_rng(1).random((100, ndf.mixture_dims))
    schemes = [ndf.sample_visible(towards(60), xi, scheme=scheme) for scheme in ("continuous", "mixture")]
    assert not np.allclose(*schemes)


def test_rounding_at_the_seam_of_the_mixture() -> None:
    """Found by a million samples: what is left of the first uniform number rounded to more than 1."""
    xi = np.full((400, 3), [0.5347374, 0.5052149, 0.27541554], dtype=np.float32)
    xi[:, 0] += (np.arange(400, dtype=np.float32) - 200) * np.float32(2**-24)
    w = towards(80, 35).astype(np.float32)
    m = mf.Beckmann(alpha=1.0).sample_visible(w, xi, scheme="mixture")
    assert not np.isnan(m).any()


@pytest.mark.parametrize(("alpha", "gamma"), [(1e-4, 15.0), (1e-3, 50.0), (10.0, 20.0)])
def test_extreme_gtr_has_visible_normals(alpha: float, gamma: float) -> None:
    """Its tables in double precision have too few pieces; its own functions serve."""
    ndf, w = mf.GTR(alpha=alpha, gamma=gamma), towards(60)
    xi = np.random.default_rng(5).random((20_000, 3))
    m = ndf.sample_visible(w, xi)
    assert m.dtype == np.float64
    assert np.all(m[:, 2] > 0)
    result = sampling_cases.Case("gtr", (("alpha", alpha), ("gamma", gamma)), "continuous", 60.0, 35.0)
    assert result.slope(20_000, 3), result
