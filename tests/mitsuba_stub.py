"""Plugins that compile in a moment, for tests of what compiles them."""

from __future__ import annotations

from pathlib import Path

import pytest

EXPORT = 'extern "C" __attribute__((visibility("default"))) const char* microfacet_register()'
STUB = EXPORT + " { return nullptr; }\n"
VARIANT = "scalar_rgb"


class Stub:
    """A source in place of the plugins, a cache of its own, and an opinion on what is compiled."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        from microfacet.mitsuba import _build, _check

        self.build, self.monkeypatch, self.checks, self.opinion = _build, monkeypatch, 0, ""
        self.sources, self.cache = folder / "plugin", folder / "cache" / "mitsuba"
        self.sources.mkdir()
        self.write(STUB)
        monkeypatch.setattr(_build, "SOURCES", self.sources)
        monkeypatch.setattr(_check, "objection", self._objection)
        monkeypatch.setenv("MICROFACET_CACHE", str(folder / "cache"))
        monkeypatch.delenv("CXX", raising=False)

    def _objection(self, *_: object) -> str:
        self.checks += 1
        return self.opinion

    def write(self, text: str) -> None:
        (self.sources / "stub.cpp").write_text(text, encoding="utf-8")

    def key(self) -> str:
        return str(self.build.key(self.build.find_compiler(), VARIANT))

    def library(self) -> Path:
        return Path(self.build.library(VARIANT))
