"""OpenImageIO (pixels) and tifffile (what GeoTIFF adds), in the child process of `process.py`.

It imports nothing of microfacet. Sizes are checked before anything is decoded.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.float64]

FORMATS = ("png", "tiff", "openexr")
_MODEL_GEOGRAPHIC = 2  # GeoTIFF key GTModelTypeGeoKey
_METRE = 9001  # EPSG code of ProjLinearUnitsGeoKey
# Private tags of microscopes whose TIFF files hold a picture for looks and the heights elsewhere: Park, JPK.
_MICROSCOPE_TAGS = (50434, 0x8000)


class Unusable(Exception):
    """The file can be parsed but not used; the message is for the user."""


def read(request: dict[str, Any]) -> tuple[dict[str, Any], Image]:
    """The answer without the pixels, and the pixels: (ny, nx), or (ny, nx, 3) where `normals` are asked for.

    The first row is the top of the image, as stored. Integers stay whole numbers; `bits` says which range
    they have (0 for floating point).
    """
    import OpenImageIO

    source = OpenImageIO.ImageInput.open(request["path"])
    if source is None:
        raise Unusable(
            f"this is no image that can be read ({' '.join(OpenImageIO.geterror().split())[:150]})"
        )
    spec = source.spec()
    if source.format_name() not in FORMATS:
        raise Unusable(f"this is a {source.format_name()} image, and heights come in PNG, TIFF or EXR")
    if spec.width * spec.height > request["max_pixels"] or spec.nchannels > 16 or spec.depth > 1 or spec.deep:
        raise Unusable(
            f"an image of {spec.width} x {spec.height} pixels with {spec.nchannels} channels exceeds the "
            f"limit of {request['max_pixels']} pixels, 16 channels and one layer"
        )
    answer: dict[str, Any] = {"bits": bits(spec), "signed": str(spec.format).startswith("int")}
    names = list(spec.channelnames)
    if request["normals"]:
        wanted = triple(names)
    else:
        if source.format_name() == "tiff":
            answer |= geography(request["path"])
            if answer["microscope"]:
                return answer | {"shape": [0, 0]}, np.empty((0, 0))
        wanted = [one(names, request["channel"])]
    pixels = source.read_image(0, 0, 0, spec.nchannels, OpenImageIO.UNKNOWN)
    if pixels is None:
        raise Unusable(f"the image is damaged ({' '.join(source.geterror().split())[:150]})")
    chosen = np.asarray(pixels[:, :, wanted], dtype=np.float64)
    if not request["normals"]:
        chosen = chosen[:, :, 0]
        if answer.get("nodata") is not None:
            chosen[chosen == answer["nodata"]] = np.nan
    answer["shape"] = chosen.shape
    return answer, chosen


def bits(spec: Any) -> int:
    """Bits of an integer, 0 for a floating-point number."""
    name = str(spec.format)
    if name in ("float", "half", "double"):
        return 0
    size = {"uint8": 8, "int8": 8, "uint16": 16, "int16": 16, "uint": 32, "int": 32}.get(name)
    stated = spec.getattribute("oiio:BitsPerSample")
    if size is None or stated not in (None, size):  # the library would rescale odd depths
        raise Unusable(f"pixels of {stated or name} bits are not supported, but 16 or 32 bits are")
    return size


def one(names: list[str], wanted: int | str | None) -> int:
    """The index of the channel that holds the heights."""
    if wanted is None and len(names) == 1:
        return 0
    for index, name in enumerate(names):
        if wanted is not None and wanted in (index, name):
            return index
    listed = ", ".join(f"{index} ({name[:24]})" for index, name in enumerate(names))
    if wanted is None:
        raise Unusable(f"the image has {len(names)} channels, name the one of the heights: {listed}")
    raise Unusable(f"there is no channel {wanted!r:.60}, the image has {listed}")


def triple(names: list[str]) -> list[int]:
    """The indices of the three channels that hold the components of the normals."""
    for wanted in (("R", "G", "B"), ("X", "Y", "Z"), ("x", "y", "z")):
        if all(name in names for name in wanted):
            return [names.index(name) for name in wanted]
    listed = ", ".join(name[:24] for name in names)
    raise Unusable(f"a normal map has three channels R, G, B, and this image has {listed}")


def geography(path: str) -> dict[str, Any]:
    """What GeoTIFF and GDAL say about the pixels, and whether the file is a microscope's."""
    import tifffile

    with tifffile.TiffFile(path) as file:
        page = file.pages.first
        tags = page.geotiff_tags
        nodata = page.tags.get("GDAL_NODATA") or page.tags.get(42113)
        answer: dict[str, Any] = {"microscope": any(tag in page.tags for tag in _MICROSCOPE_TAGS)}
        answer["nodata"] = None if nodata is None else float(str(nodata.value).strip("\0 ") or "nan")
    if not tags:
        return answer
    size = tags.get("ModelPixelScale")
    unit = int(tags.get("ProjLinearUnitsGeoKey", _METRE))
    model = int(tags.get("GTModelTypeGeoKey", 0))
    return answer | {
        "pixel_size": None if size is None else [abs(float(size[0])), abs(float(size[1]))],
        "geographic": model == _MODEL_GEOGRAPHIC,
        "metric": unit == _METRE,
    }
