"""pyarrow, in the child process of `process.py`. It imports nothing of microfacet."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


class Unusable(Exception):
    """The file can be parsed but not used; the message is for the user."""


def read(request: dict[str, Any]) -> tuple[dict[str, Any], NDArray[np.float64]]:
    """The shape, and the columns p and q, or the only two, as (N, 2)."""
    from pyarrow import parquet

    with parquet.ParquetFile(request["path"]) as source:
        names = source.schema_arrow.names
        wanted = ["p", "q"] if {"p", "q"} <= set(names) else names
        if len(wanted) != 2:
            raise Unusable(f"the file has the columns {', '.join(names)[:200]}, and not p and q")
        if source.metadata.num_rows > request["max_pixels"]:
            raise Unusable(f"{source.metadata.num_rows} rows exceed the limit of {request['max_pixels']}")
        slopes = np.empty((source.metadata.num_rows, 2))
        done = 0
        for batch in source.iter_batches(columns=wanted):
            for place, name in enumerate(wanted):
                slopes[done : done + len(batch), place] = batch.column(name).to_numpy(zero_copy_only=False)
            done += len(batch)
    return {"shape": slopes.shape}, slopes
