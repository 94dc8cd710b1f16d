"""Several wavelengths: the distribution is prepared once for each of them, not once for each element."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from material_cases import COPPER, FAMILIES, directions, of_family

N = 3000


def prepared(call: Callable[[], Any]) -> int:
    """How many distributions the kernels of materials prepare for a call."""
    count = mf.GGX.kernels.distributions_prepared
    before = count()
    call()
    return int(count() - before)


def calls(material: Any, n: int) -> dict[str, Callable[[], Any]]:
    wi, wo = directions(n, 1, +1), directions(n, 2, +1)
    if getattr(material, "scattering", "single") == "multiple":
        return {
            "eval": lambda: material.eval(wi, wo, rng=1),
            "sample": lambda: material.sample(wi, rng=1),
            "walk": lambda: material.walk(wi, rng=1),
        }
    xi = np.random.default_rng(3).random((n, material.sample_dims))
    return {
        "eval": lambda: material.eval(wi, wo),
        "pdf": lambda: material.pdf(wi, wo),
        "sample": lambda: material.sample(wi, xi),
    }


@pytest.mark.parametrize("family", FAMILIES)
def test_once_for_each_channel(family: str) -> None:
    ndf = of_family(family, 0.4)
    for make, channels in (
        (lambda eta, k: mf.Conductor(ndf, eta, k), 3),
        (lambda eta, k: mf.Conductor(ndf, eta, k, scattering="multiple"), 3),
        (lambda eta, _: mf.Diffuse(ndf, np.asarray(eta) / 2, scattering="multiple"), 3),
    ):
        one, several = calls(make(0.2, 3.9), N), calls(make(*COPPER), N)
        for name in one:
            alone, together = prepared(one[name]), prepared(several[name])
            assert 1 <= alone <= 4, name  # samples of walks ask for a density, too
            assert together <= channels * alone, name


def test_the_same_values_in_any_order() -> None:
    """Elements or channels, whichever are more, run in the inner loop; results do not show which."""
    eta, k = np.linspace(0.2, 2.0, 40), np.linspace(1.0, 4.0, 40)
    ndf = mf.StudentT(alpha_x=0.2, alpha_y=0.5, gamma=2.5)
    for constants in ((eta, k), (eta.reshape(5, 8), k.reshape(5, 8)), (eta[:, None], k[:3])):
        shape = np.broadcast_shapes(*(np.shape(c) for c in constants))
        metal = mf.Conductor(ndf, *constants)
        for n in (1, 7, 200):
            wi, wo = directions(n, 4, +1), directions(n, 5, +1)
            xi = np.random.default_rng(6).random((n, 3))
            values, (out, weights, pdf) = metal.eval(wi, wo), metal.sample(wi, xi)
            assert values.shape == weights.shape == (n, *shape)
            assert (out.shape, pdf.shape) == ((n, 3), (n,))
            for index in np.ndindex(shape):
                single = mf.Conductor(ndf, *(np.broadcast_to(c, shape)[index] for c in constants))
                np.testing.assert_array_equal(values[(..., *index)], single.eval(wi, wo))
                expected = single.sample(wi, xi)
                np.testing.assert_array_equal(weights[(..., *index)], expected[1])
                np.testing.assert_array_equal(out, expected[0])
                np.testing.assert_array_equal(pdf, expected[2])


@pytest.mark.parametrize(
    ("elements", "constants", "most"),
    [(3000, (), 1), (3000, (3,), 3), (2, (40,), 2), (1, (3,), 1), (50, (50,), 50), (3000, (2, 3), 6)],
)
def test_as_few_as_there_can_be(elements: int, constants: tuple[int, ...], most: int) -> None:
    metal = mf.Conductor(mf.GTR(alpha=0.4, gamma=1.5), np.full(constants, 0.2), np.full(constants, 3.9))
    for name, call in calls(metal, elements).items():
        assert prepared(call) <= most, name


def test_axes_that_are_short_or_broadcast() -> None:
    """The kind, not the case: directions whose last axis is short, or that are views of one another."""
    wi, wo = directions(N, 7, +1), directions(N, 8, +1)
    for material in (mf.Conductor(mf.GGX(alpha=0.4), *COPPER), mf.Dielectric(mf.K0(alpha=0.4), 1.5)):
        channels = 3 if isinstance(material, mf.Conductor) else 1
        for i, o in (
            (wi.reshape(-1, 3, 3), wo.reshape(-1, 3, 3)),
            (wi.reshape(-1, 1, 3), wo.reshape(-1, 3)[:4]),
            (np.broadcast_to(wi[0], (N // 2, 2, 3)), wo.reshape(-1, 2, 3)[:, :1]),
            (wi[::-2], wo[0]),
        ):
            expected = material.eval(
                np.array(np.broadcast_arrays(i, o)[0]), np.array(np.broadcast_arrays(i, o)[1])
            )
            assert prepared(lambda i=i, o=o, m=material: m.eval(i, o)) <= channels
            assert prepared(lambda i=i, o=o, m=material: m.pdf(i, o)) <= channels
            np.testing.assert_array_equal(material.eval(i, o), expected)
