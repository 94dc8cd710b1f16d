"""The charts of docs/performance.md."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("agg")

from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from microfacet.plot import COLORS

from .page import YARDSTICKS, elements
from .results import Results
from .suite import Measurement

COPY = "#777777"


def _label(name: str) -> str:
    return name.replace("Lambda", "Λ").replace("sigma", "σ")


def _row(ax: Axes, y: float, m: Measurement, size: float) -> None:
    color = COLORS[m.kernel.split(".")[0]]
    filled = m.dtype == "float32"
    ax.plot(m.speeds["ours"] / 1e9, y, "o", ms=size, color=color, mfc=color if filled else "white", zorder=3)
    for name, value in m.speeds.items():
        if name not in ("ours", *YARDSTICKS):
            ax.plot(value / 1e9, y, "x", ms=5, color=COPY, alpha=1.0 if filled else 0.4, zorder=2)


def speeds(results: Results, path: Path, length: int) -> None:
    """Every kernel at one length: both precisions, what SciPy and Mitsuba do, and a copy and exp as lines."""
    names = list(dict.fromkeys(m.kernel for m in results.measurements if m.length == length))
    figure, ax = plt.subplots(figsize=(8, 0.8 + 0.21 * len(names)), layout="constrained")
    for y, name in enumerate(names):
        for dtype in ("float64", "float32"):
            if m := results.find(name, dtype, length):
                _row(ax, y, m, 6)
        _mitsuba(ax, y, name, results)
    for name, style in (("copy", "-"), ("own exp", "--")):
        of = [m.speeds[name] for m in results.measurements if (m.dtype, m.length) == ("float32", length)]
        if of:
            ax.axvline(max(of) / 1e9, color=COPY, ls=style, lw=1, zorder=1)
    ax.set(xscale="log", xlabel=f"G evaluations/s, {elements(length)} elements, one thread")
    ax.set_yticks(range(len(names)), [_label(name) for name in names], fontsize=8)
    ax.set_ylim(len(names) - 0.5, -0.5)
    ax.grid(axis="both", lw=0.4, alpha=0.5)
    _legend(ax)
    _save(figure, path)


def _mitsuba(ax: Axes, y: float, name: str, results: Results) -> None:
    """Only where the same call is measured on both: D and G1 on x, y, z."""
    for m in results.mitsuba:
        if m.threads == 1 and name == f"{m.kernel}(x, y, z)":
            ax.plot(m.speeds["Mitsuba"] / 1e9, y, "D", ms=5, color=COPY, mfc="white", zorder=2)


def _legend(ax: Axes) -> None:
    marks = {
        "float32": Line2D([], [], marker="o", ls="", color="black"),
        "float64": Line2D([], [], marker="o", ls="", color="black", mfc="white"),
        "NumPy, SciPy (pale: float64)": Line2D([], [], marker="x", ls="", color=COPY),
        "Mitsuba 3, float32": Line2D([], [], marker="D", ls="", color=COPY, mfc="white"),
        "copy, float32": Line2D([], [], color=COPY),
        "own exp, float32": Line2D([], [], color=COPY, ls="--"),
    }
    place: dict[str, Any] = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "ncols": 3}
    ax.legend(marks.values(), marks.keys(), fontsize=8, frameon=False, **place)


def scaling(results: Results, path: Path) -> None:
    """Throughput against the length, and the gain by threads."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained", width_ratios=(2, 1))
    _lengths(left, results)
    _threads(right, results)
    _save(figure, path)


def _lengths(ax: Axes, results: Results) -> None:
    records = results.scaling.get("lengths", [])
    for kernel, dtype in dict.fromkeys((r["kernel"], r["dtype"]) for r in records):
        of = [r for r in records if (r["kernel"], r["dtype"]) == (kernel, dtype)]
        color = COPY if kernel == "copy" else COLORS[kernel.split(".")[0]]
        single = dtype == "float32"
        label = _label(kernel) if single else None
        x, y = [r["length"] for r in of], [r["speed"] / 1e9 for r in of]
        ax.plot(x, y, "-" if single else "--", color=color, label=label, lw=1.5 if single else 1)
    for name, size in results.machine["caches"].items():
        ax.axvline(size / 8, color=COPY, lw=0.6, ls=":")  # argument and result, float32
        at = ("data", "axes fraction")
        ax.annotate(name, (size / 8, 1), xycoords=at, fontsize=8, va="bottom", ha="center")
    ax.set(xscale="log", yscale="log", xlabel="length (dashed: float64; dotted: float32 arrays fill a cache)")
    ax.set_ylabel("G evaluations/s, one thread")
    ax.grid(lw=0.4, alpha=0.5)
    if records:
        ax.legend(fontsize=8)


def _threads(ax: Axes, results: Results) -> None:
    records = [r for r in results.scaling.get("threads", []) if r["dtype"] == "float32"]
    for kernel in dict.fromkeys(r["kernel"] for r in records):
        color = COLORS[kernel.split(".")[0]]
        of = [r for r in records if r["kernel"] == kernel and r["threads"] != "dask"]
        counts = [int(r["threads"]) for r in of]
        ax.plot(counts, [r["gain"]["median"] for r in of], "o-", color=color, ms=4, label=_label(kernel))
        for r in (r for r in records if r["kernel"] == kernel and r["threads"] == "dask"):
            ax.plot(counts[-1], r["gain"]["median"], "s", ms=6, color=color, mfc="none")
    top = results.machine["cores"]
    ax.plot([1, top], [1, top], ":", color=COPY, lw=1)
    ax.set(xlabel="threads (squares: dask)", ylabel="gain over one thread, float32", ylim=(0, top + 0.25))
    ax.set_xticks(range(1, top + 1, max(1, top // 8)))
    ax.grid(lw=0.4, alpha=0.5)


def _save(figure: Figure, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=130, metadata={"Software": None})
    plt.close(figure)
