"""How often intervals of fits to profiles hold the truth: the table of docs/profiles.md.

Maps of a known family are cut into profiles, or slopes along a line are drawn that do not depend on each
other; each is fitted, and the share of intervals of 95 % that hold the truth is counted.

    python tools/measure_profiles.py [--repetitions 40]
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable

import numpy as np

import microfacet as mf

FAMILIES = {family.name: family for family in mf.families()}
CASES = (("beckmann", ()), ("ggx", ()), ("student_t", (3.0,)), ("bessel_k", (1.5,)))
ALPHA = 0.3
NORMAL = 1.96


def truth(name: str, shape: tuple[float, ...]) -> dict[str, float]:
    """Parameters by name."""
    return dict(zip([one.name for one in FAMILIES[name].parameters], (ALPHA, *shape), strict=True))


def independent(name: str, shape: tuple[float, ...], seed: int) -> mf.Profile:
    """One trace of 4000 points, whose slopes do not depend on each other."""
    rng = np.random.default_rng([seed, 1])
    slopes = FAMILIES[name].kernels.sample_slope(rng.random(4000), ALPHA, *shape)
    slopes = slopes * np.cos(2 * math.pi * rng.random(4000))
    heights = np.zeros(4002)
    for start in (0, 1):  # every second height is the sum of every second slope
        heights[start + 2 :: 2] = np.cumsum(2 * slopes[start::2])
    return mf.Profile(heights, 1.0)


def correlated(name: str, shape: tuple[float, ...], seed: int) -> mf.Profile:
    """Four rows of a map, whose roughness varies over 16 pixels where the family is a mixture."""
    varying = {} if name == "beckmann" else {"amplitude_length": 16e-6}
    ndf = FAMILIES[name].cls(**truth(name, shape))
    surface = mf.synthesize(ndf, (256, 2048), seed=seed, **varying)
    return mf.Profile.from_surface(surface, row=slice(0, 256, 64))


def missing(name: str, shape: tuple[float, ...], seed: int) -> mf.Profile:
    """The same without 20 % of the points, at random."""
    profile = correlated(name, shape, seed)
    rng = np.random.default_rng([seed, 2])
    return mf.Profile(
        [np.where(rng.random(trace.size) < 0.2, math.nan, trace) for trace in profile.traces], profile.spacing
    )


KINDS: tuple[tuple[str, Callable[[str, tuple[float, ...], int], mf.Profile]], ...] = (
    ("independent slopes", independent),
    ("rows of a map", correlated),
    ("the same, 20 % missing", missing),
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=40)
    repetitions = parser.parse_args().repetitions
    print(
        "| profile | family | parameter | intervals that hold the truth | rms deviation, in errors | worth |"
    )
    print("|---|---|---|---|---|---|")
    for kind, make in KINDS:
        for name, shape in CASES:
            known, deviations, worth = truth(name, shape), dict[str, list[float]](), list[float]()
            for seed in range(repetitions):
                fit = mf.fit(make(name, shape, seed), name)[0]
                worth.append(fit.n_effective / fit.n)
                for key, value in known.items():
                    error = (fit.params[key] - value) / fit.standard_errors[key]
                    deviations.setdefault(key, []).append(error)
            for key, found in deviations.items():
                held = np.mean(np.abs(found) < NORMAL)
                rms = math.sqrt(np.mean(np.square(found)))
                print(
                    f"| {kind} | {name} | {key} | {held:.0%} | {rms:.2f} | {np.mean(worth):.0%} |", flush=True
                )


if __name__ == "__main__":
    main()
