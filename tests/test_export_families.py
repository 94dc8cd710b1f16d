"""Families and materials, exported and run beside the library: as C, WGSL and GLSL ES."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import export_programs as programs
import export_tools as tools
import microfacet as mf
from export_choices import choice_of, file_of, named, rows_of
from microfacet._export.accuracy import error_of
from microfacet._export.functions import FUNCTIONS
from microfacet._export.languages import languages

VALUES = ("D", "sigma", "Lambda", "G1", "G2", "pdf_visible")
SAMPLERS = ("sample", "sample_visible")
ALL = [name for name in FUNCTIONS if name != "survival"]  # which is of isotropic distributions alone
MATERIALS = ("conductor_eval", "conductor_sample")
SETS, FEW = 400, 16  # of 512 points: 204,800 and 8,192

#: A ring has no density to compare.
OF_A_RING = ["sigma", "Lambda", "G1", "G2", "sample", "sample_visible"]
RINGS = [family.name for family in mf.families() if family.singular]

each_family = pytest.mark.parametrize("family", [family.name for family in mf.families()])


def of_a_density(family: str, names: list[str]) -> list[str]:
    """Those of the functions that have values."""
    return [name for name in names if family not in RINGS or name in OF_A_RING]


def sets_of(name: str) -> int:
    """What a browser is to be sent: many points of that on which the rest is built."""
    return SETS if name in ("D", "sigma", "Lambda") else FEW


def assert_accurate(errors: dict[str, float], fast: bool = False, drawn: float = 1e-4) -> None:
    """Within 2e-5 relative, twice of P2, 5e-5 where the compiler regroups sums; directions within 1e-4."""
    for name, error in errors.items():
        bound = drawn if "sample" in name else 5e-5 if fast else 4e-5 if name == "P2" else 2e-5
        assert not error > bound, (
            f"{name}: {error:.1e} beyond {bound}"
        )  # nan: there is nothing to compare with


@each_family
@pytest.mark.parametrize("anisotropic", [False, True])
@pytest.mark.parametrize("flags", [("-O0",), ("-O2",), ("-O3", "-ffast-math")], ids=" ".join)
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_c_is_as_accurate_as_promised(
    compiler: str, flags: tuple[str, ...], family: str, anisotropic: bool, tmp_path: Path
) -> None:
    choice = choice_of(family, anisotropic)
    text, functions, graphs = file_of("c", choice, tuple(ALL))
    source = text + programs.wrapped(languages()["c"], functions, "")
    library = tools.compiled_c(tmp_path, source, compiler, *flags)

    def evaluate(name: str, columns: Any) -> Any:
        outputs = programs.outputs_of(functions[name])
        return named(graphs[name], tools.called(library, name, rows_of(functions[name], columns), outputs))

    sets = SETS if flags == ("-O2",) and anisotropic else FEW
    names = of_a_density(family, ALL)
    errors = {name: error_of(name, graphs[name], choice, partial(evaluate, name), sets) for name in names}
    assert_accurate(errors, "-ffast-math" in flags)


@each_family
def test_wgsl_is_as_accurate_as_promised(family: str) -> None:
    choice = choice_of(family, True)

    def evaluate(name: str, columns: Any) -> Any:
        text, functions, graphs = file_of("wgsl", choice, (name,))
        source = programs.compute_wgsl(languages()["wgsl"], name, functions[name], text)
        rows = rows_of(functions[name], columns)
        return named(graphs[name], tools.dispatched(source, rows, programs.outputs_of(functions[name])))

    names = of_a_density(family, [*VALUES, *SAMPLERS, *MATERIALS])
    graphs = {name: choice.graph(name, False) for name in names}
    errors = {name: error_of(name, graphs[name], choice, partial(evaluate, name), SETS) for name in names}
    print(errors)
    assert_accurate(errors)


@each_family
def test_glsl_es_is_as_accurate_as_promised(family: str) -> None:
    """All functions of a family in one browser: their points are collected first, their results then."""
    choice, names = choice_of(family, True), of_a_density(family, [*VALUES, *SAMPLERS, *MATERIALS])
    sources, rows, graphs = {}, {}, {}

    def collect(name: str, columns: Any) -> Any:
        text, functions, found = file_of("glsl-es", choice, (name,))
        sources[name] = programs.fragment_es(languages()["glsl-es"], name, functions[name], text)
        rows[name], graphs[name] = rows_of(functions[name], columns), found[name]
        return named(found[name], np.zeros((len(rows[name]), len(found[name].results)), np.float32))

    for name in names:
        error_of(name, choice.graph(name, False), choice, partial(collect, name), sets_of(name))
    results, seconds = tools.drawn({name: sources[name] for name in rows}, rows, width=512)
    assert seconds  # to compile
    errors = {}
    for name in rows:
        values = named(graphs[name], results[name])
        errors[name] = error_of(name, graphs[name], choice, lambda _, found=values: found, sets_of(name))
    print(errors, seconds)
    assert_accurate(errors)
