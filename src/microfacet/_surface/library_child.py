"""The child process of `library.py`: a request on stdin, a line of JSON and the heights on stdout.

It is run as a script and imports nothing of microfacet, so that it starts with its memory limit in place and
loads only what reading needs.
"""

from __future__ import annotations

import json
import logging
import os
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Unusable(Exception):
    """The file can be parsed but not used; the message is for the user."""


def main() -> None:
    request = json.load(sys.stdin)
    # Libraries may print; only this function writes to the real stdout.
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    logging.disable()
    limit_memory(request["max_bytes"])
    try:
        answer, heights = read(request["path"], request["channel"], request["max_pixels"])
    except Unusable as error:
        answer, heights = {"error": str(error)}, None
    except MemoryError:
        answer, heights = {"error": "reading it needs more memory than a file of its size should"}, None
    except Exception as error:
        reason = " ".join(str(error).split())[:200]
        answer, heights = {"error": f"cannot be read ({type(error).__name__}: {reason})"}, None
    output.write(json.dumps(answer).encode() + b"\n")
    if heights is not None:
        output.write(np.ascontiguousarray(heights, dtype=np.float64).data)
    output.flush()
    os._exit(0)  # no destructors of half-opened files


def limit_memory(bytes_: int) -> None:
    try:
        import resource
    except ImportError:  # Windows has no such limit; the checks of sizes remain
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit = bytes_ if hard == resource.RLIM_INFINITY else min(bytes_, hard)
    resource.setrlimit(resource.RLIMIT_AS, (limit, hard))


def read(path: str, wanted: int | str | None, max_pixels: int) -> tuple[dict[str, Any], NDArray[np.float64]]:
    """The answer without the heights, and the heights (ny, nx) with nan where undefined."""
    from SurfaceTopography import open_topography
    from SurfaceTopography.Exceptions import CannotDetectFileFormat

    try:
        reader = open_topography(path)
    except CannotDetectFileFormat:  # its message lists every attempt
        raise Unusable("this is not a height map in a format that SurfaceTopography reads") from None
    channel = select(reader, wanted)
    nx, ny = channel.nb_grid_pts
    if nx * ny > max_pixels:
        raise Unusable(f"a map of {nx} x {ny} pixels exceeds the limit of {max_pixels} pixels")
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
                raise Unusable(f"channel {wanted!r} is not a height map")
            return channel
    listed = ", ".join(f"{channel.index} ({channel.name})" for channel in channels[:20])
    raise Unusable(f"there is no channel {wanted!r}, the file has {listed}")


def is_height_map(channel: Any) -> bool:
    return channel.dim == 2 and (channel.unit is None or isinstance(channel.unit, str))


if __name__ == "__main__":
    main()
