"""Every format that is not ours, through SurfaceTopography in a process of its own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from microfacet import _optional
from microfacet._surface.checks import SurfaceError
from microfacet._surface.read import process

__all__ = ["LibraryMap", "read"]


@dataclass(frozen=True)
class LibraryMap:
    """What the library found: heights in `unit` with nan where invalid, and the pixel size in `unit` if
    stated."""

    heights: NDArray[np.float64]
    pixel_size: tuple[float, float] | None
    unit: str | None
    channel: str


def read(file: Path, channel: int | str | None, bytes_to_read: int) -> LibraryMap:
    """Read `file` with SurfaceTopography; `SurfaceError` when it cannot, for whatever reason."""
    if not _optional.installed("SurfaceTopography"):
        what = "any format but .npy, .npz, .x3p and text grids needs"
        raise SurfaceError(_optional.sentence(what, "SurfaceTopography"))
    answer, heights = process.run("library_child", file, bytes_to_read, channel=channel)
    size = answer["pixel_size"]
    return LibraryMap(
        heights, None if size is None else (size[0], size[1]), answer["unit"], answer["channel"]
    )
