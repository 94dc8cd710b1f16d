"""How throughput and memory grow with the array, with threads and dask; what a call and a set-up cost."""

from __future__ import annotations

import importlib.util
import io
import json
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import microfacet as mf

from .kernels import PARAMETERS, Array, Inputs, Kernel, bind
from .machine import available_memory, cores
from .suite import elements_in
from .threads import parts, together
from .timing import Contender, Spread, interleave, ratio, speed

CURVES = (
    Kernel("beckmann", "D"),
    Kernel("ggx", "sigma"),
    Kernel("student_t", "Lambda"),
    Kernel("bessel_k", "Lambda"),
)
LENGTHS = tuple(round(10 ** (k / 2)) for k in range(17))  # 1 to 1e8
LONGEST_CALL = 1.0  # seconds; a curve ends before a call takes longer
PARALLEL = 1 << 24
PREPARED = (1 << 14, 1 << 17)

Record = dict[str, Any]


def lengths(seconds: float, longest: int = LENGTHS[-1]) -> Iterator[Record]:
    """Speed of the CURVES and of a copy against the length of the array, both precisions."""
    for dtype in ("float32", "float64"):
        slow: set[str] = set()
        for n in (n for n in LENGTHS if n <= longest):
            if 8 * n * np.dtype(dtype).itemsize > available_memory():  # a few arrays, and room to spare
                break
            inputs = Inputs(n, dtype)
            copy = partial(np.copyto, inputs.out, inputs.u)
            contenders = [Contender("copy", copy, n)]
            contenders += [Contender(k.name, bind(k, inputs), n) for k in CURVES if k.name not in slow]
            times = interleave(contenders, seconds, warm=n <= 1 << 20)
            slow |= {name for name, t in times.items() if t.min() * n * 3 > LONGEST_CALL}
            for name, t in times.items():
                yield {
                    "kernel": name,
                    "dtype": dtype,
                    "length": n,
                    "speed": speed(t),
                    "time": vars(Spread.of(t * n)),
                }


def calls(seconds: float) -> Iterator[Record]:
    """Seconds for one call on one number: the ufuncs, a frozen distribution, and numpy.exp for comparison."""
    one = np.array([0.7])
    ndf = mf.GGX(alpha=0.3)
    direction = np.array([0.0, 0.6, 0.8])
    table: dict[str, Callable[[], object]] = {
        "numpy.exp": partial(np.exp, one),
        "beckmann.D": partial(mf.beckmann.D, one, 0.3),
        "ggx.sigma": partial(mf.ggx.sigma, one, 0.3),
        "student_t.Lambda": partial(mf.student_t.Lambda, one, 0.3, 2.5),
        "GGX(...).D(m)": partial(ndf.D, direction),
    }
    for name, t in interleave([Contender(name, call, 1) for name, call in table.items()], seconds).items():
        ours = name.split(".")[0] in PARAMETERS
        yield {"call": name, "ufunc": ours, "time": vars(Spread.of(t))}


def threads(seconds: float, longest: int = PARALLEL) -> Iterator[Record]:
    """Speed on 1 to all processors, through concurrent.futures and through dask, relative to one thread."""
    for dtype in ("float32", "float64"):
        for kernel in CURVES:
            length = min(longest, elements_in(kernel, dtype, LONGEST_CALL / 5))
            inputs = Inputs(length, dtype)
            with ThreadPoolExecutor(cores()) as pool:
                contenders = []
                for count in range(1, cores() + 1):
                    split = [bind(kernel, inputs, part) for part in parts(length, count)]
                    contenders.append(Contender(f"{count}", together(pool, split), length))
                if importlib.util.find_spec("dask"):
                    contenders.append(Contender("dask", through_dask(kernel, inputs), length))
                times = interleave(contenders, seconds)
            for name, t in times.items():
                yield {
                    "kernel": kernel.name,
                    "dtype": dtype,
                    "length": length,
                    "threads": name,
                    "speed": speed(t),
                    "gain": vars(ratio(t, times["1"])),
                }


def through_dask(kernel: Kernel, inputs: Inputs) -> Callable[[], Array]:
    """The ufunc on a dask array of as many blocks as there are processors; dask allocates the result."""
    import dask.array as da

    function = getattr(getattr(mf, kernel.family), kernel.quantity)
    blocks = da.from_array(inputs.u, chunks=-(-inputs.length // cores()))
    rest = bind(kernel, inputs).args[1:]
    return lambda: function(blocks, *rest).compute(scheduler="threads")


# Nothing is freed before the calls are made: the peak that they raise is then what is in use.
_MEMORY = """
import json, re, numpy as np, microfacet as mf
n = {length}
def peak():
    return 1024 * int(re.search(r"VmHWM:\\s*(\\d+)", open("/proc/self/status").read())[1])
def growth(call):
    before = peak()
    call()
    return peak() - before
few = np.full(100000, 0.7, np.float32)
mf.student_t.Lambda(few, 0.3, 2.5)
u, out = np.full(n, 0.7, np.float32), np.ones(n, np.float32)
v, wide = np.full(n, 0.7), np.ones(n)
swapped = np.full(n, 0.7, u.dtype.newbyteorder())
pairs = np.full((n, 2), 0.7, np.float32)
found = {{}}
found["float32"] = growth(lambda: mf.student_t.Lambda(u, 0.3, 2.5, out=out))
found["float64"] = growth(lambda: mf.student_t.Lambda(v, 0.3, 2.5, out=wide))
found["every parameter an array"] = growth(lambda: mf.beckmann.D(u, u, out=out))
found["every second element"] = growth(lambda: mf.beckmann.D(pairs[:, 0], 0.3, out=pairs[:, 1]))
found["foreign byte order"] = growth(lambda: mf.beckmann.D(swapped, 0.3, out=out))
found["float32 written as float64"] = growth(lambda: mf.beckmann.D(u, 0.3, out=wide))
found["the NumPy expression"] = growth(lambda: np.exp((1 - 1 / (u * u)) / 0.09, out=out))
print(json.dumps(found))
"""


def memory(length: int = 10_000_000) -> Record:
    """By how many bytes a call raises the peak of a process that holds the arguments and the result.

    Only where the system states the peak of a process by itself; getrusage also knows that of its parents.
    """
    if not Path("/proc/self/status").exists():
        return {}
    done = _python(_MEMORY.format(length=length))
    return {"length": length, "array": 4 * length, "growth": json.loads(done.stdout)}


def importing(repeats: int = 5) -> Record:
    """Seconds that `import microfacet` takes in a fresh process, with and without NumPy's share; the best."""
    program = (
        "import time; a = time.perf_counter(); import numpy; b = time.perf_counter(); "
        "import microfacet; c = time.perf_counter(); print(b - a, c - b)"
    )
    shares = np.array([[float(s) for s in _python(program).stdout.split()] for _ in range(repeats)])
    numpy, own = shares.min(axis=0)
    return {"numpy": float(numpy), "microfacet": float(own)}


def _python(program: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)


def preparing(rounds: int = 15) -> Iterator[Record]:
    """Seconds that a new shape parameter costs once: the part of a call that does not grow with length.

    Every call gets a shape that no call before had; two lengths separate the two parts.
    """
    short, long = PREPARED
    for family in ("student_t", "bessel_k", "gtr"):
        for dtype in ("float32", "float64"):
            u, out = Inputs(long, dtype).u, np.ones(long, dtype)
            function = getattr(mf, family).Lambda
            best = {}
            for n in (short, long):
                shapes = (2.5 + 1e-3 * k for k in range(rounds))
                best[n] = min(_once(partial(function, u[:n], 0.3, shape, out=out[:n])) for shape in shapes)
            constant = best[short] - (best[long] - best[short]) * short / (long - short)
            yield {"family": family, "dtype": dtype, "seconds": max(constant, 0.0)}


def _once(call: Callable[[], object]) -> float:
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def package_size() -> int:
    """Bytes of the installed package, compressed as a wheel is."""
    stream, root = io.BytesIO(), Path(mf.__file__).parent
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path in sorted(root.rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts:
                wheel.write(path, path.relative_to(root.parent))
    return len(stream.getvalue())
