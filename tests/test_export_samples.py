"""Directions that exported samplers draw, each target in its own arithmetic, follow the library's density."""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import numpy as np
import pytest
import scipy.stats
from numpy.typing import NDArray

import microfacet as mf
from export_targets import TARGETS
from microfacet._export.choice import Choice, chosen
from microfacet._export.density import density_of
from microfacet._export.functions import FUNCTIONS
from microfacet.testing import chi2

PROCESSOR, SHADERS = ("NumPy", "C -O3 -ffast-math"), ("WGSL", "WebGL 2")
COUNT, RESOLUTION = 60_000, (16, 16)
ALPHA, ETA, K = 0.4, 1.5, 3.0
#: Functions, and the cosines to their first direction, from above and from below.
CASES = {"sample": (1.0,), "sample_visible": (0.4, -0.1), "conductor_sample": (0.5,)}


#: Shapes as arguments, where formulas are so long that tables stand in for a shape that is fixed.
FREE = [f"{family.name}:free" for family in mf.families() if density_of(family.name).tabulated]


def functions_of(target: str, family: str) -> list[str]:
    """Drivers compile tables for many seconds: there, the visible normals that all else is made of."""
    if family in FREE:
        return ["sample_visible"]
    if target in PROCESSOR:
        return list(CASES)
    return ["sample_visible"] if density_of(family).tabulated else ["sample_visible", "conductor_sample"]


ALL = [
    (target, family.name, name, cosine)
    for target in (*PROCESSOR, *SHADERS)
    for family in mf.families()
    if not family.singular
    for name in functions_of(target, family.name)
    for cosine in CASES[name]
] + [("NumPy", family, "sample_visible", cosine) for family in FREE for cosine in (0.4, -0.1)]


def values_of(family: str) -> dict[str, float]:
    parameters = density_of(family.partition(":")[0]).parameters
    return {p.name: min(p.lower + 1.0, 0.5 * (p.lower + p.upper)) for p in parameters} | {"alpha": ALPHA}


@cache
def choice_of(family: str) -> Choice:
    """All parameters are numbers, the same for each target, or all are free."""
    fixed = {} if family in FREE else {**values_of(family), "eta": ETA, "k": K}
    return chosen(density_of(family.partition(":")[0]), tuple(FUNCTIONS), fixed, None)


def direction(cosine: float) -> NDArray[np.float32]:
    return np.array([np.sqrt(1 - cosine**2) * 0.8, np.sqrt(1 - cosine**2) * 0.6, cosine], np.float32)


@cache
def drawn(target: str, family: str) -> dict[tuple[str, float], NDArray[np.float64]]:
    """Directions for each case; a target draws them all at once, so that a browser starts once a family."""
    rng = np.random.default_rng(7)
    columns: dict[str, Any] = {}
    for name in functions_of(target, family):
        given = np.repeat([direction(cosine) for cosine in CASES[name]], COUNT, axis=0)
        columns[name] = {
            entry: rng.random(len(given), np.float32)
            if entry.startswith("xi")
            else np.full(len(given), values_of(family)[entry])
            if "." not in entry
            else given[:, "xyz".index(entry[-1])]
            for entry in choice_of(family).graph(name, False).inputs
        }
    found = {}
    for name, results in TARGETS[target](choice_of(family), columns).items():
        vector = "wo" if name.startswith("conductor") else "m"
        parts = np.stack([results[f"{vector}.{letter}"].astype(np.float64) for letter in "xyz"], axis=-1)
        for i, cosine in enumerate(CASES[name]):
            found[name, cosine] = parts[i * COUNT : (i + 1) * COUNT]
    return found


@pytest.mark.parametrize(("target", "family", "name", "cosine"), ALL)
def test_samples_follow_the_density(target: str, family: str, name: str, cosine: float) -> None:
    ndf: Any = density_of(family.partition(":")[0]).at(values_of(family))
    w = direction(cosine).astype(np.float64)
    densities = {
        "sample": ndf.pdf,
        "sample_visible": lambda m: ndf.D_visible(m, w),
        "conductor_sample": lambda wo: mf.Conductor(ndf, eta=ETA, k=K).pdf(w, wo),
    }
    samples = drawn(target, family)[name, cosine]
    length = np.linalg.norm(samples, axis=-1, keepdims=True)
    assert np.nanmax(np.abs(length - 1)) < 1e-5
    lossy = name.startswith("conductor")  # what leaves below the horizon is nan
    result = chi2(
        samples / length, densities[name], resolution=RESOLUTION, tests=len(ALL), lossy=lossy
    )  # of unit length in double precision, as the test takes them
    assert result, result


@pytest.mark.parametrize("target", [*PROCESSOR, *SHADERS])
@pytest.mark.parametrize("family", [family.name for family in mf.families() if family.singular])
def test_samples_of_a_ring_lie_on_it(target: str, family: str) -> None:
    """Their azimuths are as the cosines to the direction that sees them."""
    for (name, cosine), m in drawn(target, family).items():
        if name == "conductor_sample":
            continue
        p, q = -m[:, 0] / m[:, 2], -m[:, 1] / m[:, 2]
        np.testing.assert_allclose(np.hypot(p, q), ALPHA, rtol=1e-5)
        turn = (np.arctan2(q, p) - np.arctan2(0.6, 0.8)) % (2 * np.pi)
        at = np.linspace(0, 2 * np.pi, 100_001)
        seen = np.sqrt(1 - cosine**2) * ALPHA if name == "sample_visible" else 0.0
        area = np.cumsum(np.maximum(cosine - seen * np.cos(at), 0))
        assert scipy.stats.kstest(turn, partial(np.interp, xp=at, fp=area / area[-1])).pvalue > 1e-4, name


def test_a_wrong_roughness_is_found() -> None:
    """The test can fail: six percent are too much."""
    w = direction(0.4).astype(np.float64)
    samples = drawn("NumPy", "ggx")["sample_visible", 0.4]
    wrong = mf.GGX(alpha=1.06 * ALPHA)
    assert not chi2(samples, lambda m: wrong.D_visible(m, w), resolution=RESOLUTION, tests=len(ALL))
