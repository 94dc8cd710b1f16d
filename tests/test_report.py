"""The report as a page: self-contained, accessible, complete, and true to the library."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from importlib.resources import files
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import microfacet as mf
from microfacet import _checks
from microfacet._family.looks import PALETTE
from microfacet._report import families, figure, mathml
from microfacet._report import page as pages
from microfacet._report.families import Report, build, figures, formulas
from microfacet._report.families import parameters as examples
from microfacet._report.sources import sources
from report_pages import Page, rough_surface

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[Report, Page]:
    path = tmp_path_factory.mktemp("report") / "page.html"
    report = build(path, ["k0", "beckmann"], {"alpha": 0.4}, rough_surface())
    return report, Page(path.read_text("utf-8"))


@pytest.fixture(scope="module")
def page(built: tuple[Report, Page]) -> Page:
    return built[1]


# The page


def test_page_loads_nothing(page: Page) -> None:
    assert not page.all("script", "link", "iframe", "object", "embed", "base")
    for element in page.elements:
        for name, value in element["attrs"].items():
            if name in {"src", "srcset", "poster", "data", "xlink:href"} or (
                name == "href" and element["tag"] != "a"
            ):
                assert value.startswith(("data:image/png;base64,", "#")), (element["tag"], name, value[:60])
            assert not name.startswith("on"), "no scripts in attributes"
    assert "@import" not in page.style
    assert all(target.startswith("#") for target in re.findall(r"url\(([^)]*)\)", page.html))


def test_page_says_what_it_is(page: Page) -> None:
    (html,) = page.all("html")
    assert html["attrs"]["lang"] == "en"
    assert page.html.lower().startswith("<!doctype html>")
    titles = [element for element in page.all("title") if "svg" not in element["inside"]]
    assert len(titles) == 1
    assert "microfacet" in titles[0]["text"]
    viewport = [e["attrs"]["content"] for e in page.all("meta") if e["attrs"].get("name") == "viewport"]
    assert viewport == ["width=device-width, initial-scale=1"]
    assert any("charset" in element["attrs"] for element in page.all("meta"))


def test_headings_descend_in_steps(page: Page) -> None:
    levels = [int(element["tag"][1]) for element in page.all("h1", "h2", "h3", "h4")]
    assert levels.count(1) == 1
    assert levels[0] == 1
    assert all(after <= before + 1 for before, after in itertools.pairwise(levels))


def test_ids_are_unique_and_links_arrive(page: Page) -> None:
    ids = Counter(element["attrs"]["id"] for element in page.elements if "id" in element["attrs"])
    assert [name for name, count in ids.items() if count > 1] == []
    targets = [element["attrs"]["href"] for element in page.all("a", "use")]
    assert [t for t in targets if t.startswith("#") and t[1:] not in ids] == []
    assert [t for t in re.findall(r"url\(#([^)]*)\)", page.html) if t not in ids] == []
    external = [target for target in targets if not target.startswith("#")]
    assert all(target.startswith("https://doi.org/") for target in external)


def test_figures_have_captions_and_names(page: Page) -> None:
    figures, captions = page.all("figure"), page.all("figcaption")
    assert len(figures) == len(captions) >= 10
    assert all(len(caption["text"]) > 60 and "figure" in caption["inside"] for caption in captions)
    images = page.all("svg")
    assert len(images) >= len(figures)
    for image in images:
        assert "figure" in image["inside"]
        assert image["attrs"]["role"] == "img"
        assert len(image["attrs"]["aria-label"]) > 15


def test_scrolling_regions_can_be_reached_by_keyboard(page: Page) -> None:
    tables = page.all("table")
    assert tables
    assert all("div" in table["inside"] for table in tables)
    regions = [element for element in page.elements if element["attrs"].get("class") == "scroll"]
    assert len(regions) == len(tables)
    for region in regions:
        assert region["attrs"]["tabindex"] == "0"
        assert region["attrs"]["aria-label"]
    assert all(element["attrs"].get("scope") in {"row", "col"} for element in page.all("th"))


def test_figures_follow_the_theme(page: Page) -> None:
    assert "prefers-color-scheme: dark" in page.style
    assert "currentColor" in page.html
    svg = "".join(re.findall(r"<svg.*?</svg>", page.html, re.DOTALL))
    paint = set(re.findall(r"(?:fill|stroke): ?([^;\"]+)", svg))
    assert all(value in {"none", "currentColor"} or value.startswith("var(--") for value in paint), paint
    for name in re.findall(r"var\((--[a-z0-9-]+)\)", svg):
        assert page.style.count(f"{name}:") == 2, f"{name} needs a value for light and one for dark"


def test_colours_contrast_in_both_themes() -> None:
    css = files("microfacet._report").joinpath("templates", "report.css").read_text("utf-8")
    light, dark = (
        dict(re.findall(r"(--[\w-]+): (#[0-9a-f]{6})", part)) for part in css.split("@media", 2)[:2]
    )
    assert light.keys() == dark.keys()
    for theme in (light, dark):
        for name, needed in {
            "--ink": 7.0,
            "--muted": 4.5,
            "--accent": 4.5,
            "--good": 4.5,
            "--bad": 4.5,
        }.items():
            assert contrast(theme[name], theme["--paper"]) >= needed, name
        for name in (f"--curve-{number}" for number in range(1, len(PALETTE) + 1)):
            assert contrast(theme[name], theme["--paper"]) >= 3.0, name


def contrast(one: str, other: str) -> float:
    """The contrast ratio of the Web Content Accessibility Guidelines 2."""

    def luminance(color: str) -> float:
        channels = np.array([int(color[i : i + 2], 16) for i in (1, 3, 5)]) / 255
        linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


# Its content


def test_every_check_of_the_families_is_in_the_table(built: tuple[Report, Page]) -> None:
    report, page = built
    items = [item for item in _checks.catalogue() if item.family in {"k0", "beckmann"}]
    rows = [e for e in page.all("tr") if e["attrs"].get("id", "").startswith("check-")]
    assert {row["attrs"]["id"] for row in rows} == {f"check-{item.id}" for item in items}
    assert report.total == len(items)
    marks = [row["text"] for row in rows if "✓ holds" in row["text"]]
    assert report.passed == len(marks), "the mark is a word, not only a colour"
    counted = {" ".join(row["text"].split()) for row in page.all("tr")}
    for family, title in (("k0", "K0"), ("beckmann", "Beckmann")):
        own, ours = (sum(i.family == family and i.notebook == kind for i in items) for kind in (True, False))
        assert f"{title}{own} of {own}{ours} of {ours}" in counted
    assert any("algebra: " in row["text"] for row in rows)
    notebook = sum(item.notebook for item in items)
    assert f"{notebook} of {notebook} notebook checks hold" in " ".join(page.all("header")[0]["text"].split())


def test_given_parameters_reach_figures_and_checks(page: Page) -> None:
    rows = [e["text"] for e in page.all("tr") if e["attrs"].get("id", "").startswith("check-")]
    assert all("α\u00a0=\u00a00.4" in row for row in rows if "singular" not in row)


def test_measured_surface_is_escaped_and_ranked(page: Page) -> None:
    assert "synthetic &amp; &lt;small&gt;" in page.html
    text = " ".join(page.all("main")[0]["text"].split())
    assert "levelled: least-squares plane subtracted" in text
    fits = mf.fit(rough_surface(), families=["k0", "beckmann"])
    ranked = list(dict.fromkeys(fit.family for fit in fits))
    titles = {family.name: family.title for family in mf.families()}
    table = next(element["text"] for element in page.all("tbody") if "check" not in element["text"])
    places = [table.index(titles[name]) for name in ranked]
    assert places == sorted(places)


def test_a_failed_build_leaves_the_old_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "page.html"
    path.write_text("old")

    def fail(*_: object) -> str:
        raise RuntimeError("on the way")

    monkeypatch.setattr(families, "set_page", fail)
    with pytest.raises(RuntimeError, match="on the way"):
        build(path, ["ggx"], quick=True)
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["page.html"]


@pytest.mark.parametrize(
    ("families", "parameters", "message"),
    [
        (["nonsense"], None, r"family must be one of beckmann, .*, got 'nonsense'"),
        (["ggx"], {"alpha": -1.0}, r"alpha must lie in \(1e-101, 1e\+101\), got -1"),
        (["student_t"], {"gamma": 1.2}, r"gamma must lie in \(1.5, inf\), got 1.2"),
        (["ggx"], {"gamma": 2.0}, r"gamma is no parameter of ggx"),
    ],
)
def test_bad_input_is_named(
    tmp_path: Path, families: list[str], parameters: dict[str, float] | None, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        build(tmp_path / "page.html", families, parameters)
    assert not list(tmp_path.iterdir())


def test_output_folder_must_exist(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="output must lie in an existing folder"):
        build(tmp_path / "missing" / "page.html")


def test_progress_counts_to_the_end(tmp_path: Path) -> None:
    calls: list[tuple[str, int, int]] = []
    build(tmp_path / "page.html", ["ggx"], quick=True, progress=lambda *call: calls.append(call))
    done = [count for _, count, _ in calls]
    assert done == sorted(done)
    assert calls[-1][1] == calls[-1][2]


# What it is made of


def test_both_routes_to_sigma_agree_in_the_figures() -> None:
    with figure.style():
        for family in (family for family in mf.families() if not family.singular):
            caption = figures.two_routes(family, examples.example(family, None)).caption
            mantissa, exponent = re.findall(r"(\d+)\\times 10\^\{(-\d+)\}", caption)[-1]
            # A density that grows like the reciprocal of the slope is cut off at the flattest facets.
            shape = [own.pictured for own in family.parameters[1:]]
            reciprocal = np.isinf(family.kernels.P2(0.0, 0.3, *shape))
            assert float(mantissa) * 10.0 ** int(exponent) <= (1e-11 if reciprocal else 1e-13)


@pytest.mark.parametrize("family", mf.families(), ids=lambda family: family.name)
def test_every_family_has_formulas_and_sources(family: Any) -> None:
    text = formulas.load().families[family.name]
    names = " ".join(formula.name.lower() for formula in text.formulas)
    for word in ("density", "slopes", "masking", "survival", "sampling"):
        assert word in names
    assert set(family.sources) <= sources().keys()


def test_every_formula_converts_completely() -> None:
    shown = formulas.load()
    entries = [*shown.common, *(f for text in shown.families.values() for f in text.formulas)]
    latex = [piece for entry in entries for piece in entry.latex]
    latex += [item.latex for item in _checks.catalogue()]
    for text in latex:
        for piece in mathml.display_pieces(text):
            root = ElementTree.fromstring(piece)
            assert root.tag == "math"
            leaves = [leaf.text or "" for leaf in root.iter() if leaf.tag in {"mi", "mo", "mn", "mtext"}]
            assert not [leaf for leaf in leaves if "\\" in leaf or "&" in leaf], text
    for entry in entries:
        assert (entry.name + entry.remark).count("$") % 2 == 0


def test_prose_keeps_brackets_and_punctuation_with_their_formula() -> None:
    html = mathml.prose("a < b ($x$), then $y$")
    assert html.startswith('a &lt; b <span class="nb">(<math')
    assert "</math>),</span> then <math" in html


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (0.25, 6, "0.25"),
        (-1.5, 6, "−1.5"),
        (1.5e-13, 2, "1.5\u202f×\u202f10<sup>−13</sup>"),
        (2e20, 3, "2\u202f×\u202f10<sup>20</sup>"),
        (np.inf, 3, "∞"),
        (None, 3, "–"),
    ],
)
def test_numbers_are_set_as_one_writes_them(value: float | None, digits: int, text: str) -> None:
    assert str(pages.number(value, digits)) == text


def test_sources_come_from_the_bibliography() -> None:
    bibliography = (ROOT / "references.bib").read_text("utf-8")
    entries = dict(re.findall(r"^@\w+\{(\w+),\n(.*?)^\}", bibliography, re.M | re.S))
    assert {
        key for key, entry in entries.items() if re.search(r"^\s*author", entry, re.M)
    } == sources().keys()
    for key, source in sources().items():
        year = re.search(r"year\s*=\s*\{(\d+)\}", entries[key])
        assert year
        assert source.short.endswith(f" {year.group(1)}"), key
        doi = re.search(r"doi\s*=\s*\{([^}]*)\}", entries[key])
        links = re.findall(r'href="([^"]*)"', source.html)
        assert links == ([f"https://doi.org/{doi.group(1)}"] if doi else []), key
    assert sources()["walter2007microfacet"].short == "Walter et al. 2007"
    assert sources()["ribardiere2017std"].short == "Ribardière et al. 2017"
    assert sources()["trowbridge1975average"].short == "Trowbridge and Reitz 1975"


def test_works_are_linked_where_a_check_cites_them() -> None:
    work = "d'Eon 2020, A Hitchhiker's Guide to Multiple Scattering, notebook K0 NDF"
    assert pages._cite(work) == '<a href="#ref-deon2020hitchhiker">d&#39;Eon 2020</a>, notebook K0 NDF'
    assert pages._cite("Walter et al. 2007; nobody 1900").startswith('<a href="#ref-walter2007microfacet">')


# Sampling


def test_visible_normals_have_their_figures(page: Page) -> None:
    shown = {element["attrs"]["id"] for element in page.all("figure")}
    for family in ("k0", "beckmann"):
        assert {f"fig-{family}-{what}" for what in ("visible-slopes", "visible-normals", "noise")} <= shown
    assert "sampled normals seen from three directions" in page.html


# Materials


def test_materials_have_their_figures(page: Page) -> None:
    shown = {element["attrs"]["id"] for element in page.all("figure")}
    for family in ("k0", "beckmann"):
        assert {f"fig-{family}-{what}" for what in ("lobes", "albedo", "furnace")} <= shown
