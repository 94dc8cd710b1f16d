"""What a file holds, without asking for what it does not state: channels, sizes, units, valid pixels."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from microfacet._surface.areal import Roughness, roughness
from microfacet._surface.checks import SurfaceError, checked_file
from microfacet._surface.read import images, kinds, library, numpy_files, text_files
from microfacet._surface.read.complete import Options, complete, known_size
from microfacet._surface.read.raw import Channel, NoMap, RawMap
from microfacet._surface.read.surfaces import NPZ_KEYS, raw_map

__all__ = ["FileSummary", "MapSummary", "describe"]

_MOST_CHANNELS = 64


@dataclass(frozen=True)
class MapSummary:
    """One map of a file.

    Attributes
    ----------
    channel : Channel
        Its name, index, size in pixels, stated unit, and whether it holds heights.
    pixel_size : (float, float), optional
        In metres, where the file or the caller says it.
    valid : float, optional
        The fraction of its pixels that have a height.
    lowest, highest : float, optional
        Of the numbers in the file, in its own unit.
    roughness : Roughness, optional
        After levelling by a plane, where unit and pixel size are known.
    missing : str, optional
        The sentence that `read_surface` would say, for want of an option or for another reason.
    steps, warnings : tuple of str
        As of the surface.
    """

    channel: Channel
    pixel_size: tuple[float, float] | None = None
    valid: float | None = None
    lowest: float | None = None
    highest: float | None = None
    roughness: Roughness | None = None
    missing: str | None = None
    steps: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class FileSummary:
    """What a file is, and its maps; `sentence` says what else to read it with, where it holds none."""

    file: str
    kind: str
    maps: tuple[MapSummary, ...] = ()
    sentence: str | None = None


def describe(
    path: str | os.PathLike[str],
    channel: int | str | None = None,
    pixel_size: float | tuple[float, float] | None = None,
    unit: str | None = None,
    height_scale: float | None = None,
) -> FileSummary:
    """What the file holds; `SurfaceError` only where it cannot be read at all.

    The arguments are those of `read_surface`; with a channel that one alone is described.
    """
    file = Path(path)
    options = Options.checked(pixel_size, unit, height_scale)
    quiet = np.errstate(over="ignore", invalid="ignore")
    with checked_file(file), quiet, kinds.unpacked(file) as inner:
        try:
            found = _channels(inner, channel)
            maps = [_summary(file, inner, one, options, alone=len(found) == 1) for one in found]
        except NoMap as error:
            return FileSummary(str(file), error.kind, sentence=str(error))
    kind = next((what for what, _ in maps if what), "file without a map of heights")
    return FileSummary(str(file), kind, tuple(summary for _, summary in maps))


def _channels(file: Path, wanted: int | str | None) -> list[Channel]:
    """The channels of the file; of a file with one map, one without a name."""
    kind = kinds.kind_of(file)
    found: list[Channel] | None = None
    if kind == "npz":
        names = [name for name in numpy_files.npz_names(file) if name not in NPZ_KEYS]
        if len(names) > 1 and "heights" not in names and set(names) != {"p", "q"}:
            found = [Channel(name, index, ()) for index, name in enumerate(names)]
    elif kind == "image":
        found = images.channels(file) or library.channels(file)
    elif kind == "other":
        found = library.channels(file)
    elif kind == "text" and (form := kinds.text_format(file)):
        found = library.channels(file, (form,))
    elif kind == "text":
        found = text_files.channels(file)
    if found is None or (len(found) == 1 and wanted is None):
        return [Channel(str(wanted or ""), 0, ())] if found is None else found
    chosen = [one for one in found if wanted is None or wanted in (one.name, one.index)]
    if not chosen:
        raw_map(file, wanted)  # which says what there is
    return chosen[:_MOST_CHANNELS]


def _summary(
    file: Path, inner: Path, channel: Channel, options: Options, alone: bool
) -> tuple[str, MapSummary]:
    """What the map is, and its summary."""
    if not channel.is_height:
        return "", MapSummary(channel, missing="this channel holds no heights")
    # Arrays go by their names, names of other channels may repeat.
    by_name = kinds.kind_of(inner) == "npz"
    key = (channel.name or None) if by_name else None if alone else channel.index
    try:
        raw = raw_map(inner, key)
    except NoMap:
        raise
    except SurfaceError as error:
        if alone:
            raise
        return "", MapSummary(channel, missing=str(error))
    heights = np.asarray(raw.heights)
    if heights.ndim != 2 or heights.dtype.kind not in "iuf":
        return "", MapSummary(
            channel, missing=f"this is no map, but {heights.dtype} of shape {heights.shape}"
        )
    valid = np.isfinite(heights) if raw.mask is None else np.isfinite(heights) & raw.mask
    numbers = heights[valid]
    summary = MapSummary(
        replace(channel, pixels=heights.shape[::-1], unit=raw.unit or channel.unit),
        valid=float(np.mean(valid)),
        lowest=float(numbers.min()) if numbers.size else None,
        highest=float(numbers.max()) if numbers.size else None,
    )
    return raw.kind, _completed(file, raw, options, summary)


def _completed(file: Path, raw: RawMap, options: Options, summary: MapSummary) -> MapSummary:
    """The same with what follows where unit and pixel size are known."""
    try:
        surface = complete(file, raw, options)
    except SurfaceError as error:
        unit = raw.unit or options.unit or raw.usual
        try:
            size = options.size or known_size(raw, unit)
        except SurfaceError:
            size = None
        return replace(summary, missing=str(error), pixel_size=size, steps=raw.steps, warnings=raw.warnings)
    summary = replace(summary, pixel_size=surface.pixel_size, steps=surface.steps, warnings=surface.warnings)
    try:
        return replace(summary, roughness=roughness(surface.level()))
    except SurfaceError as error:
        return replace(summary, missing=str(error))
