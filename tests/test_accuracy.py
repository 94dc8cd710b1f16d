"""The accuracy contract: both precisions, every family and function (numbers: accuracy_points.py)."""

from __future__ import annotations

import pytest

import microfacet as mf
import reference
from accuracy_points import QUANTITIES, measure, points

# Per family, as many as its truth is cheap and its code is intricate. Two thirds are representable in float32
# and serve both precisions.
COUNTS = {"beckmann": 100, "ggx": 100, "gtr": 400, "student_t": 300, "k0": 60, "bessel_k": 180}


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("family", reference.FAMILIES)
def test_contract(family: str, quantity: str) -> None:
    function = getattr(getattr(mf, family), quantity)
    count = COUNTS.get(family, 100) * (6 if quantity in ("D", "P22") else 1)  # whose truth needs no integral
    both = points(family, quantity, 2 * count // 3)
    samples = {"float32": both, "float64": both + points(family, quantity, count // 3, rounded=False)}
    failures = {
        dtype: [m for m in measure(function, family, quantity, dtype, sample) if not m.ok]
        for dtype, sample in samples.items()
    }
    report = "\n".join(
        f"{dtype} {family}.{quantity}{m}"
        for dtype, found in failures.items()
        for m in sorted(found, key=lambda m: -m.error / max(m.tolerance, 1e-300))[:6]
    )
    counts = ", ".join(f"{dtype}: {len(found)} of {len(samples[dtype])}" for dtype, found in failures.items())
    assert not report, f"outside the contract ({counts})\n{report}"
