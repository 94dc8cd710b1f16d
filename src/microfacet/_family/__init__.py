"""The families: one module each, in the order in which documentation lists them."""

from __future__ import annotations

from functools import cache

from . import (
    beckmann,
    bessel_k,
    dirac,
    double_ggx,
    ei,
    erfc,
    exponential,
    generalised_exponential,
    ggx,
    gtr,
    k0,
    student_t,
)
from .registry import Family, Parameter, describe

__all__ = ["MODULES", "Family", "Parameter", "families"]

MODULES = (
    beckmann,
    ggx,
    gtr,
    student_t,
    k0,
    bessel_k,
    ei,
    erfc,
    double_ggx,
    generalised_exponential,
    exponential,
    dirac,
)
"""THE list of families in Python; tests, checks and reports iterate `families()`."""


@cache
def families() -> tuple[Family, ...]:
    """Every family of the library, with its parameters, their domains and its sources.

    Examples
    --------
    >>> import microfacet as mf
    >>> [family.name for family in mf.families()][:6]
    ['beckmann', 'ggx', 'gtr', 'student_t', 'k0', 'bessel_k']
    >>> mf.families()[3].parameters[1]
    Parameter(name='gamma', lower=1.5, upper=inf)
    """
    return tuple(describe(module) for module in MODULES)
