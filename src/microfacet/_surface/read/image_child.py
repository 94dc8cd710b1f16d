"""OpenImageIO (pixels) and tifffile (what GeoTIFF adds), in the child process of `process.py`.

It imports nothing of microfacet. Sizes are checked before anything is decoded.
"""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.float64]

FORMATS = ("png", "tiff", "openexr")
_MODEL_GEOGRAPHIC = 2  # GeoTIFF key GTModelTypeGeoKey
_METRE = 9001  # EPSG code of ProjLinearUnitsGeoKey
# Private tags of microscopes whose TIFF files hold a picture for looks and the heights elsewhere: Park, JPK.
_MICROSCOPE_TAGS = (50434, 0x8000)
_GDAL_NODATA, _GDAL_METADATA = 42113, 42112
_REDUCED, _MASK = 1, 4  # bits of the tag NewSubfileType


class Unusable(Exception):
    """The file can be parsed but not used; the message is for the user."""


def read(request: dict[str, Any]) -> tuple[dict[str, Any], Image]:
    """The answer without the pixels, and the pixels: (ny, nx), or (ny, nx, 3) where `normals` are asked for.

    The first row is the top of the image, as stored. Integers stay whole numbers; `bits` says which range
    they have (0 for floating point).
    """
    import OpenImageIO

    config = OpenImageIO.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)  # levels as stored, not multiplied by alpha
    source = OpenImageIO.ImageInput.open(request["path"], config)
    if source is None:
        raise Unusable(
            f"this is no image that can be read ({' '.join(OpenImageIO.geterror().split())[:150]})"
        )
    kind = source.format_name()
    answer: dict[str, Any] = {"format": kind, "shape": [0, 0]}
    wanted = request["channel"]
    if kind == "tiff":
        answer |= pages(request["path"])
        if answer["microscope"]:
            return answer, np.empty((0, 0))
        if len(answer["pages"]) > 1:
            page, wanted = page_of(answer["pages"], wanted, request)
            if page is None:
                return answer, np.empty((0, 0))
            source.seek_subimage(page, 0)
            answer["channel"] = f"page {page}"
    spec = source.spec()
    check(kind, spec, request)
    answer |= {"bits": bits(spec), "signed": str(spec.format).startswith("int")}
    answer |= {"channels": list(spec.channelnames), "pixels": [spec.width, spec.height]}
    if request.get("list"):
        return answer, np.empty((0, 0))
    names = answer["channels"]
    indices = triple(names) if request["normals"] else [one(names, wanted)]
    pixels = source.read_image(source.current_subimage(), 0, 0, spec.nchannels, OpenImageIO.UNKNOWN)
    if pixels is None:
        raise Unusable(f"the image is damaged ({' '.join(source.geterror().split())[:150]})")
    pixels = np.asarray(pixels).reshape(spec.height, spec.width, spec.nchannels)
    if request["normals"]:
        chosen = np.asarray(pixels[:, :, indices], dtype=np.float64)
    else:
        chosen = heights(pixels[:, :, indices[0]], answer)
        if "A" in names and names[indices[0]] != "A":
            chosen[pixels[:, :, names.index("A")] == 0] = np.nan
    answer["shape"] = chosen.shape
    return answer, chosen


def check(kind: str, spec: Any, request: dict[str, Any]) -> None:
    """Refuse other formats, and sizes beyond the limits."""
    if kind == "jpeg" and not request["normals"]:
        raise Unusable(
            "a JPEG image holds no heights: its blocks make slopes of their own, export PNG or TIFF"
        )
    if kind not in (*FORMATS, "jpeg"):
        raise Unusable(f"this is a {kind} image, and heights come in PNG, TIFF or EXR")
    if spec.width * spec.height > request["max_pixels"] or spec.nchannels > 16 or spec.depth > 1 or spec.deep:
        raise Unusable(
            f"an image of {spec.width} x {spec.height} pixels with {spec.nchannels} channels exceeds the "
            f"limit of {request['max_pixels']} pixels, 16 channels and one layer"
        )


def heights(pixels: NDArray[Any], answer: dict[str, Any]) -> Image:
    """The pixels as numbers, nan where they hold the mark of missing data, a number of their type."""
    chosen = np.asarray(pixels, dtype=np.float64)
    mark = answer.get("nodata")
    if mark is not None and pixels.dtype.kind == "f":
        with np.errstate(over="ignore"):
            chosen[pixels == pixels.dtype.type(mark)] = np.nan
    elif mark is not None and mark == int(mark):
        chosen[pixels == int(mark)] = np.nan
    return np.asarray(chosen * answer.get("factor", 1.0) + answer.get("offset", 0.0))


def bits(spec: Any) -> int:
    """Bits of an integer, 0 for a floating-point number."""
    name = str(spec.format)
    if name in ("float", "half", "double"):
        return 0
    size = {"uint8": 8, "int8": 8, "uint16": 16, "int16": 16, "uint": 32, "int": 32}.get(name)
    stated = spec.getattribute("oiio:BitsPerSample")
    if size is None or stated not in (None, size):  # the library would rescale odd depths
        raise Unusable(f"pixels of {stated or name} bits are not supported, but 8, 16 or 32 bits are")
    return size


def one(names: list[str], wanted: int | str | None) -> int:
    """The index of the channel that holds the heights; alpha is none."""
    others = [index for index, name in enumerate(names) if name != "A"]
    if wanted is None and len(others) == 1:
        return others[0]
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


def page_of(
    found: list[list[int]], wanted: int | str | None, request: dict[str, Any]
) -> tuple[int | None, None]:
    """The page of a TIFF of several that is wanted; None where they are only to be listed."""
    if request.get("list"):
        return None, None
    listed = ", ".join(f"page {page} ({nx} x {ny} pixels)" for page, nx, ny in found[:8])
    if len(found) > 8:
        listed += f", ... ({len(found)} in all)"
    if wanted is None:
        raise Unusable(
            f"the file holds several images, name the one of the heights with channel= (--channel): {listed}"
        )
    for page, _, _ in found:
        if wanted in (page, f"page {page}"):
            return page, None
    raise Unusable(f"there is no channel {wanted!r:.60}, the file has {listed}")


def pages(path: str) -> dict[str, Any]:
    """The pages of a TIFF that are images, [number, width, height], and what GeoTIFF says of the first."""
    import tifffile

    with tifffile.TiffFile(path) as file:
        found = [
            [number, page.imagewidth, page.imagelength]
            for number, page in enumerate(map(file.pages.get, range(min(len(file.pages), 1000))))
            if not int(page.subfiletype) & (_REDUCED | _MASK)
        ]
        page = file.pages.first
        answer = {"pages": found, "microscope": any(tag in page.tags for tag in _MICROSCOPE_TAGS)}
        images = (file.imagej_metadata or {}).get("images", 1) if file.is_imagej else 1
        if int(images) > len(file.pages):
            raise Unusable(
                f"the file holds {images} images behind one another, export the one of the heights"
            )
        return answer | geography(page)


def geography(page: Any) -> dict[str, Any]:
    """What GeoTIFF and GDAL say about the pixels of a page."""
    nodata, metadata = page.tags.get(_GDAL_NODATA), page.tags.get(_GDAL_METADATA)
    answer: dict[str, Any] = {}
    if nodata is not None:
        mark = float(str(nodata.value).strip("\0 ") or "nan")
        answer["nodata"] = mark if math.isfinite(mark) else None
    for role, name in (("scale", "factor"), ("offset", "offset")):
        found = re.search(rf'role="{role}"[^>]*>\s*([^<\s]{{1,40}})', str(metadata.value) if metadata else "")
        if found:
            answer[name] = float(found.group(1))
    tags = page.geotiff_tags
    if not tags:
        return answer
    unit = int(tags.get("ProjLinearUnitsGeoKey", _METRE))
    vertical = int(tags.get("VerticalUnitsGeoKey", _METRE))
    return answer | {
        "pixel_size": cell(tags),
        "geographic": int(tags.get("GTModelTypeGeoKey", 0)) == _MODEL_GEOGRAPHIC,
        "metric": unit == _METRE,
        "metric_heights": vertical == _METRE,
    }


def cell(tags: dict[str, Any]) -> list[float] | None:
    """The pixel size by its tag, or by the matrix that takes columns and rows to the plane."""
    size = tags.get("ModelPixelScale")
    if size is not None:
        return [abs(float(size[0])), abs(float(size[1]))]
    matrix = tags.get("ModelTransformation")
    if matrix is None:
        return None
    (a, b, *_), (d, e, *_) = matrix[0], matrix[1]
    dx, dy = math.hypot(a, d), math.hypot(b, e)
    if abs(a * b + d * e) > 1e-6 * dx * dy:
        raise Unusable("the axes of the pixels are not perpendicular on the ground, resample the map first")
    return [dx, dy]
