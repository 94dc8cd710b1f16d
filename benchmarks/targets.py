"""What the library sets itself to reach: ratios of speeds at a million elements, one thread, AVX-512.

They stand beside the library's own exp on the same array and beside peers: the speed of a copy depends on the
machine more than arithmetic does.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Target:
    """`kernel` shall be at least `at_least` times as fast as `contender`."""

    kernel: str
    dtype: str
    contender: str
    at_least: float


def _table() -> Iterator[Target]:
    for name in ("beckmann.D", "beckmann.Lambda", "ggx.D", "ggx.Lambda", "ggx.sigma", "k0.D"):
        yield Target(f"{name}(u)", "float32", "own exp", 0.4)

    yield Target("beckmann.D(u)", "float64", "NumPy", 8)
    yield Target("beckmann.Lambda(u)", "float64", "erfcx", 18)
    yield Target("k0.D(u)", "float64", "k0", 18)
    yield Target("k0.D(u)", "float64", "kv", 70)
    for quantity in ("Lambda", "sigma"):
        yield Target(f"student_t.{quantity}(u)", "float64", "hyp2f1", 40)
        yield Target(f"student_t.{quantity}(varying)", "float64", "hyp2f1", 3)
        yield Target(f"bessel_k.{quantity}(u)", "float64", "kv, modstruve", 40)
    yield Target("bessel_k.D(u)", "float64", "kv", 40)

    mitsuba = {"ggx.D": 1.25, "ggx.G1": 1.6, "beckmann.D": 1.25, "beckmann.G1": 0.65}
    visible = {"beckmann": 2, "ggx": 1.8, "student_t": 1.5, "k0": 2, "bessel_k": 1, "gtr": 1}
    mitsuba |= {f"{family}.sample_visible": ratio for family, ratio in visible.items()}
    for name, ratio in mitsuba.items():
        yield Target(name, "float32", "Mitsuba", ratio)


TARGETS = tuple(_table())


def wanted(kernel: str, dtype: str, contender: str) -> float | None:
    """The least ratio, where one is set."""
    found = (t.at_least for t in TARGETS if (t.kernel, t.dtype, t.contender) == (kernel, dtype, contender))
    return next(found, None)
