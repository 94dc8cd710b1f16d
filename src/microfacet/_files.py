"""Files of ours: a reader never finds half of one, and what we read anybody may have written."""

from __future__ import annotations

import errno
import io
import json
import os
import secrets
import selectors
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any, BinaryIO

__all__ = ["WholeWrites", "ending", "is_stdout", "read_json", "replacing"]


class WholeWrites(io.RawIOBase):
    """An open file each write to which is whole or an error, also where the file does not wait.

    `write` of a raw stream may take a part, and a pipe whose other end has made it non-blocking takes what
    fits. After an error it takes everything and keeps nothing: the streams above it, which try again when
    Python ends, would fail there a second time.
    """

    def __init__(self, number: int, name: str, *, closes: bool) -> None:
        self.error: OSError | None = None
        self._number, self._name, self._closes = number, name, closes

    def write(self, data: Any) -> int:
        """All of it."""
        content = memoryview(data).cast("B")
        rest = content if self.error is None else content[:0]
        while rest:
            try:
                rest = rest[os.write(self._number, rest) :]
            except BlockingIOError:
                self._wait()
            except OSError as error:
                self.error = type(error)(error.errno, error.strerror, self._name)
                raise self.error from None
        return len(content)

    def _wait(self) -> None:
        with selectors.DefaultSelector() as selector:
            selector.register(self._number, selectors.EVENT_WRITE)
            selector.select()

    def writable(self) -> bool:
        """Always."""
        return True

    def fileno(self) -> int:
        """The number of the open file."""
        return self._number

    def isatty(self) -> bool:
        """Whether it is a terminal."""
        return os.isatty(self._number)

    def close(self) -> None:
        """Close the file, if it is ours."""
        if self._closes and not self.closed:
            os.close(self._number)
        super().close()


def read_json(stream: IO[Any], most: int) -> Any:
    """The JSON in a stream; ValueError where it is none, is longer than `most` or nested too deeply."""
    text = stream.read(most + 1)
    if len(text) > most:
        raise ValueError(f"more than {most} characters")
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None


@contextmanager
def replacing(path: str | Path, mode: int = 0o666) -> Iterator[BinaryIO]:
    """A binary stream whose content takes the place of `path` once the block ends without an error.

    A link keeps pointing to what it names, and a file keeps its mode and owner; `mode` is that of a new one,
    before the umask. What is no regular file (a pipe, a device, an open file such as /dev/stdout) cannot be
    replaced: it is written to at once.
    """
    number = _open_file(os.fspath(path))
    if number is not None:
        with _written_through(os.dup(number), path) as stream:
            yield stream
        return
    target = os.path.realpath(path)
    try:
        old = os.stat(target)
    except FileNotFoundError:
        old = None
    if old is None or stat.S_ISREG(old.st_mode):
        with _neighbour(target, old, mode) as stream:
            yield stream
        return
    if stat.S_ISDIR(old.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
    with _written_through(os.open(target, os.O_WRONLY), path) as stream:
        yield stream


def ending(path: str | Path, formats: Iterable[str], default: str) -> str:
    """Which of the endings a path has; the default for a pipe or a device, whose name says no format."""
    found = Path(path).suffix
    if found in formats:
        return found
    if _open_file(os.fspath(path)) is not None or (os.path.exists(path) and not _is_ordinary(path)):
        return default
    raise ValueError(f"output must end in {', '.join(formats)}, got {os.fspath(path)!r}")


def is_stdout(path: str | Path) -> bool:
    """Whether what is written to `path` goes to standard output."""
    if _open_file(os.fspath(path)) == 1:
        return True
    try:
        return not _is_ordinary(path) and os.path.samestat(os.stat(path), os.fstat(1))
    except OSError:
        return False


def _is_ordinary(path: str | Path) -> bool:
    return os.path.isfile(path) or os.path.isdir(path)


def _written_through(number: int, path: str | Path) -> BinaryIO:
    return io.BufferedWriter(WholeWrites(number, os.fspath(path), closes=True))


def _open_file(path: str) -> int | None:
    """The number of one of our open files where `path` names it: /dev/stdout, /dev/fd/3, links to them."""
    numbers = os.path.realpath("/dev/fd")
    for _ in range(40):  # as many links as Linux follows
        folder, name = os.path.split(os.path.abspath(path))
        if name.isdecimal() and os.path.realpath(folder) == numbers:
            return int(name)
        if not os.path.islink(path):
            break
        path = os.path.join(folder, os.readlink(path))
    return None


@contextmanager
def _neighbour(target: str, old: os.stat_result | None, mode: int) -> Iterator[BinaryIO]:
    """A new file beside `target` that takes its place once it is whole."""
    effective = os.access in os.supports_effective_ids
    if old is not None and not os.access(target, os.W_OK, effective_ids=effective):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), target)
    folder, name = os.path.split(target)
    new = os.path.join(folder, f".{name[:40]}.{secrets.token_hex(6)}.part")
    try:
        handle = os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), mode)
    except OSError as error:
        raise OSError(error.errno, error.strerror, target) from None
    try:
        with open(handle, "wb") as stream:
            yield stream
        if old is not None:
            _like(new, old)
        os.replace(new, target)
    except BaseException as error:
        if isinstance(error, OSError) and error.filename in (None, new):
            error.filename, error.filename2 = target, None
        with suppress(OSError):
            os.unlink(new)
        raise


def _like(new: str, old: os.stat_result) -> None:
    """Give a file the owner, as far as we may, and the mode of another."""
    mode = stat.S_IMODE(old.st_mode)
    made = os.stat(new)
    if hasattr(os, "chown") and (made.st_uid, made.st_gid) != (old.st_uid, old.st_gid):
        try:
            os.chown(new, -1, old.st_gid)
        except OSError:  # another group gets no more than everybody
            mode &= ~0o070 | (mode & 0o007) << 3
        with suppress(OSError):
            os.chown(new, old.st_uid, -1)
    os.chmod(new, mode)  # at last: chown takes bits away
