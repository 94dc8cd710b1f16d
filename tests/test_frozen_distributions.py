"""What Python users expect of the frozen distributions: they compare, hash, pickle and refuse nonsense."""

from __future__ import annotations

import math
import pickle
import re
from typing import Any

import pytest

import microfacet as mf

each_family = pytest.mark.parametrize("family", mf.families(), ids=lambda family: family.name)


def parameters(family: Any) -> tuple[float, ...]:
    """A typical value of each parameter, inside its open interval."""
    return tuple(
        0.3 if p.name == "alpha" else min(p.lower + 1.25, (p.lower + p.upper) / 2) for p in family.parameters
    )


def distribution(family: Any) -> Any:
    return family.cls(**dict(zip((p.name for p in family.parameters), parameters(family), strict=True)))


@each_family
def test_frozen_distribution_is_a_value(family: Any) -> None:
    one, same = distribution(family), distribution(family)
    assert one == same
    assert hash(one) == hash(same)
    assert pickle.loads(pickle.dumps(one)) == one
    assert one.family == family.name
    namespace = {family.cls.__name__: family.cls}
    assert eval(repr(one), namespace) == one
    other = family.cls(0.31, *family.shapes[-1])
    assert len({one, same, other}) == 2
    with pytest.raises(AttributeError):
        one.alpha = 0.5


@each_family
def test_constructor_names_parameter_value_interval(family: Any) -> None:
    names = [p.name for p in family.parameters]
    good = dict(zip(names, parameters(family), strict=True))
    for parameter in family.parameters:
        for value in (parameter.lower, -1.0, math.nan, math.inf, -math.inf):
            interval = re.escape(f"({parameter.lower:g}, {parameter.upper:g}), got {value:g}")
            sentence = f"^{family.cls.__name__}: {parameter.name} must lie in {interval}"
            with pytest.raises(ValueError, match=sentence):
                family.cls(**{**good, parameter.name: value})


@each_family
def test_constructor_refuses_what_is_no_number(family: Any) -> None:
    names = [p.name for p in family.parameters]
    good = dict(zip(names, parameters(family), strict=True))
    for bad in ("0.3", None, [0.3, 0.4], 0.3j):
        with pytest.raises((TypeError, ValueError)):
            family.cls(**{**good, "alpha": bad})
    with pytest.raises(TypeError):
        family.cls(**good, roughness=0.5)


@each_family
def test_anisotropic_constructor(family: Any) -> None:
    shape = dict(zip((p.name for p in family.parameters), parameters(family), strict=True))
    del shape["alpha"]
    if not family.anisotropic:
        with pytest.raises((TypeError, ValueError)):
            family.cls(alpha_x=0.1, alpha_y=0.4, **shape)
        return
    ndf = family.cls(alpha_x=0.1, alpha_y=0.4, rotation=0.2, **shape)
    assert family.cls(alpha_x=0.1, alpha_y=0.4, rotation=0.2, **shape) == ndf
    assert pickle.loads(pickle.dumps(ndf)) == ndf
    assert eval(repr(ndf), {family.cls.__name__: family.cls}) == ndf
    with pytest.raises(ValueError, match=r"alpha_y must lie in \(1e-101, 1e\+101\), got -0.4"):
        family.cls(alpha_x=0.1, alpha_y=-0.4, **shape)
    with pytest.raises((TypeError, ValueError)):
        family.cls(alpha=0.3, alpha_x=0.1, alpha_y=0.4, **shape)
    with pytest.raises((TypeError, ValueError)):
        family.cls(alpha_x=0.1, **shape)
