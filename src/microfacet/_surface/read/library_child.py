"""SurfaceTopography, in the child process of `process.py`. It imports nothing of microfacet."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Answer = tuple[dict[str, Any], NDArray[np.float64]]

# Words in the name of a channel that holds no heights, whatever its unit.
_NO_HEIGHTS = (
    "phase",
    "amplitude",
    "deflection",
    "friction",
    "lateral",
    "current",
    "error",
    "intensity",
    "bright",
)


class Unusable(Exception):
    """The file can be parsed but not used; the message is for the user."""


def read(request: dict[str, Any]) -> Answer:
    """The answer without the heights, and the heights (ny, nx) with nan where undefined."""
    reader = opened(request)
    channels = [describe(channel) for channel in reader.channels]
    nothing: Answer = ({"shape": [0, 0], "channels": channels, "format": reader.format()}, np.empty((0, 0)))
    if request.get("list"):
        return nothing
    if request["channel"] is None and channels and all(len(channel["pixels"]) == 1 for channel in channels):
        return nothing[0] | {"profile": True}, nothing[1]
    channel = select(reader, request["channel"])
    nx, ny = channel.nb_grid_pts
    if nx * ny > request["max_pixels"]:
        raise Unusable(f"a map of {nx} x {ny} pixels exceeds the limit of {request['max_pixels']} pixels")
    stated = channel.physical_sizes
    # The library refuses to build a map without a size; ours come from the caller, later.
    topography = reader.topography(
        channel_index=channel.index, **({} if stated is not None else {"physical_sizes": (nx, ny)})
    )
    heights = np.ma.filled(np.ma.asarray(topography.heights(), dtype=np.float64), np.nan).T
    answer = {
        "shape": heights.shape,
        "pixel_size": None if stated is None else [float(stated[0]) / nx, float(stated[1]) / ny],
        "unit": topography.unit,
        "channel": channel.name,
        "channels": channels,
        "format": reader.format(),
        "doubtful": not is_height_map(channel),
    }
    return answer, heights


def opened(request: dict[str, Any]) -> Any:
    """The reader of the library that takes the file.

    Plain text, NumPy and x3p have readers of ours, which ask where the library's guess; some formats have no
    mark, so that the library takes any file of a fitting size for them.
    """
    from SurfaceTopography import IO
    from SurfaceTopography.Exceptions import CannotDetectFileFormat

    wanted = request.get("formats")
    without = {
        "asc",
        "xyz",
        "npy",
        "npz",
        "x3p",
        *(() if request["path"].lower().endswith(".hgt") else ("hgt",)),
    }
    IO.readers[:] = [
        reader
        for reader in IO.readers
        if (reader.format() in wanted if wanted else reader.format() not in without)
    ]
    try:
        return IO.open_topography(request["path"])
    except CannotDetectFileFormat:  # its message lists every attempt
        raise Unusable("this is not a height map in a format that SurfaceTopography reads") from None


def describe(channel: Any) -> dict[str, Any]:
    return {
        "name": channel.name,
        "index": channel.index,
        "pixels": list(channel.nb_grid_pts or ()),
        "unit": unit(channel),
        "is_height": is_height_map(channel),
    }


def select(reader: Any, wanted: int | str | None) -> Any:
    """The wanted channel, or the first one that maps lengths over two dimensions."""
    channels = list(reader.channels)
    if wanted is None:
        maps = [channel for channel in channels if is_height_map(channel)]
        if not maps:
            listed = ", ".join(f"{channel.name[:24]} in {unit(channel)}" for channel in channels[:8])
            raise Unusable(f"the file holds no height map (it has {listed or 'nothing'})")
        return reader.default_channel if reader.default_channel in maps else maps[0]
    for channel in channels:
        if wanted in (channel.index, channel.name):
            if not is_map_of_lengths(channel):
                raise Unusable(f"channel {wanted!r:.60} is not a height map: it holds {unit(channel)}")
            return channel
    listed = ", ".join(f"{channel.index} ({channel.name[:24]})" for channel in channels[:8])
    raise Unusable(f"there is no channel {wanted!r:.60}, the file has {listed}")


def unit(channel: Any) -> str | None:
    """The unit of the values of a channel, where one is stated."""
    stated = getattr(channel, "data_unit", None) or channel.unit
    if isinstance(stated, tuple):  # of positions and of values
        stated = stated[-1]
    return None if stated is None else str(stated)


def is_map_of_lengths(channel: Any) -> bool:
    """Whether a channel maps lengths, or what states no unit."""
    kind = getattr(channel, "data_kind", None)  # which older versions of the library do not tell
    has_unit = channel.unit is None or isinstance(channel.unit, str)
    return bool(channel.dim == 2 and has_unit and (kind is None or kind.value == "height"))


def is_height_map(channel: Any) -> bool:
    """Whether it is of heights: the error signal of a microscope, say, may be a length and is none."""
    return is_map_of_lengths(channel) and not any(word in channel.name.lower() for word in _NO_HEIGHTS)
