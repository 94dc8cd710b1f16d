"""Intervals on maps hold the truth as often as they state: a few of the maps of tools/measure_coverage.py."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

import coverage_cases
import fit_cases
import microfacet as mf
from coverage_cases import KINDS

MAPS = 12
QUICK = [("correlated", "beckmann"), ("inhomogeneous", "ggx")]


@pytest.mark.parametrize(("kind", "family"), QUICK)
def test_intervals_of_maps_cover_the_truth(kind, family):
    own = next(one for one in KINDS if one.name == kind)
    found = [
        coverage_cases.deviations(family, own, seed)[0] for seed in coverage_cases.seeds(own, family, MAPS)
    ]
    covered = [abs(one) < stats.norm.ppf(0.975) for each in found for one in each.values()]
    assert fit_cases.coverage_p_value(sum(covered), len(covered)) > mf.testing.sidak(0.01, len(QUICK))


def test_patches_are_uniform_in_the_logarithm_and_differ_from_map_to_map():
    values = np.concatenate([np.log2(coverage_cases.patches(seed)[::64, ::64]).ravel() for seed in range(40)])
    assert stats.kstest(values, stats.uniform(-0.5, 1).cdf).pvalue > 0.01
    means = [np.log2(coverage_cases.patches(seed)).mean() for seed in range(8)]
    assert np.std(means) > 0.02
