"""Lines of text in the encodings that instruments write, with bounded memory."""

from __future__ import annotations

import codecs
import io
import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import IO

from microfacet._surface.checks import SurfaceError

__all__ = ["MAX_LINE", "encoding", "is_text", "lines"]

#: Longest line: 65536 numbers with every digit.
MAX_LINE = 2**21
_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),  # before UTF-16, whose mark it begins with
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_SAMPLE = 2**16
# Control characters that stand in no text; DOS ends a file with 0x1a.
_CONTROL = re.compile("[\0-\x08\x0e-\x19\x1b-\x1f\x7f]")


def encoding(start: bytes) -> str:
    """The encoding of a text that begins like this: by its mark, or by the zeros of UTF-16 without one."""
    for mark, name in _MARKS:
        if start.startswith(mark):
            return name
    pairs = start[: len(start) // 2 * 2]
    if len(pairs) >= 4:
        for name, zeros, others in (
            ("utf-16-le", pairs[1::2], pairs[::2]),
            ("utf-16-be", pairs[::2], pairs[1::2]),
        ):
            if zeros.count(0) > 0.9 * len(zeros) and 0 not in others:
                return name
    return "utf-8"


def lines(stream: IO[bytes]) -> Iterator[str]:
    """The lines of a text; one that is too long or no text is refused, before it fills the memory.

    UTF-8, UTF-16 and UTF-32; a byte that is none of them is taken for Latin-1, which shares the micro sign
    and the sign of the angstrom with the code pages of Windows. Lines end with LF, CR LF or CR.
    """
    place = stream.tell()
    name = encoding(stream.read(4096))
    stream.seek(place)
    errors = "surrogateescape" if name.startswith("utf-8") else "strict"
    text = io.TextIOWrapper(stream, encoding=name, errors=errors, newline=None)
    try:
        while line := text.readline(MAX_LINE + 1):
            if len(line) > MAX_LINE:
                raise SurfaceError(f"a line is longer than {MAX_LINE} characters")
            if errors == "surrogateescape" and not line.isascii():
                line = _latin(line)
            if _CONTROL.search(line):
                raise SurfaceError("this is not a text file")
            yield line.rstrip("\n\x1a")
    except UnicodeError:
        raise SurfaceError("this is not a text file") from None
    finally:
        with suppress(ValueError):  # the stream may be closed before the generator is
            text.detach()


def is_text(file: Path) -> bool:
    """Whether beginning, middle and end of the file look like text: instruments put data under a heading."""
    size = file.stat().st_size
    with file.open("rb") as stream:
        start = stream.read(_SAMPLE)
        name = encoding(start)
        if not name.startswith("utf-8"):
            return not _CONTROL.search(start[: len(start) // 4 * 4].decode(name, "replace"))
        parts = [start]
        for place in (size // 2, size - _SAMPLE):
            stream.seek(max(place, 0))
            parts.append(stream.read(_SAMPLE))
    return not any(_CONTROL.search(part.decode("latin-1")) for part in parts)


def _latin(line: str) -> str:
    try:
        line.encode("utf-8")
    except UnicodeEncodeError:  # it holds bytes that are no UTF-8
        return line.encode("utf-8", "surrogateescape").decode("latin-1")
    return line
