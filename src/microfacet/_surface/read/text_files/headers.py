"""What the heading of a text states: sizes, units, the name of the channel, under the names in use."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from microfacet._surface.checks import METRES_PER_UNIT, SurfaceError, short
from microfacet._surface.read.text_files.numbers import number
from microfacet._surface.read.units import unit_in_brackets, unit_name

__all__ = ["Header", "parse", "starts_a_channel"]

_LINE = re.compile(r"[\W_]*([^\W\d_][^:=\uff1a\t;,]{0,60}?)\s*[:=\uff1a\t;,]\s*(.{1,200})$")
_SIZE = r"([-+]?[\d.,]+(?:[eE][-+]?\d+)?)\s*(\D{0,24}?)"
_VALUE = re.compile(rf"{_SIZE}(?:\s*(?:[x\u00d7*;]|,\s)\s*{_SIZE})?\s*$")

# Sentences: "heights in nm", "all lengths are in um", "pixel size 0.5 um", "Topography [nm]".
_PROSE = re.compile(
    r"[\W_]*((?:all )?(?:the )?(?:heights?|z|z values?|values?|data|lengths?|units?|dimensions?))\s+"
    r"(?:are |is )?(?:given )?(?:in )?([^\W\d_]{1,20})[\W_]*$",
    re.IGNORECASE,
)
_NO_LENGTHS = ("V", "mV", "volt", "volts", "deg", "degrees", "rad", "nA", "pA", "Hz", "N", "nN", "counts")
_ALL = (
    "all lengths",
    "all the lengths",
    "lengths",
    "units",
    "unit",
    "all units",
    "dimensions",
    "all dimensions",
)
_PROSE_SIZE = re.compile(r"[\W_]*([^\W\d_][^\d:=]{0,30}?)\s+(?:is |of )?(\d.{0,60})$")
_TITLE = re.compile(
    r"[\W_]*(?:\w+ ){0,3}(?:heights?|height map|topography|elevation|depth|z)\s*"
    r"[\[(]([^\[\]()]{1,20})[\])]\W*$",
    re.IGNORECASE,
)

# Keys in lower case with single spaces for whatever is no letter or digit.
_KEYS = {
    "width": "width|breite|largeur|anchura|larghezza|x length|x size|size x|x range|range x|scan size x|"
    "physical size x|x scan size|field width|length x|lx|image width|scan width",
    "height": "height|h\u00f6he|hauteur|altura|altezza|y length|y size|size y|y range|range y|scan size y|"
    "physical size y|y scan size|field height|length y|ly|image height|scan height",
    "dx": "dx|pixel size|pixelsize|pixel width|pixel size x|x pixel size|x step|step x|step size x|x spacing|"
    "spacing x|delta x|x increment|increment x|sampling x|x sampling|pixel spacing|lateral sampling|"
    "pixel pitch|sampling distance|point spacing|x pitch|pixel distance|xy calibration",
    "dy": "dy|pixel height|pixel size y|y pixel size|y step|step y|step size y|y spacing|spacing y|delta y|"
    "y increment|increment y|sampling y|y sampling|y pitch",
    "unit": "value units|value unit|z unit|z units|unit z|units z|height unit|height units|data unit|"
    "data units|einheiten|unit\u00e9s|unidades de valor|unit\u00e0 valore|unit data|zunit|unit of height|"
    "unit of heights|heights in|heights",
    "lateral": "x unit|xy unit|xy units|lateral unit|lateral units|unit x|units x|y unit|unit y|unit xy|"
    "xunit|x units|horizontal unit",
    "both": "unit|units|length unit|unit of length|length units",
    "channel": "channel|kanal|canal|canale|kan\u00e1l",
}  # fmt: skip
_MEANING = {key: meaning for meaning, keys in _KEYS.items() for key in keys.split("|")}
_PIXELS = frozenset(("px", "pixel", "pixels", "points", "pts", "samples"))


@dataclass(frozen=True)
class Header:
    """Sizes as stated, of the whole map or of a pixel, with their unit; the unit of the heights."""

    whole: tuple[float, float] | None = None
    pixel: tuple[float, float] | None = None
    size_unit: str | None = None
    unit: str | None = None
    channel: str | None = None


def parse(heading: Iterable[str]) -> Header:
    """What the lines of a heading state."""
    sizes: dict[str, float] = {}
    words: dict[str, str] = {}
    units: dict[str, str] = {}
    for line in heading:
        meaning, unit, value = _statement(line.replace('"', ""))
        if meaning in ("width", "height", "dx", "dy"):
            _size(meaning, value, unit, sizes, units)
        elif meaning is not None:
            words.setdefault(meaning, value)
    stated = {unit_name(unit) for unit in units.values() if unit}
    lateral = words.get("lateral", words.get("both"))
    if lateral is not None and not stated:
        stated = {unit_name(lateral)}
    if len(stated) > 1:
        sizes = _in_metres(sizes, units)
        stated = {"m"}
    heights = words.get("unit", words.get("both"))
    return Header(
        _pair(sizes, "width", "height"),
        _pair(sizes, "dx", "dy"),
        next(iter(stated), None),
        None if heights is None else unit_name(heights),
        words.get("channel"),
    )


def _statement(line: str) -> tuple[str | None, str | None, str]:
    """What a line of a heading is about, the unit in its name, and what it states."""
    found = _LINE.match(line)
    if found is not None:
        name, unit = unit_in_brackets(found.group(1))
        meaning = _MEANING.get(_key(name))
        if meaning is not None:
            return meaning, unit, found.group(2).strip()
    prose = _PROSE.match(line)
    if prose is not None and (unit_name(prose.group(2)) in METRES_PER_UNIT or prose.group(2) in _NO_LENGTHS):
        return "both" if prose.group(1).casefold() in _ALL else "unit", None, prose.group(2)
    prose = _PROSE_SIZE.match(line)
    if prose is not None:
        return _MEANING.get(_key(prose.group(1))), None, prose.group(2)
    titled = _TITLE.match(line)
    if titled is not None and unit_name(titled.group(1)) in METRES_PER_UNIT:
        return "unit", None, titled.group(1)
    return None, None, ""


def _key(name: str) -> str:
    return " ".join(re.sub(r"[\W_]+", " ", name).casefold().split())


def starts_a_channel(line: str) -> bool:
    """Whether a line between numbers begins the heading of another map."""
    found = _LINE.match(line)
    return found is not None and _MEANING.get(found.group(1).strip().casefold()) == "channel"


def _size(meaning: str, value: str, unit: str | None, sizes: dict[str, float], units: dict[str, str]) -> None:
    """Take in a size such as ``1.25 um``, or two such as ``1 x 2 mm``; what is no size is left alone."""
    found = _VALUE.match(value)
    if found is None:
        return
    first, its_unit, second, last_unit = found.groups()
    if (its_unit or last_unit or "").strip(" .;,").casefold() in _PIXELS:
        return
    other = {"dx": "dy", "width": "height"}.get(meaning)
    pairs = [(meaning, first)] + ([(other, second)] if other and second else [])
    for name, text in pairs:
        text = text.rstrip(",;")
        try:
            size = number(text, decimal_comma="," in text)
        except ValueError:
            return
        sizes[name] = size
        units[name] = unit or its_unit.strip(" .;,") or (last_unit or "").strip(" .;,")


def _pair(sizes: dict[str, float], x: str, y: str) -> tuple[float, float] | None:
    """Both sizes; a pixel of one stated side is square, a map is not."""
    if x not in sizes or (y not in sizes and x == "width"):
        return None
    return sizes[x], sizes.get(y, sizes[x])


def _in_metres(sizes: dict[str, float], units: dict[str, str]) -> dict[str, float]:
    for unit in units.values():
        if unit_name(unit) not in METRES_PER_UNIT:
            raise SurfaceError(f"the heading states a size in {short(unit)}, which is not a known length")
    return {name: size * METRES_PER_UNIT[unit_name(units[name])] for name, size in sizes.items()}
