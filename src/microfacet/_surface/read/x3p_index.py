"""The index of an x3p file, ``main.xml``: parsed as a stream, because it may hold the points themselves."""

from __future__ import annotations

import math
from typing import IO
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import MAX_PIXELS, SurfaceError
from microfacet._surface.read.text_files.numbers import number

__all__ = ["Index", "parse"]

_BLOCK = 2**16
# Characters of all elements but the points, of one of them, and bytes of one tag or comment.
_MOST_TEXT, _LONGEST_POINT, _LONGEST_TOKEN = 2**20, 200, 2**20
_MOST_DEPTH, _LONGEST_TAG = 40, 100
_POINT = "Record3/DataList/Datum"


class Index:
    """What ``main.xml`` says: texts by their path below the root, and points that it holds.

    `points` has three columns x, y, z; a point of one number is z alone, a point without any is missing.
    """

    def __init__(self, size: int) -> None:
        self.size = size
        self.texts: dict[str, str] = {}
        self.points: NDArray[np.float64] | None = None
        self.count = 0

    def text(self, path: str) -> str | None:
        return self.texts.get(path) or None

    def choice(self, path: str, choices: dict[str, str]) -> str:
        text = self.text(path)
        if text not in choices:
            raise SurfaceError(
                f"main.xml: {path} must be one of {', '.join(choices)}, got {str(text)[:20]!r}"
            )
        return text

    def number(self, path: str, default: float | None = None) -> float:
        text = self.text(path)
        if text is None and default is not None:
            return default
        try:
            return float(text or "")
        except ValueError:
            raise SurfaceError(f"main.xml: {path} must be a number, got {str(text)[:20]!r}") from None

    def whole(self, path: str) -> int:
        text = self.text(path)
        if text is None or not text.isdecimal() or len(text) > 12 or int(text) < 1:
            raise SurfaceError(f"main.xml: {path} must be a positive whole number, got {str(text)[:20]!r}")
        return int(text)

    def add(self, text: str) -> None:
        """Take in the next point."""
        if self.points is None:
            nx, ny, nz = (self.whole(f"Record3/MatrixDimension/Size{axis}") for axis in "XYZ")
            count = nx * ny * nz
            # The shortest point is <Datum/>: a header alone earns no memory.
            if count > MAX_PIXELS or 8 * count > self.size:
                raise SurfaceError(f"main.xml claims {count} points, which it cannot hold")
            self.points = np.full((count, 3), math.nan)
        if self.count >= len(self.points):
            raise SurfaceError(f"main.xml holds more than the {len(self.points)} points that it states")
        try:
            values = [number(cell) for cell in text.split(";")]
        except ValueError:
            raise SurfaceError(f"main.xml holds the point {text[:40]!r}, which is not x;y;z") from None
        if len(values) not in (1, 3):
            raise SurfaceError(f"main.xml holds the point {text[:40]!r}, which is not x;y;z")
        self.points[self.count, -len(values) :] = values
        self.count += 1


def parse(stream: IO[bytes], size: int) -> Index:
    """The index that the stream of so many bytes holds."""
    index = Index(size)
    path: list[str] = []
    texts: list[list[str]] = []
    spent = 0

    def begin(tag: str, _: dict[str, str]) -> None:
        path.append(tag.rpartition(":")[2])
        texts.append([])
        if len(path) > _MOST_DEPTH or len(tag) > _LONGEST_TAG:
            raise SurfaceError(
                f"main.xml is nested deeper than {_MOST_DEPTH}, or has tags of over {_LONGEST_TAG} letters"
            )

    def end(_: str) -> None:
        where, text = "/".join(path[1:]), "".join(texts.pop()).strip()
        path.pop()
        if where == _POINT:
            index.add(text)
        elif text:
            index.texts.setdefault(where, text)

    def characters(text: str) -> None:
        nonlocal spent
        texts[-1].append(text)
        if path[-1] == "Datum":
            if sum(map(len, texts[-1])) > _LONGEST_POINT:
                raise SurfaceError(f"main.xml holds a point of more than {_LONGEST_POINT} characters")
        elif path[-1] == "DataList":
            texts[-1].clear()  # white space between points
        else:
            spent += len(text)
            if spent > _MOST_TEXT:
                raise SurfaceError(f"main.xml holds more than {_MOST_TEXT} characters besides its points")

    def document_type(*_: object) -> None:
        raise SurfaceError("main.xml declares a document type, which no x3p file has")

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.CharacterDataHandler, parser.StartDoctypeDeclHandler = characters, document_type
    fed = 0
    while block := stream.read(_BLOCK):
        parser.Parse(block, False)
        fed += len(block)
        if fed - max(parser.CurrentByteIndex, 0) > _LONGEST_TOKEN:
            raise SurfaceError(f"main.xml holds a tag or a comment of more than {_LONGEST_TOKEN} bytes")
    parser.Parse(b"", True)
    return index
