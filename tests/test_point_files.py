"""Lists of points x, y, z become maps where they lie on a grid, and are refused elsewhere."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import microfacet as mf
from surface_file_cases import our_own_readers, refused

RNG = np.random.default_rng(11)
NX, NY = 9, 7
HEIGHTS = np.round(RNG.normal(size=(NY, NX)), 5)
X, Y = np.meshgrid(3.0 + 0.5 * np.arange(NX), -2.0 + 0.25 * np.arange(NY))
POINTS = np.column_stack((X.ravel(), Y.ravel(), HEIGHTS.ravel()))


def write(folder, points, heading="", mark=" ", digits=6):
    file = folder / "points.txt"
    rows = (mark.join(f"{number:.{digits}f}" for number in row) for row in points)
    file.write_text(heading + "\n".join(rows) + "\n", encoding="utf-8")
    return file


def check(surface, heights=HEIGHTS, factor=1e-6, size=(5e-7, 2.5e-7)):
    assert surface.pixel_size == pytest.approx(size)
    known = np.isfinite(heights)
    assert np.array_equal(surface.mask, known)
    assert surface.heights[known] == pytest.approx(factor * heights[known], abs=1e-12)


ORDERS = {
    "rows": np.arange(len(POINTS)),
    "columns": np.arange(len(POINTS)).reshape(NY, NX).T.ravel(),
    "from the top": np.arange(len(POINTS)).reshape(NY, NX)[::-1].ravel(),
    "back and forth": np.concatenate(
        [row[:: (-1) ** i] for i, row in enumerate(np.arange(NX * NY).reshape(NY, NX))]
    ),
    "shuffled": RNG.permutation(len(POINTS)),
}


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("mark", [" ", ",", ";", "\t"])
def test_in_any_order(tmp_path, order, mark):
    surface = mf.read_surface(write(tmp_path, POINTS[ORDERS[order]], mark=mark), unit="um")
    check(surface)
    assert surface.steps == ("63 points x, y, z (columns 1, 2, 3) put on their grid of 9 x 7 pixels",)


def test_gaps_are_missing_pixels(tmp_path):
    rest = np.delete(POINTS, [0, 5, 30, 62], axis=0)
    heights = HEIGHTS.copy()
    heights.ravel()[[0, 5, 30, 62]] = np.nan
    check(mf.read_surface(write(tmp_path, rest), unit="um"), heights)
    no_column = POINTS[X.ravel() != X[0, 4]]
    heights = HEIGHTS.copy()
    heights[:, 4] = np.nan
    check(mf.read_surface(write(tmp_path, no_column), unit="um"), heights)


@pytest.mark.parametrize(
    ("heading", "columns", "factor"),
    [
        ("x [um] y [um] z [nm]\n", [0, 1, 2], 1e-9),
        ("# z/nm x/um y/um\n", [2, 0, 1], 1e-9),
        ("Y(um) X(um) Height(um)\n", [1, 0, 2], 1e-6),
        ("i x [um] y [um] z [um] intensity\n", [3, 0, 1, 2, 3], 1e-6),
        ("x y z\n[um] [um] [nm]\n", [0, 1, 2], 1e-9),
        ("Unit: um\nx y z\n", [0, 1, 2], 1e-6),
    ],
)
def test_columns_go_by_their_names_and_units(tmp_path, heading, columns, factor):
    extended = np.column_stack((POINTS, RNG.integers(0, 99, len(POINTS))))
    surface = mf.read_surface(write(tmp_path, extended[:, columns], heading))
    check(surface, factor=factor)
    assert ("2 other columns left out" in surface.steps) == (len(columns) == 5)
    assert surface.warnings == ()
    refused(lambda: mf.read_surface(tmp_path / "points.txt", unit="mm"), "states the unit")
    refused(lambda: mf.read_surface(tmp_path / "points.txt", pixel_size=1e-3), "states a pixel of")


def test_points_without_a_unit_ask_for_it(tmp_path):
    file = write(tmp_path, POINTS)
    refused(lambda: mf.read_surface(file), "does not state its unit of length, give unit=")
    check(mf.read_surface(file, unit="nm", pixel_size=(5e-7, 2.5e-7)), factor=1e-9)
    numbered = np.column_stack((np.arange(len(POINTS)), POINTS, POINTS[:, 2] ** 2))
    check(mf.read_surface(write(tmp_path, numbered), unit="um"))  # columns 2, 3, 4 by what they hold


def test_positions_of_few_digits(tmp_path):
    x, y = np.meshgrid(np.arange(30) / 3, np.arange(20) / 7)
    heights = RNG.normal(size=x.shape)
    points = np.column_stack((x.ravel(), y.ravel(), heights.ravel()))
    surface = mf.read_surface(write(tmp_path, points[RNG.permutation(600)], digits=3), unit="um")
    assert surface.pixel_size == pytest.approx((1e-6 / 3, 1e-6 / 7), rel=1e-3)
    assert surface.heights == pytest.approx(1e-6 * heights, abs=1e-9)


SCATTERED = RNG.uniform(size=(200, 3))
REFUSED = {
    "scattered": (SCATTERED, "on no regular grid"),
    "scattered on a fine lattice": (np.round(SCATTERED, 2), "on no regular grid"),
    "three pixels wide": (RNG.normal(size=(40, 3)), "three columns are taken for points"),
    "twice": (np.concatenate((POINTS, POINTS[:9])), "on no regular grid|at the same place"),
    "turned": (POINTS @ np.array([[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]]), "on no regular grid"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_lies_on_no_grid_is_refused(tmp_path, case):
    points, message = REFUSED[case]
    refused(lambda: mf.read_surface(write(tmp_path, points), unit="um", pixel_size=1e-6), message)


NAMED = {
    "scattered": (SCATTERED, "lie on no regular grid along x"),
    "scattered on a fine lattice": (np.round(SCATTERED, 2), "fill too little"),
    "twice": (np.concatenate((POINTS, POINTS[:9])), "at the same place"),
    "few": (POINTS[:8], "8 points x, y, z, at least 9"),
    "a line": (POINTS[:9], "on no regular grid along y"),
}


@pytest.mark.parametrize("case", NAMED)
def test_named_columns_say_why(tmp_path, case):
    points, message = NAMED[case]
    refused(lambda: mf.read_surface(write(tmp_path, points, "x y z\n"), unit="um"), message)


def test_positions_without_a_unit_are_not_guessed(tmp_path):
    file = write(tmp_path, POINTS, "x y z[nm]\n")
    refused(lambda: mf.read_surface(file), "positions or a pixel size without their unit, give pixel_size")
    check(mf.read_surface(file, pixel_size=(5e-7, 2.5e-7)), factor=1e-9)


def test_two_units_of_one_plane_are_refused(tmp_path):
    file = write(tmp_path, POINTS, "x[um] y[mm] z[um]\n")
    refused(lambda: mf.read_surface(file), "x is in 'um' and y in 'mm'")


@settings(max_examples=100)
@given(
    rows=st.lists(st.lists(st.floats(), min_size=4, max_size=4), min_size=3, max_size=30),
    columns=st.integers(2, 4),
    heading=st.sampled_from(["", "x y z w\n", "x[nm] y[nm] z[nm]\n"]),
)
def test_any_numbers_are_read_or_refused(tmp_path, rows, columns, heading):
    file = tmp_path / "points.txt"
    file.write_text(heading + "\n".join(" ".join(map(repr, row[:columns])) for row in rows))
    with contextlib.suppress(mf.SurfaceError), our_own_readers():
        surface = mf.read_surface(file, unit="nm")
        assert np.isfinite(surface.heights[surface.mask]).all()
    with contextlib.suppress(mf.SurfaceError), our_own_readers():
        assert np.isfinite(mf.read_slopes(file).values).all()


@settings(max_examples=60)
@given(
    shape=st.tuples(st.integers(3, 40), st.integers(3, 40)),
    steps=st.tuples(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3)),
    start=st.tuples(st.floats(-1e4, 1e4), st.floats(-1e4, 1e4)),
    seed=st.integers(0, 2**32 - 1),
    missing=st.floats(0, 0.3),
)
def test_any_grid_is_recovered(tmp_path, shape, steps, start, seed, missing):
    """Whatever the order, with gaps and in full precision; the corners are there, so the extent is known."""
    rng = np.random.default_rng(seed)
    heights = rng.normal(size=shape)
    heights[rng.uniform(size=shape) < missing] = np.nan
    heights[[0, 0, -1, -1], [0, -1, 0, -1]] = 1.0, 2.0, 3.0, 4.0
    heights[0, :2] = heights[:2, 0] = 1.0, 5.0
    x, y = np.meshgrid(start[0] + steps[0] * np.arange(shape[1]), start[1] + steps[1] * np.arange(shape[0]))
    known = np.isfinite(heights)
    points = np.column_stack((x[known], y[known], heights[known]))
    rng.shuffle(points)
    file = tmp_path / "points.txt"
    file.write_text("x y z\n" + "\n".join(" ".join(map(repr, row)) for row in points.tolist()))
    if known.sum() < 9:
        return
    surface = mf.read_surface(file, unit="m")
    assert np.array_equal(surface.mask, known)
    assert np.array_equal(surface.heights[known], heights[known])
    assert surface.pixel_size == pytest.approx(steps, rel=1e-6)
