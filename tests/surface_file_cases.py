"""Images of surfaces, for tests of files."""

from __future__ import annotations

import struct
import sys
import zlib
from unittest import mock

import numpy as np
import pytest

import microfacet as mf

RNG = np.random.default_rng(0)
LEVELS = RNG.integers(0, 65536, size=(6, 8), dtype=np.uint16)


def our_own_readers():
    """Without the libraries: a process for each damaged file would take the time of a test for nothing."""
    return mock.patch.dict(sys.modules, {"SurfaceTopography": None, "OpenImageIO": None})


def refused(call, message):
    with pytest.raises(mf.SurfaceError, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 600


def write_image(file, pixels, names=None):
    if file.suffix.startswith(".tif"):
        pytest.importorskip("tifffile", reason="the extra 'surface' is not installed").imwrite(file, pixels)
        return
    oiio = pytest.importorskip("OpenImageIO", reason="the extra 'surface' is not installed")
    pixels = np.ascontiguousarray(pixels if pixels.ndim == 3 else pixels[..., np.newaxis])
    kinds = {"float32": "float", "float64": "double", "float16": "half"}
    spec = oiio.ImageSpec(
        pixels.shape[1], pixels.shape[0], pixels.shape[2], kinds.get(str(pixels.dtype), str(pixels.dtype))
    )
    if names:
        spec.channelnames = names
    output = oiio.ImageOutput.create(str(file))
    assert output.open(str(file), spec), output.geterror()
    assert output.write_image(pixels), output.geterror()
    output.close()


def png(width, height, bits=16, colour=0, data=b""):
    """A PNG that claims any size."""

    def chunk(name, content):
        return (
            struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))
        )

    header = struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")
