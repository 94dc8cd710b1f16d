"""Cells that are done, kept beside the table that is to come, so that a killed bake goes on where it was."""

from __future__ import annotations

import json
import shutil
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet._bake.recipe import Recipe
from microfacet._files import replacing

__all__ = ["Journal"]

Array = NDArray[np.float64]


class Journal:
    """A folder with the recipe and a file for each cell, each of which is whole or absent."""

    def __init__(self, output: Path, recipe: Recipe, provenance: dict[str, str]) -> None:
        self.folder = output.parent / f".{output.name}.bake"
        self.recipe = recipe
        described = {"recipe": recipe.as_dict(), "version": provenance["version"]}
        path = self.folder / "recipe.json"
        self.folder.mkdir(exist_ok=True)
        if path.exists():
            found = json.loads(path.read_text(encoding="utf-8"))
            if {key: found.get(key) for key in described} != described:
                raise ValueError(
                    f"{self.folder} holds a bake of something else that was interrupted: "
                    "remove it, or choose another output"
                )
            self.provenance = found["provenance"]
            return
        self.provenance = provenance
        with replacing(path) as stream:
            stream.write(json.dumps({**described, "provenance": provenance}).encode())

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
                    result[cell] = {name: kept[name] for name in self.recipe.variables}
            except (FileNotFoundError, KeyError, ValueError, EOFError, zipfile.BadZipFile):
                continue  # not there, or damaged since: computed again
        return result

    def remove(self) -> None:
        """The table has been written."""
        shutil.rmtree(self.folder)


def provenance(command: str, date: str, version: str) -> dict[str, Any]:
    """What is recorded besides the recipe."""
    return {"command": command, "date": date, "version": version, "numpy": np.__version__}
