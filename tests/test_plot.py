"""The public figures: the curves they draw are the library's functions."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.axes import Axes

import microfacet as mf
from microfacet import plot
from microfacet._family.looks import look

NDF = mf.StudentT(alpha_x=0.2, alpha_y=0.5, rotation=0.3, gamma=2.5)


@pytest.fixture
def ax() -> Iterator[Axes]:
    mpl.use("agg")
    figure, axes = plt.subplots()
    yield axes
    plt.close(figure)


def line(axes: Axes) -> tuple[np.ndarray, np.ndarray]:
    x, y = axes.lines[-1].get_data()
    return np.asarray(x), np.asarray(y)


def direction(theta: np.ndarray, azimuth: float) -> np.ndarray:
    return np.stack(
        [np.sin(theta) * np.cos(azimuth), np.sin(theta) * np.sin(azimuth), np.cos(theta)], axis=-1
    )


def test_density_and_areas_along_an_azimuth(ax: Axes) -> None:
    theta, values = line(plot.density(NDF, ax, azimuth=0.7))
    np.testing.assert_allclose(values, NDF.D(direction(np.radians(theta), 0.7)), rtol=1e-9)
    u, values = line(plot.sigma(NDF, ax, azimuth=0.7))
    assert u[0] == -1
    assert u[-1] == 1
    np.testing.assert_allclose(values, NDF.sigma(direction(np.arccos(u), 0.7)), atol=1e-9)
    u, values = line(plot.Lambda(NDF, ax, azimuth=0.7))
    np.testing.assert_allclose(values, NDF.Lambda(direction(np.arccos(u), 0.7)), rtol=1e-7)


def test_slope_densities_integrate_to_one(ax: Axes) -> None:
    p, values = line(plot.marginal(mf.Beckmann(alpha=0.3), ax))
    assert np.trapezoid(values, p) == pytest.approx(1.0, abs=1e-3)
    p, values = line(plot.joint(mf.Beckmann(alpha=0.3), ax, extent=2.0))
    assert p[-1] == 2.0
    # Integrated over circles, with p dp dphi for the area.
    half = p >= 0
    assert np.trapezoid(2 * np.pi * p[half] * values[half], p[half]) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("name", ["density", "joint", "marginal", "sigma"])
def test_infinite_values_are_left_out(ax: Axes, name: str) -> None:
    getattr(plot, name)(mf.BesselK(alpha=0.5, a=0.3), ax, log=True)
    assert all(np.isfinite(data).all() for data in line(ax))
    assert ax.get_yscale() == "log"
    low, high = ax.get_ylim()
    assert 0 < low < high < np.inf


def test_log_axes_grow_with_every_curve(ax: Axes) -> None:
    plot.density(mf.Beckmann(alpha=0.5), ax, log=True)
    first = ax.get_ylim()
    plot.density(mf.Beckmann(alpha=0.05), ax, log=True)
    assert ax.get_ylim()[1] > first[1]
    assert ax.get_ylim()[0] <= first[0]


@pytest.mark.parametrize("ndf", [mf.GGX(alpha=0.5), NDF], ids=["isotropic", "anisotropic"])
def test_histogram_follows_its_curve(ax: Axes, ndf: mf.GGX) -> None:
    plot.histogram(ndf, ax, n=100_000, bins=20)
    heights, edges, _ = ax.patches[0].get_data()
    u, curve = line(ax)
    middle = 0.5 * (edges[1:] + edges[:-1])
    expected = [np.mean(curve[(u > a) & (u < b)]) for a, b in itertools.pairwise(edges)]
    assert middle.size == 20
    np.testing.assert_allclose(heights, expected, atol=0.1, rtol=0.1)
    assert np.sum(heights * np.diff(edges)) == pytest.approx(1.0)


def test_slope_histogram_turns_the_fitted_density(ax: Axes) -> None:
    normals = NDF.sample(np.random.default_rng(5).random((200_000, 2)))
    slopes = -normals[:, :2] / normals[:, 2:]
    plot.slope_histogram(slopes, {"fit": NDF}, ax, azimuth=0.3 + np.pi / 2, bins=40)
    heights, edges, _ = ax.patches[0].get_data()
    p, curve = line(ax)
    # Along the second principal axis the marginal is that of roughness alpha_y.
    np.testing.assert_allclose(curve, mf.student_t.P2(p, 0.5, 2.5), rtol=1e-10)
    np.testing.assert_allclose(heights, np.interp(0.5 * (edges[1:] + edges[:-1]), p, curve), atol=0.05)


def test_every_family_has_a_colour_and_a_dash() -> None:
    names = {family.name for family in mf.families()}
    assert names == plot.COLORS.keys() == plot.DASHES.keys()
    assert len({(plot.COLORS[name], str(plot.DASHES[name])) for name in names}) == len(names)


def test_looks_tell_many_curves_apart() -> None:
    looks = [look(number) for number in range(144)]
    assert len({(color, str(dashes)) for color, dashes in looks}) == 144
    assert len({color for color, _ in looks[:12]}) == len({str(dashes) for _, dashes in looks[:12]}) == 12


def test_draws_into_the_current_axes(ax: Axes) -> None:
    assert plot.density(mf.GGX(alpha=0.5)) is ax
