"""The folder that keeps compiled plugins, each beside a record of what its check found."""

from __future__ import annotations

import errno
import fcntl
import hashlib
import json
import os
import re
import shutil
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import BufferedReader
from pathlib import Path
from typing import Any

import platformdirs

from microfacet._files import read_json, replacing

__all__ = [
    "directory",
    "library_in",
    "locked",
    "prune",
    "read_private",
    "read_record",
    "scratch_prefix",
    "write_private",
    "write_record",
]

KEPT = 12  # libraries, of all variants and versions together
LONGEST_RECORD = 2**20
LIBRARY = re.compile(r"(scalar|llvm|cuda|metal)_\w+-[0-9a-f]+\.so")
ABANDONED = 86400.0  # seconds after which what a killed process left is dropped
scratch_prefix = ".compiling-"


def directory() -> Path:
    """$MICROFACET_CACHE/mitsuba, or the same in the user's folder for caches."""
    chosen = os.environ.get("MICROFACET_CACHE") or platformdirs.user_cache_dir("microfacet", appauthor=False)
    return Path(chosen).expanduser().absolute() / "mitsuba"


def library_in(folder: Path, variant: str, key: str) -> Path:
    return folder / f"{variant}-{key}.so"


def _objection(status: os.stat_result) -> str:
    """Why a file or folder of this status is not loaded from, "" where none but us and root can change it."""
    if status.st_uid not in (0, os.geteuid()):
        return f"belongs to user {status.st_uid}"
    return "can be written by others" if status.st_mode & 0o022 and not stat.S_ISLNK(status.st_mode) else ""


def _objection_to(folder: Path) -> str:
    """The same of the folder, and of a link to it: who can change these can put any library there."""
    return _objection(os.lstat(folder)) or _objection(os.stat(folder))


@contextmanager
def locked(name: str) -> Iterator[Path]:
    """The folder, made if need be, to one process at a time for each `name`."""
    folder = directory()
    try:
        _make(folder)
        flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
        lock = os.open(folder / f"{name}.lock", flags, 0o600)
    except OSError as error:
        raise ImportError(
            f"the folder {folder} cannot be written ({error.strerror}): choose another in MICROFACET_CACHE"
        ) from None
    try:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield folder
    finally:
        os.close(lock)


def _make(folder: Path) -> None:
    """The folder, closed to others; ImportError where others can change it all the same."""
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    status = os.stat(folder)
    if status.st_uid == os.geteuid() and status.st_mode & 0o022:
        os.chmod(folder, stat.S_IMODE(status.st_mode) & ~0o022)
    if objection := _objection_to(folder):
        raise ImportError(
            f"the folder {folder} {objection}, who could put other libraries there: "
            "choose another in MICROFACET_CACHE"
        )


@contextmanager
def _opened(path: Path) -> Iterator[BufferedReader]:
    """A file of the folder to read; OSError where it is a link, or others could have written it."""
    with open(os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC), "rb") as stream:
        status = os.fstat(stream.fileno())
        if not stat.S_ISREG(status.st_mode) or _objection(status) or _objection_to(path.parent):
            raise PermissionError(errno.EPERM, "others could have written it", str(path))
        yield stream


def read_private(path: Path) -> Any:
    """The JSON in a file of the folder; OSError or ValueError where there is none that is ours."""
    with _opened(path) as stream:
        return read_json(stream, LONGEST_RECORD)


def write_private(path: Path, content: Any) -> None:
    """Write it, whatever was there."""
    _make(path.parent)
    path.unlink(missing_ok=True)  # its owner, its mode, and where it pointed if it was a link
    with replacing(path, 0o644) as stream:
        stream.write(json.dumps(content).encode() + b"\n")


def _digest(path: Path) -> str:
    with _opened(path) as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def read_record(path: Path) -> str | None:
    """What the check of the library at `path` found, "" for nothing; None where it has to be made (again).

    That is where it is missing, not the file that was checked, or its record not readable, or where somebody
    else could have written one of them.
    """
    try:
        record = read_private(path.with_suffix(".json"))
        if record["sha256"] != _digest(path):
            return None
        objection = str(record["objection"])
    except (OSError, ValueError, LookupError, TypeError):
        return None
    with suppress(OSError):  # a folder that others fill may not be ours to write
        os.utime(path)  # the least recently used are dropped first
    return objection


def write_record(path: Path, objection: str) -> None:
    """Remember what the check of the library at `path` found."""
    write_private(path.with_suffix(".json"), {"sha256": _digest(path), "objection": objection})


def prune(folder: Path) -> None:
    """Drop all but the most recently used libraries, and what killed processes left: nothing but ours."""
    libraries = [path for path in folder.glob("*.so") if LIBRARY.fullmatch(path.name)]
    libraries.sort(key=lambda path: path.lstat().st_mtime, reverse=True)
    for path in libraries[KEPT:]:
        path.unlink(missing_ok=True)
        path.with_suffix(".json").unlink(missing_ok=True)
    for left in folder.glob(f"{scratch_prefix}*"):
        if time.time() - left.lstat().st_mtime > ABANDONED:
            shutil.rmtree(left, ignore_errors=True)
