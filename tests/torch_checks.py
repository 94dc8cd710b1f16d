"""`array_functions` on PyTorch: what a process of its own checks, each function by its name.

It runs where PyTorch belongs to another Python and an older NumPy: arrays of both meet through DLPack alone.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest
import torch

import microfacet as mf
from array_cases import CASES, METALS, errors, inputs, shape_of, truth
from array_graphs import every_operation, nested_loops
from gradients import POINTS, derivatives, function_of, parameters_of
from microfacet._export.evaluate import Evaluator
from microfacet._export.libraries import library_of
from test_array_functions import tolerance
from test_array_graphs import check, numbers


def tensor(array: Any) -> Any:
    return torch.from_dlpack(np.ascontiguousarray(array))


def array(values: Any) -> Any:
    return np.from_dlpack(values.detach().contiguous())


def graphs() -> None:
    for make in (every_operation, nested_loops):
        for real in ("float32", "float64"):
            built, (x, y, _) = make(real), numbers(real)
            found = Evaluator(built.graph(), library_of(torch))([tensor(x), tensor(y)])
            check(built, list(map(array, found)), x, y)


def values(family: Any) -> None:
    shape = shape_of(family)
    for dtype in ("float32", "float64"):
        given = inputs(1000, dtype, shape["alpha"])
        functions = mf.array_functions(family.name, torch)
        for case in CASES:
            if family.singular and case.material:  # what a ring scatters is 0 or infinite by rounding
                continue
            arguments = [tensor(given[name]) for name in case.takes]
            found = case.of(functions)(*arguments, **shape, **METALS.get(case.material, {}))
            found = found if isinstance(found, tuple) else (found,)
            for got, want in zip(found, truth(case, family.cls(**shape), given), strict=True):
                assert got.dtype == getattr(torch, dtype), case
                off = errors(case, array(got), want)
                part = 0.999 if (case.samples or family.singular) and dtype == "float32" else 1
                off = np.quantile(off, part, method="higher")
                assert off < tolerance(case, dtype), (str(case), dtype, off)


def gradients(family: Any) -> None:
    """Of each quantity by all arguments, in both precisions, as the reference's derivatives."""
    parameters = parameters_of(family)
    for dtype, most in ((torch.float64, 1e-10), (torch.float32, 1e-5)):
        functions = mf.array_functions(family.name, torch)
        for quantity, points in POINTS.items():
            function = function_of(functions, family, quantity)
            for point in points:
                arguments = (*point, *parameters)
                value, want = derivatives(family.name, quantity, arguments)
                given = [torch.tensor(x, dtype=dtype, requires_grad=True) for x in arguments]
                result = function(*given)
                result.backward()
                got = [float(x.grad) for x in given]
                assert float(result.detach()) == pytest.approx(value, rel=most)
                np.testing.assert_allclose(got, want, most, 1e-2 * abs(value) * most, err_msg=quantity)


def samples(family: Any) -> None:
    """Derivatives of drawn directions, weights and densities, by PyTorch's own differences."""
    shape, rng = shape_of(family), np.random.default_rng(1)
    functions = mf.array_functions(family.name, torch)
    w = tensor(inputs(3, "float64", 0.3)["wi"]).requires_grad_(True)
    xi = tensor(rng.uniform(0.2, 0.8, (3, functions.dielectric.sample_dims))).requires_grad_(True)
    alpha = torch.tensor(shape["alpha"], dtype=torch.float64, requires_grad=True)
    rest = {name: value for name, value in shape.items() if name != "alpha"}
    assert torch.autograd.gradcheck(
        lambda w, xi, alpha: functions.sample_visible(w, xi, alpha=alpha, **rest),
        (w, xi, alpha),
        eps=1e-6,
        atol=1e-5,
    )
    assert torch.autograd.gradcheck(
        lambda w, xi, alpha: functions.dielectric.sample(w, xi, eta=1.5, alpha=alpha, **rest),
        (w, xi, alpha),
        eps=1e-6,
        atol=1e-4,
        rtol=1e-3,
    )


def broadcasting() -> None:
    functions = mf.array_functions("student_t", torch)
    alpha = torch.full((4, 1), 0.3, requires_grad=True)
    gamma = torch.tensor([2.0, 2.5, 3.0], requires_grad=True)
    w = tensor(inputs(12, "float32", 0.3)["w"].reshape(4, 3, 3))
    functions.sigma(w, alpha=alpha, gamma=gamma).sum().backward()
    assert alpha.grad.shape == (4, 1)
    assert gamma.grad.shape == (3,)
    single = torch.tensor(0.3, requires_grad=True)
    functions.sigma(w, alpha=single, gamma=gamma.detach()).sum().backward()
    assert float(single.grad) == pytest.approx(float(alpha.grad.sum()), rel=1e-5)
    assert not functions.sigma(w, alpha=0.3, gamma=2.5).requires_grad
    with torch.no_grad():
        assert not functions.sigma(w, alpha=alpha, gamma=2.5).requires_grad


def domains() -> None:
    functions = mf.array_functions("ggx", torch)
    alpha = torch.tensor([0.3, -1.0, float("nan")], requires_grad=True)
    found = functions.cosine.D(0.5, alpha=alpha)
    assert found.isnan().tolist() == [False, True, True]
    found[0].backward()
    assert np.isfinite(float(alpha.grad[0]))


def types() -> None:
    functions = mf.array_functions("ggx", torch).cosine
    assert functions.D(0.5, alpha=0.3).dtype == torch.float32
    assert functions.D([0.5, 1], alpha=0.3).dtype == torch.float32
    assert functions.D(torch.tensor([1]), alpha=0.3).dtype == torch.float32
    assert functions.D(torch.tensor([0.5], dtype=torch.bfloat16), alpha=0.3).dtype == torch.float32
    assert (
        functions.D(torch.tensor([0.5]), alpha=torch.tensor(0.3, dtype=torch.float64)).dtype == torch.float32
    )
    assert (
        functions.D(torch.tensor([0.5], dtype=torch.float64), alpha=torch.tensor([0.3])).dtype
        == torch.float64
    )
    with pytest.raises(ValueError, match="alpha must be real numbers, got complex64"):
        functions.D(0.5, alpha=torch.tensor(0.3j))


def second_derivatives() -> None:
    """The first derivative is a constant to PyTorch."""
    alpha = torch.tensor(0.3, requires_grad=True)
    value = mf.array_functions("ggx", torch).cosine.D(0.5, alpha=alpha)
    (first,) = torch.autograd.grad(value * alpha, alpha, create_graph=True)
    with pytest.raises(RuntimeError, match="once_differentiable"):
        first.backward()


def main(name: str, family: str = "") -> None:
    found = {f.name: f for f in mf.families()}
    globals()[name](*([found[family]] if family else []))


if __name__ == "__main__":
    main(*sys.argv[1:])
