"""When several files are fitted by the workers of dask, and where those are."""

from __future__ import annotations

import importlib
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

from microfacet._threads import processors

__all__ = ["WORTH_A_CLUSTER", "client", "worthwhile"]

#: Bytes of files. Workers take seconds to start, and one process uses two processors well for large maps:
#: below this it is done before they are worth their start.
WORTH_A_CLUSTER = 2**27


def worthwhile(files: Iterable[str]) -> bool:
    """Whether starting workers on this machine is likely to save time."""
    if processors() < 3:
        return False
    total = 0
    for file in files:
        with suppress(OSError, ValueError):  # which the fit will say
            total += os.stat(file).st_size
    return total >= WORTH_A_CLUSTER


@contextmanager
def client(address: str, jobs: int) -> Iterator[Any]:
    """A client of the scheduler at an address, or ("local") of a cluster of processes on this machine."""
    distributed: Any = importlib.import_module("distributed")
    if address != "local":
        try:
            found = distributed.Client(address)
        except (OSError, ValueError) as error:
            raise ValueError(f"--dask: no scheduler answers at {address} ({error})") from error
        with found:
            yield found
        return
    workers = min(jobs, processors())
    with (
        distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as found,
    ):
        yield found
