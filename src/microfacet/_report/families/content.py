"""What the page shows, collected from the library as plain data."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

import microfacet as mf
from microfacet import _checks
from microfacet._report import Progress, figure
from microfacet._report.families import cross, figures, formulas, materials, sampling
from microfacet._report.families import parameters as parameters_of
from microfacet._report.figure import FigureBlock
from microfacet._report.surfaces.content import MeasuredSurface, measured_surface

__all__ = ["CheckGroup", "Content", "FamilySection", "collect"]

_FIGURES_PER_FAMILY = 11
_MAX_SLOPES = 200_000  # a second of the report's time


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

    def count(self, notebook: bool) -> tuple[int, int]:
        """(passed, total) of the statements of the family's notebook, or of those beyond it."""
        results = [result.passed for item, result in self.rows if item.notebook == notebook]
        return sum(results), len(results)


@dataclass(frozen=True)
class FamilySection:
    """One family: the library's entry for it, its text, its figures."""

    family: Any
    text: formulas.FamilyText
    figures: tuple[FigureBlock, ...]


@dataclass(frozen=True)
class Content:
    """The whole page, before it is set."""

    overview: FigureBlock
    families: tuple[FamilySection, ...]
    comparisons: tuple[FigureBlock, ...]
    checks: tuple[CheckGroup, ...]
    surface: MeasuredSurface | None

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
        counts = [group.count(notebook) for group in self.checks]
        return sum(passed for passed, _ in counts), sum(total for _, total in counts)


def collect(
    names: Collection[str] | None,
    parameters: Mapping[str, float] | None,
    surface: Any,
    progress: Progress,
    quick: bool,
) -> Content:
    """Draw every figure and run every check."""
    families = parameters_of.choose(names, parameters)
    chosen = tuple(family.name for family in families)
    with_density = [family.name for family in families if not family.singular]
    items = {} if quick else {item.id: item for item in _checks.catalogue() if item.family in chosen}
    figures_of = {family.name: 1 if family.singular else _FIGURES_PER_FAMILY for family in families}
    steps = 1 + sum(figures_of.values()) + 4 + len(items) + (5 if surface is not None else 0)
    done = 0

    def step(what: str, by: int = 1) -> None:
        nonlocal done
        progress(what, done, steps)
        done += by

    with figure.style():
        step("overview")
        overview = cross.overview(families, parameters)
        sections = []
        for family in families:
            blocks = []
            example = parameters_of.example(family, parameters)
            drawn = [figures.family_figures(family, example)]
            if not family.singular:
                drawn.append(sampling.sampling_figures(family, example))
                drawn.append(materials.material_figures(family, example))
            for block in itertools.chain(*drawn):
                step(f"{family.title}: figures")
                blocks.append(block)
            sections.append(FamilySection(family, formulas.load().families[family.name], tuple(blocks)))
        step("comparisons", 4)
        comparisons = tuple(cross.comparison_figures(chosen, parameters))
        section = None
        if surface is not None:
            step("measured surface", 5)
            section = measured_surface(
                surface, mf.fit(surface, families=with_density, max_slopes=_MAX_SLOPES)
            )
    results: dict[str, list[tuple[Any, Any]]] = {name: [] for name in chosen}
    if items:
        for result in _checks.run(families=chosen, parameters=parameters):
            step(f"check {result.id}")
            results[result.family].append((items[result.id], result))
    progress("page", steps, steps)
    titles = {family.name: family.title for family in families}
    groups = tuple(CheckGroup(name, titles[name], tuple(rows)) for name, rows in results.items() if rows)
    return Content(overview, tuple(sections), comparisons, groups, section)
