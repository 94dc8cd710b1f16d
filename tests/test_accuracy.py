"""The accuracy contract: all builds, precisions, families and functions (numbers: accuracy_points.py)."""

from __future__ import annotations

import pytest

import reference
from accuracy_points import QUANTITIES, measure, points
from builds import BUILDS

# Per family, as many as its truth is cheap and its code is intricate. Two thirds are representable in float32
# and serve both precisions.
COUNTS = {
    "beckmann": 100,
    "ggx": 100,
    "gtr": 400,
    "student_t": 300,
    "k0": 60,
    "bessel_k": 180,
    "ei": 60,
    "erfc": 60,
    "double_ggx": 60,
}


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("family", reference.FAMILIES)
def test_contract(family: str, quantity: str) -> None:
    count = COUNTS.get(family, 100) * (6 if quantity in ("D", "P22") else 1)  # whose truth needs no integral
    both = points(family, quantity, 2 * count // 3)
    samples = {"float32": both, "float64": both + points(family, quantity, count // 3, rounded=False)}
    failures = {
        (build, dtype): [
            m
            for m in measure(getattr(getattr(module, family), quantity), family, quantity, dtype, sample)
            if not m.ok
        ]
        for build, module in BUILDS.items()
        for dtype, sample in samples.items()
    }
    report = "\n".join(
        f"{build} {dtype} {family}.{quantity}{m}"
        for (build, dtype), found in failures.items()
        for m in sorted(found, key=lambda m: -m.error / max(m.tolerance, 1e-300))[:6]
    )
    counts = ", ".join(
        f"{build} {dtype}: {len(found)} of {len(samples[dtype])}"
        for (build, dtype), found in failures.items()
    )
    assert not report, f"outside the contract ({counts})\n{report}"
