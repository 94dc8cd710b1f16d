"""Values computed by others: Mathematica curves, Mitsuba tables (../shared/reference/README.md)."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy import stats

import microfacet as mf

Array = NDArray[np.float64]

REFERENCE = Path(__file__).resolve().parents[2] / "shared" / "reference"
if not REFERENCE.is_dir():
    pytest.skip(f"the reference data of others is absent: {REFERENCE}", allow_module_level=True)

CURVES = json.loads((REFERENCE / "mathematica" / "manifest.json").read_text())["curves"]
TABLES = json.loads((REFERENCE / "mitsuba" / "tables.json").read_text())["tables"]

# The families a curve serves: one with the parameters given, and those that coincide with it there.
IDENTITIES: dict[str, Callable[..., list[tuple[Any, tuple[float, ...]]]]] = {
    "beckmann": lambda alpha: [(mf.beckmann, (alpha,))],
    "ggx": lambda alpha: [(mf.ggx, (alpha,)), (mf.student_t, (alpha, 2.0)), (mf.gtr, (alpha, 2.0))],
    "gtr": lambda alpha, gamma: [(mf.gtr, (alpha, gamma))],
    "studentt": lambda alpha, gamma: [(mf.student_t, (alpha, gamma))],
    "k0": lambda alpha: [(mf.k0, (alpha,)), (mf.bessel_k, (alpha, 1.0))],
    "besselk": lambda alpha, a: [(mf.bessel_k, (alpha, a))],
}
QUANTITIES: dict[str, Callable[..., Array]] = {
    "D": lambda kernels, u, *parameters: kernels.D(u, *parameters),
    "2piuD": lambda kernels, u, *parameters: 2 * np.pi * u * kernels.D(u, *parameters),
    "sigma": lambda kernels, u, *parameters: kernels.sigma(u, *parameters),
    "G1": lambda kernels, u, *parameters: kernels.G1(u, *parameters),
}


def columns(path: Path) -> Array:
    with path.open(newline="") as file:
        rows = list(csv.reader(file))[1:]
    return np.array(rows, float).T


def served() -> list[Any]:
    return [
        pytest.param(
            curve, kernels, parameters, id=f"{curve['file'][:-4]}-{kernels.__name__.rpartition('.')[2]}"
        )
        for curve in CURVES
        for kernels, parameters in IDENTITIES[curve["family"]](**curve["params"])
    ]


@pytest.mark.parametrize(("curve", "kernels", "parameters"), [c for c in served() if "hist" not in c.id])
def test_mathematica_curve(curve: dict[str, Any], kernels: Any, parameters: tuple[float, ...]) -> None:
    """Within the tolerance of the manifest: absolute, relative above 1e-3 (sigma), or above 1e-300 (D)."""
    u, expected = columns(REFERENCE / "mathematica" / curve["file"])
    result = QUANTITIES[curve["quantity"].split("-")[0]](kernels, u, *parameters)
    tolerance = curve["suggested_tolerance"]
    rtol, atol = tolerance.get("rtol"), tolerance.get("atol")
    assert len(u) == curve["points"]
    if atol is None:
        normal = expected > 1e-300
        assert_allclose(result[normal], expected[normal], rtol=rtol)
        assert np.all(result[~normal] < 1.001e-300)
        return
    large = expected >= 1e-3 if rtol is not None else np.zeros(len(u), bool)
    assert_allclose(result[large], expected[large], rtol=rtol or 0)
    assert_allclose(result[~large], expected[~large], rtol=0, atol=atol)


def test_exponential_ndf_is_bessel_k_of_three_halves() -> None:
    """D = 2 exp(-2 tan/alpha)/(pi alpha^2 u^4), as the notebook of the exponential NDF states it."""
    u, _ = columns(REFERENCE / "mathematica" / "besselk_2piuD_alpha2.3_a1.5.csv")
    tangent = np.sqrt((1 - u) * (1 + u)) / u
    expected = 2 * np.exp(-2 * tangent / 2.3) / (np.pi * 2.3**2 * u**4)
    normal = expected > 1e-300
    assert_allclose(mf.bessel_k.D(u, 2.3, 1.5)[normal], expected[normal], rtol=1e-11)


@pytest.mark.parametrize(("curve", "kernels", "parameters"), [c for c in served() if "hist" in c.id])
def test_mathematica_histogram(curve: dict[str, Any], kernels: Any, parameters: tuple[float, ...]) -> None:
    """Cosines drawn in the notebooks against Pr(U < u) = survival(tan): chi-square, 10 or more a cell."""
    low, high, count = columns(REFERENCE / "mathematica" / curve["file"])
    width = 0.005
    counts = np.zeros(200)
    counts[np.rint(low / width).astype(int)] = count
    assert_allclose(high - low, width, rtol=1e-9)
    edges = np.arange(201) * width
    with np.errstate(divide="ignore"):
        tangent = np.sqrt((1 - edges) * np.minimum(1 + edges, 2.0).clip(0)) / edges
    tangent[-1] = 0.0
    expected = curve["samples"] * np.diff(kernels.survival(tangent, *parameters))
    pooled: list[tuple[float, float]] = [(0.0, 0.0)]
    for observed, mass in zip(counts, expected, strict=True):
        if pooled[-1][1] >= 10:
            pooled.append((0.0, 0.0))
        pooled[-1] = (pooled[-1][0] + observed, pooled[-1][1] + mass)
    if pooled[-1][1] < 10:
        rest = pooled.pop()
        pooled[-1] = (pooled[-1][0] + rest[0], pooled[-1][1] + rest[1])
    observed_cells, expected_cells = np.array(pooled).T
    assert observed_cells.sum() == curve["counted"] == curve["samples"]
    assert stats.chisquare(observed_cells, expected_cells).pvalue > 1e-3


def frozen(table: dict[str, Any]) -> Any:
    cls = {"beckmann": mf.Beckmann, "ggx": mf.GGX}[table["distribution"]]
    return cls(alpha_x=table["alpha_u"], alpha_y=table["alpha_v"])


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table["id"])
def test_mitsuba_table(table: dict[str, Any]) -> None:
    """Within Mitsuba's own test tolerances; 4e-3 for its rational approximation of the Beckmann G1."""
    ndf, rows = frozen(table), np.array(table["rows"])
    tolerance = {key: table["tolerance"][key] for key in ("rtol", "atol")}
    if "sample" in table["id"]:
        m = ndf.sample(rows[:, :2])
        if table["id"].endswith("pdf"):
            assert_allclose(ndf.pdf(m), rows[:, 2], **tolerance)
        else:
            assert_allclose(m, rows[:, 2:], **tolerance)
        return
    theta, phi, expected = rows.T
    direction = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    result = getattr(ndf, table["columns"][2])(direction)
    if table["columns"][2] == "G1" and table["distribution"] == "beckmann":
        tolerance["rtol"] = 4e-3
    assert_allclose(result, expected, **tolerance)
