"""What the library sets itself to reach: ratios of speeds at a million elements, one thread, AVX-512.

A copy's speed depends on the machine more than arithmetic does: whether the array is still in a cache,
whether the copy writes past it. For that reason the ratio to the library's own exp on the same array
stands beside it.
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


def _against(names: tuple[str, ...], single: float, double: float) -> Iterator[Target]:
    for name in names:
        yield Target(name, "float32", "copy", single)
        yield Target(name, "float64", "copy", double)


def _table() -> Iterator[Target]:
    three = ("D", "Lambda", "sigma")
    yield from _against(("beckmann.D(u)", "beckmann.Lambda(u)"), 0.75, 0.6)
    yield from _against(tuple(f"ggx.{q}(u)" for q in three), 0.8, 0.65)
    yield from _against(("k0.D(u)",), 0.45, 0.28)
    yield from _against(tuple(f"student_t.{q}(u)" for q in three), 0.45, 0.25)
    yield from _against(tuple(f"bessel_k.{q}(u)" for q in three), 0.4, 0.22)
    yield from _against(tuple(f"gtr.{q}(u)" for q in three), 0.4, 0.22)
    yield from _against(("student_t.Lambda(varying)", "student_t.sigma(varying)"), 0.02, 0.015)
    for family in ("bessel_k", "gtr"):
        yield from _against((f"{family}.Lambda(varying)", f"{family}.sigma(varying)"), 0.002, 0.001)

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

    yield Target("beckmann.D", "float32", "Mitsuba", 0.85)
    yield Target("ggx.D", "float32", "Mitsuba", 1.2)
    yield Target("beckmann.G1", "float32", "Mitsuba", 0.55)
    visible = {"beckmann": 3, "ggx": 1.2, "student_t": 1, "k0": 1, "bessel_k": 0.5, "gtr": 0.5}
    for family, ratio in visible.items():
        yield Target(f"{family}.sample_visible", "float32", "Mitsuba", ratio)


TARGETS = tuple(_table())


def wanted(kernel: str, dtype: str, contender: str) -> float | None:
    """The least ratio, where one is set."""
    found = (t.at_least for t in TARGETS if (t.kernel, t.dtype, t.contender) == (kernel, dtype, contender))
    return next(found, None)
