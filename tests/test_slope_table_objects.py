"""Densities on grids of slopes: objects, histograms, and arguments that are refused."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from slope_table_cases import made, sphere


def test_they_are_values() -> None:
    ndf = made("tilted")
    for other in (copy.copy(ndf), copy.deepcopy(ndf), pickle.loads(pickle.dumps(ndf))):
        assert other == ndf
        assert hash(other) == hash(ndf)
        w = sphere(50)
        np.testing.assert_array_equal(other.sigma(w), ndf.sigma(w))
        assert not other.masses.flags.writeable
    assert ndf != made("anisotropic")
    assert ndf.moved(0.0, 0.0) == ndf
    assert ndf.parameters == {}
    with pytest.raises(AttributeError, match="SlopeTable is frozen"):
        ndf.error = 0.0
    with pytest.raises(ValueError, match="read-only"):
        ndf.masses[0, 0] = 1.0
    assert "12 x 9 cells" in repr(ndf)
    assert "mean slope (0.8, -0.5)" in repr(ndf)
    metal = mf.Conductor(ndf, 1.5, 2.0)
    assert pickle.loads(pickle.dumps(metal)) == metal


def test_given_arrays_stay_as_they_are() -> None:
    p, masses = np.linspace(-1, 1, 4), np.ones((3, 3))
    ndf = mf.SlopeTable(p, p, masses)
    masses[0, 0] = 5.0
    p[0] = -7.0
    assert ndf.p_edges[0] == -1.0
    assert ndf.masses[0, 0] == pytest.approx(1 / 9)


def test_histograms() -> None:
    slopes = np.random.default_rng(1).normal([0.1, -0.2], [0.2, 0.4], (50_000, 2))
    ndf = mf.SlopeTable.from_slopes(slopes, bins=(32, 48))
    counts, p, q = np.histogram2d(*slopes.T, bins=(32, 48))
    assert ndf == mf.SlopeTable(p, q, counts)
    assert ndf.mean == pytest.approx(slopes.mean(axis=0), abs=5e-3)
    by_rule = mf.SlopeTable.from_slopes(slopes)
    step = 3.5 * slopes.std(axis=0) * 50_000**-0.25
    assert np.diff(by_rule.p_edges)[0] == pytest.approx(step[0], rel=0.05)
    assert np.diff(by_rule.q_edges)[0] == pytest.approx(step[1], rel=0.05)
    sample = mf.SlopeSample(slopes, "test")
    assert mf.SlopeTable.from_slopes(sample) == by_rule
    terrain = mf.sample_terrain()
    assert mf.SlopeTable.from_slopes(terrain, bins=40) == mf.SlopeTable.from_slopes(terrain.slopes(), bins=40)


E = np.linspace(-1.0, 1.0, 4)
M = np.ones((3, 3))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((E, E, -M), "masses must be finite and not negative, got -1"),
        ((E, E, M * np.nan), "masses must be finite and not negative, got nan"),
        ((E, E, M * np.inf), "masses must be finite and not negative, got inf"),
        ((E, E, 0 * M), "masses must not all be 0"),
        ((E, E, M[:2]), r"masses must have shape \(3, 3\), one less than edges each way, got \(2, 3\)"),
        ((E, E, "text"), "masses must be an array of real numbers with 2 axes, got str"),
        ((E, E, [[1.0], [1.0, 2.0]]), "masses must be an array of real numbers"),
        ((E, E, 1j * M), "masses must be an array of real numbers"),
        ((E[::-1], E, M), "p_edges must increase strictly"),
        ((E, [-1.0, 0.0, 0.0, 1.0], M), "q_edges must increase strictly"),
        (([-1.0, 0.0, 0.5, 1.0], E, M), "p_edges must be evenly spaced, got steps from 0.5 to 1"),
        ((E * np.inf, E, M), r"p_edges must lie in \[-1e\+06, 1e\+06\], got -inf"),
        ((E, [0.0, np.nan, 1.0], M), r"q_edges must lie in .* got nan"),
        ((E * 1e7, E, M), "p_edges must lie in"),
        ((1.0 + E * 1e-12, E, M), "the steps of p_edges must be at least 1e-09 of its largest edge"),
        (([1.0], E, M), "p_edges must be 2 to 513 edges of cells, got 1"),
        ((np.linspace(0, 1, 514), E, M), "p_edges must be 2 to 513 edges of cells, got 514"),
        ((M, E, M), "p_edges must be an array of real numbers with 1 axis, got ndarray of shape"),
    ],
)
def test_bad_tables(arguments: tuple[Any, ...], message: str) -> None:
    with pytest.raises(ValueError, match="SlopeTable: " + message):
        mf.SlopeTable(*arguments)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: mf.SlopeTable.from_slopes(np.zeros((50, 2))), "at least 100 pairs"),
        (lambda: mf.SlopeTable.from_slopes(np.zeros((200, 3))), r"pairs \(p, q\), got shape \(200, 3\)"),
        (lambda: mf.SlopeTable.from_slopes(np.zeros((200, 2))), "all slopes p are the same"),
        (lambda: mf.SlopeTable.from_slopes(np.full((200, 2), np.nan)), "slopes must lie in .* got nan"),
        (lambda: mf.SlopeTable.from_slopes("file"), "slopes must be an array of real numbers"),
        (lambda: mf.SlopeTable.from_slopes(sphere(200)[:, :2], bins=0), "bins must be a whole number in"),
        (lambda: mf.SlopeTable.from_slopes(sphere(200)[:, :2], bins=(3, 513)), "bins must be a whole number"),
        (lambda: mf.SlopeTable.from_slopes(sphere(200)[:, :2], extent=(1, 2)), "extent must be"),
        (lambda: mf.SlopeTable.from_slopes(sphere(200)[:, :2], extent=((5, 6), (5, 6))), "must not all be 0"),
        (lambda: mf.SlopeTable.from_distribution("ggx"), "ndf must be a distribution, got 'ggx'"),
        (
            lambda: mf.SlopeTable.from_distribution(mf.GGX(alpha=0.3), mean=(np.nan, 0)),
            "mean must be two slopes",
        ),
        (lambda: mf.SlopeTable.from_distribution(mf.GGX(alpha=0.3), bins=1.5), "bins must be a whole number"),
        (lambda: made("holes").moved(np.inf, 0.0), "p_edges must lie in"),
    ],
)
def test_bad_input(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(ValueError, match=r"SlopeTable.(from_\w+|moved): .*" + message):
        call()


def test_tiny_and_huge_masses() -> None:
    whole = mf.SlopeTable(E, E, M)
    for factor in (1e-308, 1e300):
        np.testing.assert_allclose(mf.SlopeTable(E, E, M * factor).masses, whole.masses, rtol=1e-14)


def test_largest_table() -> None:
    """512 x 512 cells, in which nothing overflows and sums keep their digits."""
    edges = np.linspace(-1.0, 1.0, 513)
    centre = (edges[1:] + edges[:-1]) / 2
    ndf = mf.SlopeTable(edges, edges, np.exp(-20 * (centre[:, None] ** 2 + centre**2)))
    assert ndf.error < 1e-11
    assert ndf.sigma([0, 0, 1]) == pytest.approx(1.0, rel=1e-13)
    w = sphere(100)
    family = mf.Beckmann(alpha=20**-0.5)
    steep = np.abs(w[:, 2]) < 0.9
    np.testing.assert_allclose(ndf.sigma(w)[steep], family.sigma(w)[steep], rtol=2e-3, atol=1e-6)
    m = ndf.sample_visible(w, np.random.default_rng(1).random((100, 2)))
    assert np.all((m * w).sum(axis=1)[ndf.sigma(w) > 0] > -1e-12)
