"""Standard output and standard error of the program: what is written to them is whole, or it failed."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from microfacet._files import WholeWrites

__all__ = ["READER_LEFT", "standard"]

READER_LEFT = 141  # the status then: 128 + SIGPIPE, what a shell reports


@contextmanager
def standard() -> Iterator[None]:
    """While the program runs, its streams take all that is written to them, or raise.

    Python's own take a part where they are unbuffered (PYTHONUNBUFFERED) and the disk is full or the reader
    of the pipe slow, and say how much to nobody. Whatever stands in for Python's own streams is left alone.
    """
    with _whole("stdout", "standard output") as output, _whole("stderr", "standard error"):
        try:
            yield
        finally:
            if output is not None and isinstance(output.error, BrokenPipeError):
                sys.exit(READER_LEFT)  # libraries choose other statuses


@contextmanager
def _whole(name: str, title: str) -> Iterator[WholeWrites | None]:
    own = getattr(sys, name)
    if own is not getattr(sys, f"__{name}__") or not isinstance(own, io.TextIOWrapper):
        yield None
        return
    own.flush()
    raw = WholeWrites(own.fileno(), title, closes=False)
    text = _text(raw, own)
    setattr(sys, name, text)
    try:
        yield raw
    finally:
        setattr(sys, name, own)
        with suppress(OSError):  # whoever needs to know has flushed it
            text.flush()
        text.detach()


def _text(raw: WholeWrites, like: io.TextIOWrapper) -> io.TextIOWrapper:
    """A text stream over `raw` in the encoding of another, buffered as much as that."""
    unbuffered = like.write_through
    return io.TextIOWrapper(
        raw if unbuffered else io.BufferedWriter(raw),  # type: ignore[arg-type]
        encoding=like.encoding,
        errors=like.errors,
        line_buffering=like.line_buffering,
        write_through=unbuffered,
    )
