"""Line scans by SurfaceTopography, in the child process of `process.py`. It imports nothing of microfacet."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


class Unusable(Exception):
    """The file can be parsed but not used; the message is for the user."""


def read(request: dict[str, Any]) -> tuple[dict[str, Any], NDArray[np.float64]]:
    """The answer without the numbers, and positions and heights, (2, n), in the unit that it names."""
    from SurfaceTopography import open_topography
    from SurfaceTopography.Exceptions import CannotDetectFileFormat

    try:
        reader = open_topography(request["path"])
    except CannotDetectFileFormat:  # its message lists every attempt
        raise Unusable("this is not a profile in a format that SurfaceTopography reads") from None
    channel = select(reader, request["channel"])
    points = int(np.prod(channel.nb_grid_pts)) if channel.nb_grid_pts is not None else 0
    if points > request["max_pixels"]:
        raise Unusable(f"a profile of {points} points exceeds the limit of {request['max_pixels']} points")
    stated = channel.physical_sizes
    # The library refuses to build a uniform scan without a length; ours comes from the caller, later.
    given = {} if stated is not None or not channel.is_uniform else {"physical_sizes": points}
    scan = reader.topography(channel_index=channel.index, **given)
    x, z = (
        np.ma.filled(np.ma.asarray(part, dtype=np.float64), np.nan) for part in scan.positions_and_heights()
    )
    answer = {
        "shape": (2, z.size),
        "sized": not given,
        "unit": scan.unit,
        "channel": channel.name,
        "format": reader.format(),
    }
    return answer, np.stack((x, z))


def select(reader: Any, wanted: int | str | None) -> Any:
    """The wanted channel, or the first one that is a line of lengths."""
    channels = list(reader.channels)
    if wanted is None:
        lines = [channel for channel in channels if is_profile(channel)]
        if not lines:
            raise Unusable("the file holds no profile")
        return reader.default_channel if reader.default_channel in lines else lines[0]
    for channel in channels:
        if wanted in (channel.index, channel.name):
            if not is_profile(channel):
                raise Unusable(f"channel {wanted!r:.60} is not a profile")
            return channel
    listed = ", ".join(f"{channel.index} ({channel.name[:24]})" for channel in channels[:8])
    raise Unusable(f"there is no channel {wanted!r:.60}, the file has {listed}")


def is_profile(channel: Any) -> bool:
    return channel.dim == 1 and (channel.unit is None or isinstance(channel.unit, str))
