"""pyarrow, in the child process of `process.py`. It imports nothing of microfacet."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


class Unusable(Exception):
    """The file can be parsed but not used; the message is for the user."""


def read(request: dict[str, Any]) -> tuple[dict[str, Any], NDArray[np.float64]]:
    """The names of the columns, and those that are wanted as (N, count); first of all, none are."""
    from pyarrow import parquet

    with parquet.ParquetFile(request["path"]) as source:
        names = [str(name)[:200] for name in source.schema_arrow.names[:1000]]
        wanted = request["columns"]
        if wanted is None:
            return {"names": names, "shape": [0, 0]}, np.empty((0, 0))
        if source.metadata.num_rows > request["max_pixels"]:
            raise Unusable(f"{source.metadata.num_rows} rows exceed the limit of {request['max_pixels']}")
        # The number of rows that a file states is no reason to make room for them.
        parts = [
            np.column_stack([batch.column(name).to_numpy(zero_copy_only=False) for name in wanted])
            for batch in source.iter_batches(columns=wanted)
        ]
    slopes = np.concatenate([np.empty((0, len(wanted))), *parts])
    return {"names": names, "shape": slopes.shape}, slopes
