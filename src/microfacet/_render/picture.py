"""From radiance to files: PNG and JPEG for the eye, OpenEXR with the values themselves."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from microfacet._files import replacing

__all__ = ["FORMATS", "display", "save"]

Array = npt.NDArray[Any]

FORMATS = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".exr": "OpenEXR"}
JPEG = 92  # quality
SHOULDER = 0.6  # up to here a picture shows radiance as it is


def display(radiance: Array) -> Array:
    """Linear values in [0, 1): highlights above SHOULDER are compressed, smoothly, in each channel."""
    rest = 1.0 - SHOULDER
    above = np.maximum(radiance - SHOULDER, 0.0)
    return np.minimum(radiance, SHOULDER) + rest * -np.expm1(-above / rest)


def save(path: str | Path, picture: Array, record: Mapping[str, str]) -> None:
    """Write RGB (height, width, 3), whole or not at all; `record` goes into it (JPEG has no room).

    Values of 8 bits are written as they are, radiance as a PNG or JPEG shows it; in OpenEXR as it is.
    """
    import mitsuba as mi

    suffix = Path(path).suffix.lower()
    kind = mi.Struct.Type.Float32 if suffix == ".exr" else mi.Struct.Type.UInt8
    ready = picture.dtype == np.uint8
    values = picture if ready or suffix == ".exr" else display(picture)
    bitmap = mi.Bitmap(np.ascontiguousarray(values, dtype=np.uint8 if ready else np.float32))
    if not ready:
        bitmap = bitmap.convert(mi.Bitmap.PixelFormat.RGB, kind, srgb_gamma=suffix != ".exr")
    for name, text in record.items():
        bitmap.metadata()[name] = text
    content = mi.MemoryStream()
    bitmap.write(content, getattr(mi.Bitmap.FileFormat, FORMATS[suffix]), JPEG if suffix[1] == "j" else -1)
    with replacing(path) as stream:
        stream.write(content.raw_buffer())
