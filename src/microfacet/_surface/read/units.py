"""Units of length as files and people write them."""

from __future__ import annotations

import re

from microfacet._surface.checks import METRES_PER_UNIT, SurfaceError, short

__all__ = ["agreed_unit", "unit_in_brackets", "unit_name"]

_WORDS = {
    "km": ("kilometer", "kilometre"),
    "m": ("meter", "metre"),
    "cm": ("centimeter", "centimetre"),
    "mm": ("millimeter", "millimetre"),
    "um": ("micrometer", "micrometre", "micron", "mikrometer"),
    "nm": ("nanometer", "nanometre"),
    "A": ("angstrom", "\u00e5ngstr\u00f6m", "\u00c5ngstr\u00f6m", "ang"),
    "pm": ("picometer", "picometre"),
    "fm": ("femtometer", "femtometre"),
}
_NAMES = {word: unit for unit, words in _WORDS.items() for word in words}
_BRACKETS = re.compile(r"[\[(]\s*([^\[\]()]{0,24}?)\s*[\])]")


def unit_name(text: str) -> str:
    """The unit that is written there, by the name that we use; what is no length stays as it is."""
    bare = text.strip().strip("[]()\"'").strip()
    # The micro sign in UTF-8 that somebody took for Latin-1; both micro signs; the sign of the angstrom.
    bare = bare.replace("\u00c2\u00b5", "\u00b5").replace("\u212b", "\u00c5")
    if bare in METRES_PER_UNIT:
        return "um" if bare in ("\u00b5m", "\u03bcm") else "A" if bare == "\u00c5" else bare
    word = bare.casefold()
    word = word.removesuffix("s") if len(word) > 2 else word
    return _NAMES.get(word, bare)


def unit_in_brackets(text: str) -> tuple[str, str | None]:
    """A name without the unit in brackets behind it, and that unit: ``x [um]``, ``Width (mm)``, ``z/nm``."""
    found = _BRACKETS.search(text)
    if found:
        unit = found.group(1)
        return (text[: found.start()] + text[found.end() :]).strip(), unit_name(unit) if unit else None
    name, mark, rest = text.rpartition("/")
    if mark and name.strip() and unit_name(rest) in METRES_PER_UNIT:
        return name.strip(), unit_name(rest)
    return text.strip(), None


def agreed_unit(stated: str | None, given: str | None) -> str | None:
    """The unit that the file states or the caller gives, which must not contradict each other."""
    known = None if stated is None else unit_name(stated)
    if stated is not None and known not in METRES_PER_UNIT:
        raise SurfaceError(f"the file states the unit {short(stated[:20])}, which is not a known length")
    if known is not None and given is not None and METRES_PER_UNIT[known] != METRES_PER_UNIT[given]:
        raise SurfaceError(f"the file states the unit {known}, not {given}")
    return known or given
