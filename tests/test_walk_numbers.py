"""Random numbers of walks: a function of the seed and the place, whatever the arrays, threads and builds."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

import microfacet as mf
from builds import BUILDS, FUSED
from furnace_cases import Furnace
from material_cases import (
    COPPER,
    FAMILIES,
    absorbing,
    agree,
    directions,
    mean,
    stretched,
    towards,
)

EVALUATIONS = 40_000

each_family = pytest.mark.parametrize("family", FAMILIES)
each_dtype = pytest.mark.parametrize("dtype", [np.float64, np.float32])


@each_family
@each_dtype
def test_a_seed_gives_each_place_its_walks(family: str, dtype: type) -> None:
    """Whatever the length and layout of arrays, and on however many threads."""
    wi, wo = directions(1100, 23).astype(dtype), directions(1100, 24).astype(dtype)
    for material in absorbing(stretched(family)).values():
        value = material.eval(wi, wo, n=2, rng=25)
        walked = material.walk(wi, rng=25)
        assert value.dtype == dtype
        assert walked[0].dtype == dtype
        for length in (1, 5, 255, 256, 257, 600):
            np.testing.assert_array_equal(
                material.eval(wi[:length], wo[:length], n=2, rng=25), value[:length]
            )
            for part, whole in zip(material.walk(wi[:length], rng=25), walked, strict=True):
                np.testing.assert_array_equal(part, whole[:length])
        folded = material.eval(wi.reshape(11, 100, 3), np.asfortranarray(wo.reshape(11, 100, 3)), n=2, rng=25)
        np.testing.assert_array_equal(folded.reshape(-1), value)
        with ThreadPoolExecutor(3) as pool:
            again = [pool.submit(material.eval, wi, wo, n=2, rng=25) for _ in range(3)]
            for each in again:
                np.testing.assert_array_equal(each.result(), value)
        assert np.any(material.eval(wi, wo, n=2, rng=26) != value)


def test_places_and_wavelengths() -> None:
    """Elements at different places have walks of their own; wavelengths of one element share theirs."""
    wi, wo = np.broadcast_to(towards(40.0), (500, 3)), towards(30.0, 120.0)
    metal = mf.Conductor(mf.GGX(alpha=0.7), *COPPER, scattering="multiple")
    value = metal.eval(wi, wo, rng=1)
    assert len(np.unique(value[:, 0])) > 100
    for channel in range(3):
        one = mf.Conductor(metal.ndf, COPPER[0][channel], COPPER[1][channel], scattering="multiple")
        assert np.corrcoef(one.eval(wi, wo, rng=1), value[:, channel])[0, 1] > 0.999


def test_generators_go_on() -> None:
    clay, wi, wo = mf.Diffuse(mf.GGX(alpha=0.7), 0.5), towards(40.0), towards(30.0, 120.0)
    rng = np.random.default_rng(1)
    first, second = clay.eval(wi, wo, rng=rng), clay.eval(wi, wo, rng=rng)
    assert first != second
    assert clay.eval(wi, wo, rng=np.random.default_rng(1)) == first
    assert clay.eval(wi, wo) != clay.eval(wi, wo), "entropy of the system"


@pytest.mark.skipif(len(FUSED) < 2, reason="one build with fused arithmetic runs here")
@each_family
@each_dtype
def test_fused_builds_walk_alike(family: str, dtype: type, monkeypatch: pytest.MonkeyPatch) -> None:
    ndf, wi, wo = stretched(family), directions(700, 27).astype(dtype), directions(700, 28).astype(dtype)
    results = []
    for name in FUSED:
        monkeypatch.setattr(type(ndf), "kernels", getattr(BUILDS[name], family))
        results.append([m.eval(wi, wo, n=2, rng=29) for m in absorbing(ndf).values()])
        results[-1] += [x for m in absorbing(ndf).values() for x in m.walk(wi, rng=30)]
    for one, other in zip(results[0], results[1], strict=True):
        np.testing.assert_array_equal(one, other)


@each_family
def test_float32_has_the_same_means(family: str) -> None:
    case = Furnace("glass", family, 0.5, 60.0)
    wo, density = case.propose(EVALUATIONS // 2, np.random.default_rng(31))
    for name, material in absorbing(case.ndf).items():
        if name.startswith("glass"):
            case = replace(case, material="glass")
        single, double = (
            mean(material.eval(case.wi.astype(t), wo.astype(t), rng=32) / density)
            for t in (np.float32, np.float64)
        )
        agree(single, double)
        walked = [
            mean(material.walk(np.broadcast_to(case.wi, (20_000, 3)).astype(t), rng=33)[1])
            for t in (np.float32, np.float64)
        ]
        agree(*walked)
