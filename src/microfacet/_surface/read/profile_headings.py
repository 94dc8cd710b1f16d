"""What the words above a table of numbers say of its columns: which holds what, in which unit."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from microfacet._surface.checks import METRES_PER_UNIT, SurfaceError
from microfacet._surface.read.units import unit_name
from microfacet._text import printable

__all__ = ["Heading", "heading_of", "unit_named"]

_POINTS = frozenset(("px", "pixel", "pixels", "pt", "pts", "point", "points", "index", "sample", "samples"))
_POSITION = re.compile(
    r"(x|pos|position|lateral|distance|dist|length|abscissa|weg|strecke|scan ?length)(?![a-z])", re.I
)
_COUNTED = re.compile(r"(index|point|points|no|nr|n|i|sample|#)(?![a-z])\.?", re.I)
_HEIGHT = re.compile(r"(z|height|h|profile|trace|raw|amplitude|elevation|data|höhe|total|y\d)", re.I)
_ACROSS = re.compile(r"y(?![a-z0-9])", re.I)
_GROUP = re.compile(r"(trace|profile|scan|line|track|id|nr|no)(?![a-z])", re.I)
_VALID = re.compile(r"(valid|mask|quality)(?![a-z])|\[1/0\]", re.I)
_BRACKETS = re.compile(r"[\[(<]\s*([^\])>]*?)\s*[\])>]")
_NUMBER = r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?"
_SPACING = re.compile(
    r"(?:spacing|step(?:[ _-]?(?:size|width))?|sampling(?:[ _-]?(?:distance|interval|step|length))?|"
    r"pixel[ _-]?(?:size|width)|increment|point[ _-]?distance|d[ _-]?x|delta[ _-]?x)"
    rf"\s*(?:[\[(]([^\])]*)[\])])?\s*[:=,;\t ]\s*({_NUMBER})\s*[,;\t ]?\s*[\[(]?([^\s\])]*)",
    re.I,
)
_BOTH_UNITS = re.compile(r"^units?\s*[:=,;\t]\s*(\S+)", re.I)
_POSITION_UNIT = re.compile(r"(?:lateral|x)[ _-]?units?\s*[:=,;\t]\s*(\S+)", re.I)
_HEIGHT_UNIT = re.compile(r"(?:value|z|height|vertical)[ _-]?units?\s*[:=,;\t]\s*(\S+)", re.I)
_SPLITTERS = (";", "\t", ",", r"\s{2,}", r"\s+")
_LABEL = re.compile(r"[^\s\[(]+\s*[\[(][^\])]*[\])]|\S+")


@dataclass(frozen=True)
class Heading:
    """Columns by number; units are names of `METRES_PER_UNIT`, or "px" of positions that count points."""

    position: int = 0
    group: int | None = None  # the column that numbers the traces
    valid: int | None = None  # the column that is 0 where the height is missing
    position_unit: str | None = None
    height_unit: str | None = None
    spacing: float | None = None  # metres
    pairs: bool = False  # x, z, x, z, ...
    heights_alone: bool = False  # all columns are heights
    of_profiles: bool = False  # says that more than two columns are profiles
    remarks: tuple[str, ...] = ()


def heading_of(lines: list[str], width: int) -> Heading:
    """What the lines above `width` columns of numbers say; the lowest lines have the names and units."""
    result = _stated(lines)
    labels = [found for line in reversed(lines[-4:]) if (found := _labels(line, width))]
    labels = labels[: 2 if labels and all(map(_is_unit, labels[0])) else 1]
    if not labels:
        return result
    names = labels[-1]
    group = valid = None
    roles = []
    for k, name in enumerate(names):
        if k and width > 2 and any(_VALID.match(row[k]) for row in labels):
            valid = k
        elif not k and width > 2 and _GROUP.match(name) and _POSITION.match(names[1]):
            group = k
        else:
            roles.append(k)
    position = next((k for k in roles if _POSITION.match(names[k])), None)
    counted = position is None and len(roles) > 1 and bool(_COUNTED.fullmatch(names[roles[0]]))
    alone = position is None and not counted and all(_HEIGHT.match(names[k]) for k in roles)
    place = roles[0] if position is None else position
    heights = roles if alone else [k for k in roles if k != place]
    pairs = len(roles) > 2 and len(roles) % 2 == 0 and all(_POSITION.match(names[k]) for k in roles[::2])
    if pairs:
        heights = roles[1::2]
    across = len(roles) > 2 and any(_ACROSS.match(names[k]) for k in roles)
    named = position is not None and all(_HEIGHT.match(names[k]) for k in heights)
    return replace(
        result,
        position=place,
        group=group,
        valid=valid,
        position_unit=(None if alone else "px" if counted else _unit(labels, [place]))
        or result.position_unit,
        height_unit=_unit(labels, heights) or result.height_unit,
        pairs=pairs,
        heights_alone=alone and len(roles) > 1,
        of_profiles=not across and (len(roles) == 2 or pairs or named or (alone and len(roles) > 1)),
    )


def unit_named(text: str) -> str | None:
    """The unit of length of this name, whatever the word for it; None for what is none."""
    name = unit_name(text.strip().strip("."))
    if name in METRES_PER_UNIT:
        return name
    return "px" if name.lower() in _POINTS else None


def _stated(lines: list[str]) -> Heading:
    """Units and the spacing that single lines state, such as ``# Value units: nm``."""
    result = Heading()
    for line in lines:
        if both := _BOTH_UNITS.match(line):
            unit = unit_named(both[1])
            result = replace(result, position_unit=unit, height_unit=unit)
        if along := _POSITION_UNIT.search(line):
            result = replace(result, position_unit=unit_named(along[1]))
        if up := _HEIGHT_UNIT.search(line):
            result = replace(result, height_unit=unit_named(up[1]))
        if step := _SPACING.search(line):
            unit = unit_named(step[3]) or unit_named(step[1] or "")
            if unit in METRES_PER_UNIT:
                number = float(step[2].replace(",", "."))
                result = replace(result, spacing=number * METRES_PER_UNIT[unit])
    return result


def _labels(line: str, width: int) -> list[str] | None:
    """The words above the columns, where the line has as many as there are columns and states no value."""
    if "=" in line or ":" in line:
        return None
    if width == 1:
        return [line] if len(line) <= 80 else None
    for splitter in _SPLITTERS:
        cells = [cell.strip().strip("\"'") for cell in re.split(splitter, line.strip())]
        if len(cells) == width + 1 and not cells[-1]:
            cells.pop()
        if len(cells) == width:
            return cells
    cells = _LABEL.findall(line)
    return cells if len(cells) == width else None


def _is_unit(label: str) -> bool:
    """Whether a cell is nothing but a unit, in brackets or not."""
    return bool(_BRACKETS.fullmatch(label)) or unit_named(label) is not None


def _unit(labels: list[list[str]], columns: list[int]) -> str | None:
    """The unit of these columns, which have to agree; the lowest line that states one counts."""
    for row in labels:
        found = {unit for k in columns if (unit := _unit_in(row[k])) is not None}
        if len(found) > 1:
            raise SurfaceError(f"the columns of heights have several units, {' and '.join(sorted(found))}")
        if found:
            return found.pop()
    return None


def _unit_in(label: str) -> str | None:
    """The unit that a label states: in brackets, after a slash, as its last word, or as all of it."""
    brackets = _BRACKETS.findall(label)
    stated = brackets[-1] if brackets else label.rpartition("/")[2] if "/" in label else ""
    if stated:
        unit = unit_named(stated)
        if unit is None and len(stated) <= 12 and not re.search(r"\d", stated):
            raise SurfaceError(
                f"the column {printable(label, 30)!r} has the unit {printable(stated, 20)!r}, which is not a "
                "known length"
            )
        return unit
    if unit := unit_named(label):
        return unit if label.strip() not in ("A", "n") else None
    last = re.split(r"[\s,_]+", label.strip())[-1]
    return unit_named(last) if last not in ("A",) and (last != "m" or "_" in label) else None
