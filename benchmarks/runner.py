"""One run: what is measured in which order, shown while it happens, and the ratios that are printed."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from . import arrays, machine, page, renderer, scaling, suite
from .kernels import KERNELS
from .results import Results
from .timing import Spread

CONSOLE = Console(width=None if sys.stdout.isatty() else 130)
LARGE_NEEDS = 6 << 30  # bytes, for the arrays beyond the cache


@dataclass(frozen=True)
class Settings:
    """How much is measured."""

    seconds: float  # for each kernel, precision and length
    lengths: tuple[int, ...]  # of the arrays that kernels are measured on
    longest: int  # array of the scaling study


def measure(results: Results, only: str, settings: Settings) -> None:
    """Fill `results` with everything whose name fits `only`."""
    chosen = [kernel for kernel in KERNELS if kernel.matches(only)]
    lengths = settings.lengths
    if machine.available_memory() < LARGE_NEEDS and max(lengths) > suite.MILLION:
        results.notes.append("arrays beyond the cache (less than 6 GB of memory are available)")
        lengths = tuple(n for n in lengths if n <= suite.MILLION)
    jobs = suite.plan(chosen, lengths)
    for _, m in consume(suite.run(jobs, settings.seconds), len(jobs), lambda entry: entry[0]):
        if m is not None:
            results.measurements.append(m)
    million = max((n for n in lengths if n <= suite.MILLION), default=suite.MILLION)
    _measure_renderer(results, only, settings.seconds, million)
    _measure_arrays(results, only, settings.seconds, million)
    _measure_scaling(results, only, settings.seconds, settings.longest)


def _measure_renderer(results: Results, only: str, seconds: float, length: int) -> None:
    wanted = [name for name in renderer.NAMES if fnmatchcase(f"mitsuba.{name}", only)]
    if not wanted:
        return
    names, note = renderer.usable()
    if note:
        results.notes.append(note)
        CONSOLE.print(note, style="yellow")
    names = tuple(name for name in wanted if name in names)
    if names:
        measured = renderer.run(names, length, 2 * seconds)
        for m, off in consume(measured, None, lambda entry: f"Mitsuba {entry[0].kernel}"):
            results.mitsuba.append(m)
            results.deviations[m.kernel] = off
        results.machine["versions"]["LLVM"] = renderer.llvm()


def _measure_arrays(results: Results, only: str, seconds: float, length: int) -> None:
    wanted = tuple(kernel for kernel in arrays.MEASURED if fnmatchcase(f"arrays.{kernel.name}", only))
    if not wanted:
        return
    if note := arrays.usable():
        results.notes.append(note)
        CONSOLE.print(note, style="yellow")
        return
    records = arrays.run(wanted, length, seconds)
    results.arrays += consume(records, len(wanted) * len(suite.DTYPES), lambda m: f"on arrays {m.kernel}")


def _measure_scaling(results: Results, only: str, seconds: float, longest: int) -> None:
    """Each part under its own name."""

    def lengths() -> list[scaling.Record]:
        records = scaling.lengths(seconds / 4, longest)
        return consume(records, None, lambda r: f"{r['kernel']} of {r['length']:,}")

    parts: dict[str, Callable[[], Any]] = {
        "lengths": lengths,
        "threads": lambda: list(scaling.threads(seconds, min(longest, scaling.PARALLEL))),
        "calls": lambda: list(scaling.calls(seconds)),
        "preparing": lambda: list(scaling.preparing()),
        "memory": lambda: scaling.memory(longest // 10),
        "importing": scaling.importing,
        "package": scaling.package_size,
    }
    for name, part in parts.items():
        if fnmatchcase(f"scaling.{name}", only):
            CONSOLE.print(f"scaling: {name}", style="dim")
            results.scaling[name] = part()


def consume(records: Iterable[Any], total: int | None, label: Callable[[Any], str] = str) -> list[Any]:
    """All records, with a progress bar meanwhile."""

    def shown(progress: Progress) -> Iterator[Any]:
        task = progress.add_task("", total=total)
        for entry in records:
            progress.update(task, advance=1, description=label(entry))
            yield entry

    columns = (TextColumn("{task.description:32}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=CONSOLE, transient=True, disable=not CONSOLE.is_terminal) as progress:
        return list(shown(progress))


def show(results: Results) -> None:
    """The ratios, one row for each measurement."""
    heads = ("kernel", "precision", "length", "threads", "M/s", "/ copy", "/ own exp", "/ others")
    rows = Table(*heads, box=None)
    for m in [*results.measurements, *results.mitsuba, *results.arrays]:
        others = (f"{name} {_brief(r)}" for name, r in m.ratios.items() if name not in page.YARDSTICKS)
        rows.add_row(
            m.kernel,
            m.dtype,
            page.elements(m.length),
            str(m.threads),
            page.number(m.speeds["ours"] / 1e6),
            *(_brief(m.ratios.get(name)) for name in ("copy", "own exp")),
            "  ".join(others),
        )
    if rows.row_count:
        CONSOLE.print(rows)
    for sentence in page.missed(results):
        CONSOLE.print(sentence)


def _brief(ratio: Spread | None) -> str:
    """The median, and half the distance between the quartiles."""
    if ratio is None:
        return ""
    return f"{page.number(ratio.median)} ±{(ratio.upper - ratio.lower) / 2 / ratio.median:.0%}"
