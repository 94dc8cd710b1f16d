"""Arrays in any form that NumPy takes: nested lists, buffers, tables of pandas, objects with __array__."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

import microfacet as mf


class Tensor:
    """What arrays of other libraries have in common."""

    def __init__(self, values: Any) -> None:
        self.values = np.asarray(values)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        return self.values if dtype is None else self.values.astype(dtype)


class Duck(Tensor):
    """The same with the protocol of ufuncs, but neither axes nor positions, as columns of polars have it."""

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        plain = [x.values if isinstance(x, Duck) else x for x in inputs]
        return getattr(ufunc, method)(*plain, **options)


def frame(values: Any, **labels: Any) -> Any:
    pandas = pytest.importorskip("pandas", reason="pandas, which is optional, is not installed")
    if np.ndim(values) == 1:
        return pandas.Series(values, index=[f"row {k}" for k in range(len(values))])
    assert np.ndim(values) == 2
    names = [f"column {k}" for k in range(np.shape(values)[1])]
    columns = pandas.MultiIndex.from_tuples([("a", name) for name in names]) if labels else names
    return pandas.DataFrame(values, columns=columns)


FORMS: dict[str, Callable[[Any], Any]] = {
    "list": lambda a: a.tolist(),
    "tuple": lambda a: tuple(map(tuple, a.tolist())) if a.ndim > 1 else tuple(a.tolist()),
    "memoryview": memoryview,
    "Fortran order": np.asfortranarray,
    "strided": lambda a: np.repeat(a, 2, axis=-1)[..., ::2],
    "masked": np.ma.asarray,
    "__array__": Tensor,
    "__array_ufunc__": Duck,
    "pandas": frame,
    "pandas, labels in levels": lambda a: frame(a, levels=True),
}
RNG = np.random.default_rng(7)
W = RNG.normal(size=(5, 3)) * [1, 1, 0] + [0, 0, 0.7]
W /= np.linalg.norm(W, axis=-1, keepdims=True)
XI = RNG.random((5, 4))
SLOPES = 0.2 * RNG.normal(size=(60, 2))
RADII = np.geomspace(1e-3, 10.0, 60)

NDF = mf.StudentT(alpha_x=0.2, alpha_y=0.5, rotation=0.4, gamma=2.25)
METAL = mf.Conductor(NDF, [0.2, 1.1], [3.0, 2.0])
GLASS = mf.Dielectric(NDF, 1.4)
WHITE = mf.Conductor(mf.K0(alpha=0.4))

CALLS: dict[str, tuple[Callable[[Any], Any], Any]] = {
    **{
        name: (lambda w, name=name: getattr(NDF, name)(w), W)
        for name in ("D", "sigma", "Lambda", "G1", "pdf")
    },
    "of one direction": (NDF.D, W[0]),
    "of an own density": (lambda w: own().Lambda(w), W),
    "G2": (lambda w: NDF.G2(w, W[::-1]), W),
    "D_visible": (lambda w: NDF.D_visible(W, w), W),
    "pdf_visible": (lambda w: NDF.pdf_visible(w, w), W),
    "components": (lambda x: NDF.D(x, x, x), W[0]),
    "P22": (lambda p: NDF.P22(p, p), SLOPES[:, 0].copy()),
    "slope_cdf": (NDF.slope_cdf, SLOPES[:, 0].copy()),
    "sample": (NDF.sample, XI[:, :2].copy()),
    "sample_visible, xi": (lambda xi: NDF.sample_visible(W, xi), XI),
    "sample_visible, w": (lambda w: NDF.sample_visible(w, XI), W),
    "ufunc": (lambda u: mf.k0.sigma(u, 0.3), XI[0]),
    "parameter of a ufunc": (lambda gamma: mf.gtr.D(0.4, 0.3, gamma), XI[0]),
    "Conductor.eval": (lambda w: METAL.eval(w, W), W),
    "Conductor.pdf": (lambda w: METAL.pdf(W, w), W),
    "Conductor.sample": (lambda xi: METAL.sample(W, xi), XI),
    "Conductor.albedo": (METAL.albedo, W[:2]),
    "Dielectric.eval": (lambda w: GLASS.eval(w, W), W),
    "Dielectric.sample": (lambda w: GLASS.sample(w, XI), W),
    "walk": (lambda w: GLASS.walk(w, rng=1), W),
    "Diffuse.eval": (lambda w: mf.Diffuse(NDF, 0.5).eval(w, w, rng=1), W),
    "KullaConty.eval": (lambda w: mf.KullaConty(WHITE).eval(w, w), W),
    "KullaConty.sample": (lambda xi: mf.KullaConty(WHITE).sample(W, xi), XI),
    "Turquin.albedo": (mf.Turquin(WHITE).albedo, W),
    "eta": (lambda eta: mf.Conductor(NDF, eta, eta).eval(W[0], W[1]), XI[0]),
    "albedo of Diffuse": (lambda a: mf.Diffuse(NDF, a).eval(W[0], W[1], rng=1), XI[0]),
    "fresnel_dielectric": (lambda u: mf.fresnel_dielectric(u, 1.5), XI[0]),
    "fresnel_conductor": (lambda k: mf.fresnel_conductor(0.5, 0.2, k), XI[0]),
    "fresnel_average": (mf.fresnel_average, XI[0] + 1.0),
    "fit": (lambda s: np.array([*mf.fit(s, "beckmann")[0].params.values()]), SLOPES),
    "fit_table": (
        lambda m: np.array([*mf.fit_table(mean_square_slopes=m)[0].params.values()]),
        XI[0, :2] / 10,
    ),
    "heights": (lambda h: mf.Surface(h, (1e-6, 2e-6)).heights, RNG.normal(size=(9, 8))),
    "pixel sizes": (lambda s: np.array(mf.Surface(np.eye(9), s).pixel_size), np.array([1e-6, 2e-6])),
}


@cache
def own() -> mf.RadialNDF:
    return mf.RadialNDF((RADII, np.exp(-(RADII**2))), alpha=0.4)


def plain(result: Any) -> list[Any]:
    return [np.asarray(part, dtype=float) for part in (result if isinstance(result, tuple) else (result,))]


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", CALLS)
def test_every_form_of_an_array_gives_the_same(name: str, form: str) -> None:
    call, array = CALLS[name]
    for found, expected in zip(plain(call(FORMS[form](array))), plain(call(array)), strict=True):
        np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("form", ["list", "__array_ufunc__", "pandas"])
def test_an_own_density_is_made_of_any_samples(form: str) -> None:
    given = (FORMS[form](RADII), FORMS[form](np.exp(-(RADII**2))))
    np.testing.assert_array_equal(mf.RadialNDF(given, alpha=0.4).D(W), own().D(W))


@pytest.mark.parametrize(
    "bad", [None, "word", 3.0, [[1.0, 2.0, 3.0], [1.0, 2.0]], [[1, 2]], np.zeros((3, 0)), frame]
)
def test_what_is_no_direction_is_one_sentence(bad: Any) -> None:
    given = frame(np.ones((4, 2))) if bad is frame else bad
    for call in (NDF.D, NDF.sigma, lambda w: NDF.sample_visible(w, XI[0]), lambda w: METAL.eval(w, W)):
        with pytest.raises((TypeError, ValueError)) as caught:
            call(given)
        assert str(caught.value)
        assert "\n" not in str(caught.value)
