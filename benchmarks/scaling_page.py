"""The part of docs/performance.md on lengths, threads, memory and fixed costs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from .page import elements, number, seconds, spread, table
from .results import Results
from .timing import Spread

#: Seconds, bytes: what the fixed costs shall not exceed.
LIMITS = {"call": 1e-6, "import": 0.2, "float32": 2e-4, "float64": 2e-3, "package": 5e6}


def lengths(results: Results) -> Iterator[str]:
    """Speeds by length; the chart has the same figures."""
    records = results.scaling.get("lengths")
    if not records:
        return
    yield "## Length of the array\n"
    yield "![Throughput against array length; speed-up with threads](images/performance_scaling.png)\n"
    columns = list(dict.fromkeys((r["kernel"], r["dtype"]) for r in records))
    by = {(r["kernel"], r["dtype"], r["length"]): r["speed"] for r in records}
    rows = []
    for n in dict.fromkeys(r["length"] for r in records):
        found = (by.get((*column, n)) for column in columns)
        rows.append((f"{n:,}", *("–" if s is None else number(s / 1e6) for s in found)))
    yield "M/s of the best round.\n"
    yield from table(("length", *(f"{name}, {dtype}" for name, dtype in columns)), rows)


def threads(results: Results) -> Iterator[str]:
    """Gain over one thread."""
    records = results.scaling.get("threads")
    if not records:
        return
    length = max(r["length"] for r in records)
    yield "## Threads and dask\n"
    yield f"""\
{elements(length)} elements, split among the threads of a `concurrent.futures.ThreadPoolExecutor`, or as a
dask array of one block per processor on which the ufunc is called as on any array (dask allocates its
result; the threads write into one that exists). Gain over one thread:
"""
    names = list(dict.fromkeys(r["threads"] for r in records))
    by = {(r["kernel"], r["dtype"], r["threads"]): Spread(**r["gain"]) for r in records}
    rows = []
    for kernel, dtype in dict.fromkeys((r["kernel"], r["dtype"]) for r in records):
        gains = (spread(by.get((kernel, dtype, name))) for name in names if name != "1")
        rows.append((f"`{kernel}`", dtype, *gains))
    heads = (name if name == "dask" else f"{name} threads" for name in names if name != "1")
    yield from table(("", "precision", *heads), rows)


def memory(results: Results) -> Iterator[str]:
    """Growth of the peak."""
    record = results.scaling.get("memory")
    if not record:
        return
    yield "## Memory\n"
    yield f"""\
By how much a call raises the peak memory of a process that already holds the arguments and the result
({record["length"]:,} elements, a float32 array of {record["array"] / 1e6:.0f} MB):
"""
    rows = ((name, f"{growth / 1e6:.1f} MB") for name, growth in record["growth"].items())
    yield from table(("call", "growth"), rows)


def costs(results: Results) -> Iterator[str]:
    """What does not depend on the length."""
    rows = list(_costs(results.scaling))
    if rows:
        yield "## Fixed costs\n"
        yield "Preparing is what a constant shape parameter costs once per call on a long array.\n"
        yield from table(("", "measured", "limit"), rows)


def _costs(scaling: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    for r in scaling.get("calls", ()):
        limit = f"≤ {seconds(LIMITS['call'])}" if r["ufunc"] else "–"
        yield f"one call on one number, `{r['call']}`", seconds(r["time"]["median"]), limit
    for r in scaling.get("preparing", ()):
        what = f"preparing {r['family']}, {r['dtype']}"
        yield what, seconds(r["seconds"]), f"≤ {seconds(LIMITS[r['dtype']])}"
    if found := scaling.get("importing"):
        yield (
            "`import microfacet` after NumPy",
            seconds(found["microfacet"]),
            f"≤ {seconds(LIMITS['import'])}",
        )
        yield "`import numpy`", seconds(found["numpy"]), "–"
    if size := scaling.get("package"):
        yield (
            "package, compressed as a wheel is",
            f"{size / 1e6:.2f} MB",
            f"≤ {LIMITS['package'] / 1e6:.0f} MB",
        )


SECTIONS = (lengths, threads, memory, costs)
