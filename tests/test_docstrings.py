"""The examples of all docstrings run: of every module, class and function, and of every ufunc.

This goes through the package that is installed, where the compiled core is, rather than through the files of
`src`; and doctest's own finder passes over ufuncs.
"""

from __future__ import annotations

import doctest
import importlib
import pathlib
import pkgutil
from typing import Any

import numpy as np
import pytest

import microfacet as mf

MODULES = [
    "microfacet",
    *(
        module.name
        for module in pkgutil.walk_packages(mf.__path__, "microfacet.")
        if not module.name.startswith("microfacet._core")
    ),
]
UFUNCS = [
    (family, name)
    for family in mf.families()
    for name in family.kernels.__all__
    if name != family.cls.__name__
]


def run(*tests: doctest.DocTest) -> doctest.TestResults:
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    for test in tests:
        runner.run(test)
    assert runner.failures == 0, "see the captured output"
    return doctest.TestResults(runner.failures, runner.tries)


@pytest.mark.parametrize("name", MODULES)
def test_examples_of_module(name: str, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    run(*doctest.DocTestFinder().find(importlib.import_module(name)))


@pytest.mark.parametrize(("family", "name"), UFUNCS, ids=[f"{family.name}.{name}" for family, name in UFUNCS])
def test_examples_of_ufunc(family: Any, name: str) -> None:
    ufunc = getattr(family.kernels, name)
    assert isinstance(ufunc, np.ufunc)
    test = doctest.DocTestParser().get_doctest(ufunc.__doc__, {}, f"{family.name}.{name}", None, None)
    assert run(test).attempted >= 2


def test_public_things_have_examples() -> None:
    for name in mf.__all__:
        thing = getattr(mf, name)
        if callable(thing) and not issubclass(type(thing), type) and ">>>" not in (thing.__doc__ or ""):
            raise AssertionError(f"microfacet.{name} has no example")
