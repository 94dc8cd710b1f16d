"""What the page shows, collected from the library as plain data."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Any

from microfacet import _checks
from microfacet._report import _cross, _figures, _formulas, _materials, _parameters, _sampling, _svg
from microfacet._report._figures import FigureBlock

__all__ = ["CheckGroup", "Content", "FamilySection", "collect"]

_FIGURES_PER_FAMILY = 11


@dataclass(frozen=True)
class CheckGroup:
    """The checks of one family: pairs of what is stated and what came out."""

    name: str
    title: str
    rows: tuple[tuple[_checks.CheckItem, _checks.CheckResult], ...]

    @property
    def equations(self) -> tuple[tuple[_checks.CheckItem, _checks.CheckResult], ...]:
        """Those that compare two sides."""
        return tuple(row for row in self.rows if row[0].route != _checks.HISTOGRAM.name)

    @property
    def histograms(self) -> tuple[tuple[_checks.CheckItem, _checks.CheckResult], ...]:
        """Those that compare a histogram with its density."""
        return tuple(row for row in self.rows if row[0].route == _checks.HISTOGRAM.name)

    @property
    def passed(self) -> int:
        """How many hold."""
        return sum(result.passed for _, result in self.rows)


@dataclass(frozen=True)
class FamilySection:
    """One family: the library's entry for it, its text, its figures."""

    family: Any
    text: _formulas.FamilyText
    figures: tuple[FigureBlock, ...]


@dataclass(frozen=True)
class Content:
    """The whole page, before it is set."""

    overview: FigureBlock
    families: tuple[FamilySection, ...]
    comparisons: tuple[FigureBlock, ...]
    checks: tuple[CheckGroup, ...]
    surface: Any

    @property
    def total(self) -> int:
        """How many checks ran."""
        return sum(len(group.rows) for group in self.checks)

    @property
    def passed(self) -> int:
        """How many of them hold."""
        return sum(group.passed for group in self.checks)

    def count(self, notebook: bool) -> tuple[int, int]:
        """(passed, total) of the notebooks' checks, or of those beyond them."""
        results = [r.passed for group in self.checks for item, r in group.rows if item.notebook == notebook]
        return sum(results), len(results)


def collect(
    names: Collection[str] | None,
    parameters: Mapping[str, float] | None,
    surface: Any,
    progress: Callable[[str, int, int], None],
    quick: bool,
) -> Content:
    """Draw every figure and run every check."""
    families = _parameters.choose(names, parameters)
    chosen = tuple(family.name for family in families)
    items = {} if quick else {item.id: item for item in _checks.catalogue() if item.family in chosen}
    steps = 1 + _FIGURES_PER_FAMILY * len(families) + 3 + len(items) + (5 if surface is not None else 0)
    done = 0

    def step(what: str, by: int = 1) -> None:
        nonlocal done
        progress(what, done, steps)
        done += by

    with _svg.style():
        step("overview")
        overview = _cross.overview(families, parameters)
        sections = []
        for family in families:
            figures = []
            example = _parameters.example(family, parameters)
            drawn = (
                _figures.family_figures(family, example),
                _sampling.sampling_figures(family, example),
                _materials.material_figures(family, example),
            )
            for figure in itertools.chain(*drawn):
                step(f"{family.title}: figures")
                figures.append(figure)
            sections.append(FamilySection(family, _formulas.load().families[family.name], tuple(figures)))
        step("comparisons", 3)
        comparisons = tuple(_cross.comparison_figures(chosen, parameters))
        section = None
        if surface is not None:
            from microfacet._report import _terrain

            step("measured surface", 5)
            section = _terrain.measured_surface(surface, chosen)
    results: dict[str, list[tuple[Any, Any]]] = {name: [] for name in chosen}
    if items:
        for result in _checks.run(families=chosen, parameters=parameters):
            step(f"check {result.id}")
            results[result.family].append((items[result.id], result))
    progress("page", steps, steps)
    titles = {family.name: family.title for family in families}
    groups = tuple(CheckGroup(name, titles[name], tuple(rows)) for name, rows in results.items() if rows)
    return Content(overview, tuple(sections), comparisons, groups, section)
