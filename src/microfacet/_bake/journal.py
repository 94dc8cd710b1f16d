"""Cells that are done, kept beside the table that is to come, so that a killed bake goes on where it was."""

from __future__ import annotations

import json
import os
import re
import shutil
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from microfacet._bake.recipe import PROVENANCE, Recipe
from microfacet._files import read_json, replacing
from microfacet._text import printable

try:
    import fcntl
except ImportError:  # Windows has no such locks
    fcntl = None  # type: ignore[assignment]

__all__ = ["Journal"]

Array = NDArray[np.float64]

_LOCK = "lock"
_RECIPE = "recipe.json"
#: All that a bake puts into its folder.
_OURS = re.compile(rf"{_LOCK}|{_RECIPE}|old|new\.(nc|zarr)|\d{{6,}}\.npz|\..*\.part")


class Journal:
    """A folder with the recipe and a file for each cell, each of which is whole or absent.

    Nothing else is in it: a folder that holds more is none of a bake, and is left alone.
    """

    def __init__(self, output: Path, recipe: Recipe, provenance: dict[str, str]) -> None:
        self.folder = output.parent / f".{output.name}.bake"
        self.recipe = recipe
        self.provenance = provenance

    @contextmanager
    def opened(self) -> Iterator[Journal]:
        """The folder, made if need be, to one bake at a time."""
        with self._locked():
            self._begin()
            yield self

    def _locked(self) -> IO[bytes]:
        """The lock, held by us until it is closed, in the folder."""
        path = self.folder / _LOCK
        while True:
            self._require_ours()
            self.folder.mkdir(exist_ok=True)
            with suppress(FileNotFoundError):  # another bake has just ended and removed the folder
                number = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o666)
                lock = os.fdopen(number, "wb")
                try:
                    if fcntl is not None:
                        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    if os.path.samestat(os.fstat(number), os.stat(path)):
                        return lock
                except BlockingIOError:
                    raise ValueError(
                        f"another bake is at work in {self.folder}: wait, or choose another output"
                    ) from None
                lock.close()

    def _require_ours(self) -> None:
        """ValueError where the folder holds what no bake has put there."""
        move = "move it away, or choose another output"
        if self.folder.is_symlink() or (self.folder.exists() and not self.folder.is_dir()):
            raise ValueError(f"a bake keeps its cells in {self.folder}, which is no folder: {move}")
        with suppress(FileNotFoundError), os.scandir(self.folder) as entries:
            for entry in entries:
                plain = entry.is_file(follow_symlinks=False) or entry.is_dir(follow_symlinks=False)
                if not (plain and _OURS.fullmatch(entry.name)):
                    raise ValueError(
                        f"a bake keeps its cells in {self.folder}, which holds {printable(entry.name)!r}: "
                        f"{move}"
                    )

    def _begin(self) -> None:
        """Compare the recipe with that of an earlier run, or write it down."""
        described = {"recipe": self.recipe.as_dict(), "version": self.provenance["version"]}
        ours = json.dumps({**described, "provenance": self.provenance})
        path = self.folder / _RECIPE
        if path.exists():
            try:
                with path.open("rb") as stream:
                    found = read_json(stream, 2 * len(ours) + 2**22)  # a command may be long
                same = {key: found.get(key) for key in described} == described
                kept = {key: str(found["provenance"][key]) for key in self.provenance} if same else {}
            except (ValueError, LookupError, TypeError, AttributeError):
                same, kept = False, {}
            if not same:
                raise ValueError(
                    f"{self.folder} holds a bake of something else that was interrupted: "
                    "remove it, or choose another output"
                )
            self.provenance = kept
            return
        with replacing(path) as stream:
            stream.write(ours.encode())

    def _path(self, cell: int) -> Path:
        return self.folder / f"{cell:06d}.npz"

    def keep(self, cell: int, values: dict[str, Array]) -> None:
        """Write a cell."""
        with replacing(self._path(cell)) as stream:
            np.savez(stream, **values)  # type: ignore[arg-type]

    def done(self) -> dict[int, dict[str, Array]]:
        """The cells of an earlier run."""
        result = {}
        for cell in range(self.recipe.cells):
            try:
                with np.load(self._path(cell)) as kept:
                    values = {name: kept[name] for name in self.recipe.variables}
            except (FileNotFoundError, LookupError, ValueError, EOFError, zipfile.BadZipFile):
                continue  # not there, or damaged since: computed again
            if all(values[name].shape == shape for name, shape in self.recipe.shapes.items()):
                result[cell] = values
        return result

    def place(self, name: str) -> Path:
        """The path of that name in the folder, where nothing is left of what a killed bake had there."""
        path = self.folder / name
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)
        else:
            with suppress(OSError):
                path.unlink()
        return path

    def remove(self) -> None:
        """The table has been written: remove what is ours, the lock last."""
        for entry in sorted(os.listdir(self.folder), key=lambda name: name == _LOCK):
            if _OURS.fullmatch(entry):
                self.place(entry)
        with suppress(OSError):
            self.folder.rmdir()


def provenance(command: str, date: str, version: str) -> dict[str, str]:
    """What is recorded besides the recipe."""
    return dict(zip(PROVENANCE, (command, date, version, np.__version__), strict=True))
