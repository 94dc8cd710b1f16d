"""Figures of the pages: matplotlib as SVG inside HTML, themed by CSS, without identifiers that clash."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from microfacet._family.looks import PALETTE

__all__ = [
    "GRID",
    "INK",
    "REFERENCE",
    "SERIES",
    "FigureBlock",
    "inline_svg",
    "name_panel",
    "panel",
    "style",
    "themed",
    "thousands",
]

# Drawn in colours that occur nowhere else, then replaced: text and axes follow the page, curves follow
# custom properties of the style sheet that have a value for light and one for dark.
INK = "#010203"
GRID = "#040506"
_THEME = {INK: "currentColor", GRID: "var(--rule)"} | {
    color: f"var(--curve-{number})" for number, (color, _) in enumerate(PALETTE, 1)
}
_SVG = "{http://www.w3.org/2000/svg}"
_HREF = "{http://www.w3.org/1999/xlink}href"

#: Colours and dashes of curves that differ in a parameter, not in the family.
SERIES: tuple[tuple[str, Any], ...] = tuple(PALETTE[number] for number in (1, 0, 3, 2, 4, 5))
#: A curve that the others are compared with.
REFERENCE: dict[str, Any] = {"color": INK, "linewidth": 1.3, "linestyle": (0, (1.2, 1.6))}


@dataclass(frozen=True)
class FigureBlock:
    """One `figure` of the page: SVG panels side by side and a caption with inline formulas."""

    id: str
    panels: tuple[str, ...]
    caption: str


@contextmanager
def style() -> Iterator[None]:
    """The look of the report's figures; glyphs are outlines, so that every reader sees the same."""
    with mpl.rc_context(
        {
            "svg.fonttype": "path",
            "svg.hashsalt": "microfacet",
            "font.family": "STIXGeneral",
            "mathtext.fontset": "stix",
            "font.size": 13,
            "axes.labelsize": 14,
            "legend.fontsize": 12,
            "legend.frameon": False,
            "legend.handlelength": 2.2,
            "legend.labelspacing": 0.3,
            "lines.linewidth": 1.6,
            "axes.linewidth": 0.8,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "axes.edgecolor": INK,
            "axes.labelcolor": INK,
            "text.color": INK,
            "xtick.color": INK,
            "ytick.color": INK,
            "axes.grid": True,
            "grid.color": GRID,
            "grid.linewidth": 0.7,
            "axes.axisbelow": True,
            "figure.figsize": (5.4, 3.6),
            "figure.facecolor": "none",
            "axes.facecolor": "none",
            # Fixed margins: the axes of neighbouring panels align, and no second layout pass is needed.
            "figure.subplot.left": 0.15,
            "figure.subplot.right": 0.97,
            "figure.subplot.bottom": 0.17,
            "figure.subplot.top": 0.97,
        }
    ):
        yield


def panel(name: str, description: str, draw: Callable[[Axes], Any], legend: Any = "best") -> str:
    """One set of axes as inline SVG; `description` is what a screen reader says."""
    figure = Figure()
    ax = figure.add_subplot()
    draw(ax)
    if legend and ax.get_legend_handles_labels()[0]:
        ax.legend(loc=legend)
    return inline_svg(figure, name, description)


def name_panel(figure: Figure, name: str) -> None:
    """Write a panel's name in its upper corner: side by side or stacked, a caption can refer to it."""
    figure.text(0.01, 0.98, name, va="top")


def thousands(n: int) -> str:
    """A count with a narrow space between its thousands."""
    return f"{n:,}".replace(",", "\u202f")


def inline_svg(figure: Figure, name: str, label: str) -> str:
    """The figure as an `svg` element labelled for screen readers, every id prefixed by `name`."""
    buffer = io.StringIO()
    figure.savefig(
        buffer, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None}
    )
    root = ElementTree.fromstring(buffer.getvalue())
    for key in ("width", "height", "version"):
        root.attrib.pop(key, None)
    root.attrib |= {"role": "img", "aria-label": label}
    for element in root.iter():
        if "id" in element.attrib:
            if element.tag == f"{_SVG}g":  # matplotlib names every group; nothing refers to them
                del element.attrib["id"]
            else:
                element.attrib["id"] = f"{name}-{element.attrib['id']}"
        if (target := element.attrib.pop(_HREF, None)) is not None:
            element.attrib["href"] = f"#{name}-{target[1:]}" if target.startswith("#") else target
        if "d" in element.attrib:  # a hundredth of a point is enough, and half the size of the page
            element.attrib["d"] = re.sub(r"\d+\.\d{3,}", _rounded, element.attrib["d"])
        for key in ("clip-path", "style", "fill", "stroke"):
            if key in element.attrib:
                element.attrib[key] = themed(element.attrib[key].replace("url(#", f"url(#{name}-"))
    text = ElementTree.tostring(root, encoding="unicode")
    text = re.sub(r"<(/?)ns\d+:", r"<\1", text)  # HTML knows the namespace of an inline svg
    return re.sub(r' xmlns(:\w+)?="[^"]*"', "", text)


def _rounded(number: re.Match[str]) -> str:
    return f"{float(number.group()):.2f}".rstrip("0").rstrip(".")


def themed(value: str) -> str:
    """A style in which the drawing's colours have become those of the page."""
    for color, property_ in _THEME.items():
        value = value.replace(color, property_)
    return value
