"""A table as a file or as a Zarr store, put in place of an older one, and of nothing else."""

from __future__ import annotations

import os
import re
import shutil
import stat
from pathlib import Path

from microfacet._bake.recipe import names_of
from microfacet._files import read_json, replacing
from microfacet._text import printable

__all__ = ["SUFFIXES", "place", "put", "require_replaceable"]

SUFFIXES = (".nc", ".zarr")
_LONGEST_METADATA = 2**26  # grids are not part of it, but the command may be
_METADATA = (".zgroup", ".zattrs", ".zmetadata")
_IN_ARRAYS = re.compile(r"\.zarray|\.zattrs|\d+(\.\d+)*")


def place(output: str | Path) -> Path:
    """Where a table belongs: at the end of links, or at a link that leads to no file, but to a pipe, say."""
    given = Path(os.path.abspath(output))
    written_through = given.exists() and not given.is_file() and not given.is_dir()
    return given if written_through else Path(os.path.realpath(output))


def require_replaceable(target: Path) -> None:
    """ValueError, if a table in place of what stands there would remove what no bake has made."""
    if target.suffix not in SUFFIXES:
        raise ValueError(f"output must end in {' or '.join(SUFFIXES)}, got {str(target)!r}")
    if not target.parent.is_dir():
        raise ValueError(f"output must lie in a folder that exists, got {str(target)!r}")
    if not target.exists():
        return
    if target.is_dir() != (target.suffix == ".zarr"):
        kind = "folder" if target.is_dir() else "file"
        raise ValueError(f"{target} is a {kind}: move it away, or choose another output")
    if target.is_dir() and (stranger := _stranger(target)) is not None:
        raise ValueError(f"{target} {stranger}: move it away, or choose another output")


def _stranger(folder: Path) -> str | None:
    """What is in a folder that is no part of a table of ours."""
    nothing = "is a folder, and no table that a bake has made"
    try:
        with (folder / ".zmetadata").open("rb") as stream:
            metadata = read_json(stream, _LONGEST_METADATA)["metadata"]
        attributes = metadata[".zattrs"]
        kind, family, material = (attributes[name] for name in ("kind", "family", "material"))
        arrays, facts = names_of(kind, family, material, attributes.get("density", ""))
        if set(attributes) != facts:
            return nothing
        stated = {name.removesuffix("/.zarray") for name in metadata if name.endswith("/.zarray")}
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return nothing
    for inside, folders, files in os.walk(folder):
        name = Path(inside).relative_to(folder).as_posix()
        for entry in folders:
            if (
                name != "."
                or entry not in arrays
                or entry not in stated
                or (Path(inside) / entry).is_symlink()
            ):
                return f"holds {printable(entry)!r}, which no bake has made"
        for entry in files:
            known = entry in _METADATA if name == "." else _IN_ARRAYS.fullmatch(entry)
            if not known:
                return f"holds {printable(entry)!r}, which no bake has made"
    return None


def put(new: Path, target: Path, old: Path) -> None:
    """What is whole at `new` takes the place of an older table, which goes to `old` if it is a folder."""
    if target.suffix == ".nc":
        with new.open("rb") as whole, replacing(target) as stream:
            shutil.copyfileobj(whole, stream)
        return
    require_replaceable(target)  # hours may have passed
    if not target.exists():
        new.rename(target)
        return
    new.chmod(stat.S_IMODE(target.stat().st_mode))
    shutil.rmtree(old, ignore_errors=True)
    target.rename(old)
    try:
        new.rename(target)
    except BaseException:
        old.rename(target)
        raise
