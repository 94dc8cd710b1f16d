"""A check compares all that its statement says, by routes that share nothing, in numbers that show it."""

from __future__ import annotations

import json
import re
import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from flint import arb, ctx
from mpmath import mp
from scipy.stats import chi2

import microfacet as mf
import reference
from microfacet._checks import CheckResult, catalogue, gtr_forms, k0, p_value, routes, run, tallies
from microfacet._checks.symbolic import Algebra
from microfacet.cli import main

ITEMS = {item.id: item for item in catalogue()}
SHAPES: dict[str, tuple[dict[str, float], ...]] = {
    "gtr": ({"gamma": 0.7}, {"gamma": 2.9}),
    "student_t": ({"gamma": 1.75}, {"gamma": 4.4}),
    "bessel_k": ({"a": 0.37}, {"a": 0.94}, {"a": 1.0}, {"a": 2.7}),
    "generalised_exponential": ({"g": 0.6}, {"g": 1.4}, {"g": 3.7}),
}
WHOLE = [
    id
    for id, item in ITEMS.items()
    if id.endswith(("normalization", "slopes_normalized")) and re.search(r"\\int.* = 1\b", item.latex)
]
SINGULAR = {"k0", "bessel_k", "ei", "erfc"}  # infinite at the normal, for some shape at least


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
    # Next to a pole that is a power, the statement leaves the normals to a closed form.
    if shape.get("a", 1.0) >= 1 and item.family != "erfc"
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
        singular = item.family in SINGULAR
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


# Printed forms


@pytest.mark.parametrize("alpha", [0.02, 0.5, 1.0, 3.0])
def test_gtr_of_three_halves_is_henyey_and_greensteins_phase_function(alpha: float) -> None:
    """To 60 digits, typed anew; the mean cosine of the angle from the mirror direction is its asymmetry g."""
    with ctx.workprec(256), mp.workdps(60):
        a = arb(alpha)
        g = (1 - a) / (1 + a)
        for u in map(arb, (0.001, 0.3, 0.7, 0.999, 1.0)):
            c = 2 * u**2 - 1
            phase = (1 - g**2) / (4 * arb.pi() * (1 + g**2 - 2 * g * c) ** arb(1.5))
            density = reference.Reference("gtr", alpha, 1.5).D(u)
            assert abs(density / (4 * phase) - 1) < arb("1e-60")
            typed = gtr_forms.henyey_greenstein(*(mp.mpf(x.str(70, radius=False)) for x in (c, g)))
            assert abs(arb(str(typed)) / phase - 1) < arb("1e-55")
        normal = float(g)
    xi = (np.arange(200_000) + 0.5) / 200_000
    u = mf.gtr.sample_u(xi, alpha, 1.5)
    assert np.mean(2 * u**2 - 1) == pytest.approx(normal, abs=1e-5)


@pytest.mark.parametrize("check_id", [id for id in ITEMS if "density" in id.partition(".")[2]])
def test_a_density_below_the_horizon_is_found(check_id: str, altered: Any) -> None:
    altered(ITEMS[check_id].family, "D", lambda D: lambda u, *a: D(u, *a) + 1e-9 * (np.asarray(u) <= 0))
    assert not once(check_id).passed


def test_k0_grows_towards_the_mirror_direction_and_beckmann_ends() -> None:
    """Between 1e-4 and 1e-8 rad by 2 ln(1e4) over the peak of Beckmann, at any roughness."""
    off = np.array([1e-2, 1e-4, 1e-8])
    wo = np.stack([np.sin(off), 0 * off, np.cos(off)], axis=-1)
    for alpha in (0.3, 3.0, 30.0):
        of_k0, of_beckmann = (
            4 * np.pi * alpha**2 * mf.Conductor(family(alpha=alpha)).eval([0, 0, 1], wo) / wo[:, 2]
            for family in (mf.K0, mf.Beckmann)
        )
        assert of_k0[0] < of_k0[1] < of_k0[2]
        assert of_k0[2] - of_k0[1] == pytest.approx(2 * np.log(1e4), rel=1e-4)
        assert of_beckmann == pytest.approx(1.0, abs=2e-3)
        assert np.isinf(mf.Conductor(mf.K0(alpha=alpha)).eval([0, 0, 1], [0, 0, 1]))


def test_a_singularity_that_levels_off_is_found(altered: Any) -> None:
    altered("k0", "P22", lambda P22: lambda p, q, *a: P22(np.maximum(p, 1e-7), q, *a))
    assert not once("k0.brdf_singular").passed


# Algebra

PROVED = [f"{family}.sigma_{side}" for family in ("beckmann", "student_t") for side in ("upper", "lower")]
PROVED += ["ggx.sigma_upper", "gtr.henyey_greenstein"]


@pytest.mark.parametrize("check_id", PROVED)
def test_algebra_confirms_what_the_notebooks_simplify(check_id: str) -> None:
    pytest.importorskip("sympy", reason="SymPy, which is optional, is not installed")
    assert once(check_id).symbolic == "confirmed"
    assert once(check_id, alpha=0.37).symbolic == "confirmed", "for all roughnesses"


def test_algebra_refutes_what_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    sp = pytest.importorskip("sympy", reason="SymPy, which is optional, is not installed")
    x = sp.Symbol("x", positive=True)
    assert Algebra(lambda sp: (sp.sqrt(x**2) - x,)).verdict({}) == "confirmed"
    wrong = Algebra(lambda sp: (sp.sqrt(x**2) - x, sp.erf(x) - x))
    assert wrong.verdict({}) == "refuted"
    monkeypatch.setattr(Algebra, "verdict", lambda *_: "refuted")
    result = once("beckmann.sigma_upper")
    assert not result.passed
    assert result.symbolic == "refuted"


def test_algebra_that_is_not_run_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    assert once("student_t.sigma_upper", gamma=2.7).symbolic == "not run", "the proof is of gamma = 3"
    assert once("k0.sigma_upper").symbolic is None, "no proof"
    monkeypatch.setitem(sys.modules, "sympy", None)
    result = CliRunner().invoke(main, ["verify", "--id", "beckmann.sigma_upper"])
    assert result.exit_code == 0
    row = next(line for line in result.stdout.splitlines() if "beckmann.sigma_upper" in line)
    assert "not run" in row
    assert "✓ holds" in row, "the numbers do"
    assert "algebra was not run: it needs sympy, which is not installed" in result.stdout


# Counts


def test_statements_are_counted_family_by_family() -> None:
    ids = ["k0.sampling", "k0.marginal", "gtr.gamma_1"]
    result = CliRunner().invoke(main, ["verify", *(f"--id={id}" for id in ids)])
    rows = {cells[0]: cells[1:] for line in result.stdout.splitlines() if (cells := line.split())}
    stated = {
        family: [sum(i.family == family and i.notebook == kind for i in ITEMS.values()) for kind in (1, 0)]
        for family in ("gtr", "k0")
    }
    assert rows["gtr"] == [str(stated["gtr"][0]), "1", "1", str(stated["gtr"][1]), "0", "0"]
    assert rows["k0"] == [str(stated["k0"][0]), "1", "1", str(stated["k0"][1]), "1", "1"]
    record = json.loads(CliRunner().invoke(main, ["verify", "--json", *(f"--id={id}" for id in ids)]).stdout)
    assert list(record["families"]) == ["gtr", "k0"]
    assert record["families"]["k0"]["further"] == {"stated": stated["k0"][1], "checked": 1, "held": 1}


def test_a_statement_that_fails_anywhere_does_not_hold(altered: Any) -> None:
    altered("k0", "Lambda", lambda Lambda: lambda u, a: Lambda(u, a) * (1 + 1e-6 * (a > 2)))
    results = list(run(ids=["k0.lambda_of_x", "k0.survival"], grid=True))
    assert any(result.passed for result in results if result.id == "k0.lambda_of_x")
    assert tallies(results)["k0"]["notebook"][1:] == (1, 0)
    assert tallies(results)["k0"]["further"][1:] == (1, 1)


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
