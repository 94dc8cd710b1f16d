"""A check compares all that its statement says, by routes that share nothing, in numbers that show it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from mpmath import mp
from scipy.stats import chi2

from microfacet._checks import CheckResult, catalogue, k0, p_value, routes, run
from microfacet.cli import main

ITEMS = {item.id: item for item in catalogue()}
SHAPES: dict[str, tuple[dict[str, float], ...]] = {
    "gtr": ({"gamma": 0.7}, {"gamma": 2.9}),
    "student_t": ({"gamma": 1.75}, {"gamma": 4.4}),
    "bessel_k": ({"a": 0.37}, {"a": 0.94}, {"a": 1.0}, {"a": 2.7}),
}
WHOLE = [id for id, item in ITEMS.items() if item.latex.endswith("= 1") and "int" in item.latex]


def once(check_id: str, **parameters: float) -> CheckResult:
    (result,) = run(ids=[check_id], parameters=parameters or None)
    return result


@pytest.fixture
def altered(monkeypatch: pytest.MonkeyPatch) -> Any:
    """``altered(family, name, wrong)``: in the checks the ufunc `name` of the family is `wrong` of itself."""
    original = routes.kernels

    def alter(family: str, name: str, wrong: Any) -> None:
        own = original(family)
        names = ("D", "P22", "P2", "sigma", "Lambda", "survival", "sample_slope", "sample_u")
        kernels = SimpleNamespace(**{each: getattr(own, each) for each in names})
        setattr(kernels, name, wrong(getattr(own, name)))
        monkeypatch.setattr(routes, "kernels", lambda asked: kernels if asked == family else original(asked))

    return alter


# The whole integral


def test_every_family_has_both_normalizations() -> None:
    families = {item.family for item in ITEMS.values()}
    assert set(WHOLE) == {f"{f}.{name}" for f in families for name in ("normalization", "slopes_normalized")}


@pytest.mark.parametrize("check_id", WHOLE)
@pytest.mark.parametrize("alpha", [0.23, 0.6, 2.9])
def test_what_integrates_to_one_prints_one(check_id: str, alpha: float) -> None:
    for shape in SHAPES.get(ITEMS[check_id].family, ({},)):
        result = once(check_id, alpha=alpha, **shape)
        assert result.passed, result
        assert result.rhs == 1.0
        assert f"{result.lhs:.12g}" == "1", result


def wrong_near_normal(D: Any) -> Any:
    """The density of normals, off by a thousandth for slopes between 1e-6 and 0.02."""
    return lambda u, *a: D(u, *a) * (1 + 1e-3 * ((u < 1 - 1e-12) & (u > 1 - 2e-4)))


OVER_U = [
    (check_id, shape)
    for check_id, item in ITEMS.items()
    if item.route == "quadrature over u"
    for shape in SHAPES.get(item.family, ({},))
    if shape.get("a", 1.0) >= 1  # below, the statement leaves the normals next to the pole to a closed form
]


@pytest.mark.parametrize(("check_id", "shape"), OVER_U)
def test_a_density_that_is_wrong_at_the_normal_alone_is_found(
    check_id: str, shape: dict[str, float], altered: Any
) -> None:
    altered(ITEMS[check_id].family, "D", wrong_near_normal)
    assert not once(check_id, alpha=0.45, **shape).passed


@pytest.mark.parametrize("a", [0.3, 0.8])
def test_the_double_integral_reaches_slopes_of_any_smallness(a: float, altered: Any) -> None:
    altered("bessel_k", "P22", lambda P22: lambda p, q, *s: P22(p, q, *s) * (1 + (np.hypot(p, q) < 1e-17)))
    seen = a < 0.5  # at a = 0.8 the mass there is 1e-27
    assert once("bessel_k.slopes_normalized", alpha=0.6, a=a).passed != seen


def test_a_closed_form_in_an_integral_is_said() -> None:
    for item in ITEMS.values():
        singular = item.family in {"k0", "bessel_k"}
        if item.id.endswith((".normalization", ".sigma_delta")):
            assert ("in closed form" in item.statement) == singular, item.id


# More than one roughness


@pytest.mark.parametrize(
    "check_id", [id for id in ITEMS if id.endswith((".lambda_of_x", ".shape_invariant"))]
)
def test_one_roughness_does_not_show_that_a_function_is_independent_of_it(
    check_id: str, altered: Any
) -> None:
    family, name = check_id.split(".")
    shape = SHAPES.get(family, ({},))[-1]
    at = 0.41

    def drifting(f: Any) -> Any:  # right at the roughness that was asked for
        return lambda u, alpha, *s: f(u, alpha, *s) * (1 + 1e-6 * np.log(alpha / at))

    altered(family, "D" if name == "shape_invariant" else "Lambda", drifting)
    assert not once(check_id, alpha=at, **shape).passed
    altered(family, "D" if name == "shape_invariant" else "Lambda", lambda f: f)
    assert once(check_id, alpha=at, **shape).passed


def test_the_printed_sigma_of_k0_does_not_pass_through_lambda(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(k0, "lambda_of_u", None)
    alpha = mp.mpf("0.37")

    def seen(u: Any) -> Any:
        s = mp.sqrt(1 - u**2)
        return mp.quad(lambda p: (u - p * s) * k0.P2(p, alpha), sorted({mp.ninf, min(u / s, 0), u / s}))

    for u in map(mp.mpf, (-0.8, -0.1, 0.2, 0.9)):
        assert abs(k0.sigma(u, alpha) / seen(u) - 1) < 1e-12


# Histograms


def test_the_p_value_is_that_of_the_chi_square_distribution() -> None:
    result = once("ggx.sampling", alpha=0.35)
    assert p_value(result) == pytest.approx(chi2.sf(result.lhs, result.rhs), rel=1e-12)
    assert 1e-4 < p_value(result) < 1


@pytest.mark.parametrize(("p", "passed"), [(1.02e-4, True), (0.98e-4, False)])
def test_a_histogram_is_rejected_at_the_least_p_value(
    p: float, passed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(routes, "chi_square", lambda *_: (float(chi2.isf(p, 63)), 63.0))
    result = once("k0.sampling")
    assert p_value(result) == pytest.approx(p, rel=1e-9)
    assert result.passed == passed


@pytest.mark.parametrize("check_id", [id for id in ITEMS if id.endswith(".sampling")])
def test_of_two_histograms_the_less_likely_is_shown(check_id: str, monkeypatch: pytest.MonkeyPatch) -> None:
    statistics = iter([(12.0, 63.0), (80.0, 63.0)])
    monkeypatch.setattr(routes, "chi_square", lambda *_: next(statistics))
    assert once(check_id).lhs == 80.0


def test_the_terminal_has_columns_for_histograms() -> None:
    result = CliRunner().invoke(main, ["verify", "--id", "k0.sampling", "--id", "k0.marginal"])
    above, below = result.stdout.split("k0.marginal", 1)
    assert "left side" in above
    assert "p-value" not in above
    for heading in ("chi-square", "degrees of freedom", "p-value", "least accepted"):
        assert heading in below
    alone = CliRunner().invoke(main, ["verify", "--id", "gtr.sampling"]).stdout
    assert "left side" not in alone
    assert "✓ holds" in alone
