"""`array_functions` on PyTorch, in processes of its own: values, gradients, types, broadcasting."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import microfacet as mf
import torch_process
from microfacet._graphs import shorter_from_tables

TESTS = Path(__file__).parent
CLOSED = [family for family in mf.families() if not shorter_from_tables[family.name]]
PROGRAM = f"sys.path.insert(0, {str(TESTS)!r})\nimport torch_checks\ntorch_checks.main(*sys.argv[1:])\n"


@pytest.mark.parametrize("check", ["graphs", "broadcasting", "domains", "types", "second_derivatives"])
def test_tensors(check: str) -> None:
    torch_process.run(PROGRAM, check)


@pytest.mark.parametrize("family", mf.families(), ids=lambda family: family.name)
def test_values_are_those_of_the_library(family: Any) -> None:
    torch_process.run(PROGRAM, "values", family.name)


@pytest.mark.parametrize("family", CLOSED, ids=lambda family: family.name)
def test_gradients_are_those_of_the_reference(family: Any) -> None:
    torch_process.run(PROGRAM, "gradients", family.name)


@pytest.mark.parametrize("family", ["ggx", "k0"])
def test_gradients_of_samples_are_differences(family: str) -> None:
    """What is recorded is compared with differences for all families on NumPy."""
    torch_process.run(PROGRAM, "samples", family)
