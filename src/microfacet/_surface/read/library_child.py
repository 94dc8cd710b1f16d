"""SurfaceTopography, in the child process of `process.py`. It imports nothing of microfacet."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


class Unusable(Exception):
    """The file can be parsed but not used; the message is for the user."""


def read(request: dict[str, Any]) -> tuple[dict[str, Any], NDArray[np.float64]]:
    """The answer without the heights, and the heights (ny, nx) with nan where undefined."""
    from SurfaceTopography import open_topography
    from SurfaceTopography.Exceptions import CannotDetectFileFormat

    try:
        reader = open_topography(request["path"])
    except CannotDetectFileFormat:  # its message lists every attempt
        raise Unusable("this is not a height map in a format that SurfaceTopography reads") from None
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
    sizes = None if stated is None else [float(stated[0]) / nx, float(stated[1]) / ny]
    answer = {
        "shape": heights.shape,
        "pixel_size": sizes,
        "unit": topography.unit,
        "channel": channel.name,
    }
    return answer, heights


def select(reader: Any, wanted: int | str | None) -> Any:
    """The wanted channel, or the first one that maps lengths over two dimensions."""
    channels = list(reader.channels)
    if wanted is None:
        maps = [channel for channel in channels if is_height_map(channel)]
        if not maps:
            raise Unusable("the file holds no height map")
        return reader.default_channel if reader.default_channel in maps else maps[0]
    for channel in channels:
        if wanted in (channel.index, channel.name):
            if not is_height_map(channel):
                raise Unusable(f"channel {wanted!r:.60} is not a height map")
            return channel
    listed = ", ".join(f"{channel.index} ({channel.name[:24]})" for channel in channels[:8])
    raise Unusable(f"there is no channel {wanted!r:.60}, the file has {listed}")


def is_height_map(channel: Any) -> bool:
    return channel.dim == 2 and (channel.unit is None or isinstance(channel.unit, str))
