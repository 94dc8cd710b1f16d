"""Pages of the report for tests: read as elements with their text, and a small surface to put on them."""

from __future__ import annotations

from html.parser import HTMLParser
from typing import Any

import numpy as np

import microfacet as mf

VOID = {"meta", "br", "link", "img"}


class Page(HTMLParser):
    """The page as a list of (tag, attributes, ancestors, text) and the text of its style element."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.html = html
        self.elements: list[dict[str, Any]] = []
        self.open: list[dict[str, Any]] = []
        self.feed(html)
        assert not self.open, f"unclosed: {[element['tag'] for element in self.open]}"

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        element = {"tag": tag, "attrs": dict(attrs), "inside": [e["tag"] for e in self.open], "text": ""}
        element["classes"] = [name for e in self.open for name in (e["attrs"].get("class") or "").split()]
        self.elements.append(element)
        if tag not in VOID:
            self.open.append(element)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open[-1]["tag"] == tag, f"</{tag}> closes <{self.open[-1]['tag']}>"
        self.open.pop()

    def handle_data(self, data: str) -> None:
        for element in self.open:
            element["text"] += data

    def all(self, *tags: str) -> list[dict[str, Any]]:
        return [element for element in self.elements if element["tag"] in tags]

    @property
    def style(self) -> str:
        return str(next(e["text"] for e in self.all("style")))


def rough_surface() -> mf.Surface:
    """A small surface with Gaussian heights, smoothed over a few pixels."""
    heights = np.random.default_rng(3).normal(size=(48, 64))
    for axis in (0, 1, 0, 1):
        heights = heights + np.roll(heights, 1, axis)
    return mf.Surface(heights * 1e-7, pixel_size=1e-6, source="synthetic & <small>").level()
