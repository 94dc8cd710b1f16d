"""The languages: one module each, with what the printer has to know as `LANGUAGE`."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from microfacet._export.language import Language

__all__ = ["languages"]


@cache
def languages() -> dict[str, Language]:
    """All languages by name, in the order of their names."""
    modules = [import_module(f"{__name__}.{module.name}") for module in iter_modules(__path__)]
    found = [module.LANGUAGE for module in modules]
    return {language.name: language for language in sorted(found, key=lambda language: language.name)}
