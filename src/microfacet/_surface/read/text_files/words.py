"""Grids whose numbers follow a header in any breaking of lines: read word by word, with bounded memory."""

from __future__ import annotations

from typing import IO

import numpy as np
from numpy.typing import NDArray

from microfacet._surface.checks import MAX_PIXELS, SurfaceError
from microfacet._surface.read.text_files.numbers import number

__all__ = ["check_size", "numbers", "whole"]

_MAX_WORD = 100
_BLOCK = 2**20


def whole(value: float | None, what: str) -> int:
    """A positive whole number of a header."""
    if value is None or not (1 <= value <= 1e12 and value == int(value)):
        raise SurfaceError(f"the header must state {what}, a positive whole number")
    return int(value)


def check_size(nx: int, ny: int, size: int, least: int = 2) -> None:
    """Refuse a map that is too large, or that a file of this size cannot hold, at `least` bytes a number."""
    if nx * ny > MAX_PIXELS:
        raise SurfaceError(f"a map of {nx} x {ny} pixels exceeds the limit of {MAX_PIXELS} pixels")
    if least * nx * ny - 1 > size:  # a digit and a space each
        raise SurfaceError(f"the header claims {nx} x {ny} numbers, {size} bytes cannot hold them")


def numbers(stream: IO[bytes], count: int) -> NDArray[np.float64]:
    """Exactly so many numbers, and nothing after them; words for a missing one are nan."""
    values = np.empty(count)
    done, rest = 0, b""
    while block := stream.read(_BLOCK):
        text = rest + block
        cut = max(text.rfind(mark) for mark in (b" ", b"\n", b"\t", b"\r"))
        text, rest = text[: cut + 1], text[cut + 1 :]
        if len(rest) > _MAX_WORD:
            raise SurfaceError(f"{rest[:20]!r} is not a number")
        done = _fill(values, done, text)
    done = _fill(values, done, rest)
    if done < count:
        raise SurfaceError(f"the file ends after {done} of {count} numbers")
    return values


def _fill(values: NDArray[np.float64], done: int, text: bytes) -> int:
    words = text.replace(b",", b".").replace(b"\x1a", b"").split()
    if done + len(words) > len(values):
        raise SurfaceError(f"the file holds more than the {len(values)} numbers that its header claims")
    if max(map(len, words), default=0) > _MAX_WORD:  # NumPy gives every word the room of the longest
        raise SurfaceError("the file holds what is not a number")
    try:
        values[done : done + len(words)] = np.array(words, dtype="S").astype(np.float64) if words else ()
    except ValueError:
        for index, word in enumerate(words):
            values[done + index] = _number(word)
    return done + len(words)


def _number(word: bytes) -> float:
    try:
        return number(word.decode("latin-1"))
    except ValueError:
        raise SurfaceError(f"the file holds {word[:30]!r}, which is not a number") from None
