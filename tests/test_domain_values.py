"""Values at the ends of the documented domain, against arbitrary precision and limits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf

import hostile_numbers as hostile
import microfacet as mf
import reference
from accuracy_points import CONTRACTS, QUANTITIES
from builds import BUILDS, LONG

each_family = pytest.mark.parametrize("family", mf.families(), ids=lambda family: family.name)
each_quantity = pytest.mark.parametrize("quantity", QUANTITIES)
NATIVE = ("beckmann", "ggx", "k0", "student_t")  # compute in float32
DIGITS = 40


def first(quantity: str) -> int:
    """How many arguments stand before the parameters."""
    return 2 if quantity == "P22" else 1


def tolerance(truth: float, dtype: type) -> float:
    c = CONTRACTS[np.dtype(dtype).name]
    return c.tolerance if abs(math.log(abs(truth))) < c.central else c.tail_tolerance


# Extreme roughness


def _points(family: Any, quantity: str, dtype: type, n: int) -> list[list[float]]:
    """Arguments whose result is no power of the roughness alone: slopes near alpha or near 1."""
    rng = np.random.default_rng([8, first(quantity), len(family.name)])
    lower, upper = (1e-100, 1e100) if dtype is np.float64 else (1e-15, 1e15)
    rows = []
    for _ in range(n):
        alpha = math.exp(rng.uniform(math.log(lower), math.log(upper)))
        shape = {
            "gtr": rng.choice([0.3, 1.0, 1.4, 3.0, 60.0]) * rng.uniform(0.9, 1.1),
            "student_t": 1.5 + 10 ** rng.uniform(-2, 3),
            "bessel_k": 10 ** rng.uniform(-1, 2),
            "generalised_exponential": rng.uniform(0.45, 4.0),
        }
        for own in family.parameters[1:]:
            if family.name not in shape:
                shape[family.name] = rng.choice(own.examples)
        width = alpha if family.name != "gtr" else alpha ** rng.choice([0, 1, rng.random()])
        slope = width * 10 ** rng.uniform(-2, 1.2)
        u = slope / math.hypot(1, slope) if quantity != "D" else 1 / math.hypot(1, slope)
        x = {"sample_slope": rng.random(), "sample_u": rng.random()}.get(quantity, slope)
        sign = rng.choice([-1, 1]) if quantity in ("P22", "P2", "slope_cdf", "sigma", "Lambda") else 1
        row = [sign * (u if quantity in hostile.COSINES else x)] * first(quantity) + [alpha]
        rows.append([float(dtype(y)) for y in (*row, *[shape[k] for k in shape if k == family.name])])
    return rows


@each_family
@each_quantity
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_extreme_roughness(family: Any, quantity: str, dtype: type) -> None:
    limits = CONTRACTS[np.dtype(dtype).name]
    bad, known = [], 0
    for row in _points(family, quantity, dtype, 12):
        try:
            truth = reference.value(family.name, quantity, *row)
        except ArithmeticError:  # its quadrature does not reach everywhere
            continue
        known, size = known + 1, abs(float(truth))
        for build, module in BUILDS.items():
            result = float(getattr(getattr(module, family.name), quantity)(*map(dtype, row)))
            if limits.smallest < size < limits.largest:
                wrong = reference.relative_error(result, truth) > tolerance(size, dtype)
            elif size <= limits.smallest:
                wrong = not abs(result) <= 1.01 * limits.smallest
            else:
                wrong = not abs(result) >= 0.99 * limits.largest
            if wrong:
                bad.append((build, row, result, float(truth)))
    assert not bad, f"{len(bad)}: {bad[:4]}"
    assert known > 7


def test_GTR_of_large_gamma() -> None:
    """alpha^(2 gamma) itself leaves the range from gamma = 154 on at alpha = 10."""
    assert mf.gtr.Lambda(0.2, 10.0, 200.0) == pytest.approx(387.20, abs=0.005)
    for alpha, gamma in ((10.0, 200.0), (3.0, 4e3), (1.05, 7e5), (400.0, 51.0), (1e60, 33.0), (2e-9, 1e9)):
        width = alpha * math.sqrt(gamma) if alpha > 1 else alpha / math.sqrt(gamma)
        for x in (0.03, 0.4, 2.0):
            slope = width * x
            u = slope / math.hypot(1, slope)
            upright = 1 / math.hypot(1, slope)
            for quantity, y in (
                ("Lambda", u), ("sigma", -u), ("G1", u), ("D", upright),
                ("P2", slope), ("slope_cdf", -slope), ("survival", slope),
            ):  # fmt: skip
                truth = reference.value("gtr", quantity, y, alpha, gamma)
                result = getattr(mf.gtr, quantity)(y, alpha, gamma)
                if abs(truth) < 1e-300:
                    assert abs(result) <= 1e-300
                    continue
                assert reference.relative_error(result, truth) < 1e-12, (quantity, y, alpha, gamma, result)


# Extreme shapes: limits, as far as rounding tells


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_student_t_is_beckmann_up_to_the_largest_gamma(dtype: type) -> None:
    alpha, largest = dtype(0.4), float(np.finfo(dtype).max)
    x = np.array([-2.1, -0.9, -0.3, -1e-3, 0.0, 0.02, 0.25, 0.8, 0.99, 1.0], dtype=dtype)
    for quantity in QUANTITIES:
        columns = [abs(x) if quantity == "survival" else x] * first(quantity)
        if quantity in hostile.COSINES:
            columns = [np.clip(x, -1, 1)]
        elif quantity.startswith("sample"):
            columns = [np.array([0, 1e-30, 0.01, 0.5, 0.999], dtype=dtype)]
        expected = getattr(mf.beckmann, quantity)(*columns, alpha)
        for gamma in (1e20, 1e29, 1e33, 1e38, 1e39, 1e200, 0.99 * largest):
            if gamma < largest:
                got = getattr(mf.student_t, quantity)(*columns, alpha, dtype(gamma))
                c = CONTRACTS[np.dtype(dtype).name]
                np.testing.assert_allclose(got, expected, rtol=c.tail_tolerance, atol=c.smallest)


@pytest.mark.parametrize("a", [1e20, 1e30, 1e64, 0.9e100])
def test_bessel_k_is_beckmann_for_large_a(a: float) -> None:
    alpha = 0.4 / math.sqrt(a)
    x = np.array([-1.7, -0.3, -1e-3, 0.0, 0.02, 0.25, 0.8, 0.99, 1.0])
    xi = np.array([0.0, 1e-300, 1e-250, 1e-9, 0.3, 0.99])
    for quantity in QUANTITIES:
        columns = [abs(x) if quantity == "survival" else x] * first(quantity)
        if quantity in hostile.COSINES:
            columns = [np.clip(x, -1, 1)]
        elif quantity.startswith("sample"):
            columns = [xi]
        got = getattr(mf.bessel_k, quantity)(*columns, alpha, a)
        np.testing.assert_allclose(
            got, getattr(mf.beckmann, quantity)(*columns, 0.4), rtol=1e-12, atol=1e-300
        )


@pytest.mark.parametrize("a", [1e-20, 1e-140, 1e-290])
def test_tails_of_bessel_k_are_proportional_to_a_small_a(a: float) -> None:
    """P(r > 0) = a to first order: most normals are that of the plane."""
    small, scale = 1e-16, a / 1e-16
    for quantity, x in (
        ("D", 0.6),
        ("P2", 0.3),
        ("slope_cdf", -0.3),
        ("sigma", -0.4),
        ("Lambda", 0.3),
        ("survival", 0.5),
    ):
        f = getattr(mf.bessel_k, quantity)
        np.testing.assert_allclose(f(x, 0.2, a), scale * f(x, 0.2, small), rtol=1e-12)


# Slopes whose square leaves the range, and cosines


def test_heavy_tails_far_out() -> None:
    with mp.workdps(DIGITS):
        for dtype, sizes in (
            (np.float32, (1e10, 3e15, 1e22, 1e37)),
            (np.float64, (1e100, 1e149, 1e160, 1e300)),
        ):
            tol = CONTRACTS[np.dtype(dtype).name].tail_tolerance
            for gamma in (1.001, 1.02, 1.3):
                for size in sizes:
                    p, alpha, g = dtype(size), dtype(0.7), dtype(gamma)
                    k = mpf(float(g)) - 1
                    y = (mpf(float(p)) / mpf(float(alpha))) ** 2 / k
                    norm = mp.gamma(k + 0.5) / (mp.sqrt(mp.pi * k) * mp.gamma(k))
                    # The leading term of the tail beyond y: others are 1/y below.
                    tail = norm * mp.sqrt(k) * y**-k / (2 * k)
                    truths = {
                        "survival": (1 + y) ** -k, "P2": norm * (1 + y) ** (-k - 0.5) / mpf(float(alpha)),
                    }  # fmt: skip
                    if y > 1e16:
                        truths["slope_cdf"] = tail
                    for quantity, truth in truths.items():
                        x = -p if quantity == "slope_cdf" else p
                        f = getattr(mf.student_t, quantity)
                        for result in (f(x, alpha, g), f(np.full(LONG, x), alpha, g)[7]):
                            if CONTRACTS[np.dtype(dtype).name].smallest < truth:
                                assert abs(mpf(float(result)) / truth - 1) < tol, (quantity, x, gamma, result)
    for p in (1e14, 4e15, 1e17):
        assert mf.ggx.slope_cdf(np.float32(-p), np.float32(0.7)) == pytest.approx(
            0.49 / (4 * p * p), rel=4e-6
        )
    for r in (3e19, 1e21):
        assert mf.ggx.survival(np.float32(r), np.float32(1e4)) == pytest.approx((1e4 / r) ** 2, rel=4e-6)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_grazing_student_t(dtype: type) -> None:
    """D is a power of the cosine, whose square underflows."""
    c = CONTRACTS[np.dtype(dtype).name]
    rng = np.random.default_rng(6)
    exponents = (-36, -9) if dtype is np.float32 else (-290, -9)
    with mp.workdps(DIGITS):
        for _ in range(200):
            row = 10 ** rng.uniform(*exponents), 10 ** rng.uniform(-4, 4), 1 + 10 ** rng.uniform(-3, 1)
            u, alpha, gamma = (mpf(float(dtype(x))) for x in row)
            truth = (1 + (1 - u**2) / (u * alpha) ** 2 / (gamma - 1)) ** -gamma / (mp.pi * alpha**2 * u**4)
            if c.smallest < truth < c.largest:
                result = mpf(float(mf.student_t.D(*map(dtype, row))))
                assert abs(result / truth - 1) < c.tail_tolerance, (row, result, truth)


# float32 and float64 are one function


@pytest.mark.parametrize("name", NATIVE)
@each_quantity
@pytest.mark.parametrize("build", BUILDS)
def test_float32_is_float64_rounded(name: str, quantity: str, build: str) -> None:
    """Wherever the result is a normal number, although what it is made of may not be."""
    family = next(f for f in mf.families() if f.name == name)
    n, dtype, f32 = 20_000, np.float32, np.finfo(np.float32)
    rng = np.random.default_rng(11)
    alpha = hostile.roughness(family, rng, n, dtype)
    columns = [hostile.values(quantity, rng, alpha) for _ in range(first(quantity))]
    columns += [alpha, *hostile.shapes(family, rng, n, dtype)]
    columns = [np.where(abs(c) < f32.tiny, dtype(0), c) for c in columns]
    if name == "k0" and quantity == "P22":  # a slope over alpha below the normal numbers counts as 0
        columns[:2] = [np.where(abs(c) < 1e-30, dtype(0), c) for c in columns[:2]]
    if quantity == "D":  # nor does D see a cosine whose product with about sqrt(alpha) is below them
        columns[0] = np.where(abs(columns[0]) < 1e-35, dtype(0), columns[0])
    if quantity in hostile.COSINES:  # what counts as 1 in float32
        columns[0] = np.where(abs(columns[0]) < 1 + 9 * f32.eps, np.clip(columns[0], -1, 1), columns[0])
    f = getattr(getattr(BUILDS[build], name), quantity)
    with np.errstate(all="ignore"):
        got, expected = f(*columns).astype(float), f(*[c.astype(float) for c in columns])
        size = abs(expected)
        error = abs(got / expected - 1)
        allowed = np.where(abs(np.log(size)) < 20, 4e-6, 5e-5)
    wrong = (size > 1.01 * f32.tiny) & (size < 0.02 * float(f32.max)) & ~(error <= allowed)
    wrong |= (size < 0.99 * f32.tiny) & ~(abs(got) <= 1.01 * f32.tiny)
    wrong |= (size > float(f32.max)) & ~np.isinf(got)
    rows = [([float(c[i]) for c in columns], got[i], expected[i]) for i in np.flatnonzero(wrong)]
    assert not rows, f"{len(rows)} of {n}: {rows[:5]}"


def test_quotients_of_what_underflows() -> None:
    f = np.float32
    cases = {
        "student_t.Lambda": ((0.0014372563, 0.00015024684, 171.54546), 4.6325612e-36),
        "k0.Lambda": ((0.00018431113, 4.7549106e-6), None),
        "ggx.Lambda": ((1.2e-38, 0.0383), None),
        "ggx.G1": ((1.2e-38, 0.00023), None),
        "beckmann.Lambda": ((3e-38, 2e-3), None),
        "beckmann.sigma": ((-0.9998, 2.3e3), None),
        "k0.sigma": ((-0.999, 1.7), None),
    }
    for name, (row, truth) in cases.items():
        family, quantity = name.split(".")
        exact = reference.value(family, quantity, *map(float, map(f, row)))
        result = getattr(getattr(mf, family), quantity)(*map(f, row))
        assert reference.relative_error(result, exact) < 5e-5, (name, result, exact)
        assert truth is None or result == pytest.approx(truth, rel=5e-5)
