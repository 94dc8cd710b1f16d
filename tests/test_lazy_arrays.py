"""Arrays of dask stay lazy and those of xarray keep their labels, in all that draws or scatters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from material_cases import Array, directions

da = pytest.importorskip("dask.array")
xr = pytest.importorskip("xarray")

N, M = 12, 4
COLOURS = ([0.2, 1.04, 1.18], [3.9, 2.6, 2.4])


def uniforms(count: int, *shape: int) -> Array:
    return np.random.default_rng(1).random((*shape, count))


NDF = mf.StudentT(alpha_x=0.2, alpha_y=0.5, rotation=0.3, gamma=2.5)
METAL = mf.Conductor(NDF, *COLOURS)
GLASS = mf.Dielectric(mf.K0(alpha=0.4), 1.5)
ROUGH = mf.Conductor(mf.GGX(alpha=0.6), *COLOURS)
CLAY = mf.Diffuse(mf.GGX(alpha=0.5), [[0.2, 0.5], [0.7, 0.9]])
GREY = mf.Diffuse(mf.GGX(alpha=0.5), 0.5, scattering="single")
# A function of directions (and uniform numbers), what it is given, and which of its results are directions.
CASES: dict[str, tuple[Callable[..., Any], str, str]] = {
    "sample": (NDF.sample, "u2", "w"),
    "sample of gtr": (mf.GTR(alpha=0.3, gamma=1.5).sample, "u2", "w"),
    "sample_visible": (NDF.sample_visible, "wu3", "w"),
    "sample_visible, mixture": (lambda w, xi: NDF.sample_visible(w, xi, scheme="mixture"), "wu4", "w"),
    "sample_visible, bounded": (
        lambda w, xi: mf.GGX(alpha=0.3).sample_visible(w, xi, bounded=True),
        "wu2",
        "w",
    ),
    "metal.eval": (METAL.eval, "ww", "c"),
    "metal.pdf": (METAL.pdf, "ww", "-"),
    "metal.sample": (METAL.sample, "wu3", "wc-"),
    "metal.albedo": (ROUGH.albedo, "w", "c"),
    "metal.albedo, error": (lambda w: ROUGH.albedo(w, with_error=True), "w", "cc"),
    "glass.eval": (GLASS.eval, "ww", "-"),
    "glass.pdf": (GLASS.pdf, "ww", "-"),
    "glass.sample": (GLASS.sample, "wu4", "w--"),
    "clay.eval": (lambda i, o: CLAY.eval(i, o, n=3, rng=1), "ww", "d"),
    "clay.pdf": (CLAY.pdf, "ww", "-"),
    "clay.sample": (lambda w: CLAY.sample(w, rng=1), "w", "wd-"),
    "clay.walk": (lambda w: CLAY.walk(w, rng=1), "w", "wd-"),
    "clay.albedo": (lambda w: CLAY.albedo(w, n=10, rng=1), "w", "d"),
    "grey.sample": (lambda w: GREY.sample(w, rng=2), "w", "w--"),
    **{
        f"{type(m).__name__}.{name}": (getattr(m, name), given, results)
        for m in (mf.KullaConty(ROUGH), mf.Turquin(ROUGH))
        for name, given, results in (
            ("eval", "ww", "c"),
            ("pdf", "ww", "-"),
            ("albedo", "w", "c"),
            ("sample", "wu3", "wc-") if isinstance(m, mf.KullaConty) else ("sample", "wu2", "wc-"),
        )
    },
    "D": (NDF.D, "w", "-"),
    "D_visible": (NDF.D_visible, "ww", "-"),
}
each_case = pytest.mark.parametrize("case", CASES)


def given(kinds: str) -> list[Array]:
    """Arrays that broadcast to (N, M): (N, 1, ...) and (M, ...)."""
    if len(kinds.replace("u", "")) == 1 or kinds.startswith("u"):
        count = int(kinds[1:]) if kinds.startswith("u") else 3
        return [directions(N * M, 2).reshape(N, M, 3) if kinds == "w" else uniforms(count, N, M)]
    second = uniforms(int(kinds[2:]), M) if kinds[1] == "u" else directions(M, 3)
    return [directions(N, 2).reshape(N, 1, 3), second]


def results(value: Any) -> list[Any]:
    return list(value) if isinstance(value, tuple) else [value]


@each_case
def test_dask_arrays_stay_lazy(case: str) -> None:
    function, kinds, _ = CASES[case]
    arrays = given(kinds)
    expected = results(function(*arrays))
    for chunk in (7, 5):
        lazy = [da.from_array(a, chunks=(chunk, *a.shape[1:-1], 2)) for a in arrays]
        for inputs in (lazy, [*lazy[:-1], arrays[-1]] if len(lazy) > 1 else lazy):
            found = results(function(*inputs))
            for value, exact in zip(found, expected, strict=True):
                assert isinstance(value, da.Array)
                assert value.dtype == exact.dtype
                assert value.shape == exact.shape
                same(case, value.compute(scheduler="threads"), exact)


def same(case: str, value: Array, exact: Array) -> None:
    """The same bits, but for quadratures, whose sums are of several directions at a time."""
    np.testing.assert_allclose(
        value, exact, rtol=1e-13 if "albedo" in case else 0, atol=1e-13 if "albedo" in case else 0
    )


def test_nothing_is_computed_before_it_is_asked_for() -> None:
    def fail(block: Array) -> Array:
        assert block.size == 0 or block.shape[0] == 1, "computed"  # dask looks at blocks of this size alone
        return block

    lazy = da.from_array(directions(1000, 4), chunks=(100, 3)).map_blocks(fail, dtype=float)
    xi = da.from_array(uniforms(4, 1000), chunks=(100, 4)).map_blocks(fail, dtype=float)
    later = [
        NDF.sample_visible(lazy, xi[:, :3]),
        NDF.sample(xi[:, :2]),
        METAL.eval(lazy, lazy),
        *METAL.sample(lazy, xi[:, :3]),
        CLAY.eval(lazy, lazy, rng=1),
        *CLAY.walk(lazy, rng=1),
        GLASS.albedo(lazy),
    ]
    for value in later:
        with pytest.raises(AssertionError, match="computed"):
            value.compute(scheduler="synchronous")


@each_case
@pytest.mark.parametrize("chunked", [False, True])
def test_labels_stay(case: str, chunked: bool) -> None:
    function, kinds, outputs = CASES[case]
    arrays = given(kinds)
    expected = results(function(*arrays))
    rows, columns = {"row": np.arange(N) * 0.5}, {"column": list("abcd")}
    axis = {"axis": ["x", "y", "z"]}
    labelled = []
    for array, kind in zip(arrays, (k for k in kinds if not k.isdigit()), strict=True):
        last = "axis" if kind == "w" else "number"
        coordinates = axis if kind == "w" else {}
        if array.ndim == 2:
            labelled.append(xr.DataArray(array, dims=("column", last), coords=columns | coordinates))
        elif array.shape[1] == 1:
            labelled.append(xr.DataArray(array[:, 0], dims=("row", last), coords=rows | coordinates))
        else:
            both = rows | columns | coordinates
            labelled.append(xr.DataArray(array, dims=("row", "column", last), coords=both))
    if chunked:
        labelled = [array.chunk({array.dims[0]: 9}) for array in labelled]
    dims = {
        "w": ("axis" if "w" in kinds else "xyz",),
        "c": ("channel",),
        "d": ("channel_0", "channel_1"),
        "-": (),
    }
    for value, exact, kind in zip(results(function(*labelled)), expected, outputs, strict=True):
        assert isinstance(value, xr.DataArray)
        assert value.dims == ("row", "column", *dims[kind])
        assert isinstance(value.data, da.Array) == chunked
        np.testing.assert_array_equal(value.row, rows["row"])
        np.testing.assert_array_equal(value.column, columns["column"])
        if kind == "w" and "w" in kinds:
            np.testing.assert_array_equal(value.axis, axis["axis"])
        same(case, value.values, exact)


def test_labels_align() -> None:
    """As in arithmetic, elements of one label meet; attributes stay."""
    wi = xr.DataArray(directions(5, 2), dims=("n", "xyz"), coords={"n": [1, 2, 3, 4, 5]}, attrs={"of": "wi"})
    wo = xr.DataArray(directions(5, 3), dims=("n", "xyz"), coords={"n": [3, 4, 5, 6, 7]})
    value = METAL.eval(wi, wo)
    assert value.n.values.tolist() == NDF.D_visible(wi, wo).n.values.tolist() == [3, 4, 5]
    np.testing.assert_array_equal(value, METAL.eval(wi.values[2:], wo.values[:3]))
    assert METAL.eval(wi, wi).attrs == {"of": "wi"}
    assert METAL.eval(wi, np.array([0.0, 0.6, 0.8])).dims == ("n", "channel")


def test_single_directions() -> None:
    w, xi = directions(1, 2)[0], uniforms(3)
    labelled = xr.DataArray(w, dims="xyz")
    lazy = da.from_array(w)
    for value in (METAL.eval(labelled, w), METAL.eval(lazy, w), METAL.sample(lazy, xi)[1]):
        assert value.shape == (3,)
    assert GLASS.pdf(labelled, w).shape == ()
    assert NDF.sample(xr.DataArray(xi[:2], dims="xi")).dims == ("xyz",)


def test_fresnel_functions() -> None:
    cosine, eta = np.linspace(0, 1, 50), np.linspace(0.4, 3, 50)
    for function, arrays in (
        (mf.fresnel_dielectric, [cosine, eta]),
        (mf.fresnel_conductor, [cosine, eta, eta[::-1].copy()]),
        (mf.fresnel_average, [eta]),
        (mf.fresnel_average, [eta, cosine]),
    ):
        expected = function(*arrays)
        lazy = function(*(da.from_array(a, chunks=20) for a in arrays))
        assert isinstance(lazy, da.Array)
        np.testing.assert_array_equal(lazy.compute(scheduler="threads"), expected)
        found = function(*(xr.DataArray(a, dims="n", coords={"n": cosine}) for a in arrays))
        assert found.dims == ("n",)
        np.testing.assert_array_equal(found.n, cosine)
        np.testing.assert_array_equal(found, expected)


def test_precision_stays() -> None:
    w, xi = directions(20, 5).astype(np.float32), uniforms(3, 20).astype(np.float32)
    lazy, numbers = da.from_array(w, chunks=(7, 3)), da.from_array(xi, chunks=(7, 3))
    assert NDF.sample_visible(lazy, numbers).dtype == np.float32
    assert METAL.eval(lazy, lazy).dtype == np.float32
    assert METAL.sample(lazy, numbers)[0].dtype == np.float32
    assert METAL.sample(xr.DataArray(w, dims=("n", "k")), xi)[1].dtype == np.float32


def test_bad_input_is_one_sentence_at_once() -> None:
    lazy, xi = da.from_array(directions(20, 5), chunks=(7, 3)), da.from_array(uniforms(3, 20), chunks=(7, 3))
    with pytest.raises(
        ValueError, match=r"^StudentT\.sample: xi must have shape \(\.\.\., 2\), got \(20, 3\)$"
    ):
        NDF.sample(xi)
    with pytest.raises(ValueError, match=r"^Conductor\.eval: wo must be real numbers of shape \(\.\.\., 3\)"):
        METAL.eval(lazy, lazy[:, :2])
    with pytest.raises(ValueError, match=r"^StudentT\.sample_visible: out is for NumPy arrays"):
        NDF.sample_visible(lazy, xi, out=np.empty((20, 3)))
