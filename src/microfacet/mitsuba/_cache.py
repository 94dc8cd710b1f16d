"""The folder that keeps compiled plugins, each beside a record of what its check found."""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import platformdirs

from microfacet._files import replacing

__all__ = ["directory", "library_in", "locked", "prune", "read_record", "scratch_prefix", "write_record"]

KEPT = 12  # libraries, of all variants and versions together
ABANDONED = 86400.0  # seconds after which what a killed process left is dropped
scratch_prefix = ".compiling-"


def directory() -> Path:
    """$MICROFACET_CACHE/mitsuba, or the same in the user's folder for caches."""
    chosen = os.environ.get("MICROFACET_CACHE") or platformdirs.user_cache_dir("microfacet", appauthor=False)
    return Path(chosen).expanduser().absolute() / "mitsuba"


def library_in(folder: Path, variant: str, key: str) -> Path:
    return folder / f"{variant}-{key}.so"


@contextmanager
def locked(name: str) -> Iterator[Path]:
    """The folder, made if need be, to one process at a time for each `name`."""
    folder = directory()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = open(folder / f"{name}.lock", "wb")  # noqa: SIM115  # closed below; it goes with the process too
    except OSError as error:
        raise ImportError(
            f"the folder {folder} cannot be written ({error.strerror}): choose another in MICROFACET_CACHE"
        ) from None
    with lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield folder


def _digest(path: Path) -> str:
    with open(path, "rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def read_record(path: Path) -> str | None:
    """What the check of the library at `path` found, "" for nothing; None where it has to be made (again).

    That is where it is missing, not the file that was checked, or its record not readable.
    """
    try:
        record = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
        if record["sha256"] != _digest(path):
            return None
        objection = str(record["objection"])
    except (OSError, ValueError, KeyError, TypeError):
        return None
    with suppress(OSError):  # a folder that others fill may not be ours to write
        os.utime(path)  # the least recently used are dropped first
    return objection


def write_record(path: Path, objection: str) -> None:
    """Remember what the check of the library at `path` found."""
    record = {"sha256": _digest(path), "objection": objection}
    with replacing(path.with_suffix(".json")) as stream:
        stream.write(json.dumps(record).encode())


def prune(folder: Path) -> None:
    """Drop all but the most recently used libraries, and what killed processes left."""
    libraries = sorted(folder.glob("*.so"), key=lambda path: path.stat().st_mtime, reverse=True)
    for path in libraries[KEPT:]:
        path.unlink(missing_ok=True)
        path.with_suffix(".json").unlink(missing_ok=True)
    for left in folder.glob(f"{scratch_prefix}*"):
        if time.time() - left.stat().st_mtime > ABANDONED:
            shutil.rmtree(left, ignore_errors=True)
