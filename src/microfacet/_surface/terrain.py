"""The measured terrain that ships with matplotlib: a real surface for examples and reports, no download."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from microfacet._optional import needed
from microfacet._surface.read import numpy_files
from microfacet._surface.surface import Surface

__all__ = ["sample_terrain"]

# Mean radius of the Earth (IUGG 1980), metres; the ellipsoid would change the pixel size by less than 0.3 %.
_EARTH_RADIUS = 6_371_008.8


def sample_terrain() -> Surface:
    """Elevation around the Jacksboro fault, Tennessee, from matplotlib's sample data.

    344 x 403 pixels of 0.000833 degrees. The file states degrees; they become metres on a sphere at the
    middle latitude. Its heights are whole metres, so at lag 1 the slopes come in steps of about half a
    percent; the default lag of the surface is therefore 2. `steps` names both.

    Returns
    -------
    Surface
        Heights in metres, +x east, +y north, unlevelled, ``lag=2``.

    Raises
    ------
    ImportError
        If matplotlib is not installed.

    Examples
    --------
    >>> terrain = sample_terrain()
    >>> terrain.heights.shape, [round(size, 1) for size in terrain.pixel_size], terrain.lag
    ((344, 403), [74.4, 92.7], 2)
    """
    with needed("the sample terrain needs"):
        from matplotlib import cbook

    file = Path(str(cbook.get_sample_data("jacksboro_fault_dem.npz", asfileobj=False)))
    arrays = numpy_files.read_npz(file, ("elevation", "dx", "dy", "ymin", "ymax"))
    degree = math.radians(_EARTH_RADIUS)
    # The file calls the northern edge ymin; the mean does not mind.
    latitude = (arrays["ymin"].item() + arrays["ymax"].item()) / 2
    dx = arrays["dx"].item() * degree * math.cos(math.radians(latitude))
    dy = arrays["dy"].item() * degree
    return Surface(
        np.flipud(arrays["elevation"]),  # stored from north to south
        pixel_size=(dx, dy),
        source="matplotlib sample jacksboro_fault_dem.npz",
        steps=(
            f"pixel size converted from degrees to {dx:.1f} x {dy:.1f} m at latitude {latitude:.2f} degrees",
            "slopes over a lag of 2 pixels, because the heights are whole metres",
        ),
        lag=2,
    )
