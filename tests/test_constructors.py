"""Constructors that are called wrongly: the class that was called, and how it is called."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import pytest

import microfacet as mf

FAMILIES = {family.cls.__name__: family.cls for family in mf.families()}
CLASSES = FAMILIES | {
    name: getattr(mf, name)
    for name in ("RadialNDF", "SlopeTable", "Conductor", "Dielectric", "Diffuse", "KullaConty", "Turquin")
}
WRONG: dict[str, Callable[[Any], Any]] = {
    "too many": lambda cls: cls(*[0.25] * 9),
    "unknown": lambda cls: cls(0.25, roughness=0.5),
    "unknown beside a right one": lambda cls: cls(rotations=0.5),
}


@pytest.mark.parametrize("name", CLASSES)
@pytest.mark.parametrize("call", WRONG.values(), ids=WRONG)
def test_wrong_arguments_blame_the_class_that_was_called(name: str, call: Callable[[Any], Any]) -> None:
    cls = CLASSES[name]
    with pytest.raises(TypeError) as caught:
        call(cls)
    said = str(caught.value)
    assert said.startswith(f"{name}: ")
    assert f"it is called as {name}(" in said
    for parameter in inspect.signature(cls).parameters:
        assert parameter in said
    for other in ("Distribution", "Material", "_Compensated", "__init__"):
        assert other not in said
    assert "\n" not in said


@pytest.mark.parametrize(
    "name", ["GTR", "RadialNDF", "SlopeTable", "Conductor", "Dielectric", "Diffuse", "KullaConty", "Turquin"]
)
def test_a_missing_argument_is_named(name: str) -> None:
    with pytest.raises(
        TypeError, match=rf"^{name}: missing a required argument: '\w+'; it is called as {name}\("
    ):
        CLASSES[name]()


def test_ggx_of_two_numbers_names_both_roughnesses() -> None:
    with pytest.raises(TypeError, match=r"GGX\(alpha=None, \*, alpha_x=None, alpha_y=None, rotation=0\.0\)"):
        mf.GGX(0.1, 0.2)


def test_an_error_inside_a_constructor_is_its_own() -> None:
    def density(r: float) -> float:
        raise TypeError("from the density")

    with pytest.raises(TypeError, match=r"^from the density$"):
        mf.RadialNDF(density, alpha=0.3)


def test_a_subclass_is_named_too() -> None:
    class Mine(mf.Beckmann):
        pass

    with pytest.raises(TypeError, match=r"^Mine: too many positional arguments"):
        Mine(1.0, 2.0)


@pytest.mark.parametrize("name", CLASSES)
def test_signatures_stay_readable(name: str) -> None:
    parameters = inspect.signature(CLASSES[name]).parameters.values()
    assert all(parameter.kind is not inspect.Parameter.VAR_KEYWORD for parameter in parameters)
