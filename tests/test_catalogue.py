"""The checklist of the notebooks: complete, passing, and able to fail."""

from __future__ import annotations

import json
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from microfacet._checks import CheckResult, catalogue, routes, run

NOTEBOOK = {
    "beckmann": "density sigma_upper sigma_lower lambda_of_x shape_invariant normalization slopes_from_D"
    " slopes_normalized marginal lambda_from_marginal sigma_delta sampling",
    "gtr": "density gamma_1 gamma_3_2 normalization slopes_from_D slopes_gamma_1 slopes_gamma_3_2"
    " slopes_normalized marginal marginal_gamma_1 marginal_gamma_3_2 lambda_gamma_1 sigma_gamma_1"
    " sigma_from_marginal sigma_delta",
    "student_t": "density sigma_upper sigma_lower lambda_of_x shape_invariant beckmann_mixture normalization"
    " slopes_from_D slopes_normalized marginal sigma_delta sampling",
    "k0": "density sigma_upper sigma_lower lambda_of_x beckmann_mixture singular_at_normal brdf_singular"
    " shape_invariant normalization slopes_from_D slopes_normalized sigma_delta sampling",
    "bessel_k": "density density_of_chi gamma_mixture chi_mixture shape_invariant normalization"
    " slopes_from_D slopes_normalized sampling",
    "ggx": "density sigma_upper sigma_lower lambda_of_x shape_invariant normalization slopes_from_D"
    " slopes_normalized marginal lambda_from_marginal sigma_delta frechet_mixture gamma_mixture"
    " lambda_mixture mean_roughness unbounded_mean_square",
    "ei": "density lambda_of_x beckmann_mixture shape_invariant normalization slopes_from_D slopes_normalized"
    " sigma_delta",
    "erfc": "density sigma_upper sigma_lower lambda_of_x beckmann_mixture shape_invariant normalization"
    " slopes_from_D slopes_normalized sigma_delta",
    "double_ggx": "density sigma_upper sigma_lower lambda_of_x lambda_bessel shape_invariant ggx_mixture"
    " slopes_from_D slopes_normalized sigma_delta",
    "generalised_exponential": "density beckmann exponential slopes_from_D slopes_normalized marginal_2"
    " marginal_4 shape_invariant",
    "exponential": "density gamma_mixture chi_mixture shape_invariant slopes_from_D slopes_normalized"
    " sigma_delta masking_by_ei sampling",
    "dirac": "sigma_upper sigma_lower normalization slopes_normalized marginal",
}
ITEMS = {item.id: item for item in catalogue()}
UFUNCS = ("D", "P22", "P2", "slope_cdf", "sigma", "Lambda", "G1", "survival", "sample_slope", "sample_u")


def once(check_id: str, **keywords: Any) -> CheckResult:
    (result,) = run(ids=[check_id], **keywords)
    return result


@pytest.fixture
def altered(monkeypatch: pytest.MonkeyPatch) -> Any:
    """``altered(family, wrap)``: in the checks each ufunc f of the family becomes ``wrap(name, f)``."""
    original = routes.kernels

    def alter(family: str, wrap: Any) -> None:
        wrong = {name: wrap(name, getattr(original(family), name)) for name in UFUNCS}
        monkeypatch.setattr(
            routes, "kernels", lambda name: SimpleNamespace(**wrong) if name == family else original(name)
        )

    return alter


def test_every_family_has_checks_in_the_order_of_the_library() -> None:
    assert list(dict.fromkeys(item.family for item in catalogue())) == [f.name for f in mf.families()]
    assert len(ITEMS) == len(catalogue())


@pytest.mark.parametrize("family", mf.families(), ids=lambda family: family.name)
def test_the_notebook_is_checked_to_the_last_statement(family: Any) -> None:
    stated = [item.id for item in catalogue() if item.family == family.name and item.notebook]
    assert stated == [f"{family.name}.{name}" for name in NOTEBOOK.get(family.name, "").split()]
    assert all("notebook" in ITEMS[name].source for name in stated)


@pytest.mark.parametrize("check_id", ITEMS)
def test_passes(check_id: str) -> None:
    result = once(check_id)
    assert result.passed, result
    assert result.parameters == ITEMS[check_id].parameters
    keys = [
        "id",
        "family",
        "parameters",
        "lhs",
        "rhs",
        "residual",
        "tolerance",
        "passed",
        "source",
        "symbolic",
    ]
    assert list(json.loads(json.dumps(result.as_dict(), allow_nan=False))) == keys


def used_by(check_id: str, altered: Any) -> Iterator[str]:
    """The ufuncs of its own family that a check calls."""
    used: set[str] = set()

    def recording(name: str, ufunc: Any) -> Any:
        return lambda *arguments: (used.add(name), ufunc(*arguments))[1]

    altered(ITEMS[check_id].family, recording)
    once(check_id)
    yield from sorted(used)


@pytest.mark.parametrize("check_id", [id for id in ITEMS if not id.endswith(".sampling")])
def test_fails_when_a_function_is_wrong_by_a_millionth(check_id: str, altered: Any) -> None:
    names = list(used_by(check_id, altered))
    assert names
    for wrong in names:
        altered(
            ITEMS[check_id].family,
            lambda name, f, wrong=wrong: (lambda *a: f(*a) * (1 + 1e-6)) if name == wrong else f,
        )
        result = once(check_id)
        assert not result.passed, (wrong, result)


@pytest.mark.parametrize("check_id", [id for id in ITEMS if id.endswith(".sampling")])
def test_a_histogram_fails_when_its_density_or_its_sampler_is_wrong(check_id: str, altered: Any) -> None:
    def tilted(name: str, f: Any) -> Any:  # another density, also of mass 1 to first order
        return (lambda u, *a: f(u, *a) * (1.03 - 0.06 * (u > f_median(u)))) if name == "D" else f

    def f_median(u: Any) -> Any:
        return routes.kernels(ITEMS[check_id].family).sample_u(0.5, *ITEMS[check_id].parameters.values())

    def late(name: str, f: Any) -> Any:  # a sampler that reads xi^1.1
        return (lambda xi, *a: f(np.asarray(xi) ** 1.1, *a)) if name == "sample_u" else f

    for wrap in (tilted, late):
        altered(ITEMS[check_id].family, wrap)
        assert not once(check_id).passed, wrap.__name__


@pytest.mark.parametrize("check_id", ["k0.beckmann_mixture", "bessel_k.chi_mixture", "gtr.ggx_mixture"])
def test_a_mixture_depends_on_the_family_that_it_mixes(check_id: str, altered: Any) -> None:
    altered("ggx" if "ggx" in check_id else "beckmann", lambda name, f: lambda *a: f(*a) * (1 + 1e-6))
    assert not once(check_id).passed


@pytest.mark.parametrize("check_id", [id for id in ITEMS if id.startswith("k0.")])
def test_nan_fails_and_serialises(check_id: str, altered: Any) -> None:
    altered("k0", lambda name, f: lambda *a: np.full(np.shape(f(*a)), np.nan))
    result = once(check_id)
    assert not result.passed
    assert json.loads(json.dumps(result.as_dict(), allow_nan=False))["lhs"] is None


@pytest.mark.parametrize(
    ("family", "parameters"),
    [
        ("beckmann", None),
        ("ggx", None),
        ("k0", None),
        ("student_t", {"alpha": 1e-4}),
        ("student_t", {"alpha": 0.7}),
        ("gtr", {"alpha": 1e-4}),
        ("gtr", {"alpha": 10.0}),
        ("gtr", {"gamma": 1.0}),
        ("bessel_k", {"alpha": 1e-4}),
        ("bessel_k", {"a": 0.3}),
    ],
)
def test_holds_over_the_domain(family: str, parameters: dict[str, float] | None) -> None:
    failures = [r for r in run(families=[family], grid=True, parameters=parameters) if not r.passed]
    assert not failures


def test_parameters_replace_the_notebooks_own() -> None:
    results = list(run(families=["gtr", "k0"], parameters={"alpha": 0.3, "gamma": 2.5}))
    by_id = {result.id: result.parameters for result in results}
    assert by_id["k0.lambda_of_x"] == {"alpha": 0.3}
    assert by_id["gtr.marginal"] == {"alpha": 0.3, "gamma": 2.5}
    assert by_id["gtr.gamma_1"] == {"alpha": 0.3, "gamma": 1.0}  # gamma is part of the statement
    assert "gtr.ggx_mixture" not in by_id  # no such mixture for gamma >= 2
    assert all(result.passed for result in results)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"ids": ["gtr.marginl"]}, r"unknown check 'gtr.marginl'; did you mean one of gtr.marginal"),
        ({"families": ["phong"]}, r"unknown family 'phong'; did you mean one of beckmann, ggx"),
        (
            {"parameters": {"roughness": 0.3}},
            r"unknown parameter 'roughness'; the families have a, alpha, .*gamma",
        ),
        ({"parameters": {"alpha": 0.0}}, r"beckmann: alpha must lie in \(1e-101, 1e\+101\), got 0"),
        ({"parameters": {"alpha": float("nan")}}, r"alpha must lie in \(1e-101, 1e\+101\), got nan"),
        ({"parameters": {"gamma": 1.2}}, r"student_t: gamma must lie in \(1.5, inf\), got 1.2"),
        ({"families": ["bessel_k"], "parameters": {"a": -1}}, r"bessel_k: a must lie in \(0, .*\), got -1"),
    ],
)
def test_bad_input_is_refused_at_the_call(keywords: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        run(**keywords)


def test_the_formulas_are_latex_that_the_report_can_set() -> None:
    from latex2mathml.converter import convert

    for item in ITEMS.values():
        assert "\\" not in convert(item.latex), item.id
        assert item.statement.strip()
        assert item.source.strip()


def test_the_quadrature_knows_the_gamma_function_and_a_heavy_tail() -> None:
    from scipy.special import gamma

    powers = np.array([0.5, 1.0, 3.7])
    integral = routes.integrate(lambda r, s: r ** (s - 1) * np.exp(-r), 1e-70, 1e3, powers)
    np.testing.assert_allclose(integral, gamma(powers), rtol=1e-14)
    tail = routes.integrate(lambda r: (1 + r**2) ** -0.6, 1e-20, routes.FAR)  # decays like r^-0.2
    np.testing.assert_allclose(tail, np.sqrt(np.pi) * gamma(0.1) / (2 * gamma(0.6)), rtol=1e-13)


def test_the_delta_integral_is_the_complex_one() -> None:
    """The printed formula, literally, by an adaptive rule; GGX is smooth enough for it."""
    from scipy.integrate import quad

    from microfacet import ggx

    def printed(ui: float, u: float) -> float:
        root = np.sqrt(complex(1 - u**2 - ui**2))
        arc = np.arccos(complex(-u * ui / (np.sqrt(1 - u**2) * np.sqrt(1 - ui**2))))
        return float(ggx.D(ui, 0.4) * (2 * (root + u * ui * arc)).real)

    for u in (-0.8, -0.2, 0.3, 0.9):
        kink = np.sqrt(1 - u**2)
        parts = [
            quad(printed, a, b, args=(u,), epsabs=1e-13, limit=200)[0] for a, b in ((0, kink), (kink, 1))
        ]
        np.testing.assert_allclose(
            routes.delta_integral(ggx, np.array([u]), 1e-17, 0.4), sum(parts), rtol=1e-9
        )


def test_printed_forms_that_cancel_get_the_digits_they_need() -> None:
    from mpmath import mp

    value = routes.exact(lambda x: (mp.exp(x) - 1 - x) / x**2, [1e-30, 1e-3])
    np.testing.assert_allclose(value, [0.5, 0.5001667083416681], rtol=1e-15)
