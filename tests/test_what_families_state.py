"""What families state of themselves, and that the rest of the library reads it in place of their names."""

from __future__ import annotations

import ast
import pathlib
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from microfacet._checks import common
from microfacet._fit.search import Search

PACKAGE = pathlib.Path(mf.__file__).parent
FAMILIES = mf.families()
each_family = pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)


@each_family
def test_values_lie_in_their_intervals(family: Any) -> None:
    for own in family.parameters[1:]:
        assert own.meaning
        assert list(own.examples) == sorted(set(own.examples))
        low, high = own.fitted
        assert own.lower < low < own.examples[0] <= own.examples[-1] < high < own.upper
        assert low < own.pictured < high
    assert len(family.shapes) == max(1, len(family.parameters[1:] and family.parameters[1].examples))
    assert len(family.figures) == 3
    for values in (*family.figures, *((0.3, *shape) for shape in family.shapes)):
        assert family.cls(*values).family == family.name


@pytest.mark.parametrize("ends", [(0.0, 1.0), (-2.0, 5.0), (1.5, np.inf), (0.0, 1e100)])
def test_the_variable_of_a_search_has_an_inverse(ends: tuple[float, float]) -> None:
    from microfacet._family.registry import searched

    search = Search(mf.Parameter("weight", *ends, fitted=searched(*ends)))
    low, high = search.ends
    for variable in np.linspace(low, high, 9):
        shape = search.shape(variable)
        assert ends[0] < shape < ends[1]
        assert search.variable(shape) == pytest.approx(variable, abs=1e-9)
        step = 1e-5
        slope = (search.shape(variable + step) - search.shape(variable - step)) / (2 * step)
        assert search.slope(variable) == pytest.approx(slope, rel=1e-6)
    assert search.parameter.fitted == pytest.approx((search.shape(low), search.shape(high)))


def test_what_has_no_density_is_not_fitted() -> None:
    radius, azimuth = mf.ggx.sample_slope(np.random.default_rng(1).random(500), 0.3), np.arange(500.0)
    slopes = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth)], axis=-1)
    singular = [family.name for family in FAMILIES if family.singular]
    fitted = {result.family for result in mf.fit(slopes)}
    assert fitted == {family.name for family in FAMILIES} - set(singular)
    for name in singular:
        with pytest.raises(ValueError, match=f"{name} has no density to fit"):
            mf.fit(slopes, name)


@each_family
def test_options_say_whose_shape_they_are(family: Any, run: Any) -> None:
    said = " ".join(run("eval", "--help").stdout.split())
    for own in family.parameters[1:]:
        assert f"--{own.name} X" in said
        assert family.name in said.partition(f"--{own.name} X")[2]


@each_family
def test_the_density_alone_is_checked_by_a_second_route(family: Any) -> None:
    """As of a family without checks of its own."""
    table = common.table(family)
    assert bool(table.CHECKS) != family.singular
    for check in table.CHECKS:
        values = dict(check.parameters)
        if not check.unless(*values.values()):
            result = check.run(family.name, family.kernels, values)
            assert result.passed, result


# Nothing else names them

#: What is about certain families: closed laws of mixtures, limits between families, a sampler of one, plugins
#: of Mitsuba's own; and "a" in the text of a snippet.
ABOUT_SOME = {
    *("_surface/mixing.py", "_report/families/cross.py", "_report/families/figures.py", "cli/sample.py"),
    *("mitsuba/_compare.py", "_bake/texture/snippets/__init__.py"),
}
NAMES = {family.name for family in FAMILIES} | {
    own.name for family in FAMILIES for own in family.parameters[1:]
}


def strings_of(tree: ast.AST) -> set[str]:
    """Without what formats numbers."""
    formats = {id(part) for n in ast.walk(tree) if isinstance(n, ast.JoinedStr) for part in ast.walk(n)}
    constants = (n for n in ast.walk(tree) if isinstance(n, ast.Constant) and id(n) not in formats)
    return {n.value for n in constants if isinstance(n.value, str)}


def test_no_module_names_a_family_or_its_parameter() -> None:
    named = {}
    for path in PACKAGE.rglob("*.py"):
        place = path.relative_to(PACKAGE).as_posix()
        own = place.startswith(("_family/", "_checks/")) or place in {"__init__.py", *ABOUT_SOME}
        if not own and (found := NAMES & strings_of(ast.parse(path.read_text(encoding="utf-8")))):
            named[place] = found
    assert not named


def test_no_plugin_names_a_family() -> None:
    for path in (PACKAGE / "mitsuba" / "plugin").iterdir():
        text = path.read_text(encoding="utf-8") if path.suffix in (".cpp", ".hpp") else ""
        for family in FAMILIES:
            assert f"{family.name}<" not in text, path
