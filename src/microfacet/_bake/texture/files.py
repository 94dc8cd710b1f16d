"""Lookup textures as files: OpenEXR through OpenImageIO, or the bare numbers with a JSON beside them."""

from __future__ import annotations

import json
import shutil
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet._files import ending, is_stdout, replacing
from microfacet._optional import needed

__all__ = ["FORMATS", "format_of", "require_writer", "write"]

Array = NDArray[Any]

FORMATS = ("exr", "raw")
# OpenImageIO writes the time of day where it is given none: the same table would not be the same bytes.
_NO_DATE = "1980:01:01 00:00:00"


def format_of(output: str | Path, format: str | None) -> str:
    """The format that is asked for, or that the name of the output says."""
    if format is None:
        format = ending(output, [f".{name}" for name in FORMATS], ".exr").removeprefix(".")
    if format not in FORMATS:
        raise ValueError(f"lookup_texture: format must be one of {', '.join(FORMATS)}, got {format!r}")
    if format == "raw" and (is_stdout(output) or (Path(output).exists() and not Path(output).is_file())):
        raise ValueError(f"lookup_texture: raw writes a JSON beside its file, and {str(output)!r} is none")
    if not Path(output).absolute().parent.is_dir():
        raise ValueError(f"lookup_texture: output must lie in a folder that exists, got {str(output)!r}")
    return format


def require_writer(format: str) -> None:
    """Find out before any computing whether the result can be written."""
    if format == "exr":
        with needed("writing OpenEXR needs"):
            import OpenImageIO  # noqa: F401


def write(values: Array, metadata: dict[str, Any], output: str | Path, format: str | None) -> None:
    """Whole or not at all."""
    if format_of(output, format) == "exr":
        _write_exr(values, metadata, output)
        return
    with replacing(output) as stream:
        stream.write(np.ascontiguousarray(values, values.dtype.newbyteorder("<")).tobytes())
    described = {**metadata, "byte_order": "little", "file": Path(output).name}
    with replacing(f"{output}.json") as stream:
        stream.write((json.dumps(described, indent=2) + "\n").encode())


def _write_exr(values: Array, metadata: dict[str, Any], output: str | Path) -> None:
    """Slices below each other; a third channel of zeros, which loaders that know no image of two ask for."""
    with needed("writing OpenEXR needs"):
        import OpenImageIO
    image = np.zeros((values.shape[0] * values.shape[1], values.shape[2], 3), np.float32)
    image[..., : values.shape[-1]] = values.reshape(*image.shape[:2], -1)
    spec = OpenImageIO.ImageSpec(
        image.shape[1], image.shape[0], 3, "half" if values.dtype == np.float16 else "float"
    )
    spec.channelnames = ("R", "G", "B")
    spec.attribute("compression", "zip")
    spec.attribute("DateTime", _NO_DATE)
    spec.attribute("microfacet", json.dumps(metadata))
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder, "table.exr"))
        file = OpenImageIO.ImageOutput.create(path)
        if not (file and file.open(path, spec) and file.write_image(image) and file.close()):
            raise OSError(f"OpenImageIO cannot write OpenEXR: {OpenImageIO.geterror() or file.geterror()}")
        with open(path, "rb") as whole, replacing(output) as stream:
            shutil.copyfileobj(whole, stream)
