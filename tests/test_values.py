"""Public objects are values: they compare, hash, copy and pickle by what they hold, into processes too."""

from __future__ import annotations

import copy
import inspect
import math
import multiprocessing
import pickle
from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from limits import HANG
from microfacet._bake.recipe import recipe

CHI2 = {"n": 20_000, "resolution": (4, 8)}
BAKED = {
    "shape": None,
    "material": "conductor",
    "eta": None,
    "k": 0.0,
    "cos_theta": [0.2, 0.9],
    "azimuth": 2,
    "scattering": "single",
    "walks": 10,
    "seed": 1,
}


@cache
def slopes() -> Any:
    return np.random.default_rng(2).normal(size=(400, 2)) * 0.2


def surface() -> mf.Surface:
    heights = np.random.default_rng(3).normal(size=(40, 50))
    heights[3, 4] = np.nan
    return mf.Surface(heights, pixel_size=(1.0, 2.0), source="test").level()


@cache
def fitted() -> Any:
    return mf.fit(slopes(), families=["beckmann"])[0]


def metal(**options: Any) -> Any:
    return mf.Conductor(mf.K0(alpha_x=0.2, alpha_y=0.4), [0.2, 1.04], [3.9, 2.6], **options)


def round_metal() -> Any:
    return mf.Conductor(mf.GGX(alpha=0.6), [0.2, 1.04], [3.9, 2.6])


def user_density(r: Any, k: Any) -> Any:
    return (1 + r**2) ** -k


# For every public class: objects, none of which equals another.
EXAMPLES: dict[str, Callable[[], list[Any]]] = {
    "Beckmann": lambda: [mf.Beckmann(alpha=0.3), mf.Beckmann(alpha_x=0.3, alpha_y=0.4)],
    "BesselK": lambda: [mf.BesselK(alpha=0.3, a=0.7), mf.BesselK(alpha=0.3, a=0.8)],
    "Dirac": lambda: [mf.Dirac(alpha=0.3), mf.Dirac(alpha=0.4)],
    "DoubleGGX": lambda: [mf.DoubleGGX(alpha=0.3), mf.DoubleGGX(alpha=0.4)],
    "Ei": lambda: [mf.Ei(alpha=0.3), mf.Ei(alpha_x=0.3, alpha_y=0.4)],
    "Erfc": lambda: [mf.Erfc(alpha=0.3), mf.Erfc(alpha=0.4)],
    "Exponential": lambda: [mf.Exponential(alpha=0.3), mf.Exponential(alpha=0.4)],
    "GeneralisedExponential": lambda: [
        mf.GeneralisedExponential(alpha=0.3, g=3.0),
        mf.GeneralisedExponential(alpha=0.3, g=1.0),
    ],
    "GGX": lambda: [mf.GGX(alpha=0.3), mf.GGX(alpha_x=0.3, alpha_y=0.3, rotation=0.1)],
    "GTR": lambda: [mf.GTR(alpha=0.3, gamma=1.5), mf.GTR(alpha=0.3, gamma=2.5)],
    "K0": lambda: [mf.K0(alpha=0.3), mf.K0(alpha=0.4)],
    "StudentT": lambda: [mf.StudentT(alpha=0.3, gamma=2.5), mf.StudentT(alpha=0.3, gamma=3.5)],
    "UserFamily": lambda: [
        mf.UserFamily(name, P22=user_density, parameters={"k": (1.0, 8.0, 2.0)}) for name in ("a", "b")
    ],
    "RadialNDF": lambda: [
        mf.RadialNDF(lambda r, power=power: (1 + r**2) ** -power, alpha=0.3) for power in (2.5, 3.0)
    ],
    "SlopeTable": lambda: [
        mf.SlopeTable([-1.0, 0.0, 1.0], [-1.0, 1.0], [[1.0], [share]]) for share in (1.0, 2.0)
    ],
    "Conductor": lambda: [metal(), metal(scattering="multiple"), metal(correlated=False), round_metal()],
    "Dielectric": lambda: [
        mf.Dielectric(mf.GGX(alpha=0.3), 1.5),
        mf.Dielectric(mf.GGX(alpha=0.3), 1.5, mode="importance"),
        mf.Dielectric(mf.GGX(alpha=0.3), 1.6),
    ],
    "Diffuse": lambda: [mf.Diffuse(mf.K0(alpha=0.3), [0.2, 0.3]), mf.Diffuse(mf.K0(alpha=0.3), 0.2)],
    "KullaConty": lambda: [mf.KullaConty(round_metal()), mf.KullaConty(mf.Conductor(mf.GGX(alpha=0.6)))],
    "Turquin": lambda: [mf.Turquin(round_metal()), mf.Turquin(mf.Conductor(mf.GGX(alpha=0.6)))],
    "LookupTexture": lambda: [
        mf.lookup_texture("energy", "ggx", size=(2, 2), check=0, dtype=dtype)
        for dtype in ("float32", "float16")
    ],
    "Family": lambda: list(mf.families()),
    "Parameter": lambda: [mf.Parameter("a", 0.0, math.inf), mf.Parameter("a", 1.0, math.inf)],
    "Surface": lambda: [surface(), surface().at_lag(2), surface().mask_outliers(3.0)],
    "SurfaceError": list,  # an exception: it pickles, and is compared as Python compares exceptions
    "SlopeSample": lambda: [mf.SlopeSample(slopes(), "a"), mf.SlopeSample(slopes()[1:], "a")],
    "Roughness": lambda: [mf.roughness(surface()), mf.roughness(surface().mask_outliers(2.0))],
    "MaterialRatio": lambda: [
        mf.material_ratio(surface()),
        mf.material_ratio(surface().mask_outliers(2.0)),
    ],
    "Spectrum": lambda: [mf.spectrum(surface()), mf.spectrum(surface(), window=None)],
    "KCorrelation": lambda: [mf.spectrum(surface()).abc, mf.spectrum(surface(), window=None).abc],
    "Autocorrelation": lambda: [mf.autocorrelation(surface()), mf.autocorrelation(surface(), periodic=True)],
    "FitResult": lambda: [fitted(), mf.fit(slopes()[:300], families=["beckmann"])[0]],
    "FitResults": list,  # a list, which is not frozen: tests/test_verdict.py copies it
    "Goodness": lambda: [fitted().goodness],
    "Halves": lambda: [mf.fit(mf.sample_terrain(), "beckmann", lag=lag).halves for lag in (4, 8)],
    "Verdict": lambda: [mf.fit(mf.sample_terrain(), "beckmann", lag=lag).verdict for lag in (4, 8)],
    "ScaleFit": lambda: [mf.fit_scales(mf.sample_terrain(), [4], "beckmann", max_slopes=2000)],
    "TableFit": lambda: mf.fit_table(mean_square_slopes=0.03),
    "BrdfTable": lambda: [brdf(alpha=0.3), brdf(alpha=0.4)],
    "AbgFit": lambda: brdf(alpha=0.3).abg(),
    "SpatialBandwidth": lambda: [mf.spatial_bandwidth(5e-7, theta) for theta in (0.0, 30.0)],
    "Comparison": lambda: [compared(), compared(names=["a", "b"])],
    "Difference": lambda: list(compared().differences[0]),
    "testing.Chi2Result": lambda: [
        mf.testing.chi2(mf.GGX(alpha=0.3).sample, mf.GGX(alpha=alpha).pdf, **CHI2) for alpha in (0.3, 0.4)
    ],
    "testing.SlopeResult": lambda: [
        mf.testing.ks_visible_slope(mf.GGX(alpha=0.3), [0.6, 0, 0.8], n=n) for n in (500, 1000)
    ],
    "a recipe of bake": lambda: [recipe("energy", "ggx", alpha=alpha, **BAKED) for alpha in (0.2, 0.3)],
    "Profile": lambda: [profile(), profile().level(), profile().at_lag(2)],
    "ProfileRoughness": lambda: [profile().roughness(), profile().level().roughness()],
    "ProfileSpectrum": lambda: [profile().psd(), profile().level().psd()],
}
each_class = pytest.mark.parametrize("name", EXAMPLES)


def profile() -> mf.Profile:
    return mf.Profile(np.random.default_rng(4).normal(size=(2, 400)).cumsum(axis=1), 1e-6)


def brdf(**roughness: float) -> mf.BrdfTable:
    return mf.brdf_table(mf.GGX(**roughness), theta_i=0, polar=[0, 10, 20, 30], azimuth=0, n=16)


def compared(**options: Any) -> mf.Comparison:
    return mf.compare([slopes(), 2 * slopes()], "beckmann", **options)


@cache
def examples(name: str) -> list[Any]:
    return EXAMPLES[name]()


def public_classes() -> set[str]:
    spaces = {"": mf, "testing.": mf.testing}
    return {
        prefix + name
        for prefix, space in spaces.items()
        for name in space.__all__
        if isinstance(getattr(space, name), type)
    }


def test_every_public_class_is_here() -> None:
    forgotten = public_classes() - set(EXAMPLES)
    assert not forgotten, f"give examples of {sorted(forgotten)}: do they compare, hash, copy and pickle?"


def copies(thing: Any) -> list[Any]:
    protocols = range(2, pickle.HIGHEST_PROTOCOL + 1)
    return [
        copy.copy(thing),
        copy.deepcopy(thing),
        *(pickle.loads(pickle.dumps(thing, p)) for p in protocols),
    ]


def arrays(thing: Any) -> list[Any]:
    """All arrays in it that are attributes, or in tuples that are."""
    names = [
        *getattr(thing, "__dict__", {}),
        *(n for c in type(thing).__mro__ for n in getattr(c, "__slots__", ())),
    ]
    values = [getattr(thing, name) for name in names]
    parts = [part for value in values for part in (value if isinstance(value, tuple) else (value,))]
    return [part for part in parts if isinstance(part, np.ndarray)]


@each_class
def test_copies_are_equal(name: str) -> None:
    for thing in examples(name):
        for again in copies(thing):
            assert type(again) is type(thing)
            assert again == thing
            assert hash(again) == hash(thing)
            assert repr(again) == repr(thing)
            assert {thing: 1}[again] == 1
            assert not any(array.flags.writeable for array in arrays(again))


@each_class
def test_others_differ(name: str) -> None:
    things = examples(name)
    for i, thing in enumerate(things):
        assert thing != 1
        assert thing != "a"
        for other in things[i + 1 :]:
            assert thing != other
    assert len(set(things)) == len(things)


@each_class
def test_objects_are_frozen(name: str) -> None:
    """What is hashed must not change."""
    for thing in examples(name):
        field = next(iter(getattr(thing, "__dict__", {})), None) or dir(thing)[-1]
        with pytest.raises((AttributeError, TypeError)):
            setattr(thing, field, None)
        assert not any(array.flags.writeable for array in arrays(thing))


def test_nan_is_itself_in_copies() -> None:
    """A standard error that is no number leaves a fit equal to its copy."""
    result = mf.TableFit("k0", {"alpha": 0.3}, {"alpha": math.nan}, 0.1, mf.K0(alpha=0.3))
    for again in copies(result):
        assert again == result
        assert hash(again) == hash(result)
    assert result != mf.TableFit("k0", {"alpha": 0.3}, {"alpha": 0.01}, 0.1, mf.K0(alpha=0.3))


def test_exceptions_pickle() -> None:
    again = pickle.loads(pickle.dumps(mf.SurfaceError("no heights")))
    assert (type(again), str(again)) == (mf.SurfaceError, "no heights")


def test_functions_pickle_by_name() -> None:
    for space in (mf, mf.testing):
        for name in space.__all__:
            thing = getattr(space, name)
            if callable(thing):
                assert pickle.loads(pickle.dumps(thing)) is thing, name
            else:
                assert isinstance(thing, ModuleType | str), f"{name}: copy and pickle it in EXAMPLES"
            if isinstance(thing, ModuleType) and hasattr(thing, "__all__"):
                for member in vars(thing).values():
                    assert not inspect.isfunction(member) or pickle.loads(pickle.dumps(member)) is member


# Other processes


def answers(thing: Any) -> tuple[Any, Any, Any]:
    """What a process says of an object that came to it."""
    value = (
        thing.albedo([0.6, 0.0, 0.8])
        if hasattr(thing, "sample_dims") and not hasattr(thing, "walk")
        else None
    )
    value = thing.sigma([0.6, 0.0, 0.8]) if hasattr(thing, "sigma") else value
    return thing, repr(thing), value


@pytest.mark.parametrize("method", multiprocessing.get_all_start_methods())
@pytest.mark.filterwarnings("ignore:This process.*fork:DeprecationWarning")
def test_every_object_passes_a_pool(method: str) -> None:
    """A pool hangs where its process dies of what it is given: the limit is for that alone."""
    things = [thing for name in EXAMPLES for thing in examples(name)]
    with multiprocessing.get_context(method).Pool(1) as pool:
        returned = pool.map_async(answers, things, chunksize=len(things)).get(timeout=HANG)
    for thing, (again, text, value) in zip(things, returned, strict=True):
        assert again == thing
        assert text == repr(thing)
        np.testing.assert_array_equal(value, answers(thing)[2])


def test_dask_takes_objects() -> None:
    dask = pytest.importorskip("dask")
    for material in (metal(), mf.Dielectric(mf.K0(alpha=0.3), 1.5)):
        later = dask.delayed(answers)(material)
        assert later.compute(scheduler="processes", num_workers=1)[0] == material
        assert dask.base.tokenize(material) == dask.base.tokenize(copy.deepcopy(material))
