"""The pages at the widths of a phone, a tablet and a desk: nothing is cut off, nothing says left or right."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import browser
import microfacet as mf
from microfacet import _checks
from microfacet._checks import CheckItem, CheckResult
from microfacet._report import figure, mathml
from microfacet._report.families import build, content, cross, formulas, set_page
from microfacet.cli import main
from report_pages import Page, rough_surface

PHONE, TABLET, DESK = 390, 768, 1400
CSS = files("microfacet._report").joinpath("templates", "report.css").read_text("utf-8")


def result_of(item: CheckItem) -> CheckResult:
    """An outcome whose numbers take as much room as any."""
    lhs, rhs, residual = -1.2345678901234e-12, -1.2345678901235e-12, 8.1e-14
    if item.route == _checks.HISTOGRAM.name:
        lhs, rhs, residual = 123.456, 63.0, 0.96
    return CheckResult(item.id, item.family, item.parameters, lhs, rhs, residual, 2e-13, False, item.source)


@pytest.fixture(scope="module")
def formulas_and_checks() -> str:
    """The page of all families, every formula and every check, without figures."""
    items = _checks.catalogue()
    texts = formulas.load().families
    groups = [
        content.CheckGroup(
            family.name, family.title, tuple((i, result_of(i)) for i in items if i.family == family.name)
        )
        for family in mf.families()
    ]
    sections = [content.FamilySection(family, texts[family.name], ()) for family in mf.families()]
    overview = figure.FigureBlock("overview", (), "No figures here.")
    return set_page(content.Content(overview, tuple(sections), (), tuple(groups), None), 1.0)


@pytest.fixture(scope="module")
def with_figures(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("layout") / "page.html"
    build(path, ["ggx"], {"alpha": 0.3}, rough_surface(), quick=True)
    return path.read_text("utf-8")


@pytest.fixture(scope="module")
def of_a_fit(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("layout")
    surface = rough_surface()
    np.savez(folder / "map.npz", heights=surface.heights, pixel_size=1e-6)
    command = ["fit", str(folder / "map.npz"), "--report", str(folder / "page.html")]
    result = CliRunner().invoke(main, command)
    assert result.exit_code == 0, result.stderr
    return (folder / "page.html").read_text("utf-8")


@pytest.fixture(scope="module", params=["formulas_and_checks", "with_figures", "of_a_fit"])
def html(request: pytest.FixtureRequest) -> str:
    return str(request.getfixturevalue(request.param))


# What HTML and style sheet alone can tell


def rule(selector: str) -> str:
    """The declarations of all rules that name the selector, outside media queries."""
    plain = re.sub(r"@media[^{]*\{(?:[^{}]*\{[^{}]*\})*[^{}]*\}", "", re.sub(r"/\*.*?\*/", "", CSS))
    rules = re.findall(r"([^{}]+)\{([^{}]*)\}", plain)
    return " ".join(body for names, body in rules if selector in map(str.strip, names.split(",")))


def test_what_may_be_wide_scrolls_in_a_container_of_its_own(html: str) -> None:
    for selector in (".scroll", ".formula"):
        assert "overflow-x: auto" in rule(selector)
        assert "background" in rule(selector), "the shade that says that there is more"
    page = Page(html)
    tables, formulas = page.all("table"), page.all("math")
    assert tables
    assert formulas
    assert all("scroll" in table["classes"] for table in tables)
    for formula in formulas:
        assert formula["attrs"]["display"] == "inline" or "formula" in formula["classes"], formula["text"]


def test_images_shrink_and_words_break() -> None:
    assert "width: 100%" in rule("svg")
    assert "overflow-wrap: break-word" in rule("body")


def test_captions_name_figures_by_what_they_show(html: str) -> None:
    for caption in Page(html).all("figcaption"):
        assert not re.search(r"\b(left|right)\b", caption["text"], re.I), caption["text"]


def test_captions_of_comparisons_do_too() -> None:
    with figure.style():
        blocks = list(cross.comparison_figures([family.name for family in mf.families()], None))
    assert len(blocks) == 4
    for block in blocks:
        assert not re.search(r"\b(left|right)\b", block.caption, re.I), block.caption


def test_a_display_is_broken_into_its_statements() -> None:
    for latex in (r"a=b,\quad c=d", r"a=b, \quad c=d", r"a=b,\quad c=d ,  \quad e"):
        pieces = mathml.display_pieces(latex)
        assert len(pieces) == latex.count("quad") + 1
    for item in _checks.catalogue():
        assert all("quad" not in piece for piece in re.split(r",\s*\\quad", item.latex)), item.id


def test_histograms_and_equations_have_columns_of_their_own(formulas_and_checks: str) -> None:
    tables = re.findall(r'<table class="checks">.*?</table>', formulas_and_checks, re.DOTALL)
    drawn = {item.family for item in _checks.catalogue() if item.id.endswith(".sampling")}
    assert len(tables) == len(mf.families()) + len(drawn)  # a family may have no histogram
    for table in tables:
        head, body = (re.sub(r"<[^>]*>", " ", part) for part in table.split("</thead>"))
        heads = " ".join(head.split())
        ids = re.findall(r'id="check-([^"]*)"', table)
        assert ids
        if any(id.endswith(".sampling") for id in ids):
            assert all(id.endswith(".sampling") for id in ids)
            assert all(word in heads for word in ("statistic", "Degrees of freedom", "p-value"))
            assert "side" not in heads
            assert "123.46" in body
            assert "63" in body.split()
        else:
            assert "Left side" in heads
            assert "statistic" not in heads
        labels = re.findall(r'<td[^>]*data-label="([^"]+)"', table)
        assert len(labels) == len(re.findall("<td", table)), "stacked, each number says what it is"


# What a browser says


@pytest.fixture(scope="module")
def layouts(html: str, tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, Any]]:
    chromium = browser.find()
    if chromium is None:
        pytest.skip("no Chromium to lay the page out")
    return browser.layouts(chromium, html, (PHONE, TABLET, DESK), Path(tmp_path_factory.mktemp("browser")))


def test_nothing_reaches_beyond_the_window(layouts: list[dict[str, Any]]) -> None:
    for layout in layouts:
        assert layout["page"] == layout["width"], "the page does not scroll sideways"
        assert not layout["outside"], layout["width"]


def test_only_a_phone_cuts_formulas_and_they_scroll(layouts: list[dict[str, Any]]) -> None:
    phone, tablet, desk = layouts
    assert not desk["clipped"]
    assert not [name for kind, _, name in tablet["clipped"] if kind == "formula"]
    assert all(overflow == "auto" for _, overflow, _ in phone["clipped"])


def test_checks_are_never_wider_than_their_place(layouts: list[dict[str, Any]]) -> None:
    for layout in layouts:
        assert all(excess <= 1 for excess in layout["checks"])
