"""Sampled normals as a file or a stream, in blocks, so that memory stays bounded for any number of them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from microfacet._files import replacing

__all__ = ["save", "write_csv"]

_BLOCK = 2**16


def save(ndf: Any, n: int, seed: int, path: Path) -> None:
    """Write `n` normals to a .npy file of shape (n, 3) or to a .csv file; nothing is left if it fails."""
    if path.suffix not in {".npy", ".csv"}:
        raise ValueError(f"output must end in .npy or .csv, got {str(path)!r}")
    with replacing(path) as stream:
        if path.suffix == ".csv":
            write_csv(ndf, n, seed, stream)
        else:
            header = {"descr": "<f8", "fortran_order": False, "shape": (n, 3)}
            npy.write_array_header_1_0(stream, header)
            for block in _blocks(ndf, n, seed):
                stream.write(block.astype("<f8").tobytes())


def write_csv(ndf: Any, n: int, seed: int, stream: BinaryIO) -> None:
    """Write `n` normals as lines x,y,z under a heading, with every digit."""
    stream.write(b"x,y,z\n")
    for block in _blocks(ndf, n, seed):
        stream.write("".join(f"{x!r},{y!r},{z!r}\n" for x, y, z in block.tolist()).encode())


def _blocks(ndf: Any, n: int, seed: int) -> Iterator[NDArray[np.float64]]:
    """The same normals whatever the block size: the generator fills row after row."""
    rng = np.random.default_rng(seed)
    for start in range(0, n, _BLOCK):
        yield np.asarray(ndf.sample(rng.random((min(_BLOCK, n - start), 2))), dtype=np.float64)
