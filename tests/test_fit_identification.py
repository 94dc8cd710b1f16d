"""Slopes of every family, isotropic and anisotropic, are told to be of that family with that symmetry.

Once each; `make fit-coverage` does it many times (docs/fitting_tests.md).
"""

from __future__ import annotations

import pytest

import fit_cases
import microfacet as mf

CASES = [*fit_cases.isotropic_cases(), *fit_cases.cases()]


@pytest.mark.parametrize("case", CASES, ids=str)
def test_the_true_family_and_symmetry_are_found(case: fit_cases.Case) -> None:
    """First, but for a rival that the slopes do not tell from it: then tied with the first."""
    true = fit_cases.simplest(case)
    results = mf.fit(case.slopes(10_000, 1))
    tied = [(result.family, result.symmetry) for result in results if result.tied]
    assert results[0].symmetry == case.symmetry
    assert (true, case.symmetry) in tied
    families = fit_cases.FAMILIES
    if all(
        len(families[name].parameters) > len(families[true].parameters) for name, _ in tied if name != true
    ):
        assert results[0].family == true
    assert not any(symmetry == "isotropic" for _, symmetry in tied if case.symmetry == "anisotropic")


def test_the_simplest_family_of_a_density() -> None:
    found = {str(case): fit_cases.simplest(case) for case in CASES}
    assert found.pop("gtr (alpha 0.05, gamma 2)") == "ggx"
    assert all(name.startswith(f"{simplest} (") for name, simplest in found.items())
