"""Mitsuba 3's MicrofacetDistribution (llvm_ad_rgb) on the same arrays, on one thread and on all.

Dr.Jit compiles with whatever LLVM library it finds, and an unsuitable one can end the process. What works is
therefore tried in a process of its own first; what does not is left out, and a sentence says so.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import numpy as np

from .kernels import PARAMETERS, VISIBLE, Call, Inputs, Kernel, bind
from .machine import cores
from .suite import Measurement
from .threads import parts, together
from .timing import Contender, interleave

VARIANT = "llvm_ad_rgb"
TITLES = {"beckmann": "Beckmann", "ggx": "GGX"}
QUANTITIES = ("D", "G1", "sample")
#: In the order in which they are tried. Mitsuba samples visible normals of GGX and Beckmann; beside the other
#: families stands its Beckmann.
NAMES = (
    *(f"{family}.{quantity}" for quantity in QUANTITIES for family in ("ggx", "beckmann")),
    *(f"{family}.{quantity}" for family in PARAMETERS for quantity in VISIBLE),
)
ADVICE = (
    "Dr.Jit needs an LLVM library newer than 15: install one (Debian: apt install libllvm19) or name it in "
    "DRJIT_LIBLLVM_PATH"
)


class Renderer:
    """Mitsuba, and the arrays of `inputs` as it sees them (not copied)."""

    def __init__(self, inputs: Inputs) -> None:
        import drjit
        import mitsuba

        mitsuba.set_variant(VARIANT)
        self.drjit, self.mitsuba = drjit, mitsuba
        self.direction = mitsuba.Vector3f(*(mitsuba.Float(a) for a in inputs.direction))
        self.xi = mitsuba.Point2f(*(mitsuba.Float(a) for a in inputs.xi[:2]))
        drjit.eval(self.direction, self.xi)

    def expression(self, name: str) -> Callable[[], Any]:
        """The unevaluated result of ``family.quantity``."""
        family, quantity = name.split(".")
        kind = getattr(self.mitsuba.MicrofacetType, TITLES.get(family, "Beckmann"))
        alpha = PARAMETERS[family]["alpha"]
        ndf = self.mitsuba.MicrofacetDistribution(kind, alpha, quantity in VISIBLE)
        normal = self.mitsuba.Vector3f(0, 0, 1)
        if quantity == "D":
            return partial(ndf.eval, self.direction)
        if quantity == "G1":
            return partial(ndf.smith_g1, self.direction, normal)
        return lambda: ndf.sample(self.direction, self.xi)[0]

    def call(self, name: str) -> Call:
        """Evaluate and wait."""
        expression, drjit = self.expression(name), self.drjit

        def evaluate() -> Any:
            value = expression()
            drjit.eval(value)
            drjit.sync_thread()
            return value

        return evaluate


def usable() -> tuple[tuple[str, ...], str | None]:
    """The names that can be measured here, and a sentence on those that cannot."""
    if importlib.util.find_spec("mitsuba") is None:
        return (), "Mitsuba is not installed (pip install mitsuba)"
    tried = subprocess.run([sys.executable, "-m", __name__], capture_output=True, text=True)
    names = tuple(name for name in tried.stdout.split() if name in NAMES)
    missing = [name for name in NAMES if name not in names]
    return names, f"not with Mitsuba here: {', '.join(missing)}. {ADVICE}" if missing else None


def llvm() -> str:
    """The version of the library that Dr.Jit compiles with; only after a `run`."""
    import drjit

    return ".".join(map(str, drjit.detail.llvm_version()))


def counterpart(name: str) -> Kernel:
    """The same evaluation by this library."""
    family, quantity = name.split(".")
    form = "w, xi" if quantity in VISIBLE else "xi" if quantity == "sample" else "x, y, z"
    return Kernel(family, quantity, form)


def deviation(name: str, renderer: Renderer, inputs: Inputs) -> float | None:
    """Largest relative difference between Mitsuba and this library in float64 where the value is ordinary.

    Of samples: the largest difference between cosines; None where normals are drawn in another way.
    """
    if counterpart(name).quantity in VISIBLE and name != "beckmann.sample_visible":
        return None
    value = renderer.call(name)()
    wide = Inputs(inputs.length, "float64")
    wide.direction = tuple(a.astype(np.float64) for a in inputs.direction)
    wide.xi = inputs.xi.astype(np.float64)
    exact = bind(counterpart(name), wide)()
    if counterpart(name).form in ("xi", "w, xi"):
        return float(np.max(abs(np.array(value.z, dtype=np.float64) - exact[:, 2])))
    ordinary = exact > 1e-6
    return float(np.max(abs(np.array(value, dtype=np.float64)[ordinary] / exact[ordinary] - 1)))


def measure(name: str, renderer: Renderer, inputs: Inputs, threads: int, seconds: float) -> Measurement:
    """Mitsuba and this library on `threads` threads each, interleaved."""
    settle = partial(renderer.drjit.set_thread_count, 1)  # its idle threads would disturb ours
    with ThreadPoolExecutor(threads) as pool:
        calls = [bind(counterpart(name), inputs, part) for part in parts(inputs.length, threads)]
        here = calls[0] if threads == 1 else together(pool, calls)
        contenders = [
            Contender("ours", here, inputs.length, settle),
            Contender(
                "Mitsuba",
                renderer.call(name),
                inputs.length,
                partial(renderer.drjit.set_thread_count, threads),
            ),
        ]
        times = interleave(contenders, seconds)
    return Measurement.of(name, inputs, times, threads)


def run(names: tuple[str, ...], length: int, seconds: float) -> Iterator[tuple[Measurement, float | None]]:
    """Measure `names` on one thread and on all, with the deviation of Mitsuba's values from ours."""
    inputs = Inputs(length, "float32")
    renderer = Renderer(inputs)
    for name in names:
        off = deviation(name, renderer, inputs)
        for threads in sorted({1, cores()}):
            yield measure(name, renderer, inputs, threads, seconds), off


def _try() -> None:
    renderer = Renderer(Inputs(256, "float32"))
    for name in NAMES:
        renderer.call(name)()
        print(name, flush=True)


if __name__ == "__main__":
    _try()
