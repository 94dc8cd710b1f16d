"""The generated coefficients: tools/ makes them again, and each set meets the error that is stated here.

The forms below are those in which the headers evaluate the sets; the other side is mpmath's own function. The
errors are those of the approximation alone, all sums being exact.
"""

from __future__ import annotations

import os
import pathlib
import re
import subprocess
import sys
from collections.abc import Callable, Sequence

import mpmath
import numpy as np
import pytest
from mpmath import mpf

ROOT = pathlib.Path(__file__).parent.parent
SPECIAL = ROOT / "include/microfacet/special/coefficients"
HEADERS = {  # by the tool and its arguments
    "derive_elementary.py": ROOT / "include/microfacet/core/elementary_coefficients.hpp",
    "derive_special.py": SPECIAL / "special.hpp",
    "derive_erfc_inverse.py": SPECIAL / "erfc_inverse.hpp",
    "derive_visible.py": SPECIAL / "visible.hpp",
    "derive_student.py": SPECIAL / "student.hpp",
    "derive_bessel.py": SPECIAL / "bessel.hpp",
    "derive_variance_gamma.py tail": SPECIAL / "variance_gamma_tail.hpp",
    "derive_variance_gamma.py excess": SPECIAL / "variance_gamma_excess.hpp",
}
FAST = {  # groups of a tool
    "derive_elementary.py": "exp log log_polynomial sin cos",
    "derive_special.py": "erfc debye",
    "derive_erfc_inverse.py": "",
    "derive_visible.py": SPECIAL / "visible.hpp",
    "derive_student.py": "",
    "derive_bessel.py": "near",
}
SLOW = os.environ.get("MICROFACET_SLOW") == "1"

Form = Callable[["Sets", mpf], mpf]


def arrays() -> dict[str, list[mpf]]:
    """Every one-dimensional array of the headers, as the compiler reads its numbers."""
    found: dict[str, list[mpf]] = {}
    for header in HEADERS.values():
        text = header.read_text(encoding="utf-8")
        for kind, count, name, body in re.findall(r"array<(float|double), (\d+)> (\w+)\{([^{}]*)\}", text):
            real = np.float32 if kind == "float" else np.float64
            found[name] = [mpf(float(real(v.strip().rstrip("F")))) for v in body.split(",")]
            assert len(found[name]) == int(count), name
    return found


ARRAYS = arrays()


class Sets:
    """The arrays of one format as functions: ``Sets(32).exp(r)`` is the polynomial exp_32 at r."""

    def __init__(self, bits: int) -> None:
        self.bits = bits

    def __getattr__(self, name: str) -> Callable[[mpf], mpf]:
        values = ARRAYS[f"{name}_{self.bits}"]
        return lambda x: mpmath.fsum(c * x**k for k, c in enumerate(values))


def minus_log(y: mpf) -> mpf:
    return -mpmath.euler - mpmath.log(y)


def depth(t: mpf) -> mpf:
    """-log(4v(1 - v)) where v = erfc(t)/2."""
    return -mpmath.log(mpmath.erfc(t) * (1 + mpmath.erf(t)))


def points(lower: float, upper: float, crowded: bool = False) -> list[mpf]:
    """Dense on the interval, or denser towards its lower end."""
    y = np.linspace(0, 1, 151)
    return [mpf(float(lower + (upper - lower) * (t**4 if crowded else t))) for t in y]


# Name, form, exact value, points in float32 and in float64, and the largest relative error in both.
END = float(mpmath.log(2)) / 2
CASES: list[
    tuple[str, Form, Callable[[mpf], mpf], Sequence[Sequence[mpf]], tuple[float | None, float | None]]
] = [
    (
        "exp",
        lambda c, r: 1 + r + r**2 * c.exp(r),
        mpmath.exp,
        [points(-END, END)] * 2,
        (4e-9, 5e-18),
    ),
    (
        "log",
        lambda c, f: (s := f / (2 + f)) * 2 + s**3 * c.log(s**2),
        mpmath.log1p,
        [points(0.5**0.5 - 1, 2**0.5 - 1)] * 2,
        (9e-10, 2e-18),
    ),
    (
        "log_polynomial",
        lambda c, f: f - f**2 / 2 + f**3 * c.log_polynomial(f),
        mpmath.log1p,
        [points(0.5**0.5 - 1, 2**0.5 - 1)] * 2,
        (7e-9, None),
    ),
    (
        "sin",
        lambda c, y: y * c.sin(y**2),
        lambda y: mpmath.sin(mpmath.pi * y / 2),
        [points(-0.5, 0.5)] * 2,
        (3e-8, 4e-17),
    ),
    (
        "cos",
        lambda c, y: c.cos(y**2),
        lambda y: mpmath.cos(mpmath.pi * y / 2),
        [points(-0.5, 0.5)] * 2,
        (2e-9, 5e-18),
    ),
    (
        "erfc",
        lambda c, x: c.erfc_numerator(x) / c.erfc_denominator(x),
        lambda x: mpmath.exp(x**2) * mpmath.erfc(x),
        [points(0, 9.5, crowded=True), points(0, 27, crowded=True)],
        (1e-8, 9e-17),
    ),
    (
        "ierfc",
        lambda c, x: c.ierfc_numerator(x) / c.ierfc_denominator(x),
        lambda x: 1 / mpmath.sqrt(mpmath.pi) - x * mpmath.exp(x**2) * mpmath.erfc(x),
        [points(0, 9.5, crowded=True), points(0, 27, crowded=True)],
        (2e-8, 9e-17),
    ),
    (
        "erfc_inverse",
        lambda c, t: (d := depth(t)) * c.erfc_inverse_numerator(d) / c.erfc_inverse_denominator(d),
        lambda t: t**2,
        [points(1e-6, 9.3, crowded=True), points(1e-6, 26.5, crowded=True)],
        (2.9e-7, 2.9e-6),
    ),
    (
        "k0_near",
        lambda c, y: minus_log(y) * c.k0_near_log(y**2) + y**2 * c.k0_near(y**2),
        lambda y: 2 * mpmath.besselk(0, 2 * y),
        [points(1e-9, 0.5625)] * 2,
        (4e-9, 1e-18),
    ),
    (
        "k0_far",
        lambda c, y: mpmath.exp(-2 * y) / mpmath.sqrt(y) * c.k0_far_numerator(y) / c.k0_far_denominator(y),
        lambda y: 2 * mpmath.besselk(0, 2 * y),
        [points(0.5625, 44, crowded=True), points(0.5625, 355, crowded=True)],
        (2e-8, 3e-17),
    ),
    (
        "k1_near",
        lambda c, y: y**2 * (minus_log(y) * c.k1_near_log(y**2) + c.k1_near(y**2)),
        lambda y: 1 - 2 * y * mpmath.besselk(1, 2 * y),
        [points(1e-5, 0.5625)] * 2,
        (3e-8, 2e-17),
    ),
    (
        "k1_far",
        lambda c, y: mpmath.exp(-2 * y) * mpmath.sqrt(y) * c.k1_far_numerator(y) / c.k1_far_denominator(y),
        lambda y: 2 * y * mpmath.besselk(1, 2 * y),
        [points(0.5625, 44, crowded=True), points(0.5625, 355, crowded=True)],
        (2e-8, 2e-17),
    ),
]


@pytest.mark.parametrize(
    ("form", "exact", "at", "bits", "bound"),
    [
        pytest.param(form, exact, at, bits, bound, id=f"{name}_{bits}")
        for name, form, exact, both, bounds in CASES
        for at, bits, bound in zip(both, (32, 64), bounds, strict=True)
        if bound is not None
    ],
)
def test_error(form: Form, exact: Callable[[mpf], mpf], at: Sequence[mpf], bits: int, bound: float) -> None:
    with mpmath.workdps(36):
        values = [(form(Sets(bits), x), exact(x)) for x in at]
        assert max(abs(a - b) / abs(b) if b else abs(a) for a, b in values) <= bound


def test_nothing_cancels() -> None:
    """The terms of the rationals and of the series of K_0 and K_1 are positive."""
    names = [name for name in ARRAYS if name.startswith(("k0_", "k1_")) or "erfc_numerator" in name]
    names += [name for name in ARRAYS if "erfc_denominator" in name or "erfc_inverse" in name]
    assert len(names) == 34
    assert all(value > 0 for name in names for value in ARRAYS[name])


def made(command: str) -> str:
    tool, *groups = command.split()
    return subprocess.run(
        [sys.executable, ROOT / "tools" / tool, *groups], capture_output=True, text=True, check=True
    ).stdout


@pytest.mark.parametrize("tool", FAST)
def test_fast_groups_are_reproduced(tool: str) -> None:
    header = HEADERS[tool].read_text(encoding="utf-8")
    definitions = made(f"{tool} {FAST[tool]}").split("\n\n")
    assert len(definitions) > 6
    for definition in definitions:
        assert definition in header


@pytest.mark.skipif(not SLOW, reason="takes long: set MICROFACET_SLOW=1")
@pytest.mark.parametrize("command", HEADERS)
def test_headers_are_reproduced(command: str) -> None:
    assert made(command) == HEADERS[command].read_text(encoding="utf-8")
