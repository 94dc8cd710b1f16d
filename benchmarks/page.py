"""docs/performance.md from the results of a run."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from .results import Results
from .suite import DTYPES, MILLION, Measurement
from .targets import TARGETS, wanted
from .timing import Spread

YARDSTICKS = ("copy", "own exp", "numpy.exp")

INTRODUCTION = """\
# Performance

Written by `make bench`; do not edit.
"""

READING = """\
## How to read this

Everything runs in one process and interleaved: in every round each contender runs once, in random order,
so that all meet the same machine. A **ratio** is the speed of this library divided by that of the
contender in the same round; the tables give its median and, in brackets, its quartiles over the rounds.
Above 1 this library is faster. Absolute **speeds** are those of the best round, in million evaluations
per second (M/s), on one thread unless said otherwise.

- **copy**: `numpy.copyto` of an array of the same length and precision. How fast that is depends on where
  the arrays live: 16 Ki elements stay in the inner caches, 1 Mi in the outer one if it is large, 64 Mi in
  memory.
- **own exp**: this library's exponential function, as a ufunc on the same array: the price of one
  elementary function.
- **NumPy, SciPy**: the textbook expression with temporaries, on at most 32 Ki elements so that these stay
  in the cache; named by the function that dominates its cost.
- **Mitsuba 3**: `MicrofacetDistribution` in `llvm_ad_rgb` on the same arrays of x, y and z. Tracing,
  which takes some microseconds per call, is part of its time.

`u` in brackets is a function of a cosine with constant parameters; `x, y, z` a method of a frozen
distribution on three arrays; `varying` a function whose parameters are arrays, too; `xi` sampling of all
normals; `w, xi` of those that directions see, one for each.
Cosines and directions are spread evenly over the hemisphere (over the sphere for sigma); alpha = 0.3,
Student-T gamma = 2.5, GTR gamma = 1.5, Bessel K a = 1.7.
"""

MITSUBA = """\
float32 arrays of x, y and z. On several threads, this library is called by as many threads of
`concurrent.futures`, each on its part of the arrays. Target, on one thread: D at least 0.85 (Beckmann)
and 1.2 (GGX), Beckmann's G1 at least 0.55. The last column is the largest difference between Mitsuba's
values and ours in float64, relative where the value exceeds 1e-6 (of samples: between cosines).

`sample_visible` draws one visible normal for each direction, continuously in the uniform numbers,
`sample_visible_mixture` by the cheaper scheme. Mitsuba samples GGX and Beckmann alone: GGX stands beside
its GGX, every other family beside its Beckmann. Target, on one thread: Beckmann at least 3, GGX 1.2,
Student-T and K0 1, Bessel K and GTR 0.5 (`sample_visible`).
"""


ARRAYS = """\
`array_functions` gives the same functions to other libraries, which carry out one operation of theirs
after the other: compiled by JAX (`jit`, XLA on one thread, on arrays of its own, without the time that
compiling takes), and on NumPy, in blocks.
"""


def number(value: float) -> str:
    """Two or three digits, without an exponent in the usual range."""
    if value >= 99.95:
        return f"{value:,.0f}"
    if value < 0.0995:
        return f"{value:.2g}"
    return f"{value:.{1 if value >= 9.95 else 2}f}"


def spread(ratio: Spread | None) -> str:
    """Median and quartiles."""
    return "–" if ratio is None else f"{number(ratio.median)} ({number(ratio.lower)}–{number(ratio.upper)})"


def seconds(value: float) -> str:
    """With the unit that suits."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if value >= size:
            return f"{number(value / size)} {unit}"
    return f"{number(value / 1e-9)} ns" if value else "0"


def elements(count: int) -> str:
    """Binary multiples by name, others as a power of ten or as they are."""
    for unit, size in (("Mi", 1 << 20), ("Ki", 1 << 10)):
        if count >= size and count % size == 0:
            return f"{count // size} {unit}"
    return f"{count:,}"


def table(header: Iterable[str], rows: Iterable[Iterable[str]]) -> Iterator[str]:
    """A Markdown table and an empty line."""
    header = tuple(header)
    yield f"| {' | '.join(header)} |"
    yield f"|{'---|' * len(header)}"
    for row in rows:
        yield f"| {' | '.join(row)} |"
    yield ""


def machine(results: Results) -> Iterator[str]:
    """What it ran on."""
    m = results.machine
    caches = ", ".join(f"{name} {size >> 10:,} KiB" for name, size in m["caches"].items())
    yield f"- {results.date}; {m['processor']}, {m['cores']} cores{', ' + caches if caches else ''}"
    packages = ", ".join(f"{name} {version}" for name, version in m["versions"].items())
    yield f"- {packages}; {m['system']}; instruction set of the kernels: {m['instruction_set']}"
    yield f"- processors busy with something else when the run began: {m['busy']:.1f}"
    for note in results.notes:
        yield f"- left out: {note}"
    yield ""


def verdict(ratio: Spread | None, target: float | None) -> str:
    """A ratio beside its target; one that is missed stands out."""
    if target is None or ratio is None:
        return spread(ratio)
    return spread(ratio) if ratio.median >= target else f"**{spread(ratio)}**"


def targets(results: Results) -> Iterator[str]:
    """Each target beside what was measured at every length."""
    lengths = results.lengths()
    rows = []
    for target in TARGETS:
        if target.contender == "Mitsuba":
            continue
        found = [results.find(target.kernel, target.dtype, n) for n in lengths]
        if any(found):
            ratios = (m.ratios.get(target.contender) if m else None for m in found)
            cells = (verdict(ratio, target.at_least) for ratio in ratios)
            what = (f"`{target.kernel}`", target.dtype, target.contender)
            rows.append((*what, f"≥ {target.at_least:g}", *cells))
    if rows:
        yield "## Targets\n"
        yield "Set for 1 Mi elements on one thread with AVX-512; **bold** where a ratio lies below.\n"
        yield from table(("", "precision", "beside", "target", *map(elements, lengths)), rows)


def missed(results: Results) -> list[str]:
    """A sentence for each target that was measured at its length and not reached."""
    found = []
    for target in TARGETS:
        if target.contender == "Mitsuba":
            alone = (m for m in results.mitsuba if (m.threads, m.length) == (1, MILLION))
            m = next((m for m in alone if m.kernel == target.kernel), None)
        else:
            m = results.find(target.kernel, target.dtype, MILLION)
        ratio = m.ratios.get(target.contender) if m else None
        if ratio is not None and ratio.median < target.at_least:
            found.append(
                f"{target.kernel} in {target.dtype}: {spread(ratio)} of {target.contender}, "
                f"target {target.at_least:g}"
            )
    return found


def renderer(results: Results) -> Iterator[str]:
    """Mitsuba on one thread and on all."""
    if not results.mitsuba:
        return
    yield "## Beside Mitsuba 3\n"
    yield MITSUBA
    rows = []
    for m in results.mitsuba:
        off = results.deviations[m.kernel]
        set_here = (m.threads, m.length) == (1, MILLION)
        target = wanted(m.kernel, m.dtype, "Mitsuba") if set_here else None
        rows.append(
            (
                f"`{m.kernel}`",
                elements(m.length),
                str(m.threads),
                number(m.speeds["ours"] / 1e6),
                number(m.speeds["Mitsuba"] / 1e6),
                verdict(m.ratios["Mitsuba"], target),
                "–" if off is None else f"{off:.1e}",
            )
        )
    header = ("", "length", "threads", "ours, M/s", "Mitsuba, M/s", "ours/Mitsuba", "Mitsuba differs by")
    yield from table(header, rows)


def arrays(results: Results) -> Iterator[str]:
    """JAX and NumPy through `array_functions`."""
    if not results.arrays:
        return
    yield "## On other libraries' arrays\n"
    yield ARRAYS
    names = list(dict.fromkeys(m.kernel for m in results.arrays))
    for dtype in DTYPES:
        rows = []
        for name in names:
            for m in (m for m in results.arrays if (m.kernel, m.dtype) == (name, dtype)):
                speeds = (number(m.speeds[who] / 1e6) for who in ("ours", "JAX", "NumPy"))
                rows.append((f"`{name}`", *speeds, spread(m.ratios["JAX"]), spread(m.ratios["NumPy"])))
        length = elements(results.arrays[0].length)
        header = (f"{dtype}, {length}", "ufunc, M/s", "JAX, M/s", "NumPy, M/s", "ufunc/JAX", "ufunc/NumPy")
        yield from table(header, rows)


def expressions(results: Results) -> Iterator[str]:
    """NumPy and SciPy, both precisions in a row."""
    rows = []
    for m in (m for m in results.measurements if m.length == main_length(results) and m.dtype == "float64"):
        single = results.find(m.kernel, "float32", m.length)
        for name in m.ratios:
            if name not in YARDSTICKS:
                rows.append(
                    (
                        f"`{m.kernel}`",
                        name,
                        number(m.speeds[name] / 1e6),
                        spread(single.ratios.get(name)) if single else "–",
                        verdict(m.ratios[name], wanted(m.kernel, "float64", name)),
                    )
                )
    if rows:
        yield "## Beside NumPy and SciPy\n"
        header = ("", "expression", "its M/s (float64)", "ours/it, float32", "ours/it, float64")
        yield from table(header, rows)


def main_length(results: Results) -> int:
    """The length that the targets are set for, or the longest there is."""
    lengths = results.lengths()
    return next((n for n in lengths if n >= MILLION), lengths[-1])


def kernels(results: Results) -> Iterator[str]:
    """Absolute speeds and ratios of every kernel at every length."""
    lengths = results.lengths()
    names = list(dict.fromkeys(m.kernel for m in results.measurements))
    for dtype in DTYPES:
        rows = []
        for name in names:
            row = [f"`{name}`"]
            for n in lengths:
                row += _cells(results.find(name, dtype, n))
            rows.append(row)
        if rows:
            yield f"## All kernels, {dtype}\n"
            yield " ".join(_yardsticks(results, dtype, n) for n in lengths) + "\n"
            heads = [head for n in lengths for head in (f"{elements(n)}: M/s", "/ copy", "/ own exp")]
            yield from table(("", *heads), rows)


def _cells(m: Measurement | None) -> list[str]:
    if m is None:
        return ["–", "–", "–"]
    return [number(m.speeds["ours"] / 1e6), spread(m.ratios.get("copy")), spread(m.ratios.get("own exp"))]


def _yardsticks(results: Results, dtype: str, length: int) -> str:
    of = [m.speeds for m in results.measurements if (m.dtype, m.length) == (dtype, length)]
    best = {name: max((s[name] for s in of if name in s), default=None) for name in YARDSTICKS}
    said = ", ".join(f"{name} {number(value / 1e6)} M/s" for name, value in best.items() if value)
    return f"{elements(length)}: {said}."


def document(results: Results, sections: Iterable[Any] = ()) -> str:
    """The page; `sections` are further functions of the results, such as those of `scaling_page`."""
    parts = [machine, _chart, _reading, targets, renderer, expressions, arrays, kernels, *sections]
    lines = [INTRODUCTION, *(line for part in parts for line in part(results))]
    return "\n".join(lines).rstrip("\n") + "\n"


def _chart(results: Results) -> Iterator[str]:
    if results.measurements:
        yield "![Speed of every kernel beside a copy, exp, SciPy and Mitsuba](images/performance.png)\n"


def _reading(results: Results) -> Iterator[str]:
    yield READING
