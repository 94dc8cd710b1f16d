"""Derivatives of the arbitrary-precision reference, and what the array libraries' are compared with."""

from __future__ import annotations

from functools import cache
from typing import Any

from flint import arb

from reference import value

#: Quantities of the reference, at which numbers before the parameters, and their name in `array_functions`.
POINTS: dict[str, tuple[tuple[float, ...], ...]] = {
    "D": ((0.75,), (0.9375,)),
    "P22": ((0.125, -0.25),),
    "P2": ((0.25,),),
    "slope_cdf": ((-0.25,), (0.375,)),
    "sigma": ((0.5,), (-0.25,)),
    "Lambda": ((0.5,), (0.125,)),
    "G1": ((0.25,),),
    "survival": ((0.375,),),
}
OF_COSINE = {"D", "sigma", "Lambda", "G1"}
PARAMETERS = {"alpha": 0.3125, "gamma": 2.25, "a": 1.75}  # few binary digits: steps from them are exact
_DIGITS = 256  # to fractions of which values that families state are rounded

# The central difference of the eighth order.
_WEIGHTS = {1: (4, 5), 2: (-1, 5), 3: (4, 105), 4: (-1, 280)}
_STEP = 2.0**-13


@cache
def derivatives(family: str, quantity: str, arguments: tuple[float, ...]) -> tuple[float, tuple[float, ...]]:
    """The value and its derivative by each argument, to about 15 digits."""
    found = []
    for place in range(len(arguments)):
        total = arb(0)
        for steps, (up, down) in _WEIGHTS.items():
            ends = []
            for sign in (1, -1):
                moved = list(arguments)
                moved[place] += sign * steps * _STEP
                ends.append(value(family, quantity, *moved))
            total += (ends[0] - ends[1]) * up / down
        found.append(float((total / _STEP).mid()))
    return float(value(family, quantity, *arguments).mid()), tuple(found)


def parameters_of(family: Any) -> tuple[float, ...]:
    """The values at which a family is differentiated."""
    return tuple(
        PARAMETERS.get(own.name) or round(_DIGITS * own.pictured) / _DIGITS for own in family.parameters
    )


def function_of(functions: Any, family: Any, quantity: str) -> Any:
    """The function on arrays of the reference's arguments, in its order."""
    method = getattr(functions.cosine if quantity in OF_COSINE else functions, quantity)
    names = [parameter.name for parameter in family.parameters]
    own = len(POINTS[quantity][0])
    return lambda *arguments: method(*arguments[:own], **dict(zip(names, arguments[own:], strict=True)))
